// tests/nodes/blend.cpp -- blend nodes: known values, slopes, all players
// SPDX-License-Identifier: Apache-2.0
#include <burnish/nodes/blend.h>
#include <nodes/patterns.h>

using namespace differences;

namespace {
constexpr auto blends = [](const auto& node, const auto& c) { return node(c.a, c.b); };
/// Off the edges of all modes: fg = bg, bg = 0.5, fg = 0, fg = 1.
constexpr auto off_edges = [](const auto&, const auto& c) {
  const auto off = [](double fg, double bg) {
    return std::fabs(fg - bg) > 0.03 && std::fabs(bg - 0.5) > 0.03 && fg > 0.1 && fg < 0.9;
  };
  return off(c.a.x, c.b.x) && off(c.a.y, c.b.y) && off(c.a.z, c.b.z);
};
}  // namespace

TEST_CASE("blend nodes: have the compositing formulas' values", "[nodes][value]") {
  const double fg = 0.25, bg = 0.75;
  const auto check = [&](auto node, double blended) {
    CHECK(node(fg, bg) == Approx(blended));
    node.mix = 0.25;
    CHECK(node(fg, bg) == Approx(0.25 * blended + 0.75 * bg));
    node.mix = 0;
    CHECK(node(vec3<double>(fg), vec3<double>(bg)).y == bg);
  };
  check(Mix<double>{}, 0.25);
  check(Plus<double>{}, 1.0);
  check(Minus<double>{}, 0.5);
  check(Difference<double>{}, 0.5);
  check(Multiply<double>{}, 0.1875);
  check(Max<double>{}, 0.75);
  check(Min<double>{}, 0.25);
  check(Screen<double>{}, 1 - 0.75 * 0.25);
  check(Overlay<double>{}, 1 - 2 * 0.75 * 0.25);
  check(Burn<double>{}, 1 - 0.25 / 0.25);
  check(Dodge<double>{}, 0.75 / 0.75);
  CHECK(Overlay<double>{}(0.75, 0.25) == Approx(2 * 0.75 * 0.25));
  CHECK(Overlay<double>{}(0.75, 0.45) == Approx(2 * 0.75 * 0.45));
  CHECK(Overlay<double>{}(0.75, 0.55) == Approx(1 - 2 * 0.25 * 0.45));
  CHECK(Overlay<double>{}(0.3, 0.5) == Approx(0.3));
  CHECK(Difference<double>{}(0.75, 0.25) == Approx(0.5));
  CHECK(Burn<double>{}(0, 0.5) == 0);
  CHECK(Dodge<double>{}(1, 0.5) == 0);
}
TEST_CASE("blend nodes: one value and right slopes in every number", "[nodes][gradient]") {
  const auto right = [](const char* name, auto node) {
    using Point = std::tuple<decltype(node), Colors<double>>;
    Hard<Point> hard{"black, white, fg = bg, the middle, no mix", {}};
    const vec3<double> some[] = {vec3<double>(0.0), vec3<double>(1.0), vec3<double>(0.5), {0, 0.5, 1}, {1e-8, 1, 0}};
    for (const auto& a : some)
      for (const auto& b : some)
        for (const double mix : {0.0, 1.0}) hard.points.push_back(Point{{mix}, {a, b}});
    holds(name, blends, within(off_edges, node, Colors<double>()), {.rounding = 1e-4}, hard);
  };
  right("Mix", Mix<double>()), right("Plus", Plus<double>()), right("Minus", Minus<double>());
  right("Difference", Difference<double>()), right("Multiply", Multiply<double>()), right("Max", Max<double>());
  right("Min", Min<double>()), right("Screen", Screen<double>()), right("Overlay", Overlay<double>());
  right("Burn", Burn<double>()), right("Dodge", Dodge<double>());
}
TEST_CASE("blend nodes: recorded by the compiler, recorded at run time and taped they are the same",
          "[nodes][agreement]") {
  constexpr auto look = [](const auto& node, const auto& c) { return mixture(node(c.a, c.b)); };
  players_agree<Colors>(look, Overlay<float>{0.6f});
  players_agree<Colors>(look, Difference<float>{0.6f});
  players_agree<Colors>(look, Max<float>{0.6f});
}
