// examples/program.h -- what the small programs share beside burnish: arguments and PNG pictures
// SPDX-License-Identifier: Apache-2.0
//
// Here so that they need no library to be installed; nothing of it is burnish.
#pragma once
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace program {

/// An argument "--name VALUE" for a text, or for a whole number from low to high.
struct Option {
  std::string name, placeholder, help;
  std::variant<std::string*, int*> value;
  int low = 1, high = 1;

  std::string now() const {
    const auto* text = std::get_if<std::string*>(&value);
    return text ? **text : std::to_string(*std::get<int*>(value));
  }
  void set(const std::string& given) const {
    if (const auto* text = std::get_if<std::string*>(&value)) {
      **text = given;
      return;
    }
    std::size_t read = 0;
    int number = low - 1;
    try {
      number = std::stoi(given, &read);
    } catch (const std::exception&) {}
    if (given.empty() || read != given.size() || number < low || number > high)
      throw std::runtime_error(name + " " + given + ": expected a whole number from " + std::to_string(low) + " to " +
                               std::to_string(high));
    *std::get<int*>(value) = number;
  }
};

/// Reads the arguments and runs. The exit code: 0, or 2 after one line that says what was wrong.
template <class Run>
int main(int argc, char** argv, const std::string& about, const std::vector<Option>& options, Run run) {
  const std::string self = std::filesystem::path(argv[0]).filename().string();
  try {
    for (int i = 1; i < argc; i += 2) {
      const std::string name = argv[i];
      if (name == "--help") {
        std::cout << about << "\n\nusage: " << self << " [--option value]...\n";
        for (const Option& o : options)
          std::cout << "  " << o.name << " " << o.placeholder << "  " << o.help << " [" << o.now() << "]\n";
        return 0;
      }
      const auto found = std::find_if(options.begin(), options.end(), [&](const Option& o) { return o.name == name; });
      if (found == options.end()) throw std::runtime_error(name + ": no such option, see --help");
      if (i + 1 == argc) throw std::runtime_error(name + ": its value is missing, see --help");
      found->set(argv[i + 1]);
    }
    run();
    return 0;
  } catch (const std::exception& e) {
    std::cerr << self << ": " << e.what() << "\n";
    return 2;
  }
}

/// The folder, made where it is missing.
inline void make_folder(const std::string& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (!std::filesystem::is_directory(folder, failed) || access(folder.c_str(), W_OK) != 0)
    throw std::runtime_error("--output " + folder + ": expected a folder that can be written into");
}

/// A picture as an 8-bit sRGB PNG, not compressed. color(x, y) gives linear .x .y .z, clipped to 0 .. 1. The file is
/// written beside and renamed.
template <class Color> void write_png(const std::string& path, int width, int height, Color color) {
  using Bytes = std::vector<std::uint8_t>;
  const auto number = [](Bytes& to, std::uint32_t n) {
    for (int shift = 24; shift >= 0; shift -= 8) to.push_back(std::uint8_t(n >> shift));
  };
  Bytes rows;  // each begins with its filter, none
  for (int y = 0; y < height; ++y) {
    rows.push_back(0);
    for (int x = 0; x < width; ++x) {
      const auto c = color(x, y);
      for (const float linear : {float(c.x), float(c.y), float(c.z)}) {
        const float v = linear > 0 ? std::min(linear, 1.0f) : 0.0f;
        const float coded = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
        rows.push_back(std::uint8_t(std::lround(255 * coded)));
      }
    }
  }
  Bytes data{0x78, 0x01};  // zlib, in blocks that are merely stored
  std::uint32_t a = 1, b = 0;
  for (const std::uint8_t byte : rows) a = (a + byte) % 65521, b = (b + a) % 65521;
  for (std::size_t i = 0; i < rows.size(); i += 65535) {
    const std::size_t n = std::min<std::size_t>(65535, rows.size() - i);
    data.push_back(i + n == rows.size());
    for (const std::size_t half : {n, ~n}) data.push_back(std::uint8_t(half)), data.push_back(std::uint8_t(half >> 8));
    data.insert(data.end(), rows.begin() + std::ptrdiff_t(i), rows.begin() + std::ptrdiff_t(i + n));
  }
  number(data, b << 16 | a);

  Bytes file{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  const auto chunk = [&](const char* name, const Bytes& content) {
    number(file, std::uint32_t(content.size()));
    const auto start = std::ptrdiff_t(file.size());
    file.insert(file.end(), name, name + 4);
    file.insert(file.end(), content.begin(), content.end());
    std::uint32_t crc = ~0u;
    for (auto byte = file.begin() + start; byte != file.end(); ++byte) {
      crc ^= *byte;
      for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    number(file, ~crc);
  };
  Bytes header;
  number(header, std::uint32_t(width)), number(header, std::uint32_t(height));
  header.insert(header.end(), {8, 2, 0, 0, 0});
  chunk("IHDR", header), chunk("IDAT", data), chunk("IEND", {});

  const std::string partial = path + ".partial";
  std::error_code failed;
  std::ofstream out(partial, std::ios::binary);
  out.write(reinterpret_cast<const char*>(file.data()), std::streamsize(file.size()));
  out.close();
  if (out) std::filesystem::rename(partial, path, failed);
  if (!out || failed) {
    std::filesystem::remove(partial, failed);
    throw std::runtime_error(path + ": cannot be written");
  }
}


/// The pictures panel(k, x, y), k = 0 .. count - 1, side by side with white between.
template <class Color> void write_row_png(const std::string& path, int count, int width, int height, Color panel) {
  constexpr int gap = 8;
  write_png(path, count * width + (count - 1) * gap, height, [&](int x, int y) {
    const int k = x / (width + gap), column = x % (width + gap);
    using C = decltype(panel(k, column, y));
    return column < width ? panel(k, column, y) : C{1, 1, 1};
  });
}

}  // namespace program
