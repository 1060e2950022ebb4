// burnish/io/computed.h -- what networks computed elsewhere, as files of a few layouts
// SPDX-License-Identifier: Apache-2.0
//
// Files are .npy, .npz or .safetensors, the numbers of any type that io/decode.h reads:
//   embeddings      "vectors", N x D; "names", one for each row
//   features        "features", h x w x c, or 1 x c x h x w as networks give them; the first row is the picture's top
//   labels          "labels", h x w whole numbers; or a picture (PNG) whose first channel has them
//   class scores    "scores", laid out like features; the greatest of a pixel is its label
// A file with one array needs no name for it, and a .npy has none. Names are an array of strings (.npz), lines of the
// metadata's "names" (.safetensors), or of vectors.txt beside vectors.npy.
#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>
#include <burnish/io/npy.h>
#include <burnish/io/photo.h>
#include <burnish/io/safetensors.h>

namespace burnish {

/// By the ending of the file's name; the array of a .npy is called "".
inline NamedTensors read_tensors(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".npz") return read_npz(path);
  if (ending == ".safetensors") return read_safetensors(path);
  if (ending != ".npy") throw Error(path + ": expected a .npy, .npz or .safetensors file");
  NamedTensors one;
  one.tensors[""] = read_npy(path);
  return one;
}

namespace detail {
inline Tensor the_tensor(NamedTensors& all, const std::string& name, const std::string& path) {
  auto at = all.tensors.find(name);
  if (at == all.tensors.end() && all.tensors.size() == 1) at = all.tensors.begin();
  if (at == all.tensors.end())
    throw Error(path + ": " + std::to_string(all.tensors.size()) + " arrays and none called \"" + name + "\"");
  return std::move(at->second);
}
/// h x w x c of what may be 1 x c x h x w.
inline Tensor channels_last(Tensor t, const std::string& path) {
  if (t.shape.size() == 3 && t.size() > 0) return t;
  if (t.shape.size() != 4 || t.shape[0] != 1 || t.size() == 0)
    throw Error(path + ": shape " + shape_text(t.shape) + ", expected [h, w, c] or [1, c, h, w]");
  const std::size_t c = t.shape[1], h = t.shape[2], w = t.shape[3];
  Tensor out{{h, w, c}, std::vector<float>(t.size())};
  for (std::size_t k = 0; k < c; ++k)
    for (std::size_t i = 0; i < h * w; ++i) out.values[i * c + k] = t.values[k * h * w + i];
  return out;
}
}  // namespace detail

struct Embeddings {
  std::vector<std::string> names;
  Tensor vectors;  // names.size() x D
};
/// An array of one dimension is one row. Rows without a name get their number, from 0. Error where names and rows differ in number, or a number is none.
inline Embeddings read_embeddings(const std::string& path) {
  NamedTensors all = read_tensors(path);
  Embeddings e;
  e.vectors = detail::the_tensor(all, "vectors", path);
  if (e.vectors.shape.size() == 1) e.vectors.shape.insert(e.vectors.shape.begin(), 1);
  if (e.vectors.shape.size() != 2 || e.vectors.shape[1] == 0)
    throw Error(path + ": shape " + detail::shape_text(e.vectors.shape) + ", expected [N, D]");
  for (std::size_t i = 0; i < e.vectors.size(); ++i)
    if (!std::isfinite(e.vectors.values[i]))
      throw Error(path + ": row " + std::to_string(i / e.vectors.shape[1]) + " is not finite, expected numbers");
  const std::size_t rows = e.vectors.shape[0];
  const std::string beside = std::filesystem::path(path).replace_extension(".txt").string();
  std::string text = all.texts.count("names") ? all.texts["names"] : "";
  if (all.tensors.count("") && std::filesystem::exists(beside)) text = read_text(beside);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    e.names.push_back(line);
  }
  if (e.names.empty())
    for (std::size_t i = 0; i < rows; ++i) e.names.push_back(std::to_string(i));
  if (e.names.size() != rows)
    throw Error(path + ": " + std::to_string(e.names.size()) + " names, " + std::to_string(rows) + " rows");
  return e;
}

/// h x w x c.
inline Tensor read_features(const std::string& path) {
  NamedTensors all = read_tensors(path);
  return detail::channels_last(detail::the_tensor(all, "features", path), path);
}

/// The label of each pixel, for h x w x c scores; the first of equal ones.
inline std::vector<int> greatest(const Tensor& scores) {
  const std::size_t c = scores.shape[2];
  std::vector<int> out;
  for (auto at = scores.values.begin(); at != scores.values.end(); at += std::ptrdiff_t(c))
    out.push_back(int(std::max_element(at, at + std::ptrdiff_t(c)) - at));
  return out;
}
/// Labels of w x h pixels for a picture of width x height: the nearest.
inline std::vector<int> resized_labels(const std::vector<int>& labels, int w, int h, int width, int height) {
  std::vector<int> out;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      out.push_back(labels[std::size_t((2L * y + 1) * h / (2L * height)) * std::size_t(w) +
                           std::size_t((2L * x + 1) * w / (2L * width))]);
  return out;
}
/// A label for each pixel of a photo of width x height, from labels or class scores of that size or another.
inline std::vector<int> read_label_map(const std::string& path, int width, int height) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending != ".npy" && ending != ".npz" && ending != ".safetensors") {
    const detail::Pixels p = detail::read_pixels(path);
    return resized_labels(read_labels(path), p.width, p.height, width, height);
  }
  NamedTensors all = read_tensors(path);
  const bool scores = all.tensors.count("scores") != 0;
  Tensor t = detail::the_tensor(all, scores ? "scores" : "labels", path);
  if (t.shape.size() != 2) {
    t = detail::channels_last(std::move(t), path);
    return resized_labels(greatest(t), int(t.shape[1]), int(t.shape[0]), width, height);
  }
  if (t.size() == 0) throw Error(path + ": no labels, expected [h, w]");
  std::vector<int> labels;
  for (const float v : t.values) {
    if (!(v >= -16777216 && v <= 16777216 && v == std::floor(v)))
      throw Error(path + ": the label " + std::to_string(v) + ", expected whole numbers");
    labels.push_back(int(v));
  }
  return resized_labels(labels, int(t.shape[1]), int(t.shape[0]), width, height);
}

}  // namespace burnish
