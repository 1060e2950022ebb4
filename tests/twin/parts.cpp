// tests/twin/parts.cpp -- a car of boxes, panes and cylinders, of which every part is known
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include <burnish/io/parts.h>
#include <burnish/twin/part_labels.h>
#include <burnish/twin/split_parts.h>
#include "record.h"
#include "scene/shapes.h"

using namespace burnish;

namespace {
/// One more part, of the material of its name unless told otherwise.
int begin_part(Mesh& m, const char* material, vec3<float> color, float opacity = 1) {
  Part p;
  p.name = p.material = material, p.base_color = color, p.opacity = opacity;
  p.material_index = int(m.parts.size());
  for (const Part& q : m.parts)
    if (q.material == p.material) p.material_index = q.material_index;
  m.parts.push_back(p);
  return int(m.parts.size()) - 1;
}
void quad(Mesh& m, vec3<float> a, vec3<float> b, vec3<float> c, vec3<float> d) {
  const int first = m.add(a);
  m.add(b), m.add(c), m.add(d);
  m.triangles.push_back({first, first + 1, first + 2}), m.triangles.push_back({first, first + 2, first + 3});
  m.part.insert(m.part.end(), 2, int(m.parts.size()) - 1);
}
void box(Mesh& m, vec3<float> l, vec3<float> h) {
  quad(m, {l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, h.y, h.z}, {l.x, h.y, h.z});
  quad(m, {h.x, l.y, l.z}, {l.x, l.y, l.z}, {l.x, h.y, l.z}, {h.x, h.y, l.z});
  quad(m, {h.x, l.y, h.z}, {h.x, l.y, l.z}, {h.x, h.y, l.z}, {h.x, h.y, h.z});
  quad(m, {l.x, l.y, l.z}, {l.x, l.y, h.z}, {l.x, h.y, h.z}, {l.x, h.y, l.z});
  quad(m, {l.x, h.y, h.z}, {h.x, h.y, h.z}, {h.x, h.y, l.z}, {l.x, h.y, l.z});
  quad(m, {l.x, l.y, l.z}, {h.x, l.y, l.z}, {h.x, l.y, h.z}, {l.x, l.y, h.z});
}
/// A ring of a wheel between two radii, `half` thick each way, turned by `steer` about the vertical.
void ring(Mesh& m, vec3<float> center, float inner, float outer, float half, float steer = 0) {
  constexpr int n = 24;
  const auto at = [&](float r, int k, float z) {
    const float a = 2 * shapes::pi * float(k) / n, x = r * std::cos(a);
    return vec3<float>(center.x + x * std::cos(steer) + z * std::sin(steer), center.y + r * std::sin(a),
                       center.z - x * std::sin(steer) + z * std::cos(steer));
  };
  for (int k = 0; k < n; ++k) {
    quad(m, at(outer, k, -half), at(outer, k + 1, -half), at(outer, k + 1, half), at(outer, k, half));
    for (const float z : {-half, half})
      quad(m, at(inner, k, z), at(outer, k, z), at(outer, k + 1, z), at(inner, k + 1, z));
  }
}
void finish(Mesh& m) {
  MeshReport report;
  fill_normals(m, report), fill_uvs(m, report);
}

struct Car {
  Mesh mesh;
  std::vector<PartKind> kinds;
};
/// 4.4 m long, nose ahead. Names tell nothing.
Car some_car(float steer = 0, bool wheels = true) {
  using enum PartKind;
  Car car;
  Mesh& m = car.mesh;
  const auto part = [&](const char* name, vec3<float> color, PartKind kind, float opacity = 1) {
    begin_part(m, name, color, opacity), car.kinds.push_back(kind);
  };
  part("a", {0.5f, 0.05f, 0.04f}, body);
  box(m, {-2.2f, 0.35f, -0.62f}, {2.2f, 0.9f, 0.62f});
  for (const float z : {-0.76f, 0.76f}) box(m, {-0.95f, 0.3f, z - 0.14f}, {0.95f, 0.9f, z + 0.14f});
  quad(m, {-1.1f, 1.45f, 0.62f}, {0.5f, 1.45f, 0.62f}, {0.5f, 1.45f, -0.62f}, {-1.1f, 1.45f, -0.62f});
  // A cabin: four pillars of the body, panes between.
  for (const float z : {-0.66f, 0.66f}) {
    quad(m, {-1.6f, 0.9f, z}, {-1.45f, 0.9f, z}, {-1.0f, 1.45f, z * 0.94f}, {-1.1f, 1.45f, z * 0.94f});
    quad(m, {1.15f, 0.9f, z}, {1.3f, 0.9f, z}, {0.5f, 1.45f, z * 0.94f}, {0.4f, 1.45f, z * 0.94f});
  }
  part("b", {0.02f, 0.02f, 0.02f}, window);
  quad(m, {1.3f, 0.9f, -0.62f}, {1.3f, 0.9f, 0.62f}, {0.5f, 1.45f, 0.58f}, {0.5f, 1.45f, -0.58f});
  quad(m, {-1.6f, 0.9f, 0.62f}, {-1.6f, 0.9f, -0.62f}, {-1.1f, 1.45f, -0.58f}, {-1.1f, 1.45f, 0.58f});
  for (const float z : {-0.66f, 0.66f}) {
    part("c", {0.3f, 0.35f, 0.35f}, window, 0.4f);
    quad(m, {-1.45f, 0.9f, z}, {1.15f, 0.9f, z}, {0.4f, 1.45f, z * 0.94f}, {-1.0f, 1.45f, z * 0.94f});
  }
  part("d", {0.8f, 0.8f, 0.7f}, light);
  for (const float z : {-0.45f, 0.45f}) box(m, {2.15f, 0.62f, z - 0.15f}, {2.24f, 0.78f, z + 0.15f});
  part("e", {0.1f, 0.1f, 0.1f}, other);
  box(m, {-0.8f, 0.7f, -0.4f}, {0.5f, 1.1f, 0.4f});  // seats, behind the panes
  part("f", {0.7f, 0.1f, 0.1f}, other);
  box(m, {1.4f, 0.5f, -0.3f}, {1.9f, 0.8f, 0.3f});  // an engine that nobody sees
  for (const float x : {-1.35f, 1.4f})
    for (const float z : {-0.78f, 0.78f}) {
      if (!wheels) continue;
      const float turn = x > 0 ? steer : 0;
      part("g", {0.04f, 0.04f, 0.04f}, tyre);
      ring(m, {x, 0.33f, z}, 0.22f, 0.33f, 0.1f, turn);
      part("h", {0.5f, 0.5f, 0.5f}, rim);
      ring(m, {x, 0.33f, z}, 0, 0.22f, 0.08f, turn);
    }
  finish(m);
  return car;
}
bool says(const AssignedParts& parts, const std::string& words) {
  return std::any_of(parts.notes.begin(), parts.notes.end(),
                     [&](const std::string& n) { return n.find(words) != std::string::npos; });
}
std::string error_of(const auto& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return "none";
}
}  // namespace

