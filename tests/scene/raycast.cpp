// tests/scene/raycast.cpp -- what rays see, against closed forms
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include <cstring>
#include "shapes.h"
#include <burnish/scene/clean.h>
#include <burnish/scene/raycast.h>

using namespace burnish;

namespace {
Camera looking_at(vec3<float> eye, float fov, int w, int h) {
  return Camera::look_at(eye, {0, 0, 0}, {0, 1, 0}, fov, w, h);
}
/// A filled disc in the plane z = 0, normal +z.
Mesh disc(float radius, int n) {
  Mesh m;
  m.parts.push_back({.name = "disc", .material = "paint"});
  m.add({0, 0, 0}, {0, 0, 1}, {0, 0});
  for (int i = 0; i < n; ++i) {
    const float a = 2 * shapes::pi * float(i) / float(n), x = radius * std::cos(a), y = radius * std::sin(a);
    m.add({x, y, 0}, {0, 0, 1}, {x, y});
    m.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
    m.part.push_back(0);
  }
  return m;
}
}  // namespace

TEST_CASE("Raycaster: a sphere's G-buffer is the sphere in closed form", "[scene][agreement]") {
  const float radius = 1.5f;
  const Raycaster caster(shapes::sphere({0, 0, 0}, radius, 256));
  const Camera c = looking_at({0, 1, 6}, 35, 96, 80);
  const GBuffer g = caster.trace(c, 1);
  int expected = 0;
  for (int i = 0; i < 96 * 80; ++i) {
    const Ray r = c.ray(float(i % 96) + 0.5f, float(i / 96) + 0.5f);
    const float b = dot(r.origin, r.direction);
    expected += b * b - dot(r.origin, r.origin) + radius * radius > 0;
  }
  CHECK(std::abs(g.size() - expected) <= 6);  // the facets stay 0.0002 m inside
  for (int i = 0; i < g.size(); ++i) {
    const Surfel<float> s = g.at(i);
    const Ray r = c.ray(float(g.pixel[i] % 96) + 0.5f, float(g.pixel[i] / 96) + 0.5f);
    const float b = dot(r.origin, r.direction), root = b * b - dot(r.origin, r.origin) + radius * radius;
    if (root < 0.05f) continue;  // not at the rim, where depth has no bound
    const vec3<float> p = r.origin + r.direction * (-b - std::sqrt(root)), n = p / radius;
    CHECK(length(s.position - p) < 2e-3f);
    CHECK(dot(s.normal, n) > 0.99999f);
    CHECK(dot(g.geometric_normal(i), n) > 0.9999f);
    CHECK(length(s.view - -r.direction) < 1e-3f);
    CHECK(g.plane[GBuffer::depth][i] == Approx(dot(p - c.position, c.forward)).margin(2e-3));
    CHECK(s.uv.y == Approx(0.5f + std::asin(n.y) / shapes::pi).margin(2e-3));
    float u = std::atan2(n.x, n.z) / (2 * shapes::pi);
    if (u < 0) u += 1;
    CHECK(std::min(std::abs(s.uv.x - u), 1 - std::abs(s.uv.x - u)) < 2e-3f);
    const vec3<float> east = normalize(vec3<float>(n.z, 0, -n.x));  // where u grows
    CHECK(dot(s.tangent, east) > 0.999f);
    CHECK(std::abs(dot(s.tangent, s.normal)) < 1e-5f);
    CHECK(cross(s.normal, s.tangent).y > 0);  // the bitangent goes where v grows
    CHECK(s.index == float(i));
  }
}

TEST_CASE("Raycaster: coverage adds up to the area of a disc", "[scene][agreement]") {
  const Raycaster caster(disc(1, 720));
  const Camera c = looking_at({0, 0, 10}, 20, 61, 53);
  const float scale = c.fx / 10;  // pixels a metre
  for (int samples : {4, 5, 8}) {
    const GBuffer g = caster.trace(c, samples);
    double area = 0;
    bool partly = false;
    for (int i = 0; i < g.size(); ++i) {
      const float a = g.plane[GBuffer::coverage][i];
      CHECK((a > 0 && a <= 1));
      area += a, partly = partly || (a > 0.2f && a < 0.8f);
    }
    CHECK(partly);
    CHECK(area == Approx(shapes::pi * scale * scale).epsilon(0.004));
  }
}

