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

/// A cylinder across the vehicle; a wheel that is steered lies in one that is wider and a little longer than high.
struct Wheel {
  vec3<float> center;
  float half_length = 0, radius = 0, half_width = 0;  // along x, along y, along z; metres

  /// The distance from the axis in radii; huge beside the wheel.
  float radius_at(const vec3<float>& p) const {
    const float u = (p.x - center.x) / half_length, v = (p.y - center.y) / radius;
    return std::abs(p.z - center.z) > half_width + 0.15f * radius ? 1e9f : std::sqrt(u * u + v * v);
  }
};

namespace detail {
/// Whether points are the outline of a wheel seen from the side: round, all round, and as thick as wheels are.
inline bool round_from_side(const std::vector<vec3<float>>& points, Wheel& wheel) {
  Box box;
  for (const vec3<float>& p : points) box.add(p);
  const vec3<float> half = box.size() * 0.5f;
  if (points.size() < 8 || !(half.y > 0) || half.x < 0.85f * half.y || half.x > 1.3f * half.y || half.z > 0.9f * half.y)
    return false;
  wheel = {box.center(), half.x, half.y, half.z};
  std::array<float, 12> reach{};
  for (const vec3<float>& p : points) {
    const float u = (p.x - wheel.center.x) / half.x, v = (p.y - wheel.center.y) / half.y, r = std::sqrt(u * u + v * v);
    if (r > 1.13f) return false;
    float& most = reach[std::size_t(std::clamp(int((std::atan2(v, u) / 6.2831853f + 0.5f) * 12), 0, 11))];
    most = std::max(most, r);
  }
  return std::count_if(reach.begin(), reach.end(), [](float r) { return r > 0.86f; }) >= 11;
}
}  // namespace detail

/// The wheels on the ground, none when there are none or they hang together with other things. Candidates are the
/// connected pieces, and what of one part lies in one place; round, of 0.2 to 0.8 of the vehicle's height, standing
/// on the ground, and with a twin on the other side.
inline std::vector<Wheel> find_wheels(const Mesh& m) {
  const Box box = bounds(m);
  const float high = box.size().y, wide = box.size().z;
  std::vector<Wheel> found;
  const auto consider = [&](const std::vector<vec3<float>>& points) {
    Wheel w;
    if (!detail::round_from_side(points, w)) return;
    const float low = w.center.y - w.radius - box.low.y;
    if (low > 0.3f * w.radius || w.radius < 0.1f * high || w.radius > 0.4f * high) return;
    if (std::abs(w.center.z - box.center().z) < 0.15f * wide) return;
    found.push_back(w);
  };
  const std::vector<int> piece = detail::pieces(m, detail::weld(m));
  std::vector<std::vector<vec3<float>>> points(std::size_t(m.triangles.empty() ? 0 : 1 + *std::max_element(piece.begin(), piece.end())));
  std::map<std::pair<int, int>, std::vector<vec3<float>>> clusters;  // by part and quarter of the vehicle
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    for (int v : m.triangles[t]) {
      const vec3<float> p = m.positions[std::size_t(v)];
      points[std::size_t(piece[t])].push_back(p);
      clusters[{m.part[t], (p.x > box.center().x) * 2 + (p.z > box.center().z)}].push_back(p);
    }
  for (const auto& p : points) consider(p);
  for (const auto& [key, p] : clusters) consider(p);

  std::sort(found.begin(), found.end(), [](const Wheel& a, const Wheel& b) { return a.radius > b.radius; });
  std::vector<Wheel> wheels;
  const auto near = [](const Wheel& a, float x, float z) {
    return std::abs(a.center.x - x) < 0.5f * a.radius && std::abs(a.center.z - z) < a.half_width + 0.7f * a.radius;
  };
  for (const Wheel& w : found) {
    const auto same = std::find_if(wheels.begin(), wheels.end(),
                                   [&](const Wheel& a) { return near(a, w.center.x, w.center.z); });
    if (same == wheels.end()) {
      wheels.push_back(w);
      continue;
    }
    const float low = std::min(same->center.z - same->half_width, w.center.z - w.half_width),
                high_z = std::max(same->center.z + same->half_width, w.center.z + w.half_width);
    same->center.z = 0.5f * (low + high_z), same->half_width = 0.5f * (high_z - low);
  }
  std::vector<Wheel> paired;
  for (const Wheel& w : wheels)
    if (std::any_of(wheels.begin(), wheels.end(), [&](const Wheel& a) {
          return &a != &w && std::abs(a.radius - w.radius) < 0.15f * w.radius &&
                 near(a, w.center.x, 2 * box.center().z - w.center.z);
        }))
      paired.push_back(w);
  return paired;
}

}  // namespace burnish
