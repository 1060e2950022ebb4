// burnish/io/embeddings.h -- vectors that were computed elsewhere (CLIP, OpenShape, ...) become a space of a library
// SPDX-License-Identifier: Apache-2.0
//
// An NPZ or safetensors file with one array [rows, columns] and names, one a row: an array of strings "names" in NPZ, a
// text "names" of one a line in safetensors' __metadata__; or an NPY file and, beside it, its name with .txt added: one
// name a line.
#pragma once
#include <cmath>
#include <burnish/io/npy.h>
#include <burnish/io/safetensors.h>
#include <burnish/twin/library.h>

namespace burnish {

struct Embeddings {
  int columns = 0;
  std::vector<float> rows;         // row by row, as the file has them
  std::vector<std::string> names;  // one a row; empty where the file has none
};

/// An array of one dimension is one row. Error where there is not one array of rows, or not as many names.
inline Embeddings read_embeddings(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  NamedTensors in;
  if (ending == ".npz") in = read_npz(path);
  else if (ending == ".safetensors") in = read_safetensors(path);
  else if (ending == ".npy") {
    in.tensors["rows"] = read_npy(path);
    if (std::filesystem::exists(path + ".txt")) in.texts["names"] = read_text(path + ".txt");
  } else throw Error(path + ": expected a file .npy, .npz or .safetensors");
  if (in.tensors.size() != 1)
    throw Error(path + ": " + std::to_string(in.tensors.size()) + " arrays of numbers, expected one");
  Tensor& t = in.tensors.begin()->second;
  if (t.shape.size() == 1) t.shape.insert(t.shape.begin(), 1);
  if (t.shape.size() != 2 || t.shape[1] == 0 || t.shape[1] > 1000000)
    throw Error(path + ": an array " + detail::shape_text(t.shape) + ", expected rows and columns");
  for (const float v : t.values)
    if (!detail::finite(v)) throw Error(path + ": a number that is not finite, expected vectors");
  Embeddings out;
  out.columns = int(t.shape[1]), out.rows = std::move(t.values);
  std::istringstream lines(in.texts["names"]);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    out.names.push_back(line);
  }
  if (!out.names.empty() && out.names.size() != t.shape[0])
    throw Error(path + ": " + std::to_string(t.shape[0]) + " rows and " + std::to_string(out.names.size()) +
                " names, expected as many");
  return out;
}

/// Makes the rows, scaled to unit length, a space of the library, in place of one that had that name. A row is of the
/// indexed entries whose path, or whose path's end ("van/scene.gltf"), or else whose name is the row's. Gives how many
/// rows belong to no entry; Error when none does. `file` stands in the message.
inline int add_space(Library& library, const std::string& name, const Embeddings& e, const std::string& file) {
  if (name.empty() || name.find('.') != std::string::npos || name == "views" || name == "thumbnails")
    throw Error("space \"" + name + "\": expected a name without dots, other than views and thumbnails");
  if (e.names.empty()) throw Error(file + ": no names, expected one for each row");
  std::map<std::string, std::vector<int>> by_name, by_end;
  for (int i = 0; i < int(library.entries.size()); ++i) {
    const LibraryEntry& entry = library.entries[std::size_t(i)];
    if (entry.status != LibraryStatus::indexed) continue;
    by_name[entry.name].push_back(i);
    by_end[entry.path].push_back(i);
    for (std::size_t k = 1; k < entry.path.size(); ++k)
      if (entry.path[k - 1] == '/' || entry.path[k - 1] == ':') by_end[entry.path.substr(k)].push_back(i);
  }
  std::vector<std::pair<int, std::size_t>> rows;  // entry, row
  int strange = 0;
  for (std::size_t r = 0; r < e.names.size(); ++r) {
    const auto end = by_end.find(e.names[r]), known = by_name.find(e.names[r]);
    if (end == by_end.end() && known == by_name.end()) ++strange;
    else
      for (const int i : end != by_end.end() ? end->second : known->second) rows.emplace_back(i, r);
  }
  if (rows.empty()) throw Error(file + ": no row has the name or path of a vehicle that is indexed");
  std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  LibrarySpace space;
  space.columns = e.columns;
  for (const auto& [i, r] : rows) {
    space.entry.push_back(i);
    const float* const from = e.rows.data() + r * std::size_t(e.columns);
    double sum = 0;
    for (int k = 0; k < e.columns; ++k) sum += double(from[k]) * double(from[k]);
    const double scale = sum > 0 ? 1 / std::sqrt(sum) : 0;
    for (int k = 0; k < e.columns; ++k) space.values.push_back(float(double(from[k]) * scale));
  }
  library.spaces[name] = std::move(space);
  return strange;
}

}  // namespace burnish
