// tests/twin/library.cpp -- which vehicles are the same, which are of use, and what stays of a library that is changed
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include <random>
#include "record.h"
#include <burnish/twin/library.h>
#include <burnish/twin/preview.h>
#include <burnish/twin/usable.h>

using namespace burnish;

namespace {
/// A box as part `part`, which is made if it is new.
void add_box(Mesh& m, int part, const vec3<float>& low, const vec3<float>& high) {
  while (int(m.parts.size()) <= part) {
    Part p;
    p.material_index = int(m.parts.size());
    m.parts.push_back(p);
  }
  const int base = int(m.positions.size());
  for (int k = 0; k < 8; ++k)
    m.add({k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z}, {0, 1, 0}, {0, 0});
  for (const auto& [a, b, c, d] :
       {std::array{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}})
    for (const std::array<int, 3>& t : {std::array{base + a, base + b, base + c}, {base + a, base + c, base + d}})
      m.triangles.push_back(t), m.part.push_back(part);
}
/// 4.4 m long; parts for body, windows and tyres.
Mesh car(int body = 0, int windows = 1, int tyres = 2) {
  Mesh m;
  add_box(m, body, {-2.2f, 0.3f, -0.85f}, {2.2f, 0.9f, 0.85f});
  add_box(m, windows, {-1.3f, 0.9f, -0.75f}, {0.9f, 1.35f, 0.75f});
  add_box(m, body, {-1.3f, 1.35f, -0.75f}, {0.9f, 1.45f, 0.75f});
  for (const float x : {-1.4f, 1.4f})
    for (const float z : {-0.8f, 0.6f}) add_box(m, tyres, {x - 0.3f, 0, z}, {x + 0.3f, 0.6f, z + 0.2f});
  return m;
}
std::string verdict(const Mesh& m) {
  const std::string odd = odd_proportions(m);
  return odd.empty() ? inseparable(m, SeenParts(Raycaster(m))) : odd;
}
bool has(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

LibraryEntry entry(const std::string& path, LibraryStatus status, std::vector<float> shape = {}) {
  LibraryEntry e;
  e.path = path, e.status = status, e.shape = std::move(shape);
  return e;
}
}  // namespace

TEST_CASE("Fingerprint: a box's moments are those of the closed form", "[twin][value]") {
  const double a = 4, b = 1.5, c = 1.8, area = 2 * (a * b + b * c + c * a);
  Mesh m;
  add_box(m, 0, {-2, 0, -0.9f}, {2, 1.5f, 0.9f});
  const std::vector<float> f = fingerprint(m);
  REQUIRE(f.size() == 16);
  record::Worst worst;
  const std::array<double, 3> size{a, b, c};
  for (std::size_t k = 0; k < 3; ++k) {
    const double s = size[k], t = size[(k + 1) % 3], u = size[(k + 2) % 3];
    const double ends = 2 * t * u / area;  // the share of the two faces across the axis
    const auto mean = [&](int order) {
      return std::pow(s / 2, order) * (ends + (1 - ends) / (order + 1));
    };
    const double pair = (2 * t * u * s * s / 4 * t * t / 12 + 2 * s * u * t * t / 4 * s * s / 12 +
                         2 * s * t * s * s / 12 * t * t / 12) / area;
    worst(std::abs(f[4 + k] - std::pow(mean(2), 1.0 / 2) / a));
    worst(std::abs(f[7 + k] - std::pow(mean(4), 1.0 / 4) / a));
    worst(std::abs(f[10 + k] - std::pow(mean(6), 1.0 / 6) / a));
    worst(std::abs(f[13 + k] - std::pow(pair, 1.0 / 4) / a));
  }
  worst(std::abs(f[0] - c / a)), worst(std::abs(f[1] - b / a)), worst(std::abs(f[2] - std::sqrt(area) / a));
  record::claim("fingerprint", "value", "moments of a box's surface, closed form", 2e-6, worst.value, 15);
}

TEST_CASE("Fingerprint: order, scale and finer triangles do not change it, another shape does", "[twin][symmetry]") {
  const Mesh m = car();
  const std::vector<float> print = fingerprint(m);
  std::mt19937 random(1);
  Mesh other;
  other.parts = m.parts;
  std::vector<std::size_t> order(m.triangles.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), random);
  for (const std::size_t t : order) {  // larger, turned about, each triangle cut in two; no vertex is shared
    std::array<vec3<float>, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      const vec3<float> v = m.positions[std::size_t(m.triangles[t][(k + t) % 3])];
      p[k] = {-1.37f * v.x, 1.37f * v.y, -1.37f * v.z};
    }
    const vec3<float> middle = (p[1] + p[2]) * 0.5f;
    for (const auto& [a, b, c] : {std::array{p[0], p[1], middle}, {p[0], middle, p[2]}}) {
      const int first = other.add(a);
      other.add(b), other.add(c);
      other.triangles.push_back({first, first + 1, first + 2}), other.part.push_back(m.part[t]);
    }
  }
  CHECK(same_shape(print, fingerprint(other)));
  Mesh lower = car();
  for (auto& p : lower.positions)
    if (p.y > 1.4f) p.y -= 0.02f;
  CHECK_FALSE(same_shape(print, fingerprint(lower)));
  CHECK_FALSE(same_shape({}, {}));
  CHECK(fingerprint(Mesh()).empty());
}

