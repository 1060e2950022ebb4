// tests/twin/toy_car.h -- small vehicles whose front, sides and parts are known, and photos of them
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/scene/raycast.h>
#include <burnish/twin/pose.h>
#include <scene/shapes.h>

namespace toys {
using namespace burnish;

/// A car of boxes and spheres: longer than high, its cabin towards the rear, nothing symmetric but left and right.
inline Mesh car(int n = 12) {
  Mesh m;
  shapes::add_box(m, "body", {-2.1f, 0.35f, -0.85f}, {2.1f, 0.95f, 0.85f});
  shapes::add_box(m, "cabin", {-1.7f, 0.95f, -0.75f}, {0.5f, 1.5f, 0.75f});
  for (const float x : {-1.3f, 1.35f})
    for (const float z : {-0.8f, 0.8f}) {
      const Mesh wheel = shapes::sphere({x, 0.33f, z}, 0.33f, n);
      const int first = int(m.positions.size());
      for (std::size_t v = 0; v < wheel.positions.size(); ++v)
        m.add(wheel.positions[v], wheel.normals[v], wheel.uvs[v]);
      for (const auto& t : wheel.triangles)
        m.triangles.push_back({t[0] + first, t[1] + first, t[2] + first}), m.part.push_back(int(m.parts.size()));
      m.parts.push_back({.name = "wheel", .material = "rubber"});
    }
  return m;
}
/// Two boxes, each the same from ahead and from behind, so that the outline cannot tell; a window in the front half of
/// the upper one can.
inline Mesh two_way() {
  Mesh m;
  shapes::add_box(m, "body", {-2, 0.2f, -0.8f}, {2, 0.9f, 0.8f});
  shapes::add_box(m, "cabin", {-1.2f, 0.9f, -0.7f}, {1.2f, 1.5f, 0.7f});
  shapes::add_box(m, "window", {0.2f, 1.0f, -0.703f}, {1.0f, 1.4f, 0.703f});
  for (const float x : {-1.3f, 1.3f})
    shapes::add_box(m, "tyre", {x - 0.3f, 0, -0.803f}, {x + 0.3f, 0.6f, 0.803f});
  return m;
}
/// What a camera photographs of it: red paint, dark windows and tyres, light from above, before a street.
inline Image photo_of(const Raycaster& scene, const Pose<float>& pose) {
  Image out(pose.width, pose.height);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      out.set(x, y, vec3<float>(0.3f, 0.32f, 0.35f) *
                        (1 + 0.3f * std::sin(0.11f * float(x)) * std::cos(0.07f * float(y))));
  const GBuffer g = scene.trace(pose.camera(), 4);
  for (int i = 0; i < g.size(); ++i) {
    const std::string& name = g.parts[std::size_t(g.part[std::size_t(i)])].name;
    const vec3<float> albedo = name == "body" || name == "cabin" ? vec3<float>(0.5f, 0.1f, 0.08f)
                                                                 : vec3<float>(0.03f, 0.03f, 0.03f);
    const float cover = g.plane[GBuffer::coverage][std::size_t(i)];
    const int x = g.pixel[std::size_t(i)] % out.width, y = g.pixel[std::size_t(i)] / out.width;
    const vec3<float> n = g.at(i).normal;
    out.set(x, y, out.at(x, y) * (1 - cover) + albedo * ((0.7f + 0.3f * n.y + 0.1f * n.x) * cover));
  }
  return out;
}
inline Pose<float> some_pose(int w, int h) {
  Pose<float> p;
  p.azimuth = 0.9f, p.elevation = 0.15f, p.roll = 0.03f, p.distance = 9, p.right = 0.02f, p.down = -0.03f;
  p.focal = 1.3f, p.width = w, p.height = h;
  return p;
}
}  // namespace toys
