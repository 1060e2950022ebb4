// tests/reference/npy.h -- reads the reference numbers: NumPy's .npy, versions 1 and 2
// SPDX-License-Identifier: Apache-2.0
//
// Of types: float32, float16, int32 and uint8, little-endian, rows first (C order). What is wrong with a file is a
// std::runtime_error of one line: the file, what was found, what was expected.
#pragma once
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace reference {

/// Numbers in the order of the file, the last index fastest. Every type that is read is exact in double.
struct Array {
  std::vector<std::size_t> shape;
  std::vector<double> values;

  std::size_t size() const { return values.size(); }
  /// An element by all its indices.
  template <class... I> double operator()(I... index) const {
    const std::size_t at[] = {std::size_t(index)...};
    if (sizeof...(I) != shape.size())
      throw std::runtime_error("array of " + std::to_string(shape.size()) + " indices asked with " +
                               std::to_string(sizeof...(I)));
    std::size_t flat = 0;
    for (std::size_t k = 0; k < sizeof...(I); ++k) {
      if (at[k] >= shape[k])
        throw std::runtime_error("index " + std::to_string(at[k]) + " of an array of " + std::to_string(shape[k]));
      flat = flat * shape[k] + at[k];
    }
    return values[flat];
  }
};

/// IEEE 754 binary16.
inline double from_half(std::uint16_t h) {
  const int exponent = (h >> 10) & 31, fraction = h & 1023;
  const double size = exponent == 31  ? (fraction ? std::numeric_limits<double>::quiet_NaN() : HUGE_VAL)
                      : exponent == 0 ? std::ldexp(fraction, -24)
                                      : std::ldexp(1024 + fraction, exponent - 25);
  return h & 0x8000 ? -size : size;
}

inline Array read_npy(const std::string& path) {
  const auto wrong = [&](const std::string& text) -> std::runtime_error {
    return std::runtime_error(path + ": " + text);
  };
  std::ifstream file(path, std::ios::binary);
  if (!file) throw wrong("cannot be opened; tests/reference/generate.py --write makes it");
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (bytes.size() < 12 || bytes.compare(0, 6, "\x93NUMPY") != 0) throw wrong("no .npy file");
  const auto byte = [&](std::size_t i) { return std::size_t(static_cast<unsigned char>(bytes[i])); };
  const std::size_t version = byte(6), start = version == 1 ? 10 : 12;
  if (version != 1 && version != 2) throw wrong("version " + std::to_string(version) + ", expected 1 or 2");
  std::size_t length = byte(8) | byte(9) << 8;
  if (version == 2) length |= byte(10) << 16 | byte(11) << 24;
  if (length > bytes.size() - start) throw wrong("ends within its header");
  const std::string header = bytes.substr(start, length);

  // {'descr': '<f4', 'fortran_order': False, 'shape': (10000, 3), }
  const auto after = [&](const std::string& key) {
    const std::size_t at = header.find("'" + key + "':");
    if (at == std::string::npos) throw wrong("no " + key + " in its header");
    return header.substr(header.find_first_not_of(' ', at + key.size() + 3));
  };
  const std::string type = after("descr").substr(0, 5);
  if (after("fortran_order").rfind("False", 0) != 0) throw wrong("columns first, expected rows first");
  const int width = type == "'<f4'" || type == "'<i4'" ? 4 : type == "'<f2'" ? 2 : type == "'|u1'" ? 1 : 0;
  if (width == 0) throw wrong("type " + type + ", expected '<f4', '<f2', '<i4' or '|u1'");
  Array array;
  std::size_t count = 1;
  const std::string rest = after("shape"), shape = rest.substr(0, rest.find(')'));
  for (std::size_t i = 0; i < shape.size();) {
    if (shape[i] < '0' || shape[i] > '9') {
      ++i;
      continue;
    }
    std::size_t n = 0;
    for (; i < shape.size() && shape[i] >= '0' && shape[i] <= '9'; ++i) n = n * 10 + std::size_t(shape[i] - '0');
    if (n > bytes.size() || (n && count > bytes.size() / n)) throw wrong("ends before its numbers do");
    array.shape.push_back(n);
    count *= n;
  }
  const std::size_t data = start + length;
  if (bytes.size() - data != count * std::size_t(width))
    throw wrong(std::to_string(bytes.size() - data) + " bytes of numbers, expected " +
                std::to_string(count * std::size_t(width)));
  array.values.resize(count);
  const auto copy = [&]<class X>(X x, std::size_t i) {
    std::memcpy(&x, bytes.data() + data + i * sizeof x, sizeof x);
    return x;
  };
  for (std::size_t i = 0; i < count; ++i)
    array.values[i] = type == "'<f4'"   ? double(copy(float(), i))
                      : type == "'<i4'" ? double(copy(std::int32_t(), i))
                      : type == "'<f2'" ? from_half(copy(std::uint16_t(), i))
                                        : double(copy(std::uint8_t(), i));
  return array;
}

/// data/<name>.npy beside this file; CMake says where that is.
inline Array load(const std::string& name) { return read_npy(BURNISH_REFERENCE_DATA "/" + name + ".npy"); }

}  // namespace reference
