// burnish/io/embeddings.h -- vectors that were computed elsewhere (CLIP, OpenShape, ...) become a space of a library
// SPDX-License-Identifier: Apache-2.0
//
// The files are io/computed.h's.
#pragma once
#include <cmath>
#include <burnish/io/computed.h>
#include <burnish/twin/library.h>

namespace burnish {

/// Makes the rows, scaled to unit length, a space of the library, in place of one that had that name. A row is of the
/// indexed entries whose path, or whose path's end ("van/scene.gltf"), or else whose name is the row's. Gives how many
/// rows belong to no entry; Error when none does. `file` stands in the message.
inline int add_space(Library& library, const std::string& name, const Embeddings& e, const std::string& file) {
  if (name.empty() || name.find('.') != std::string::npos || name == "views" || name == "thumbnails")
    throw Error("space \"" + name + "\": expected a name without dots, other than views and thumbnails");
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
  const std::size_t columns = e.vectors.shape[1];
  space.columns = int(columns);
  for (const auto& [i, r] : rows) {
    space.entry.push_back(i);
    const float* const from = e.vectors.values.data() + r * columns;
    double sum = 0;
    for (std::size_t k = 0; k < columns; ++k) sum += double(from[k]) * double(from[k]);
    const double scale = sum > 0 ? 1 / std::sqrt(sum) : 0;
    for (std::size_t k = 0; k < columns; ++k) space.values.push_back(float(double(from[k]) * scale));
  }
  library.spaces[name] = std::move(space);
  return strange;
}

}  // namespace burnish
