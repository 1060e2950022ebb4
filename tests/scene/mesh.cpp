// tests/scene/mesh.cpp -- the defects of real CAD, each made on purpose, and vehicles stood on their wheels
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include "shapes.h"
#include <burnish/scene/vehicle.h>

using namespace burnish;
using shapes::add_box;
using shapes::add_rectangle;

namespace {
/// 4 m of saloon along +x: body, cabin behind the middle, four wheels, rear lights; no normals, no uvs.
Mesh saloon() {
  Mesh m;
  add_box(m, "body", {-2, 0.3f, -0.85f}, {2, 0.9f, 0.85f});
  add_box(m, "cabin", {-1.4f, 0.95f, -0.75f}, {0.6f, 1.45f, 0.75f});
  for (float x : {-1.3f, 1.3f}) {
    for (float z : {-0.75f, 0.75f}) add_box(m, "Wheel", {x - 0.3f, 0, z - 0.1f}, {x + 0.3f, 0.6f, z + 0.1f});
  }
  return m;
}
/// Positions turned by x -> (rows times p), times scale, plus offset.
void place(Mesh& m, vec3<float> x, vec3<float> y, vec3<float> z, float scale, vec3<float> offset) {
  for (auto& p : m.positions) p = vec3<float>(dot(x, p), dot(y, p), dot(z, p)) * scale + offset;
}
/// The part's box, after everything.
Box box_of(const Mesh& m, const std::string& name) {
  Box box;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    if (m.parts[m.part[t]].name != name) continue;
    for (int v : m.triangles[t]) box.add(m.positions[v]);
  }
  return box;
}
}  // namespace

TEST_CASE("Mesh: triangles that are none are dropped and told", "[scene][value]") {
  Mesh m;
  add_rectangle(m, "wall", {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  const auto also = [&](int a, int b, int c) { m.triangles.push_back({a, b, c}), m.part.push_back(0); };
  const int nan = m.add({std::nanf(""), 0, 0}), line = m.add({2, 0, 0});
  also(0, 1, nan);
  also(0, 1, line);
  also(0, 1, 99);
  also(2, 0, 1);  // the first one again, begun at another corner
  MeshReport report;
  drop_bad_triangles(m, report);
  CHECK(m.triangles.size() == 2);
  CHECK(m.part.size() == 2);
  CHECK(report.says("1 triangles with indices out of range"));
  CHECK(report.says("1 triangles with positions that are not numbers"));
  CHECK(report.says("1 triangles without area"));
  CHECK(report.says("1 triangles that lie on another"));
}

TEST_CASE("Mesh: a ground plane goes, the underside of the vehicle stays", "[scene][value]") {
  for (float size : {1.1f, 10.0f}) {
    Mesh m = saloon();
    const std::size_t before = m.triangles.size();
    const float x = 2.2f * size, z = size;
    add_rectangle(m, "Ground", {-x, -0.01f, z}, {x, -0.01f, z}, {x, -0.01f, -z}, {-x, -0.01f, -z});
    MeshReport report;
    drop_ground(m, report);
    CHECK(m.triangles.size() == before);
    CHECK(report.says("2 triangles of a ground plane dropped (Ground/Ground)"));
  }
  Mesh m = saloon();
  const std::size_t before = m.triangles.size();
  add_rectangle(m, "floor pan", {-1.9f, 0.2f, 0.8f}, {1.9f, 0.2f, 0.8f}, {1.9f, 0.2f, -0.8f}, {-1.9f, 0.2f, -0.8f});
  MeshReport report;
  drop_ground(m, report);
  CHECK(m.triangles.size() == before + 2);
  CHECK(report.lines.empty());
}

TEST_CASE("Mesh: normals made for a sphere are its own, for a box its faces'", "[scene][agreement]") {
  Mesh ball = shapes::sphere({1, 2, 3}, 2, 32);
  for (auto& n : ball.normals) n = {};
  for (std::size_t t = 0; t < ball.triangles.size(); t += 3) std::swap(ball.triangles[t][0], ball.triangles[t][1]);
  MeshReport report;
  fill_normals(ball, report);
  for (std::size_t v = 0; v < ball.normals.size(); ++v) {
    const vec3<float> d = normalize(ball.positions[v] - vec3<float>(1, 2, 3));
    CHECK(std::abs(dot(ball.normals[v], d)) > 0.998f);  // within 3.6 degrees; which side is out is not known
  }
  CHECK(report.says("corners without a normal"));

  Mesh box;
  add_box(box, "box", {0, 0, 0}, {1, 2, 3});
  fill_normals(box, report);
  for (std::size_t t = 0; t < box.triangles.size(); ++t) {
    const vec3<float> face = normalize(box.cross_of(int(t)));
    for (int v : box.triangles[t]) CHECK(dot(box.normals[v], face) == Approx(1));
  }
}

TEST_CASE("Mesh: every corner's normal ends up on the side of its face", "[scene][value]") {
  Mesh m = shapes::sphere({0, 0, 0}, 1, 16);
  std::swap(m.triangles[5][0], m.triangles[5][1]);   // one triangle wound against its normals
  m.normals[100] = -m.normals[100];                  // one normal flipped
  m.normals[130] = vec3<float>(std::nanf(""));       // one that is none
  MeshReport report;
  fill_normals(m, report);
  CHECK(report.says("1 triangles wound against their normals"));
  CHECK(report.says("corner normals that pointed through the back"));
  CHECK(report.says("corners without a normal"));
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    for (int v : m.triangles[t]) {
      CHECK(dot(m.normals[v], m.cross_of(int(t))) > 0);
      CHECK(dot(m.normals[v], normalize(m.positions[v])) > 0.99f);
    }
  }
}

TEST_CASE("Mesh: normals that fit nothing are not believed", "[scene][value]") {
  Mesh m = shapes::sphere({0, 0, 0}, 1, 16);
  for (std::size_t v = 0; v < m.normals.size(); ++v)
    m.normals[v] = v % 2 ? vec3<float>(1, 0, 0) : vec3<float>(0, 0, -1);
  MeshReport report;
  fill_normals(m, report);
  CHECK(report.says("1 parts with normals that do not fit"));
  for (std::size_t v = 0; v < m.normals.size(); ++v) CHECK(dot(m.normals[v], normalize(m.positions[v])) > 0.98f);
}

TEST_CASE("Mesh: made uvs measure metres and keep the hand", "[scene][agreement]") {
  Mesh m;
  add_box(m, "box", {0, 0, 0}, {1, 2, 3});
  MeshReport report;
  fill_normals(m, report);
  fill_uvs(m, report);
  CHECK(report.says("12 triangles without usable uvs"));
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const auto [a, b, c] = m.triangles[t];
    const vec2<float> e = m.uvs[b] - m.uvs[a], f = m.uvs[c] - m.uvs[a];
    const vec3<float> n = m.cross_of(int(t));
    CHECK(e.x * f.y - e.y * f.x == Approx(length(n)));  // area in uv = area in space, and not mirrored
  }
  Mesh ball = shapes::sphere({0, 0, 0}, 1, 8);
  const auto before = ball.uvs.size();
  MeshReport none;
  fill_uvs(ball, none);
  CHECK(none.lines.empty());
  CHECK(ball.uvs.size() == before);
}

