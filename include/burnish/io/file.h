// burnish/io/file.h -- files are written beside and renamed, so that nothing is ever half-written
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>
#include <burnish/scene/error.h>

namespace burnish {

/// Calls write("<path>.partial"), then renames that to path. When write throws or the file cannot be renamed, the
/// partial file is removed and path is what it was; Error in the second case.
template <class F> void write_beside(const std::string& path, F write) {
  const std::string partial = path + ".partial";
  std::error_code ignored;
  try {
    write(partial);
  } catch (...) {
    std::filesystem::remove(partial, ignored);
    throw;
  }
  std::error_code failed;
  std::filesystem::rename(partial, path, failed);
  if (!failed) return;
  std::filesystem::remove(partial, ignored);
  throw Error(path + ": cannot be written: " + failed.message());
}

/// Makes the folder where it is missing, and proves with a small file that one may write there; Error if not. For the
/// start of a program, before any work is done.
inline void check_writable(const std::string& folder) {
  const std::filesystem::path place = folder.empty() ? "." : folder;
  std::error_code failed;
  std::filesystem::create_directories(place, failed);
  if (!std::filesystem::is_directory(place, failed))
    throw Error(folder + ": not a folder that can be made, expected a writable folder");
  const std::string probe = (place / ".burnish-can-write").string();
  std::ofstream file(probe);
  if (!(file << "x" << std::flush))
    throw Error(folder + ": cannot write into it (" + std::strerror(errno) + "), expected a writable folder");
  file.close();
  std::filesystem::remove(probe, failed);
}

/// The whole file; Error where there is none or it cannot be read.
inline std::string read_text(const std::string& path) {
  if (std::filesystem::is_directory(path)) throw Error(path + ": a folder, expected a file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path + ": " + (std::filesystem::exists(path) ? "cannot be read" : "no such file"));
  std::ostringstream text;
  text << file.rdbuf();
  return std::move(text).str();
}

inline void write_text(const std::string& path, const std::string& text) {
  write_beside(path, [&](const std::string& partial) {
    std::ofstream file(partial, std::ios::binary);
    if (!(file << text << std::flush)) throw Error(path + ": cannot be written: " + std::strerror(errno));
  });
}

}  // namespace burnish