TEST_CASE("assign_parts: shapes alone tell body, windows, wheels and lights", "[twin][value]") {
  const Car car = some_car();
  AssignOptions options;
  options.names = false;
  const AssignedParts parts = assign_parts(Raycaster(car.mesh), options);
  int wrong = 0;
  for (std::size_t p = 0; p < car.kinds.size(); ++p) {
    INFO(p << ": " << parts.parts[p].reason << ", " << name_of(parts.parts[p].kind));
    CHECK(name_of(parts.parts[p].kind) == name_of(car.kinds[p]));
    wrong += parts.parts[p].kind != car.kinds[p];
  }
  CHECK(parts.body_material == 0);
  record::claim("assign_parts: kinds, names hidden", "law", "a car made of known parts", 0, wrong,
                long(car.kinds.size()));
}

TEST_CASE("find_wheels: finds centres and radii, also of wheels that are steered", "[twin][value]") {
  record::Worst worst;
  for (const float steer : {0.0f, 0.35f, -0.35f}) {
    const std::vector<Wheel> wheels = find_wheels(some_car(steer).mesh);
    REQUIRE(wheels.size() == 4);
    for (const Wheel& w : wheels) {
      CHECK(!w.spare);
      worst(std::abs(double(w.radius) - 0.33));
      worst(std::abs(double(std::abs(w.center.z)) - 0.78));
      worst(std::min(std::abs(double(w.center.x) + 1.35), std::abs(double(w.center.x) - 1.4)));
      CHECK(w.radius_at({w.center.x, w.center.y + 0.3f, w.center.z}) == Approx(0.3 / 0.33).epsilon(1e-3));
      CHECK(w.radius_at({w.center.x, w.center.y, w.center.z + 1}) > 1000);
    }
  }
  record::claim("find_wheels: centre, radius", "value", "how the car was made, metres", 2e-3, worst.value, 36);
  CHECK(find_wheels(some_car(0, false).mesh).empty());
}
TEST_CASE("find_wheels: what is round but stands alone, or high, is no wheel", "[twin][limit]") {
  Car car = some_car(0, false);
  begin_part(car.mesh, "g", {0.1f, 0.1f, 0.1f});
  ring(car.mesh, {-1.35f, 0.33f, -0.78f}, 0, 0.33f, 0.1f);
  begin_part(car.mesh, "g", {0.1f, 0.1f, 0.1f});
  for (const float z : {-0.7f, 0.7f}) ring(car.mesh, {1.2f, 0.9f, z}, 0, 0.25f, 0.05f);
  CHECK(find_wheels(car.mesh).empty());
}

