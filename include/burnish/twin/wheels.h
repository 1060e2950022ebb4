// burnish/twin/wheels.h -- where a vehicle has its wheels: round pieces, low, in pairs left and right
// SPDX-License-Identifier: Apache-2.0
//
// In the frame of scene/vehicle.h; nothing but positions is looked at.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>
#include <burnish/scene/clean.h>

namespace burnish {

/// A cylinder across the vehicle; a wheel that is steered lies in one that is wider and a little longer than high. A
/// spare wheel that hangs at the rear lies along it.
struct Wheel {
  vec3<float> center;
  float half_length = 0, radius = 0, half_width = 0;  // in its plane, level; upright; along its axis; metres
  bool spare = false;

  /// The distance from the axis in radii; huge beside the wheel.
  float radius_at(const vec3<float>& p) const {
    const vec3<float> d = p - center;
    const float u = (spare ? d.z : d.x) / half_length, v = d.y / radius;
    return std::abs(spare ? d.x : d.z) > half_width + 0.15f * radius ? 1e9f : std::sqrt(u * u + v * v);
  }
};

namespace detail {
/// Whether points are the outline of a wheel seen along its axis: round, all round, and as thick as wheels are.
inline bool round_along_axis(const std::vector<vec3<float>>& points, bool spare, Wheel& wheel) {
  Box box;
  for (const vec3<float>& p : points) box.add(p);
  const vec3<float> size = box.size() * 0.5f;
  const float along = spare ? size.z : size.x, thick = spare ? size.x : size.z;
  if (points.size() < 8 || !(size.y > 0) || along < 0.85f * size.y || along > 1.3f * size.y || thick > 0.9f * size.y)
    return false;
  wheel = {box.center(), along, size.y, thick, spare};
  std::array<float, 12> reach{};
  for (const vec3<float>& p : points) {
    const vec3<float> d = p - wheel.center;
    const float u = (spare ? d.z : d.x) / along, v = d.y / size.y, r = std::sqrt(u * u + v * v);
    if (r > 1.13f) return false;
    float& most = reach[std::size_t(std::clamp(int((std::atan2(v, u) / 6.2831853f + 0.5f) * 12), 0, 11))];
    most = std::max(most, r);
  }
  return std::count_if(reach.begin(), reach.end(), [](float r) { return r > 0.86f; }) >= 11;
}
}  // namespace detail

/// The wheels, none when there are none or they hang together with other things. Candidates are the connected pieces,
/// and what of one part lies in one quarter of the vehicle. A wheel is round, 0.18 to 0.8 of the vehicle's height,
/// stands on the ground and has a twin on the other side; a spare wheel hangs at the rear and is as large as they are,
/// or, where there are none, 0.3 to 0.6 of the vehicle's height.
inline std::vector<Wheel> find_wheels(const Mesh& m) {
  if (m.triangles.empty()) return {};
  const Box box = bounds(m);
  const float high = box.size().y, wide = box.size().z;
  std::vector<Wheel> found, spares;
  const auto consider = [&](const std::vector<vec3<float>>& points) {
    Wheel w;
    if (detail::round_along_axis(points, false, w)) {
      const float low = w.center.y - w.radius - box.low.y;
      if (low < 0.3f * w.radius && w.radius > 0.09f * high && w.radius < 0.4f * high &&
          std::abs(w.center.z - box.center().z) > 0.15f * wide)
        found.push_back(w);
    } else if (detail::round_along_axis(points, true, w)) {
      if (w.center.x - w.half_width < box.low.x + 0.12f * box.size().x && w.radius > 0.15f * high &&
          w.radius < 0.3f * high)
        spares.push_back(w);
    }
  };
  const std::vector<int> piece = detail::pieces(m, detail::weld(m));
  std::vector<std::vector<vec3<float>>> points(std::size_t(*std::max_element(piece.begin(), piece.end())) + 1);
  std::map<std::pair<int, int>, std::vector<vec3<float>>> clusters;  // by part and quarter
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    for (int v : m.triangles[t]) {
      const vec3<float> p = m.positions[std::size_t(v)];
      points[std::size_t(piece[t])].push_back(p);
      clusters[{m.part[t], (p.x > box.center().x) * 2 + (p.z > box.center().z)}].push_back(p);
    }
  for (const auto& p : points) consider(p);
  for (const auto& [key, p] : clusters) consider(p);

  // One wheel of all that share an axis: the largest, as thick as all together.
  const auto near = [](const Wheel& a, float x, float z) {
    return std::abs(a.center.x - x) < 0.5f * a.radius && std::abs(a.center.z - z) < a.half_width + 0.7f * a.radius;
  };
  const auto larger = [](const Wheel& a, const Wheel& b) { return a.radius > b.radius; };
  std::stable_sort(found.begin(), found.end(), larger), std::stable_sort(spares.begin(), spares.end(), larger);
  std::vector<Wheel> wheels;
  for (const Wheel& w : found) {
    const auto same =
        std::find_if(wheels.begin(), wheels.end(), [&](const Wheel& a) { return near(a, w.center.x, w.center.z); });
    if (same == wheels.end()) {
      wheels.push_back(w);
      continue;
    }
    const float low = std::min(same->center.z - same->half_width, w.center.z - w.half_width),
                top = std::max(same->center.z + same->half_width, w.center.z + w.half_width);
    same->center.z = 0.5f * (low + top), same->half_width = 0.5f * (top - low);
  }
  std::vector<Wheel> out;
  for (const Wheel& w : wheels)
    if (std::any_of(wheels.begin(), wheels.end(), [&](const Wheel& a) {
          return &a != &w && std::abs(a.radius - w.radius) < 0.15f * w.radius &&
                 near(a, w.center.x, 2 * box.center().z - w.center.z);
        }))
      out.push_back(w);
  const std::size_t standing = out.size();
  for (const Wheel& w : spares) {
    const bool known = std::any_of(out.begin(), out.end(), [&](const Wheel& a) {
      return a.spare && std::abs(a.center.y - w.center.y) + std::abs(a.center.z - w.center.z) < 0.5f * a.radius;
    });
    if (known || (standing > 0 && std::abs(w.radius - out[0].radius) > 0.3f * out[0].radius)) continue;
    out.push_back(w);
  }
  return out;
}

}  // namespace burnish
