// burnish/twin/split_parts.h -- wheels that share a part with the body become parts of their own
// SPDX-License-Identifier: Apache-2.0
//
// Where a file has one mesh for all of one material, say black plastic or a texture for everything small, connected
// pieces that lie wholly inside a wheel are taken out of it. Panes are not looked for in this way: a panel of the body
// that is a piece of its own has the same shape.
#pragma once
#include <burnish/twin/wheels.h>

namespace burnish {

/// Gives the pieces of a part that lie inside a wheel a part of their own, "<name>/wheels" of the same material, where
/// they are 2 to 98 % of the part's surface. Adds a line to the report for each. Returns how many parts were split.
inline int split_wheels(Mesh& m, MeshReport& report) {
  const std::vector<Wheel> wheels = find_wheels(m);
  if (wheels.empty()) return 0;
  const std::vector<int> piece = detail::pieces(m, detail::weld(m));
  std::vector<std::vector<bool>> inside;  // of each piece, for each wheel, whether all of it lies there
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    if (std::size_t(piece[t]) >= inside.size())
      inside.resize(std::size_t(piece[t]) + 1, std::vector<bool>(wheels.size(), true));
    for (std::size_t w = 0; w < wheels.size(); ++w)
      for (int v : m.triangles[t])
        if (wheels[w].radius_at(m.positions[std::size_t(v)]) > 1.05f) inside[std::size_t(piece[t])][w] = false;
  }
  const std::size_t n = m.parts.size();
  std::vector<bool> in_wheel(m.triangles.size());
  std::vector<double> area(n), taken(n);
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const auto& in = inside[std::size_t(piece[t])];
    in_wheel[t] = std::find(in.begin(), in.end(), true) != in.end();
    const vec3<float> c = m.cross_of(int(t));
    const double a = std::sqrt(double(dot(c, c)));
    area[std::size_t(m.part[t])] += a;
    if (in_wheel[t]) taken[std::size_t(m.part[t])] += a;
  }
  int split = 0;
  for (std::size_t p = 0; p < n; ++p) {
    if (taken[p] < 0.02 * area[p] || taken[p] > 0.98 * area[p] || area[p] == 0) continue;
    const int fresh = int(m.parts.size());
    m.parts.push_back(m.parts[p]);
    m.parts.back().name += "/wheels";
    for (std::size_t t = 0; t < m.triangles.size(); ++t)
      if (m.part[t] == int(p) && in_wheel[t]) m.part[t] = fresh;
    report.add("material " + m.parts[p].material + ", part " + std::to_string(p) + ": " +
               std::to_string(int(std::lround(100 * taken[p] / area[p]))) +
               " % of its surface lies inside wheels and is now part " + std::to_string(fresh));
    ++split;
  }
  return split;
}

}  // namespace burnish
