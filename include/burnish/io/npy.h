// burnish/io/npy.h -- NumPy's arrays: .npy, and .npz, a zip archive of them
// SPDX-License-Identifier: Apache-2.0
//
// The format: numpy.org/devdocs/reference/generated/numpy.lib.format.html, versions 1 to 3. Numbers as io/decode.h has
// them, in either byte order; Fortran's order is turned into C's. Structured and pickled arrays are refused.
#pragma once
#include <string_view>
#include <burnish/io/decode.h>
#include <burnish/io/file.h>
#include <burnish/io/zip.h>
#include <burnish/scene/tensor.h>

namespace burnish {
namespace detail {
/// An array, or one of strings: then text has its elements, one a line.
struct NpyArray {
  Tensor tensor;
  std::string text;
  bool is_text = false;
};

/// What a header says: {'descr': '<f4', 'fortran_order': False, 'shape': (10000, 3), }
struct NpyHeader {
  char order = '|', kind = 0;
  std::size_t width = 0;
  bool fortran = false;
  std::vector<std::size_t> shape;
};
inline NpyHeader npy_header(std::string_view text, const std::string& what) {
  const auto after = [&](const std::string& key) -> std::string_view {
    std::size_t at = text.find("'" + key + "'");
    if (at == text.npos) at = text.find("\"" + key + "\"");
    if (at != text.npos) at = text.find_first_not_of(" :", at + key.size() + 2);
    if (at == text.npos) throw Error(what + ": no " + key + " in its header");
    return text.substr(at);
  };
  const auto number = [](std::string_view digits) {
    std::size_t n = 0;
    for (const char c : digits) {
      if (n > std::size_t(-1) / 16) break;  // more than any file holds
      n = n * 10 + std::size_t(c - '0');
    }
    return n;
  };
  constexpr std::string_view digits = "0123456789";
  NpyHeader h;
  const std::string_view descr = after("descr");
  const std::string_view type = descr.substr(1, descr.find_first_of("'\"", 1) - 1);
  if ((descr[0] != '\'' && descr[0] != '"') || type.size() < 3 || type.size() > 12 ||
      std::string_view("<>|=").find(type[0]) == type.npos || type.find_first_not_of(digits, 2) != type.npos)
    throw Error(what + ": a type that is not of plain numbers, expected one such as '<f4'");
  h.order = type[0], h.kind = type[1], h.width = number(type.substr(2));
  const std::string_view fortran = after("fortran_order");
  h.fortran = fortran.rfind("True", 0) == 0;
  if (!h.fortran && fortran.rfind("False", 0) != 0) throw Error(what + ": fortran_order is neither True nor False");
  const std::string_view rest = after("shape"), list = rest.substr(0, rest.find(')'));
  if (list.empty() || list[0] != '(' || list.size() == rest.size() ||
      list.find_first_not_of("0123456789(, L") != list.npos)
    throw Error(what + ": a shape that is no list of whole numbers");
  for (std::size_t i = 1, end; i < list.size(); i = end) {
    end = std::min(list.find_first_not_of(digits, i), list.size());
    if (end > i) h.shape.push_back(number(list.substr(i, end - i)));
    else ++end;
  }
  return h;
}
inline std::optional<NumberType> npy_type(char kind, std::size_t width) {
  const std::string name = kind + std::to_string(width);
  constexpr const char* names[] = {"b1", "u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f2", "", "f4", "f8"};
  const auto* const at = std::find(std::begin(names), std::end(names), name);
  return at == std::end(names) ? std::nullopt : std::optional(NumberType(at - std::begin(names)));
}
inline void add_utf8(std::string& s, std::uint32_t c) {
  if (c < 0x80) s += char(c);
  else if (c < 0x800) s += {char(0xC0 | c >> 6), char(0x80 | (c & 63))};
  else if (c < 0x10000) s += {char(0xE0 | c >> 12), char(0x80 | (c >> 6 & 63)), char(0x80 | (c & 63))};
  else s += {char(0xF0 | c >> 18), char(0x80 | (c >> 12 & 63)), char(0x80 | (c >> 6 & 63)), char(0x80 | (c & 63))};
}
/// Strings of a fixed width, padded with zeros: 'S' of bytes, 'U' of 4-byte characters. One a line.
inline std::string npy_strings(std::string_view bytes, char kind, std::size_t count, std::size_t width, bool swapped,
                               const std::string& what) {
  const std::size_t step = kind == 'U' ? 4 : 1;
  std::string out;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < width; ++k) {
      std::uint32_t c = 0;
      for (std::size_t b = 0; b < step; ++b)
        c |= std::uint32_t(static_cast<unsigned char>(bytes[(i * width + k) * step + (swapped ? step - 1 - b : b)]))
             << 8 * b;
      if (c == 0) break;
      if (c < 32 || c > 0x10FFFF || (c >= 0xD800 && c < 0xE000))
        throw Error(what + ": string " + std::to_string(i) + " has the character " + std::to_string(c) +
                    ", expected a line of text");
      if (kind == 'U') add_utf8(out, c);
      else out += char(c);
    }
    out += '\n';
  }
  return out;
}
/// Columns first to rows first.
inline void from_fortran(Tensor& t) {
  std::vector<std::size_t> step(t.shape.size()), at(t.shape.size(), 0);
  for (std::size_t k = 0, n = 1; k < step.size(); ++k) step[k] = n, n *= t.shape[k];
  std::vector<float> out(t.size());
  for (std::size_t i = 0, from = 0; i < out.size(); ++i) {
    out[i] = t.values[from];
    for (std::size_t k = at.size(); k-- > 0;) {
      from += step[k];
      if (++at[k] < t.shape[k]) break;
      from -= at[k] * step[k], at[k] = 0;
    }
  }
  t.values = std::move(out);
}
inline NpyArray parse_npy(std::string_view bytes, const std::string& what) {
  const auto byte = [&](std::size_t i) { return std::size_t(static_cast<unsigned char>(bytes[i])); };
  if (bytes.size() < 12 || bytes.substr(0, 6) != "\x93NUMPY") throw Error(what + ": not a .npy file");
  const std::size_t version = byte(6), start = version == 1 ? 10 : 12;
  if (version < 1 || version > 3) throw Error(what + ": version " + std::to_string(version) + ", expected 1 to 3");
  std::size_t length = byte(8) | byte(9) << 8;
  if (version > 1) length |= byte(10) << 16 | byte(11) << 24;
  if (length > bytes.size() - start) throw Error(what + ": ends within its header");
  const std::string_view data = bytes.substr(start + length);
  const NpyHeader h = npy_header(bytes.substr(start, length), what);
  const bool text = h.kind == 'U' || h.kind == 'S', swapped = h.order == '>';
  const auto type = npy_type(h.kind, h.width);
  if (!type && !text)
    throw Error(what + ": type '" + h.kind + std::to_string(h.width) + "', expected b1, f2, f4, f8, u1 .. i8, U or S");
  const std::size_t width = text ? std::max<std::size_t>(h.width, 1) * (h.kind == 'U' ? 4 : 1) : h.width;
  const auto count = count_of(h.shape, width, data.size());
  if (!count || *count * width != data.size())
    throw Error(what + ": " + std::to_string(data.size()) + " bytes of numbers, expected " + std::to_string(width) +
                " for each of the shape " + shape_text(h.shape));
  NpyArray a;
  a.is_text = text;
  a.tensor.shape = h.shape;
  if (text) {
    if (h.fortran && h.shape.size() > 1) throw Error(what + ": strings, columns first, expected rows first");
    a.text = npy_strings(data, h.kind, *count, width / (h.kind == 'U' ? 4 : 1), swapped, what);
    return a;
  }
  a.tensor.values = decode(*type, data.data(), *count, swapped, what);
  if (h.fortran && h.shape.size() > 1) from_fortran(a.tensor);
  return a;
}
/// The file's beginning for a tensor of f4, a multiple of 64 bytes long.
inline std::string npy_beginning(const Tensor& t, const std::string& path) {
  if (count_of(t.shape, sizeof(float), std::size_t(-1)) != t.size())
    throw Error(path + ": " + std::to_string(t.size()) + " numbers for the shape " + shape_text(t.shape));
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (";
  for (const std::size_t n : t.shape) header += std::to_string(n) + ", ";
  header += "), }";
  if (const std::size_t comma = header.find(", )"); comma != header.npos && t.shape.size() > 1) header.erase(comma, 2);
  else if (comma != header.npos) header.erase(comma + 1, 1);
  header.append(63 - (10 + header.size()) % 64, ' ') += '\n';
  return std::string("\x93NUMPY\x01\x00", 8) + char(header.size() & 255) + char(header.size() >> 8) + header;
}
}  // namespace detail

