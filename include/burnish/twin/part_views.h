// burnish/twin/part_views.h -- a vehicle seen from all round, and how its parts look and lie there
// SPDX-License-Identifier: Apache-2.0
//
// What is never seen from outside (seats, engines) has no say: all shares are of pixels in these views.
#pragma once
#include <burnish/math/color.h>
#include <burnish/scene/raycast.h>
#include <burnish/twin/parts.h>
#include <burnish/twin/pose.h>
#include <burnish/twin/wheels.h>

namespace burnish {

/// The cameras of all views: two rings of eight, at 5 and 32 degrees, the upper one turned by half a step; each sees
/// the whole box, width x 3/4 width pixels. Label images for vote_parts have this order and size.
inline std::vector<Camera> part_cameras(const Box& box, int width = 256) {
  std::vector<Camera> out;
  const float radius = 0.5f * std::sqrt(dot(box.size(), box.size()));
  for (int k = 0; k < 16; ++k) {
    Pose<float> p;
    p.azimuth = float(k) * 0.785398163f + (k < 8 ? 0 : 0.392699082f);
    p.elevation = k < 8 ? 0.0873f : 0.5585f;
    p.focal = 3, p.distance = 8.2f * radius, p.center = box.center();
    p.width = width, p.height = width * 3 / 4;
    out.push_back(p.camera());
  }
  return out;
}
inline std::vector<GBuffer> part_views(const Raycaster& scene, int width = 256) {
  std::vector<GBuffer> out;
  for (const Camera& c : part_cameras(bounds(scene.mesh()), width)) out.push_back(scene.trace(c, 1));
  return out;
}

/// How a part lies in the vehicle and looks. Shares are of its own visible pixels, 0 to 1, where nothing else is said.
struct PartShape {
  int pixels = 0;              // in all views together
  float share = 0;             // of all the vehicle's pixels
  float wheel = 0;             // inside a wheel's cylinder
  float inner = 0, outer = 0;  // 8th and 95th percentile of the distance from the wheel's axis, in its radii
  float height = 0;            // mean, in parts of the roof's height
  float above = 0;             // above 0.45 of the roof's height: where a car has its windows
  float up = 0;                // facing up, within 17 degrees, as a roof does and hardly a windscreen
  float ends = 0;              // in the foremost and rearmost seventh of the length
  float aside = 0;             // mean distance from the middle plane, in half widths
  float middle = 0;            // in the middle three tenths of the width
  float balance = 0;           // pixels on the weaker side against those on the stronger
  float smooth = 0;            // with the same part, of nearly the same normal, 1/128 of the picture away on all sides
  float open = 0;              // of the rays from it into its hemisphere (cosine), how many leave the vehicle
  vec3<float> color;           // mean, linear RGB, as the file has it
  float spread = 0;            // standard deviation of its colour's luminance
};

namespace detail {
/// 16 directions over the hemisphere about +y, spread by the cosine (Malley's way, golden angle).
inline std::array<vec3<float>, 16> cosine_directions() {
  std::array<vec3<float>, 16> d;
  for (int i = 0; i < 16; ++i) {
    const float r = std::sqrt((float(i) + 0.5f) / 16), a = 2.39996323f * float(i);
    d[std::size_t(i)] = {r * std::cos(a), std::sqrt(1 - r * r), r * std::sin(a)};
  }
  return d;
}
}  // namespace detail

/// The shape of every part of the mesh, from its views.
inline std::vector<PartShape> part_shapes(const Raycaster& scene, const std::vector<GBuffer>& views,
                                          const std::vector<Wheel>& wheels) {
  const Mesh& mesh = scene.mesh();
  const Box box = bounds(mesh);
  const vec3<float> half = box.size() * 0.5f;
  std::vector<PartShape> out(mesh.parts.size());
  struct Sum {
    double height = 0, aside = 0, left = 0, right = 0, y = 0, yy = 0;
    std::vector<float> radii;
    std::vector<std::pair<int, int>> places;  // view and surfel
  };
  std::vector<Sum> sums(out.size());
  std::vector<float> tops;
  long all = 0;
  for (const GBuffer& g : views)
    for (int i = 0; i < g.size(); ++i) tops.push_back(g.plane[1][std::size_t(i)]);
  if (tops.empty()) return out;
  const auto roof_place = tops.begin() + std::ptrdiff_t(double(tops.size() - 1) * 0.99);
  std::nth_element(tops.begin(), roof_place, tops.end());
  const float roof = std::max(*roof_place - box.low.y, 1e-3f);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const GBuffer& g = views[v];
    std::vector<int> at(std::size_t(g.width) * std::size_t(g.height), -1);
    for (int i = 0; i < g.size(); ++i) at[std::size_t(g.pixel[std::size_t(i)])] = i;
    const int step = std::max(1, g.width / 128);
    for (int i = 0; i < g.size(); ++i, ++all) {
      const std::size_t p = std::size_t(g.part[std::size_t(i)]);
      PartShape& shape = out[p];
      Sum& sum = sums[p];
      const Surfel<float> s = g.at(i);
      const float y = (s.position.y - box.low.y) / roof, z = (s.position.z - box.center().z) / half.z;
      ++shape.pixels;
      sum.height += double(y), sum.aside += double(std::abs(z));
      (z < 0 ? sum.left : sum.right) += 1;
      shape.above += y > 0.45f;
      shape.up += g.geometric_normal(i).y > 0.956f;
      shape.middle += std::abs(z) < 0.3f;
      shape.ends += std::abs(s.position.x - box.center().x) > 0.714f * half.x;
      const vec3<float> c = mesh.color(mesh.parts[p], s.uv);
      shape.color = shape.color + c;
      sum.y += double(luminance(c)), sum.yy += double(luminance(c)) * double(luminance(c));
      for (const Wheel& w : wheels) {
        const float r = w.radius_at(s.position);
        if (r > 1.05f) continue;
        shape.wheel += 1, sum.radii.push_back(r);
        break;
      }
      const int x = g.pixel[std::size_t(i)] % g.width, row = g.pixel[std::size_t(i)] / g.width;
      int like = 0;
      for (const auto& [dx, dy] : {std::pair{step, 0}, {-step, 0}, {0, step}, {0, -step}}) {
        if (x + dx < 0 || x + dx >= g.width || row + dy < 0 || row + dy >= g.height) continue;
        const int j = at[std::size_t((row + dy) * g.width + x + dx)];
        like += j >= 0 && g.part[std::size_t(j)] == int(p) && dot(g.at(j).normal, s.normal) > 0.9f;
      }
      shape.smooth += like == 4;
      sum.places.emplace_back(int(v), i);
    }
  }
  std::vector<vec3<float>> origins, directions;
  std::vector<std::size_t> owner;
  const auto hemisphere = detail::cosine_directions();
  for (std::size_t p = 0; p < out.size(); ++p) {
    const auto& places = sums[p].places;
    for (std::size_t k = 0; k < places.size(); k += 1 + places.size() / 64) {
      const GBuffer& g = views[std::size_t(places[k].first)];
      const vec3<float> n = g.geometric_normal(places[k].second), from = g.at(places[k].second).position;
      const vec3<float> t = normalize(cross(n, std::abs(n.y) < 0.9f ? vec3<float>(0, 1, 0) : vec3<float>(1, 0, 0)));
      const vec3<float> b = cross(n, t);
      for (const vec3<float>& d : hemisphere) {
        origins.push_back(Raycaster::lift(from + n * (0.002f * half.x), n));
        directions.push_back(t * d.x + n * d.y + b * d.z);
        owner.push_back(p);
      }
    }
  }
  std::vector<std::uint8_t> blocked(origins.size());
  scene.occluded(origins, directions, blocked);
  std::vector<int> rays(out.size()), free(out.size());
  for (std::size_t k = 0; k < blocked.size(); ++k) ++rays[owner[k]], free[owner[k]] += !blocked[k];
  for (std::size_t p = 0; p < out.size(); ++p) {
    PartShape& s = out[p];
    Sum& sum = sums[p];
    if (s.pixels == 0) continue;
    const float n = float(s.pixels);
    s.share = n / float(all);
    for (float* x : {&s.wheel, &s.above, &s.up, &s.ends, &s.middle, &s.smooth}) *x /= n;
    s.height = float(sum.height) / n, s.aside = float(sum.aside) / n;
    s.balance = float(std::min(sum.left, sum.right) / std::max({sum.left, sum.right, 1.0}));
    s.color = s.color / n;
    s.spread = float(std::sqrt(std::max(0.0, sum.yy / double(n) - sum.y * sum.y / double(n) / double(n))));
    s.open = rays[p] > 0 ? float(free[p]) / float(rays[p]) : 0;
    if (sum.radii.empty()) continue;
    std::sort(sum.radii.begin(), sum.radii.end());
    const auto at = [&](double q) { return sum.radii[std::size_t(q * double(sum.radii.size() - 1))]; };
    s.inner = at(0.08), s.outer = at(0.95);
  }
  return out;
}

}  // namespace burnish
