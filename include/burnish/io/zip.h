// burnish/io/zip.h -- the files in a zip archive
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <string>
#include <vector>
#include <minizip/unzip.h>
#include <burnish/scene/error.h>

namespace burnish {

/// An archive that is open for reading, of any file name ending.
class ZipArchive {
public:
  /// Error where it cannot be read.
  explicit ZipArchive(const std::string& path) : path_(path), zip_(unzOpen64(path.c_str())) {
    if (!zip_) throw Error(path + ": not a zip archive that can be read");
    for (int more = unzGoToFirstFile(zip_); more == UNZ_OK; more = unzGoToNextFile(zip_)) {
      char name[1 << 16];
      unz_file_info64 info;
      if (unzGetCurrentFileInfo64(zip_, &info, name, sizeof name, nullptr, 0, nullptr, 0) == UNZ_OK)
        names_.emplace_back(name, std::min<std::size_t>(info.size_filename, sizeof name));
    }
  }
  ~ZipArchive() { unzClose(zip_); }
  ZipArchive(const ZipArchive&) = delete;
  ZipArchive& operator=(const ZipArchive&) = delete;

  const std::string& path() const { return path_; }
  const std::vector<std::string>& names() const { return names_; }
  /// The bytes of one of names(), stored or deflated. Error where they are damaged or not of the size that is said.
  std::string read(const std::string& name) const {
    const auto damaged = [&](const char* what) {
      return Error(path_ + ": " + plain(name) + " in the archive " + what);
    };
    unz_file_info64 info;
    if (unzLocateFile(zip_, name.c_str(), 1) != UNZ_OK) throw damaged("is not there");
    if (unzGetCurrentFileInfo64(zip_, &info, nullptr, 0, nullptr, 0, nullptr, 0) != UNZ_OK ||
        unzOpenCurrentFile(zip_) != UNZ_OK)
      throw damaged("cannot be read");
    const std::size_t size = std::size_t(info.uncompressed_size);
    // A bit of deflate stands for 258 bytes at most, in pairs: no honest size is above 1032 times the compressed one.
    std::string bytes;
    const bool fair = size / 1032 <= std::size_t(info.compressed_size);
    if (fair) bytes.reserve(std::min<std::size_t>(size, 1u << 26));
    for (int n = 1; fair && n > 0 && bytes.size() <= size;) {
      char part[1 << 16];
      n = unzReadCurrentFile(zip_, part, sizeof part);
      if (n > 0) bytes.append(part, std::size_t(n));
    }
    if (unzCloseCurrentFile(zip_) != UNZ_OK || bytes.size() != size) throw damaged("is damaged");
    return bytes;
  }
  /// A name without what would break a line.
  static std::string plain(std::string s) {
    for (char& c : s) c = static_cast<unsigned char>(c) < 32 ? '?' : c;
    return s;
  }

private:
  std::string path_;
  unzFile zip_;
  std::vector<std::string> names_;
};

}  // namespace burnish