TEST_CASE("Usable vehicle: its parts can be told apart; a refusal names what cannot", "[twin][value]") {
  CHECK(verdict(car()) == "");
  CHECK(has(verdict(car(0, 0, 0)), "one material on the whole of it"));
  CHECK(has(verdict(car(0, 0, 1)), "windows and body are one part"));
  CHECK(has(verdict(car(0, 1, 0)), "wheels and body are one part"));
  // Wheels that are missing are no reason, nor is one material where the file has parts of their own.
  Mesh without;
  add_box(without, 0, {-2.2f, 0.3f, -0.85f}, {2.2f, 0.9f, 0.85f});
  add_box(without, 1, {-1.3f, 0.9f, -0.75f}, {0.9f, 1.45f, 0.75f});
  CHECK(verdict(without) == "");
  Mesh parts = car();
  for (Part& p : parts.parts) p.material_index = 0;
  CHECK(verdict(parts) == "");
}

TEST_CASE("Usable vehicle: what has not a vehicle's proportions or name is refused", "[twin][limit]") {
  const auto box = [](float l, float h, float w) {
    Mesh m;
    add_box(m, 0, {0, 0, 0}, {l, h, w});
    return odd_proportions(m);
  };
  CHECK(box(4.5f, 1.5f, 1.8f) == "");
  CHECK(box(2.5f, 1.55f, 1.56f) == "");   // a car for two
  CHECK(box(16.5f, 4, 2.5f) == "");       // a truck with its trailer
  CHECK(box(12, 4.4f, 2.5f) == "");       // a bus of two decks
  CHECK(has(box(0.7f, 0.7f, 0.3f), "as long as high"));  // a wheel
  CHECK(has(box(2, 1, 2), "as long as wide"));
  CHECK(has(box(2, 0.1f, 1), "its height is 0.05 of its length"));
  CHECK(has(box(60, 4, 3), "20 times as long as wide"));
  CHECK(has(box(2, 1.2f, 0.4f), "as high as wide"));
  CHECK(has(box(4, 0, 2), "flat"));
  Mesh motorcycle;
  add_box(motorcycle, 0, {-1, 0.5f, -0.4f}, {1, 1.1f, 0.4f});
  for (const float x : {-0.8f, 0.5f}) add_box(motorcycle, 1, {x, 0, -0.06f}, {x + 0.3f, 0.6f, 0.06f});
  CHECK(has(odd_proportions(motorcycle), "middle line"));
  for (const char* whole : {"suv", "Wheel loader", "light_truck", "topaz", "Car 2"}) CHECK(odd_name(whole) == "");
  for (const char* piece : {"suv_tire", "frontWheel_2 wheel", "Bike", "car top 1"})
    CHECK(has(odd_name(piece), "by its name"));
}

