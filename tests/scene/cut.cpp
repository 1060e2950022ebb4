// tests/scene/cut.cpp -- a mesh that is cut stays the same surface, inside and outside apart
// SPDX-License-Identifier: Apache-2.0
#include <burnish/scene/cut.h>
#include <burnish_test.h>
#include <scene/shapes.h>

using namespace burnish;

namespace {
double area(const Mesh& m, const std::vector<char>& chosen, bool in) {
  double sum = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    if (bool(chosen[t]) == in) sum += 0.5 * double(length(m.cross_of(int(t))));
  return sum;
}
}  // namespace

TEST_CASE("cut: a ball by three planes keeps its area, and every triangle lies on one side", "[scene][value]") {
  const Mesh ball = shapes::sphere({0.1f, 0.2f, -0.3f}, 1, 24);
  const ConvexRegion region{{{1, 0, 0}, 0.4f}, {normalize(vec3<float>(0, 1, 1)), 0.3f}, {{0, -1, 0}, 0.5f}};
  const CutMesh c = cut(ball, region, [](int) { return true; });
  std::vector<char> all(ball.triangles.size(), 1);
  CHECK(area(c.mesh, c.inside, true) + area(c.mesh, c.inside, false) == Approx(area(ball, all, true)).epsilon(1e-5));
  CHECK(area(c.mesh, c.inside, true) > 1);
  for (std::size_t t = 0; t < c.mesh.triangles.size(); ++t) {
    vec3<float> middle;
    for (const int v : c.mesh.triangles[t]) {
      const vec3<float> p = c.mesh.positions[std::size_t(v)];
      middle += p / 3.0f;
      if (!c.inside[t]) continue;
      for (const HalfSpace& h : region) CHECK(h.outside(p) < 1e-5f);
    }
    if (length(c.mesh.cross_of(int(t))) > 1e-5f) CHECK(contains(region, middle) == bool(c.inside[t]));
  }
  // The seam is closed: an even number of its edges meets in every place.
  std::map<std::array<int, 3>, int> ends;
  const auto place = [&](int v) {
    const vec3<float> p = c.mesh.positions[std::size_t(v)] * 1e4f;
    return std::array{int(std::lround(p.x)), int(std::lround(p.y)), int(std::lround(p.z))};
  };
  for (const auto& [a, b] : c.seam) {
    ++ends[place(a)], ++ends[place(b)];
    float on = 1;
    for (const HalfSpace& h : region)
      on = std::min(on, std::max(std::abs(h.outside(c.mesh.positions[std::size_t(a)])),
                                 std::abs(h.outside(c.mesh.positions[std::size_t(b)]))));
    CHECK(on < 1e-5f);
  }
  CHECK(c.seam.size() > 20);
  int open = 0;
  for (const auto& [v, n] : ends) open += n % 2;
  CHECK(open == 0);
  for (const vec3<float>& n : c.mesh.normals) CHECK(length(n) == Approx(1).epsilon(1e-4));
}
TEST_CASE("cut: parts that are not to be cut stay whole", "[scene][value]") {
  Mesh two = shapes::sphere({0, 0, 0}, 1, 8);
  const std::size_t first = two.triangles.size();
  shapes::add_box(two, "box", {-1, -1, -1}, {1, 1, 1});
  const CutMesh c = cut(two, {{{1, 0, 0}, 0}}, [](int part) { return part == 0; });
  std::size_t boxes = 0;
  for (std::size_t t = 0; t < c.mesh.triangles.size(); ++t) {
    if (c.mesh.part[t] == 0) continue;
    ++boxes;
    CHECK_FALSE(c.inside[t]);
  }
  CHECK(boxes == two.triangles.size() - first);
}
