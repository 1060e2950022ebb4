// tests/reference/npy.h -- the reference numbers, in double
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <stdexcept>
#include <string>
#include <vector>
#include <burnish/io/npy.h>

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

/// data/<name>.npy beside this file; CMake says where that is.
inline Array load(const std::string& name) {
  const std::string path = BURNISH_REFERENCE_DATA "/" + name + ".npy";
  if (!std::filesystem::exists(path))
    throw std::runtime_error(path + ": not there; tests/reference/generate.py --write makes it");
  const burnish::Tensor t = burnish::read_npy(path);
  return {t.shape, {t.values.begin(), t.values.end()}};
}

}  // namespace reference
