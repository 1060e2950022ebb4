// burnish/twin/library.h -- many vehicles, known by what was found out about each of them once
// SPDX-License-Identifier: Apache-2.0
//
// Entries stand in the order of their paths. A space holds rows of numbers, each of one entry, that are compared with a
// query of the same kind: "views" has a row for every view that a vehicle was described from; others may come from
// elsewhere.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>
#include <burnish/twin/fingerprint.h>

namespace burnish {

enum class LibraryStatus {
  indexed,    // can be found
  refused,    // read, and judged to be of no use; or refused by hand
  duplicate,  // of the shape of another entry
  failed      // could not be read
};
inline constexpr std::array<const char*, 4> library_status_names{"indexed", "refused", "duplicate", "failed"};

struct LibraryEntry {
  std::string path;             // as read_vehicle takes it
  std::string name;             // to be shown
  std::int64_t bytes = 0;       // of the file, to notice that it changed
  std::int64_t modified = 0;    // of the file or its archive, in the clock's own unit
  LibraryStatus status = LibraryStatus::failed;
  std::string reason;           // why it is not indexed, or what was overruled; "" where there is nothing to say
  bool by_hand = false;         // whether a rule decided on its status
  std::vector<float> shape;     // its fingerprint (fingerprint.h); empty where it was not read
  vec3<float> size;             // metres: length, height, width
  int parts = 0, materials = 0, triangles = 0;
  float seconds = 0;            // that reading and describing it took
};

/// What the user says about entries: of all rules whose pattern fits, the last counts.
struct LibraryRule {
  std::string pattern;  // as in a shell: * ? [a-z]; fits a whole path, a name, or a path's last part
  bool accept = true;
};

struct LibrarySpace {
  int columns = 0;
  std::vector<int> entry;                 // of each row; ascending
  std::vector<float> azimuth, elevation;  // of each row, rad as in Pose; both empty where rows are no views
  std::vector<float> values;              // row by row

  int rows() const { return int(entry.size()); }
};

struct Library {
  static constexpr int thumbnail_width = 120, thumbnail_height = 80;
  std::string descriptor;  // what made the space "views": another one is not compared with it
  std::vector<LibraryEntry> entries;
  std::vector<LibraryRule> rules;
  std::map<std::string, LibrarySpace> spaces;
  std::vector<int> thumbnail_of;          // the entry of each thumbnail; ascending
  std::vector<std::uint8_t> thumbnails;   // sRGB, one after the other: height x width x 3

  /// The entry of that path, or -1.
  int find(const std::string& path) const {
    const auto at = std::lower_bound(entries.begin(), entries.end(), path,
                                     [](const LibraryEntry& e, const std::string& p) { return e.path < p; });
    return at != entries.end() && at->path == path ? int(at - entries.begin()) : -1;
  }
  int count(LibraryStatus s) const {
    return int(std::count_if(entries.begin(), entries.end(), [&](const LibraryEntry& e) { return e.status == s; }));
  }
};

/// The entries of several libraries in one, for each path the last that has it; drop(entry) says what is left out. Of
/// spaces and thumbnails, the rows of entries that are indexed stay. Rules and descriptor are the first library's.
template <class Drop> Library merged(const std::vector<const Library*>& all, Drop drop) {
  Library out;
  std::map<std::string, std::pair<const Library*, int>> chosen;
  for (const Library* l : all)
    for (int i = 0; i < int(l->entries.size()); ++i) {
      const LibraryEntry& e = l->entries[std::size_t(i)];
      if (drop(e)) chosen.erase(e.path);
      else chosen[e.path] = {l, i};
    }
  if (!all.empty()) out.rules = all.front()->rules, out.descriptor = all.front()->descriptor;
  struct Rows {
    int first = 0, count = 0;
  };
  const auto rows_of = [](const std::vector<int>& entry, int i) {
    const auto [low, high] = std::equal_range(entry.begin(), entry.end(), i);
    return Rows{int(low - entry.begin()), int(high - low)};
  };
  constexpr std::size_t picture = std::size_t(Library::thumbnail_width) * Library::thumbnail_height * 3;
  for (const auto& [path, from] : chosen) {
    const auto& [l, i] = from;
    const int to = int(out.entries.size());
    out.entries.push_back(l->entries[std::size_t(i)]);
    if (out.entries.back().status != LibraryStatus::indexed) continue;
    for (const auto& [name, space] : l->spaces) {
      const Rows r = rows_of(space.entry, i);
      LibrarySpace& s = out.spaces[name];
      if (r.count == 0 || (s.columns != 0 && s.columns != space.columns)) continue;
      s.columns = space.columns;
      s.entry.insert(s.entry.end(), std::size_t(r.count), to);
      const auto append = [&](const std::vector<float>& a, std::vector<float>& b, std::ptrdiff_t width) {
        if (!a.empty()) b.insert(b.end(), a.begin() + r.first * width, a.begin() + (r.first + r.count) * width);
      };
      append(space.azimuth, s.azimuth, 1), append(space.elevation, s.elevation, 1);
      append(space.values, s.values, space.columns);
    }
    const Rows t = rows_of(l->thumbnail_of, i);
    if (t.count == 0) continue;
    out.thumbnail_of.push_back(to);
    const auto begin = l->thumbnails.begin() + std::ptrdiff_t(std::size_t(t.first) * picture);
    out.thumbnails.insert(out.thumbnails.end(), begin, begin + std::ptrdiff_t(picture));
  }
  return out;
}

/// Where each entry's rows begin, and how many there are at the end: what nearest_models (search.h) asks for.
inline std::vector<int> first_rows(const Library& library, const LibrarySpace& space) {
  std::vector<int> first;
  for (int i = 0; i <= int(library.entries.size()); ++i)
    first.push_back(int(std::lower_bound(space.entry.begin(), space.entry.end(), i) - space.entry.begin()));
  return first;
}

namespace detail {
inline const std::string same_as = "same as ";  // begins the reason of a duplicate; a path follows
}

/// Among the entries that are indexed or duplicates, those of one shape (fingerprint.h): the first is indexed, the
/// others are its duplicates, but for those that a rule accepts. Their rows stay until merged() is asked.
inline void mark_duplicates(Library& library) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < library.entries.size(); ++i) {
    const LibraryEntry& e = library.entries[i];
    if ((e.status == LibraryStatus::indexed || e.status == LibraryStatus::duplicate) && !e.shape.empty())
      order.push_back(i);
  }
  const auto key = [&](std::size_t i) { return library.entries[i].shape[2]; };
  std::vector<std::size_t> by_area = order;
  std::sort(by_area.begin(), by_area.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  for (const std::size_t i : order) {
    LibraryEntry& e = library.entries[i];
    if (e.by_hand) continue;
    const auto low = std::lower_bound(by_area.begin(), by_area.end(), key(i) - same_shape_within,
                                      [&](std::size_t a, float k) { return key(a) < k; });
    std::size_t original = i;
    for (auto at = low; at != by_area.end() && key(*at) <= key(i) + same_shape_within; ++at) {
      const LibraryEntry& o = library.entries[*at];
      if (*at < original && o.status == LibraryStatus::indexed && same_shape(o.shape, e.shape)) original = *at;
    }
    if (original == i) continue;
    e.status = LibraryStatus::duplicate, e.reason = detail::same_as + library.entries[original].path;
  }
}

}  // namespace burnish
