// tests/reference/images_gbuffer.cpp -- what a camera sees of a car, channel by channel, against Mitsuba's `aov`
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include "images.h"

using namespace burnish;

namespace {
constexpr int width = 96, height = 64;
const std::string aov = images::mitsuba + "aov";
}  // namespace

TEST_CASE("GBuffer: of a car, every channel is Mitsuba's at every pixel", "[reference][value]") {
  const Raycaster caster(images::car());
  const GBuffer g = caster.trace(images::camera(width, height), 1);
  const reference::Array part = reference::load("car_parts"), theirs = reference::load("car_gbuffer");
  const std::vector<int> row = images::rows(part);
  const double size = double(length(bounds(caster.mesh()).size()));

  std::vector<double> ours(part.size(), 255);
  for (int i = 0; i < g.size(); ++i) ours[std::size_t(g.pixel[std::size_t(i)])] = g.part[std::size_t(i)];
  long other = 0;
  for (std::size_t p = 0; p < ours.size(); ++p) other += ours[p] != part.values[p];
  record::claim("GBuffer: pixels that see another part, or nothing", "image", aov, 0, double(other), long(ours.size()));

  images::Difference position, depth, uv, face, normal, tangent;
  long bent = 0;
  for (int i = 0; i < g.size(); ++i) {
    const int r = row[std::size_t(g.pixel[std::size_t(i)])];
    if (r < 0) continue;
    const auto get = [&](int k) { return vec3<double>(theirs(r, k), theirs(r, k + 1), theirs(r, k + 2)); };
    const Surfel<float> s = g.at(i);
    const vec3<double> p = get(0), eye(g.camera.position), forward(g.camera.forward), view = normalize(eye - p);
    position.add(s.position, p);
    // Mitsuba's depth begins at the near plane, half a metre along the axis, and goes along the ray.
    const double cosine = -dot(view, forward);
    depth.add(double(g.plane[GBuffer::depth][std::size_t(i)]), theirs(r, 14) * cosine + 0.5);
    uv.add(double(s.uv.x), theirs(r, 12)), uv.add(double(s.uv.y), theirs(r, 13));
    const vec3<double> g_n = get(3);
    face.add(g.geometric_normal(i), dot(g_n, view) < 0 ? -g_n : g_n);
    // Ours is on the face's side and looks at the viewer with a cosine of .01 at least.
    vec3<double> n = get(6);
    if (dot(n, vec3<double>(g.geometric_normal(i))) < 0) n = -n;
    if (const double nv = dot(n, view); nv < 0.01) n = normalize(n + view * (0.01 - nv)), ++bent;
    normal.add(s.normal, n);
    const vec3<double> u = get(9);
    tangent.add(s.tangent, normalize(u - n * dot(n, u)));
  }
  CHECK(bent == 3);
  record::claim("GBuffer: position, of the scene's size", "image", aov, 1e-4, position.worst() / size,
                position.count());
  record::claim("GBuffer: depth, of the scene's size", "image", aov, 1e-4, depth.worst() / size, depth.count());
  record::claim("GBuffer: uv", "image", aov, 1e-4, uv.worst(), uv.count());
  record::claim("GBuffer: geometric normal", "image", aov, 1e-4, face.worst(), face.count());
  record::claim("GBuffer: shading normal", "image", aov, 1e-4, normal.worst(), normal.count());
  record::claim("GBuffer: tangent", "image", aov, 1e-4, tangent.worst(), tangent.count());
}

TEST_CASE("GBuffer: coverage is the part of Mitsuba's rays at the same places that hit", "[reference][value]") {
  const GBuffer g = Raycaster(images::car()).trace(images::camera(width, height), 8);
  const reference::Array part = reference::load("car_parts"), covered = reference::load("car_covered");
  const Mask ours = g.frame("coverage");
  images::Difference edge;
  long inside = 0, gaps = 0, looked_at = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      bool all = x > 0 && y > 0 && x + 1 < width && y + 1 < height;
      for (int k = 0; k < 9 && all; ++k) all = part(y + k / 3 - 1, x + k % 3 - 1) < 255;
      const double theirs = covered(y, x) / 64;
      if (all) {  // counts as covered without being looked at
        ++inside, gaps += theirs < 1, looked_at += ours.at(x, y) != 1;
      } else edge.add(double(ours.at(x, y)), theirs);
    }
  }
  CHECK(looked_at == 0);
  const std::string rays = images::mitsuba + "ray_test";
  record::claim("GBuffer: coverage where it is measured", "image", rays, 1.0 / 64, edge.worst(), edge.count());
  record::claim("GBuffer: inner pixels that have a gap nevertheless", "image", rays, 0, double(gaps), inside);
}