TEST_CASE("assign_parts: left and right are of one kind", "[twin][symmetry]") {
  Car car = some_car();
  const std::size_t left = 2, right = 3;  // the side panes
  car.mesh.parts[left].name = "pane", car.mesh.parts[right].name = "brake caliper";
  const AssignedParts parts = assign_parts(Raycaster(car.mesh));
  CHECK(parts.parts[left].kind == parts.parts[right].kind);
  CHECK(parts.parts[left].kind == PartKind::window);
}

TEST_CASE("assign_parts: names help where shapes do not, and a wheel's name does not make one", "[twin][value]") {
  Car car = some_car();
  begin_part(car.mesh, "tire_rubber", {0.02f, 0.02f, 0.02f});
  box(car.mesh, {-2.3f, 0.4f, -0.6f}, {-2.2f, 0.5f, 0.6f});  // a bumper strip that is called so
  begin_part(car.mesh, "chrome", {0.6f, 0.6f, 0.6f});
  box(car.mesh, {-1, 0.7f, 0.895f}, {1, 0.8f, 0.93f});
  finish(car.mesh);
  const AssignedParts parts = assign_parts(Raycaster(car.mesh));
  CHECK(!is_wheel(parts.parts[car.kinds.size()].kind));
  CHECK(parts.parts[car.kinds.size() + 1].kind == PartKind::other);
  CHECK(parts.parts[car.kinds.size() + 1].reason.find("chrome") != std::string::npos);
}

TEST_CASE("assign_parts: refuses to guess where one material is all", "[twin][limit]") {
  Car car = some_car();
  for (int& p : car.mesh.part) p = 0;
  car.mesh.parts.resize(1);
  const AssignedParts parts = assign_parts(Raycaster(car.mesh));
  CHECK(parts.parts[0].kind == PartKind::body);
  CHECK(says(parts, "windows: no part stands apart; not separable"));
  CHECK(says(parts, "wheels"));
  CHECK(says(assign_parts(Raycaster(some_car(0, false).mesh)), "wheels: nothing round stands on the ground"));
  CHECK(assign_parts(Raycaster(some_car().mesh)).notes.empty());
}

TEST_CASE("split_wheels: wheels in one part with the body become a part", "[twin][value]") {
  Car car = some_car();
  for (std::size_t t = 0; t < car.mesh.part.size(); ++t)
    if (is_wheel(car.kinds[std::size_t(car.mesh.part[t])])) car.mesh.part[t] = 0;
  CHECK(says(assign_parts(Raycaster(car.mesh)), "not separable: material a"));
  MeshReport report;
  const std::size_t parts = car.mesh.parts.size();
  CHECK(split_wheels(car.mesh, report) == 1);
  CHECK(report.says("lies inside wheels"));
  REQUIRE(car.mesh.parts.size() == parts + 1);
  const Mesh whole = some_car().mesh;
  int wrong = 0;
  for (std::size_t t = 0; t < whole.part.size(); ++t)
    wrong += is_wheel(car.kinds[std::size_t(whole.part[t])]) != (car.mesh.part[t] == int(parts));
  CHECK(wrong == 0);
  CHECK(assign_parts(Raycaster(car.mesh)).parts.back().kind == PartKind::wheel);
  CHECK(split_wheels(car.mesh, report) == 0);
}