TEST_CASE("Raycaster: a pixel that is covered but not at its centre has a surfel of what covers it", "[scene][value]") {
  const Raycaster caster(disc(1, 720));
  const Camera c = looking_at({0, 0, 10}, 20, 61, 53);
  const GBuffer centres = caster.trace(c, 1), all = caster.trace(c, 4);
  CHECK(all.size() > centres.size());
  for (int i = 0; i < all.size(); ++i) {
    const Surfel<float> s = all.at(i);
    CHECK(length(s.position) < 1.0001f);
    const vec3<float> p = c.project(s.position);
    CHECK(int(p.x + 1e-3f) - all.pixel[i] % 61 <= 1);
    CHECK(std::abs(p.x - float(all.pixel[i] % 61) - 0.5f) < 0.501f);
    CHECK(std::abs(p.y - float(all.pixel[i] / 61) - 0.5f) < 0.501f);
  }
}

TEST_CASE("Raycaster: the nearest part is seen, from either side of its faces", "[scene][value]") {
  Mesh m;
  shapes::add_rectangle(m, "far", {-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1});
  shapes::add_rectangle(m, "near", {-1, -1, 0}, {0, -1, 0}, {0, 1, 0}, {-1, 1, 0});
  MeshReport report;
  fill_normals(m, report);
  fill_uvs(m, report);
  const Raycaster caster(m);
  for (float side : {1.0f, -1.0f}) {
    const GBuffer g = caster.trace(looking_at({0, 0, 8 * side}, 12, 32, 32), 1);
    for (int i = 0; i < g.size(); ++i) {
      const Surfel<float> s = g.at(i);
      const std::string& name = g.parts[g.part[i]].name;
      if (side < 0) CHECK(name == "far");
      else if (std::abs(s.position.x) < 0.8f) CHECK(name == (s.position.x < 0 ? "near" : "far"));
      CHECK(s.normal.z == Approx(side));
      CHECK(g.geometric_normal(i).z == Approx(side));
    }
  }
}

TEST_CASE("Raycaster: shading normals never look away from the viewer", "[scene][limit]") {
  const Raycaster caster(shapes::sphere({0, 0, 0}, 1, 5));  // coarse: interpolated normals leave the facets far behind
  const GBuffer g = caster.trace(looking_at({0.3f, 0.2f, 4}, 40, 128, 128), 4);
  REQUIRE(g.size() > 1000);
  for (int i = 0; i < g.size(); ++i) {
    const Surfel<float> s = g.at(i);
    REQUIRE(dot(s.normal, s.view) > 0.009f);
    REQUIRE(length(s.normal) == Approx(1).epsilon(1e-5));
    REQUIRE(length(s.tangent) == Approx(1).epsilon(1e-5));
    REQUIRE(dot(g.geometric_normal(i), s.view) >= 0);
  }
}

TEST_CASE("Raycaster: occlusion by a square in front of the sky", "[scene][agreement]") {
  Mesh m;
  shapes::add_rectangle(m, "roof", {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1});
  shapes::add_rectangle(m, "floor", {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9});
  MeshReport report;
  fill_normals(m, report);
  const Raycaster caster(m);
  std::vector<vec3<float>> from, to;
  std::vector<bool> expected;
  for (int i = 0; i < 999; ++i) {
    const float x = -3 + 0.006f * float(i), a = 0.37f * float(i);
    const vec3<float> d = normalize(vec3<float>(std::cos(a), 0.9f, std::sin(a)));
    from.push_back(Raycaster::lift({x, 0, 0.1f}, {0, 1, 0}));
    to.push_back(d);
    const float hx = x + d.x / d.y, hz = 0.1f + d.z / d.y;  // where it crosses the height of the roof
    expected.push_back(std::abs(hx) < 1 && std::abs(hz) < 1);
  }
  std::vector<std::uint8_t> blocked(from.size());
  caster.occluded(from, to, blocked);
  int wrong = 0;
  for (std::size_t i = 0; i < from.size(); ++i) wrong += bool(blocked[i]) != expected[i];
  CHECK(wrong <= 2);  // at the very edge
  caster.occluded(from, to, blocked, 0.5f);
  CHECK(std::count(blocked.begin(), blocked.end(), 1) == 0);  // nothing is that near

  const GBuffer g = caster.trace(Camera::look_at({0, 0.5f, 6}, {0, 0, 0}, {0, 1, 0}, 40, 48, 48), 1);
  const vec3<float> dirs[] = {{0, 1, 0}, {0, -1, 0}};
  const auto seen = caster.visible(g, dirs);
  REQUIRE(seen.size() == 2 * std::size_t(g.padded_size()));
  for (int i = 0; i < g.size(); ++i) {
    const vec3<float> p = g.at(i).position;
    if (p.y > 0.5f || std::abs(std::abs(p.x) - 1) < 0.01f || std::abs(std::abs(p.z) - 1) < 0.01f) continue;
    CHECK(bool(seen[i]) == !(std::abs(p.x) < 1 && std::abs(p.z) < 1));
    CHECK(seen[g.padded_size() + i] == 0);  // through the floor itself
  }
}