TEST_CASE("Library: of entries of one shape the first is kept, and rows stay with their entries", "[twin][value]") {
  std::vector<float> shape(16, 0.5f), near_by = shape, other = shape;
  near_by[5] += 0.5f * same_shape_within, other[5] += 2 * same_shape_within;
  Library a;
  a.descriptor = "d", a.rules = {{"*", true}};
  a.entries = {entry("b", LibraryStatus::indexed, near_by), entry("c", LibraryStatus::refused, shape),
               entry("d", LibraryStatus::indexed, other)};
  a.spaces["views"] = {2, {0, 0, 2}, {1, 2, 3}, {4, 5, 6}, {10, 11, 12, 13, 14, 15}};
  a.spaces["else"] = {1, {2}, {}, {}, {7}};
  a.thumbnail_of = {0, 2};
  a.thumbnails.assign(2 * 120 * 80 * 3, 1);
  std::fill_n(a.thumbnails.begin() + 120 * 80 * 3, 120 * 80 * 3, std::uint8_t(2));
  Library b;
  b.entries = {entry("a", LibraryStatus::indexed, shape)};
  b.spaces["views"] = {2, {0}, {9}, {9}, {20, 21}};
  const auto all = [](const LibraryEntry&) { return false; };
  Library both = merged({&a, &b}, all);
  REQUIRE(both.entries.size() == 4);
  CHECK(both.spaces["views"].entry == std::vector{0, 1, 1, 3});
  CHECK(both.spaces["views"].values == std::vector<float>{20, 21, 10, 11, 12, 13, 14, 15});
  CHECK(both.spaces["views"].azimuth == std::vector<float>{9, 1, 2, 3});
  CHECK(first_rows(both, both.spaces["views"]) == std::vector{0, 1, 3, 3, 4});
  mark_duplicates(both);
  CHECK(both.entries[0].status == LibraryStatus::indexed);
  CHECK(both.entries[1].status == LibraryStatus::duplicate);
  CHECK(both.entries[1].reason == "same as a");
  CHECK(both.entries[2].status == LibraryStatus::refused);
  CHECK(both.entries[3].status == LibraryStatus::indexed);
  const Library left = merged({&both}, [](const LibraryEntry& e) { return e.path == "a"; });
  CHECK(left.entries.size() == 3);
  CHECK(left.spaces.at("views").values == std::vector<float>{14, 15});
  CHECK(left.spaces.at("else").entry == std::vector{2});
  CHECK(left.spaces.at("else").values == std::vector<float>{7});
  CHECK(left.thumbnail_of == std::vector{2});
  CHECK(left.thumbnails == std::vector<std::uint8_t>(120 * 80 * 3, 2));
  CHECK(left.descriptor == "d");
  CHECK(left.find("d") == 2);
  CHECK(left.find("e") == -1);
  // An entry that is told to be accepted is no duplicate.
  both.entries[1].status = LibraryStatus::indexed, both.entries[1].by_hand = true;
  mark_duplicates(both);
  CHECK(both.entries[1].status == LibraryStatus::indexed);
}

TEST_CASE("Preview: the vehicle fills the picture in its own colours on white, and throws a shadow", "[twin][value]") {
  Mesh m = car();
  m.parts[0].base_color = {0.6f, 0.05f, 0.05f}, m.parts[1].opacity = 0.2f;
  const Raycaster scene(m);
  const Pose<float> pose = framed(bounds(m), 0.6f, 0.25f, 96, 64);
  const Image image = preview(scene, pose.camera(), 24);
  const Mask covered = scene.trace(pose.camera(), 1).frame("coverage");
  int left = 96, right = 0;
  float darkest = 1;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x) {
      if (covered.at(x, y) > 0) left = std::min(left, x), right = std::max(right, x);
      else if (y > 40) darkest = std::min(darkest, image.at(x, y).y);
    }
  CHECK(left >= 3);
  CHECK(left + (95 - right) < 20);
  CHECK(image.at(1, 1).x > 0.99f);
  CHECK(darkest < 0.7f);
  const vec3<float> door = pose.project(vec3<float>(0, 0.6f, 0.85f)),
                    pane = pose.project(vec3<float>(0, 1.15f, 0.75f));
  const vec3<float> red = image.at(int(door.x), int(door.y)), dark = image.at(int(pane.x), int(pane.y));
  CHECK(red.x > 3 * red.y);
  CHECK(dark.x < 0.5f * red.x);
}
