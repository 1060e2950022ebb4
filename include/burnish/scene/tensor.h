// burnish/scene/tensor.h -- numbers with a shape, such as weights, embeddings and feature maps
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace burnish {

/// Floats in the order of the shape, the last index fastest. An empty shape is that of one number; no shape and no
/// values is a tensor that nobody has filled.
struct Tensor {
  std::vector<std::size_t> shape;
  std::vector<float> values;

  std::size_t size() const { return values.size(); }
  /// An element by all its indices, which are not checked.
  template <class... I> float operator()(I... index) const {
    std::size_t flat = 0, k = 0;
    ((flat = flat * shape[k++] + std::size_t(index)), ...);
    return values[flat];
  }
};

/// Tensors and texts by name: a model's weights, an index of a library.
struct NamedTensors {
  std::map<std::string, Tensor> tensors;
  std::map<std::string, std::string> texts;
};

}  // namespace burnish
