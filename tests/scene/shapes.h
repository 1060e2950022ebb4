// tests/scene/shapes.h -- small meshes whose every number is known
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <burnish/scene/mesh.h>

namespace shapes {
using burnish::Mesh;
using burnish::vec2;
using burnish::vec3;

inline constexpr float pi = 3.14159265358979f;

/// The rectangle a, b, c, d (counter-clockwise as seen from its front) as two triangles of a new part, without normals
/// and uvs.
inline void add_rectangle(Mesh& m, const char* name, vec3<float> a, vec3<float> b, vec3<float> c, vec3<float> d) {
  const int first = m.add(a);
  m.add(b), m.add(c), m.add(d);
  m.triangles.push_back({first, first + 1, first + 2});
  m.triangles.push_back({first, first + 2, first + 3});
  m.part.insert(m.part.end(), 2, int(m.parts.size()));
  m.parts.push_back({.name = name, .material = name});
}
/// An axis-aligned box of 12 triangles, every face with vertices of its own, without normals and uvs.
inline void add_box(Mesh& m, const char* name, vec3<float> l, vec3<float> h) {
  const std::size_t part = m.parts.size();
  add_rectangle(m, name, {l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, h.y, h.z}, {l.x, h.y, h.z});
  add_rectangle(m, name, {h.x, l.y, l.z}, {l.x, l.y, l.z}, {l.x, h.y, l.z}, {h.x, h.y, l.z});
  add_rectangle(m, name, {h.x, l.y, h.z}, {h.x, l.y, l.z}, {h.x, h.y, l.z}, {h.x, h.y, h.z});
  add_rectangle(m, name, {l.x, l.y, l.z}, {l.x, l.y, h.z}, {l.x, h.y, h.z}, {l.x, h.y, l.z});
  add_rectangle(m, name, {l.x, h.y, h.z}, {h.x, h.y, h.z}, {h.x, h.y, l.z}, {l.x, h.y, l.z});
  add_rectangle(m, name, {l.x, l.y, l.z}, {h.x, l.y, l.z}, {h.x, l.y, h.z}, {l.x, l.y, h.z});
  m.parts.resize(part + 1);
  for (std::size_t t = m.part.size() - 12; t < m.part.size(); ++t) m.part[t] = int(part);
}
/// A sphere of 2 n x n rectangles with normals and uvs: u = longitude / 2 pi from +z towards +x, v = 0 at the south
/// pole to 1 at the north pole (+y).
inline Mesh sphere(vec3<float> center, float radius, int n) {
  Mesh m;
  m.parts.push_back({.name = "sphere", .material = "paint"});
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= 2 * n; ++i) {
      const float u = float(i) / float(2 * n), v = float(j) / float(n), a = 2 * pi * u, b = pi * (v - 0.5f);
      const vec3<float> d(std::cos(b) * std::sin(a), std::sin(b), std::cos(b) * std::cos(a));
      m.add(center + d * radius, d, {u, v});
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < 2 * n; ++i) {
      const int a = j * (2 * n + 1) + i, b = a + 1, c = b + 2 * n + 1, d = c - 1;
      if (j > 0) m.triangles.push_back({a, b, c}), m.part.push_back(0);
      if (j < n - 1) m.triangles.push_back({a, c, d}), m.part.push_back(0);
    }
  }
  return m;
}
}  // namespace shapes