/// One array of numbers.
inline Tensor read_npy(const std::string& path) {
  detail::NpyArray a = detail::parse_npy(read_text(path), path);
  if (a.is_text) throw Error(path + ": an array of strings, expected numbers");
  return std::move(a.tensor);
}
/// All arrays of an archive, without their ".npy"; an array of strings is a text of one a line.
inline NamedTensors read_npz(const std::string& path) {
  if (!std::filesystem::is_regular_file(path))
    throw Error(path + (std::filesystem::exists(path) ? ": a folder, expected a file" : ": no such file"));
  const ZipArchive archive(path);
  NamedTensors out;
  for (std::string name : archive.names()) {
    const std::string what = path + ": " + ZipArchive::plain(name);
    if (name.size() < 4 || name.substr(name.size() - 4) != ".npy") throw Error(what + ": expected only .npy files");
    detail::NpyArray a = detail::parse_npy(archive.read(name), what);
    name.resize(name.size() - 4);
    if (a.is_text) out.texts[name] = std::move(a.text);
    else out.tensors[name] = std::move(a.tensor);
  }
  return out;
}

/// As '<f4'.
inline void write_npy(const std::string& path, const Tensor& t) {
  const std::string beginning = detail::npy_beginning(t, path);
  write_beside(path, [&](const std::string& partial) {
    std::ofstream file(partial, std::ios::binary);
    file << beginning;
    file.write(reinterpret_cast<const char*>(t.values.data()), std::streamsize(t.size() * sizeof(float)));
    if (!file.flush()) throw Error(path + ": cannot be written: " + std::strerror(errno));
  });
}

}  // namespace burnish
