// tests/twin/edit.cpp -- joints are found where they are, and an edit moves what it names and nothing else
// SPDX-License-Identifier: Apache-2.0
#include <burnish/io/joints.h>
#include <burnish/twin/edit.h>
#include <burnish_test.h>
#include <io/files.h>
#include <scene/shapes.h>

using namespace burnish;

namespace {
/// A saloon of boxes with two panes a side, a windscreen and a rear pane that lean, on four round wheels.
struct Saloon {
  Mesh mesh;
  std::vector<PartKind> kinds;

  void add(const char* name, PartKind kind, const vec3<float>& low, const vec3<float>& high) {
    shapes::add_box(mesh, name, low, high);
    kinds.push_back(kind);
  }
  /// Four corners.
  void pane(const vec3<float>& a, const vec3<float>& b, const vec3<float>& c, const vec3<float>& d) {
    const vec3<float> n = normalize(cross(b - a, c - a));
    const int v = mesh.add(a, n, {0, 0});
    mesh.add(b, n, {1, 0}), mesh.add(c, n, {1, 1}), mesh.add(d, n, {0, 1});
    mesh.triangles.push_back({v, v + 1, v + 2}), mesh.triangles.push_back({v, v + 2, v + 3});
    mesh.parts.push_back({.name = "pane", .material = "glass"}), kinds.push_back(PartKind::window);
    mesh.part.insert(mesh.part.end(), 2, int(mesh.parts.size()) - 1);
  }
  Saloon() {
    add("body", PartKind::body, {-2.2f, 0.25f, -0.85f}, {2.2f, 0.9f, 0.85f});
    add("roof", PartKind::body, {-1.0f, 1.38f, -0.75f}, {0.4f, 1.45f, 0.75f});
    for (const float s : {-1.0f, 1.0f}) {
      pane({0.05f, 0.92f, 0.83f * s}, {0.85f, 0.92f, 0.83f * s}, {0.4f, 1.38f, 0.75f * s}, {0.05f, 1.38f, 0.75f * s});
      pane({-1.1f, 0.92f, 0.83f * s}, {-0.1f, 0.92f, 0.83f * s}, {-0.1f, 1.38f, 0.75f * s}, {-0.9f, 1.38f, 0.75f * s});
    }
    pane({0.95f, 0.92f, -0.7f}, {0.95f, 0.92f, 0.7f}, {0.4f, 1.4f, 0.65f}, {0.4f, 1.4f, -0.65f});
    pane({-1.4f, 0.92f, -0.7f}, {-1.4f, 0.92f, 0.7f}, {-1.0f, 1.4f, 0.65f}, {-1.0f, 1.4f, -0.65f});
    for (const float x : {-1.35f, 1.35f})
      for (const float z : {-0.75f, 0.75f}) {
        const Mesh ball = shapes::sphere({x, 0.32f, z}, 0.32f, 16);
        const int first = int(mesh.positions.size());
        for (const vec3<float>& p : ball.positions)  // flattened: a wheel
          mesh.add({p.x, p.y, z + 0.3f * (p.z - z)}, normalize(p - vec3<float>(x, 0.32f, z)), {0, 0});
        for (const auto& t : ball.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
        mesh.part.insert(mesh.part.end(), ball.triangles.size(), int(mesh.parts.size()));
        mesh.parts.push_back({.name = "wheel", .material = "rubber"}), kinds.push_back(PartKind::wheel);
      }
  }
};
const Joint& joint(const std::vector<Joint>& all, const std::string& name) {
  for (const Joint& j : all)
    if (j.name == name) return j;
  FAIL("no " << name);
  return all.front();
}
Box box_of_part(const Mesh& m, const std::string& name) {
  Box b;
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    if (m.parts[std::size_t(m.part[t])].name == name)
      for (const int v : m.triangles[t]) b.add(m.positions[std::size_t(v)]);
  return b;
}
}  // namespace

TEST_CASE("find_joints: wheels at their hubs, doors between pillar and arches, lid and bonnet at the panes' feet",
          "[twin][value]") {
  const Saloon s;
  std::vector<std::string> notes;
  const std::vector<Joint> j = find_joints(s.mesh, s.kinds, &notes);
  CHECK(notes.empty());
  CHECK(j.size() == 10);
  CHECK(length(joint(j, "front_right_wheel").pivot - vec3<float>(1.35f, 0.32f, 0.75f)) < 1e-3f);
  CHECK(joint(j, "front_right_wheel").steered);
  CHECK_FALSE(joint(j, "rear_left_wheel").steered);
  const Joint& door = joint(j, "front_left_door");
  CHECK(door.sure);
  CHECK(contains(door.region, {0.5f, 0.6f, -0.84f}));
  CHECK(contains(door.region, {0.3f, 1.2f, -0.78f}));
  CHECK_FALSE(contains(door.region, {0.5f, 0.6f, 0.84f}));
  CHECK_FALSE(contains(door.region, {-0.3f, 0.6f, -0.84f}));
  CHECK_FALSE(contains(door.region, {0.3f, 1.42f, -0.75f}));
  CHECK(contains(joint(j, "rear_left_door").region, {-0.3f, 0.6f, -0.84f}));
  CHECK(joint(j, "bonnet").pivot.x == Approx(0.98f));
  CHECK(joint(j, "boot").pivot.x == Approx(-1.43f));
}
TEST_CASE("find_joints: what is not there is said", "[twin][value]") {
  Mesh m;
  shapes::add_box(m, "body", {-2, 0, -0.8f}, {2, 1.4f, 0.8f});
  std::vector<std::string> notes;
  CHECK(find_joints(m, {PartKind::body}, &notes).empty());
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("no wheels") == 0);
}
TEST_CASE("edited: a door that opens goes outwards as a rigid body, and the rest stays", "[twin][value]") {
  const Saloon s;
  const std::vector<Joint> joints = find_joints(s.mesh, s.kinds);
  Edit e;
  e.open["front_right_door"] = 60;
  const EditedVehicle v = edited(s.mesh, s.kinds, joints, e);
  CHECK(v.missing.empty());
  const Box before = bounds(s.mesh), after = bounds(v.mesh);
  CHECK(after.low.z == Approx(before.low.z));
  CHECK(after.high.z > before.high.z + 0.5f);
  CHECK(after.low.y == Approx(before.low.y));
  CHECK(after.high.x == Approx(before.high.x));
  // What is new of the right pane has the old one's area.
  const auto area_of = [](const Mesh& m, const std::vector<PartKind>& kinds, float from) {
    double sum = 0;
    for (std::size_t t = 0; t < m.triangles.size(); ++t) {
      const vec3<float> p = m.positions[std::size_t(m.triangles[t][0])];
      if (kinds[std::size_t(m.part[t])] == PartKind::window && p.z > from) sum += double(length(m.cross_of(int(t))));
    }
    return sum;
  };
  CHECK(area_of(v.mesh, v.kinds, 0.72f) == Approx(area_of(s.mesh, s.kinds, 0.72f)).epsilon(1e-4));
  CHECK_NOTHROW(require_usable(v.mesh));
  e.open["front_right_door"] = 500;  // it stops at its limit
  const EditedVehicle wide = edited(s.mesh, s.kinds, joints, e);
  e.open["front_right_door"] = joint(joints, "front_right_door").high;
  CHECK(bounds(wide.mesh).high.z == bounds(edited(s.mesh, s.kinds, joints, e).mesh).high.z);
}
TEST_CASE("edited: the bonnet and the boot go up", "[twin][value]") {
  const Saloon s;
  const std::vector<Joint> joints = find_joints(s.mesh, s.kinds);
  for (const char* name : {"bonnet", "boot"}) {
    Edit e;
    e.open[name] = 50;
    const Box b = bounds(edited(s.mesh, s.kinds, joints, e).mesh);
    CHECK(b.high.y > bounds(s.mesh).high.y + 0.03f);
    CHECK(b.high.z == Approx(bounds(s.mesh).high.z));
  }
}
TEST_CASE("edited: wheels roll and steer about their hubs", "[twin][value]") {
  const Saloon s;
  const std::vector<Joint> joints = find_joints(s.mesh, s.kinds);
  Edit round;
  round.spin = 360;
  const EditedVehicle same = edited(s.mesh, s.kinds, joints, round);
  for (std::size_t t = 0; t < s.mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      CHECK(length(same.mesh.positions[std::size_t(same.mesh.triangles[t][k])] -
                   s.mesh.positions[std::size_t(s.mesh.triangles[t][k])]) < 1e-5f);
  Edit left;
  left.steer = 30;
  const EditedVehicle v = edited(s.mesh, s.kinds, joints, left);
  int moved = 0;
  for (std::size_t t = 0; t < s.mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const vec3<float> p = s.mesh.positions[std::size_t(s.mesh.triangles[t][k])],
                        q = v.mesh.positions[std::size_t(v.mesh.triangles[t][k])];
      if (length(p - q) < 1e-4f) continue;
      ++moved;
      CHECK(s.kinds[std::size_t(s.mesh.part[t])] == PartKind::wheel);
      CHECK(p.x > 0);
      if (p.x > 1.5f && std::abs(p.z - (p.z > 0 ? 0.75f : -0.75f)) < 0.03f) CHECK(q.z < p.z);  // the front goes left
    }
  CHECK(moved > 100);
}
TEST_CASE("edited: hidden parts are gone; turned over it lies on the ground", "[twin][value]") {
  const Saloon s;
  Edit e;
  e.hidden = {"window", "roof", "mast"};
  const EditedVehicle v = edited(s.mesh, s.kinds, find_joints(s.mesh, s.kinds), e);
  CHECK(v.missing == std::vector<std::string>{"mast"});
  for (std::size_t t = 0; t < v.mesh.triangles.size(); ++t)
    CHECK(v.kinds[std::size_t(v.mesh.part[t])] != PartKind::window);
  CHECK(bounds(v.mesh).high.y == Approx(0.9f));
  Edit over;
  over.over = 180;
  const EditedVehicle roof = edited(s.mesh, s.kinds, {}, over);
  CHECK(bounds(roof.mesh).low.y == Approx(0).margin(1e-5));
  CHECK(box_of_part(roof.mesh, "roof").center().y < 0.1f);
  CHECK(bounds(roof.mesh).size().y == Approx(bounds(s.mesh).size().y));
}
TEST_CASE("read_joints: what was written comes back; what is wrong is named", "[io][value]") {
  const files::Folder folder;
  const Saloon s;
  const std::vector<Joint> j = find_joints(s.mesh, s.kinds);
  write_joints(folder / "joints.json", j);
  const std::vector<Joint> back = read_joints(folder / "joints.json");
  REQUIRE(back.size() == j.size());
  for (std::size_t k = 0; k < j.size(); ++k) {
    CHECK(back[k].name == j[k].name);
    CHECK(back[k].region.size() == j[k].region.size());
    CHECK(length(back[k].pivot - j[k].pivot) < 1e-5f);
    CHECK(length(back[k].axis - j[k].axis) < 1e-5f);
    CHECK(back[k].well == Approx(j[k].well));
    CHECK(back[k].region.back().offset == Approx(j[k].region.back().offset).margin(1e-5));
  }
  write_text(folder / "bad.json", R"({"joints": [{"name": "x", "kind": "flap"}]})");
  CHECK_THROWS_WITH(read_joints(folder / "bad.json"), Catch::Contains("joint 1") && Catch::Contains("flap"));
  write_text(folder / "none.json", "{}");
  CHECK_THROWS_WITH(read_joints(folder / "none.json"), Catch::Contains("no list \"joints\""));
}
