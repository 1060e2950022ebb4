// burnish/scene/surface_at.h -- what a ray sees of a triangle: normals, tangents and uvs in between its corners
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <burnish/scene/gbuffer.h>

namespace burnish {

/// What one ray meets.
struct SeenSurface {
  Surfel<float> surfel;  ///< its index is 0
  vec3<float> face;      ///< geometric normal, unit, on the ray's side
  int part = -1;         ///< index into Mesh::parts; -1: nothing is met
};

/// The surface of triangle (a, b, c) at (1 - u - v) a + u b + v c, seen from `eye`. The normal is turned to the viewer; the
/// tangent follows u of the uvs, or lies level where there are none.
inline SeenSurface surface_at(const Mesh& mesh, int triangle, float u, float v, const vec3<float>& eye) {
  const auto& [a, b, c] = mesh.triangles[std::size_t(triangle)];
  const float w = 1 - u - v;
  const vec3<float>&p0 = mesh.positions[a], &p1 = mesh.positions[b], &p2 = mesh.positions[c];
  const vec3<float> p = p0 * w + p1 * u + p2 * v, e1 = p1 - p0, e2 = p2 - p0;
  const vec3<float> view = normalize(eye - p);
  vec3<float> face = normalize(cross(e1, e2));
  vec3<float> n = mesh.normals[a] * w + mesh.normals[b] * u + mesh.normals[c] * v;
  if (!(dot(n, n) > 1e-12f)) n = face;
  n = normalize(n);
  if (dot(face, view) < 0) face = -face;
  if (dot(n, face) < 0) n = -n;
  // An interpolated normal may look away at a silhouette; it is turned back until it faces the viewer at nv = 0.01.
  if (const float nv = dot(n, view); nv < 0.01f) n = normalize(n + view * (0.01f - nv));
  const vec2<float>&t0 = mesh.uvs[a], &t1 = mesh.uvs[b], &t2 = mesh.uvs[c];
  const float du1 = t1.x - t0.x, dv1 = t1.y - t0.y, du2 = t2.x - t0.x, dv2 = t2.y - t0.y;
  const float det = du1 * dv2 - du2 * dv1;
  vec3<float> t = (e1 * dv2 - e2 * dv1) * (det < 0 ? -1.0f : 1.0f);
  t = t - n * dot(n, t);
  if (!detail::finite(t) || !(std::abs(det) > 1e-20f) || !(dot(t, t) > 1e-30f)) {
    t = std::abs(n.y) < 0.99f ? cross(vec3<float>(0, 1, 0), n) : cross(vec3<float>(0, 0, 1), n);  // no uvs: level
  }
  t = normalize(t);
  const float s = t0.x * w + t1.x * u + t2.x * v, q = t0.y * w + t1.y * u + t2.y * v;
  return {{p, n, t, view, vec2<float>(detail::finite(s) ? s : 0, detail::finite(q) ? q : 0), 0},
          face,
          mesh.part[std::size_t(triangle)]};
}

}  // namespace burnish