TEST_CASE("vote_parts: a part is of the kind whose masks cover more than half of it", "[twin][value]") {
  const Car car = some_car();
  const Raycaster scene(car.mesh);
  const std::vector<GBuffer> views = part_views(scene);
  std::vector<std::vector<int>> labels(views.size());
  // The first part's pixels: seven tenths labelled window; the second's: four tenths labelled light.
  int count[2] = {0, 0}, covered[2] = {0, 0};
  for (std::size_t v = 0; v < views.size(); ++v) {
    labels[v].assign(std::size_t(views[v].width) * std::size_t(views[v].height), 0);
    for (int i = 0; i < views[v].size(); ++i) {
      const int p = views[v].part[std::size_t(i)];
      if (p > 1) continue;
      const bool in = count[p]++ % 10 < (p == 0 ? 7 : 4);
      covered[p] += in;
      if (in)
        labels[v][std::size_t(views[v].pixel[std::size_t(i)])] =
            part_label(p == 0 ? PartKind::window : PartKind::light);
    }
  }
  const std::vector<PartVote> votes = vote_parts(views, labels);
  for (const int p : {0, 1}) {
    CHECK(votes[std::size_t(p)].pixels == count[p]);
    CHECK(votes[std::size_t(p)].iou == Approx(double(covered[p]) / count[p]));
  }
  CHECK(!vote_witness(votes[0]).says.empty());
  CHECK(vote_witness(votes[1]).says.empty());
  AssignOptions options;
  options.labels = labels;
  const AssignedParts parts = assign_parts(scene, options);
  CHECK(parts.parts[0].kind == PartKind::window);  // masks outweigh the shape
  CHECK(parts.parts[1].kind == PartKind::window);
  labels[0].pop_back();
  CHECK(error_of([&] { vote_parts(views, labels); }).find("label image of view 0") == 0);
  labels[0].push_back(99);
  CHECK(error_of([&] {
          vote_parts(views, {{}, {}, std::vector<int>(labels[0].size(), 9)});
        }).find("value 9, expected 0 to 7") != std::string::npos);
}

TEST_CASE("parts_text: what is written is read back, and wrong lines are named", "[twin][agreement]") {
  const Car car = some_car();
  const Raycaster scene(car.mesh);
  AssignedParts parts = assign_parts(scene);
  parts.parts[2].kind = PartKind::other;  // one of the side panes, against its material
  parts.parts[1].kind = PartKind::light;
  AssignOptions options;
  options.given = parse_parts(parts_text(scene.mesh(), parts), "parts.txt");
  const AssignedParts again = assign_parts(scene, options);
  for (std::size_t p = 0; p < parts.parts.size(); ++p) CHECK(again.parts[p].kind == parts.parts[p].kind);

  CHECK(error_of([] { parse_parts("# x\na\twindo\n", "p.txt"); }) ==
        "p.txt:2: kind \"windo\", expected body, window, wheel, tyre, rim, light or other");
  CHECK(error_of([] { parse_parts("a body\n", "p.txt"); }) ==
        "p.txt:1: \"a body\", expected a material, a tab and its kind");
  CHECK(error_of([] { parse_parts("a\tbody\n\nb\trim\na\tlight\t1\twhy\n", "p.txt"); }) ==
        "p.txt:4: a is light here and body above");
  options.given = parse_parts("wood\tbody\n", "p.txt");
  CHECK(error_of([&] {
          assign_parts(scene, options);
        }).find("p.txt:1: wood: the vehicle has no such material; it has a, b") == 0);
  options.given = {parse_kind("b=other"), parse_kind("c[3]=light")};
  const AssignedParts told = assign_parts(scene, options);
  CHECK(told.parts[1].kind == PartKind::other);
  CHECK(told.parts[2].kind == PartKind::window);
  CHECK(told.parts[3].kind == PartKind::light);
  CHECK(error_of([] { parse_kind("glass"); }).find("--role glass: expected material=kind") == 0);
}

TEST_CASE("part_labels: a dark band in the paint's texture is other", "[twin][value]") {
  Mesh m;
  begin_part(m, "paint", {1, 1, 1});
  Image texture(10, 10, {0.1f, 0.2f, 0.6f});
  for (int x = 0; x < 30; ++x) texture.set(x % 10, x / 10, {0.005f, 0.005f, 0.005f});  // v above 0.7: a dark band
  m.images.push_back(texture);
  m.parts[0].texture = 0;
  quad(m, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
  for (std::size_t v = 0; v < 4; ++v)
    m.uvs[v] = {v == 1 || v == 2 ? 1.0f : 0.0f, v > 1 ? 1.0f : 0.0f}, m.normals[v] = {0, 0, 1};
  const Raycaster scene(m);
  const GBuffer g = scene.trace(Camera::look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 20, 100, 100), 1);
  AssignedParts parts;
  parts.parts = {{PartKind::body, 0.9f, 1, ""}};
  const std::vector<int> labels = part_labels(g, scene.mesh(), parts);
  int bad = 0, dark = 0;
  for (int i = 0; i < g.size(); ++i) {
    const float v = g.at(i).uv.y;
    if (std::abs(v - 0.7f) < 0.07f || v < 0.05f || v > 0.95f) continue;  // bilinear in between, and repeated
    bad += labels[std::size_t(i)] != (v > 0.7f ? 4 : 1), dark += v > 0.7f;
  }
  CHECK(bad == 0);
  CHECK(dark > 100);
  parts.parts[0].confidence = 1;  // given: no second thoughts
  const std::vector<int> given = part_labels(g, scene.mesh(), parts);
  CHECK(std::count(given.begin(), given.end(), 1) == g.size());
}
