// burnish/scene/cut.h -- a mesh cut along the faces of a convex region
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>
#include <burnish/scene/mesh.h>

namespace burnish {

/// Points with dot(normal, p) <= offset; normal unit.
struct HalfSpace {
  vec3<float> normal;
  float offset = 0;

  float outside(const vec3<float>& p) const { return dot(normal, p) - offset; }
};
/// What lies in all of them.
using ConvexRegion = std::vector<HalfSpace>;
inline bool contains(const ConvexRegion& r, const vec3<float>& p) {
  for (const HalfSpace& h : r)
    if (h.outside(p) > 0) return false;
  return true;
}

/// A mesh after the cut: which triangles lie in the region, and the new edges along its faces, as pairs of vertices of
/// the triangles inside.
struct CutMesh {
  Mesh mesh;
  std::vector<char> inside;  // a triangle each
  std::vector<std::pair<int, int>> seam;
  std::vector<int> seam_part;  // whose triangle the edge is
};
/// Cuts the triangles of those parts for which takes(part) holds; the others stay
/// outside. Normals and uvs are interpolated; nothing is moved, so the surface stays the same.
template <class Takes> CutMesh cut(const Mesh& mesh, const ConvexRegion& region, Takes takes) {
  CutMesh out;
  Mesh& m = out.mesh;
  m = mesh;
  m.triangles.clear(), m.part.clear();
  std::map<std::array<int, 3>, int> made;  // by the edge's ends and the face
  const auto crossing = [&](int a, int b, int face) {
    const std::array<int, 3> key{std::min(a, b), std::max(a, b), face};
    if (const auto known = made.find(key); known != made.end()) return known->second;
    const HalfSpace& h = region[std::size_t(face)];
    const auto at = [&](const auto& of) { return of[std::size_t(key[0])]; };
    const auto to = [&](const auto& of) { return of[std::size_t(key[1])]; };
    const float d = h.outside(at(m.positions)), e = h.outside(to(m.positions)), t = d / (d - e);
    vec3<float> n = mix(at(m.normals), to(m.normals), t);
    if (const float l = length(n); l > 1e-6f) n = n / l;
    const int v = m.add(mix(at(m.positions), to(m.positions), t), n, mix(at(m.uvs), to(m.uvs), t));
    return made[key] = v;
  };
  const auto keep = [&](const std::vector<int>& polygon, int part, bool in) {
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      m.triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
      m.part.push_back(part), out.inside.push_back(in);
    }
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    const int part = mesh.part[t];
    std::vector<int> polygon(v.begin(), v.end());
    if (!takes(part)) {
      keep(polygon, part, false);
      continue;
    }
    std::vector<std::pair<std::vector<int>, bool>> cut_off;
    for (std::size_t f = 0; f < region.size() && polygon.size() >= 3; ++f) {
      std::vector<int> in, beyond;
      for (std::size_t k = 0; k < polygon.size(); ++k) {
        const int a = polygon[k], b = polygon[(k + 1) % polygon.size()];
        const bool a_in = region[f].outside(m.positions[std::size_t(a)]) <= 0,
                   b_in = region[f].outside(m.positions[std::size_t(b)]) <= 0;
        (a_in ? in : beyond).push_back(a);
        if (a_in == b_in) continue;
        const int c = crossing(a, b, int(f));
        in.push_back(c), beyond.push_back(c);
      }
      if (beyond.size() >= 3) cut_off.push_back({beyond, false});
      polygon = in;
    }
    if (polygon.size() < 3) {  // it lies beyond after all: as it was
      keep({v.begin(), v.end()}, part, false);
      continue;
    }
    for (const auto& [p, in] : cut_off) keep(p, part, in);
    keep(polygon, part, true);
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const int a = polygon[k], b = polygon[(k + 1) % polygon.size()];
      for (const HalfSpace& h : region)
        if (std::abs(h.outside(m.positions[std::size_t(a)])) < 2e-6f &&
            std::abs(h.outside(m.positions[std::size_t(b)])) < 2e-6f) {
          out.seam.push_back({a, b}), out.seam_part.push_back(part);
          break;
        }
    }
  }
  return out;
}

}  // namespace burnish