TEST_CASE("Raycaster: a convex mesh hides exactly what lies behind a face from that face, at its edges too",
          "[scene][agreement]") {
  const Raycaster caster(shapes::sphere({0, 0, 0}, 1, 7));
  const GBuffer g = caster.trace(looking_at({0.4f, 0.3f, 4}, 32, 96, 96), 1);
  std::vector<vec3<float>> directions;
  for (int k = 0; k < 60; ++k) {
    const float a = 2.4f * float(k), y = 1 - (float(k) + 0.5f) / 30;
    directions.push_back(vec3<float>(std::sqrt(1 - y * y) * std::cos(a), y, std::sqrt(1 - y * y) * std::sin(a)));
  }
  const auto seen = caster.visible(g, directions);
  std::vector<std::uint8_t> blocked(directions.size());
  int wrong = 0, asked = 0;
  for (int i = 0; i < g.size(); ++i) {
    caster.blocked(g, i, directions, blocked);
    for (std::size_t d = 0; d < directions.size(); ++d) {
      const float above = dot(g.geometric_normal(i), directions[d]);
      if (std::abs(above) < 1e-6f) continue;
      ++asked;
      wrong += (seen[d * std::size_t(g.padded_size()) + std::size_t(i)] == 1) != (above > 0);
      wrong += (blocked[d] == 0) != (above > 0);
    }
  }
  CHECK(wrong == 0);
  CHECK(asked > 100000);
}

TEST_CASE("Raycaster: the same bits for any number of threads", "[scene][agreement]") {
  const Raycaster caster(shapes::sphere({0, 0, 0}, 1, 40));
  const Camera c = looking_at({1, 1, 3}, 45, 101, 67);
  const int before = threads();
  set_threads(1);
  const GBuffer one = caster.trace(c);
  for (int n : {2, 5}) {
    set_threads(n);
    const GBuffer many = caster.trace(c);
    CHECK(many.pixel == one.pixel);
    for (int k = 0; k < GBuffer::planes; ++k) {
      REQUIRE(many.plane[k].size() == one.plane[k].size());
      CHECK(std::memcmp(many.plane[k].data(), one.plane[k].data(), one.plane[k].size() * sizeof(float)) == 0);
    }
  }
  set_threads(before);
}

TEST_CASE("GBuffer: packed and padded, chosen from, and spread out again", "[scene][value]") {
  Mesh m;
  shapes::add_box(m, "left", {-1, -0.5f, -0.5f}, {-0.1f, 0.5f, 0.5f});
  shapes::add_box(m, "right", {0.1f, -0.5f, -0.5f}, {1, 0.5f, 0.5f});
  MeshReport report;
  fill_normals(m, report);
  fill_uvs(m, report);
  const GBuffer g = Raycaster(m).trace(looking_at({0, 0, 5}, 30, 50, 40), 1);
  CHECK(std::is_sorted(g.pixel.begin(), g.pixel.end()));
  CHECK(g.plane[0].size() % 256 == 0);
  for (const Floats& p : g.plane) {
    CHECK(reinterpret_cast<std::uintptr_t>(p.data()) % 64 == 0);
    CHECK(p.back() == p[g.size() - 1]);
  }
  const GBuffer left = g.only([](int part) { return part == 0; });
  const GBuffer right = g.only([](const Surfel<float>& s) { return s.position.x > 0; });
  CHECK(left.size() > 0);
  CHECK(left.size() + right.size() == g.size());
  CHECK(right.at(right.size() - 1).index == float(right.size() - 1));
  const Mask ids = g.frame("part"), depth = right.frame("depth");
  CHECK(ids.at(0, 0) == -1);
  CHECK(ids.at(15, 20) == 0);
  CHECK(ids.at(34, 20) == 1);
  CHECK(depth.at(15, 20) == 0);
  CHECK(depth.at(34, 20) == Approx(4.5));
  CHECK(g.only([](int) { return false; }).size() == 0);
  int fields = 0;
  Surfel<float> s;
  each([&](float&) { ++fields; }, s);
  CHECK(fields == GBuffer::fields);
}

TEST_CASE("Raycaster: a mesh that cannot be traced is refused in one line", "[scene][limit]") {
  CHECK_THROWS_AS(Raycaster(Mesh{}), Error);
  Mesh m;
  shapes::add_rectangle(m, "wall", {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  m.positions[2].y = std::nanf("");
  CHECK_THROWS_AS(Raycaster(m), Error);
  const GBuffer g = Raycaster(disc(1, 8)).trace(Camera::look_at({0, 0, 5}, {0, 0, 9}, {0, 1, 0}, 30, 16, 16));
  CHECK(g.size() == 0);  // looking away
}
