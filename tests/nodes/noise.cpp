// tests/nodes/noise.cpp -- the noise nodes: values, slopes by their parameters, all players
// SPDX-License-Identifier: Apache-2.0
#include <burnish/nodes/noise.h>
#include <nodes/patterns.h>

using namespace differences;

namespace {
constexpr auto off_lattice = [](double x) { return std::fabs(x - std::round(x)) > 0.02; };
constexpr auto off_lines = [](const auto&, const auto& s) {
  return off_lattice(s.uv.x) && off_lattice(s.uv.y) && off_lattice(s.position.x) && off_lattice(s.position.y) &&
         off_lattice(s.position.z);
};
/// Off the lattice lines of every octave, where third derivatives jump, and off whole octaves, the edges.
constexpr auto off_all_lines = [](const auto& node, const auto& s) {
  auto spot = s;
  for (int i = 0; i < 8; ++i, spot.uv = spot.uv * node.lacunarity, spot.position = spot.position * node.lacunarity)
    if (i < node.octaves && !off_lines(0, spot)) return false;
  return std::fabs(node.octaves - std::round(node.octaves)) > 0.05 && node.octaves < 5;
};
}  // namespace

TEST_CASE("noise nodes: amplitude and pivot scale and shift MaterialX's noise", "[nodes][value]") {
  // Noise values as in tests/math/noise.cpp, from MaterialX's own text.
  const vec2<double> uv{7.640625, 26.859375};
  CHECK(Noise2d<double>{}(uv) == Approx(-0.0577962080477).epsilon(0).margin(2e-8));
  CHECK(Noise2d<double>{0.5, 0.25}(uv) == Approx(0.25 - 0.5 * 0.0577962080477));
  CHECK(Noise3d<double>{2, -1}(vec3<double>{4.375, 22.53125, -11.171875}) == Approx(-1 - 2 * 0.74782787344));
  CHECK(Fractal2d<double>{}(vec2<double>{2.6875, -3.703125}) == Approx(0.377643066315));
  CHECK(Fractal3d<double>{3}(vec3<double>{2.6875, -3.703125, -2.53125}) == Approx(3 * 0.514037381794));
}
TEST_CASE("noise nodes: one value and right slopes in every number", "[nodes][gradient]") {
  const auto over_uv = [](const auto& node, const auto& s) {
    const auto h = node.height(s.uv);
    return node(s.uv) + 0.3f * h.slope.x - 0.4f * h.slope.y;
  };
  const auto in_space = [](const auto& node, const auto& s) {
    const auto h = node.height(s.position);
    return node(s.position) + 0.3f * h.slope.x - 0.4f * h.slope.y + 0.2f * h.slope.z;
  };
  const auto right = [](const char* name, auto f, auto away, auto node, const How& how) {
    using Point = std::tuple<decltype(node), Spot<double>>;
    Hard<Point> lattice{"lattice corners and lines", {}};
    for (const vec3<double>& p : {vec3<double>(), vec3<double>{1, -1, 2}, vec3<double>{0.5, -2, 0}})
      lattice.points.push_back(Point{node, {vec2<double>(p), p}});
    holds(name, f, within(away, node, Spot<double>()), how, lattice);
  };
  right("Noise2d", over_uv, off_lines, Noise2d<double>(), {.rounding = 1e-4});
  right("Noise3d", in_space, off_lines, Noise3d<double>(), {.rounding = 1e-4});
  right("Fractal2d", over_uv, off_all_lines, Fractal2d<double>(), {.rounding = 1e-3, .step = 1e-4});
  right("Fractal3d", in_space, off_all_lines, Fractal3d<double>(), {.rounding = 1e-3, .step = 1e-4});
}
TEST_CASE("noise nodes: recorded by the compiler, recorded at run time and taped they are the same",
          "[nodes][agreement]") {
  players_agree<Spot>([](const auto& node, const auto& s) { return node(s.uv) * node.height(s.uv).slope.x; },
                      Noise2d<float>{0.7f, 0.2f});
  players_agree<Spot>([](const auto& node, const auto& s) { return node(s.uv) * node.height(s.uv).slope.x; },
                      Fractal2d<float>{0.7f, 3.4f, 2.1f, 0.6f}, 300, 1e-4);
  players_agree<Spot>(
      [](const auto& node, const auto& s) { return node(s.position) * node.height(s.position).slope.z; },
      Fractal3d<float>{0.7f, 2.4f, 2.1f, 0.6f}, 300, 1e-4);
}
