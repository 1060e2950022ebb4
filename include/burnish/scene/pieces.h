// burnish/scene/pieces.h -- which triangles of a mesh hang together
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <burnish/scene/mesh.h>

namespace burnish::detail {

/// For every vertex the number of its place: vertices closer than about 1e-6 of the mesh's size share one.
inline std::vector<int> weld(const Mesh& m) {
  Box box;
  for (const auto& t : m.triangles) {
    for (int v : t) box.add(m.positions[v]);
  }
  const vec3<float> size = box.size();
  const double cell = std::max({size.x, size.y, size.z, 1e-30f}) * 1e-6;
  struct Hash {
    std::size_t operator()(const std::array<std::int64_t, 3>& k) const {
      std::uint64_t h = 0;
      for (std::int64_t x : k) h = (h ^ std::uint64_t(x)) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
      return h;
    }
  };
  std::unordered_map<std::array<std::int64_t, 3>, int, Hash> places;
  places.reserve(m.positions.size());
  std::vector<int> place(m.positions.size(), -1);
  for (const auto& t : m.triangles) {
    for (int v : t) {
      if (place[v] >= 0) continue;
      const vec3<float> p = m.positions[v] - box.low;
      const std::array<std::int64_t, 3> key{std::llround(p.x / cell), std::llround(p.y / cell),
                                            std::llround(p.z / cell)};
      place[v] = places.try_emplace(key, int(places.size())).first->second;
    }
  }
  return place;
}

/// Triangles that hang together, by welded vertices: the number of its piece for every triangle, from 0.
inline std::vector<int> pieces(const Mesh& m, const std::vector<int>& place) {
  std::vector<int> root(m.positions.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (const auto& t : m.triangles) {
    for (int k : {1, 2}) root[find(place[t[k]])] = find(place[t[0]]);
  }
  std::unordered_map<int, int> number;
  std::vector<int> piece;
  piece.reserve(m.triangles.size());
  for (const auto& t : m.triangles)
    piece.push_back(number.try_emplace(find(place[t[0]]), int(number.size())).first->second);
  return piece;
}

/// Keeps the triangles for which keep(t) holds; returns how many went.
template <class F> long keep_triangles(Mesh& m, F keep) {
  std::size_t to = 0;
  const std::size_t n = m.triangles.size();
  for (std::size_t t = 0; t < n; ++t) {
    if (!keep(int(t))) continue;
    m.triangles[to] = m.triangles[t];
    m.part[to++] = m.part[t];
  }
  m.triangles.resize(to);
  m.part.resize(to);
  return long(n - to);
}

}  // namespace burnish::detail