TEST_CASE("Mesh: materials without a name get one by their place", "[scene][value]") {
  Mesh m;
  for (int i : {7, 7, 12}) m.parts.push_back({.name = "p", .material = "", .material_index = i});
  m.parts.push_back({.name = "q", .material = "chrome", .material_index = 3});
  MeshReport report;
  name_materials(m, report);
  CHECK(m.parts[1].material == "material_07");
  CHECK(m.parts[2].material == "material_12");
  CHECK(m.parts[3].material == "chrome");
  CHECK(report.says("2 materials without a name"));
}

TEST_CASE("Vehicle: the same frame, however it stood in its file", "[scene][agreement]") {
  Mesh reference = saloon();
  clean_vehicle(reference);
  const Box all = bounds(reference);
  CHECK(all.low.y == Approx(0).margin(1e-6));
  CHECK(all.center().x == Approx(0).margin(1e-6));
  CHECK(all.size().x == Approx(4));
  const Box cabin = box_of(reference, "cabin");
  CHECK(cabin.center().x == Approx(-0.4).margin(1e-4));  // the front, at +x, has the longer bonnet
  const vec3<float> x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const float c = std::cos(0.6f), s = std::sin(0.6f);
  struct Pose {
    vec3<float> x, y, z;
    float scale;
  };
  for (const Pose& p : {Pose{-x, y, -z, 1}, Pose{z, y, -x, 100}, Pose{x, -z, y, 1000}, Pose{y, x, -z, 0.01f},
                        Pose{-x, -y, z, 1}, Pose{{c, 0, s}, y, {-s, 0, c}, 1}}) {
    Mesh m = saloon();
    place(m, p.x, p.y, p.z, p.scale, {5, -7, 11});
    VehicleOptions options;
    if (p.scale < 1) options.length = 4;
    const MeshReport report = clean_vehicle(m, options);
    INFO(report.lines[0]);
    const Box found = bounds(m), b = box_of(m, "cabin");
    CHECK(found.size().x == Approx(4).epsilon(1e-4));
    CHECK(found.size().y == Approx(1.45).epsilon(1e-4));
    CHECK(found.low.y == Approx(0).margin(1e-4));
    CHECK(b.center().x == Approx(-0.4).margin(1e-3));
    CHECK(b.low.y == Approx(0.95).margin(1e-3));
  }
}

TEST_CASE("Vehicle: the names of parts outdo the profile, and what is told outdoes both", "[scene][value]") {
  const auto named = [] {
    Mesh m = saloon();
    add_box(m, "Head-Light", {-2.02f, 0.6f, -0.8f}, {-2, 0.7f, 0.8f});
    return m;
  };
  Mesh m = named();
  MeshReport report = clean_vehicle(m);
  CHECK(box_of(m, "Head-Light").center().x > 1.9f);
  CHECK(report.says("by the names of parts"));
  m = named();
  VehicleOptions options;
  options.front = "+x";
  report = clean_vehicle(m, options);
  CHECK(box_of(m, "Head-Light").center().x < -1.9f);
  CHECK(report.says("front is its +x as told"));
}
