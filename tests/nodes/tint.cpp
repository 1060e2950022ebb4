// tests/nodes/tint.cpp -- tint nodes: known values, slopes, all players
// SPDX-License-Identifier: Apache-2.0
#include <burnish/nodes/tint.h>
#include <nodes/patterns.h>

using namespace differences;

namespace {
constexpr auto tints = [](const auto& node, const auto& c) { return node(c.a); };
/// Off the edges of hue: no two channels alike, no channel at a sixth of the turned hue.
bool hue_is_plain(const vec3<double>& c, double turn) {
  if (std::min({std::fabs(c.x - c.y), std::fabs(c.y - c.z), std::fabs(c.z - c.x), c.x, c.y, c.z}) < 0.05) return false;
  const double h = 6 * (rgbtohsv(c).x + turn);
  return std::fabs(h - std::round(h)) > 0.1;
}
}  // namespace

TEST_CASE("tint nodes: their defaults change nothing", "[nodes][value]") {
  const vec3<double> c{0.2, 0.7, 0.4};
  CHECK(length(HsvAdjust<double>{}(c)-c) < 1e-15);
  CHECK(length(Contrast<double>{}(c)-c) < 1e-15);
  CHECK(length(Saturate<double>{}(c)-c) < 1e-15);
  CHECK(length(Remap<double>{}(c)-c) < 1e-15);
  CHECK(length(RangeNode<double>{}(c)-c) < 1e-15);
  CHECK(length(ColorCorrect<double>{}(c)-c) < 1e-15);
}
TEST_CASE("tint nodes: have MaterialX's values", "[nodes][value]") {
  const vec3<double> c{0.2, 0.7, 0.4};
  CHECK(Contrast<double>{2, 0.25}(0.5) == Approx(0.75));
  CHECK(Luminance<double>{}(c) == Approx(0.2 * 0.2722287 + 0.7 * 0.6740818 + 0.4 * 0.0536895).epsilon(1e-6));
  CHECK(Saturate<double>{0}(c).x == Approx(Luminance<double>{}(c)));
  CHECK(Remap<double>{0.25, 0.75, 1, 2}(0.5) == Approx(1.5));
  CHECK(RangeNode<double>{0, 1, 2, 0, 3}(0.25) == Approx(1.5));    // 3 sqrt(0.25)
  CHECK(RangeNode<double>{0, 1, 2, 0, 1}(-0.25) == Approx(-0.5));  // the sign is kept
  CHECK(RangeNode<double>{0, 1, 2, 0, 1}.clamped(-0.25) == 0);
  CHECK(RangeNode<double>{0, 1, 2, 0, 1}.clamped(1.5) == 1);
  CHECK(length(HsvAdjust<double>{{1 / 3.0, 1, 1}}(vec3<double>{1, 0, 0}) - vec3<double>{0, 1, 0}) < 1e-12);
  CHECK(length(HsvAdjust<double>{{0, 0, 0.5}}(c)-vec3<double>(0.35)) < 1e-12);
  // By hand, hue 0: gamma 2, lift 0.1, gain 0.5, contrast 2 about 0.25, exposure 1.
  const auto corrected = ColorCorrect<double>{0, 1, 2, 0.1, 0.5, 2, 0.25, 1}(vec3<double>{0.25, 0.16, 0.81});
  const auto by_hand = [](double x) { return (((x * 0.9 + 0.1) * 0.5 - 0.25) * 2 + 0.25) * 2; };
  CHECK(length(corrected - vec3<double>{by_hand(0.5), by_hand(0.4), by_hand(0.9)}) < 1e-12);
}
TEST_CASE("range: at black its slope is finite, and 1 where nothing is bent", "[nodes][limit]") {
  const auto slope = [](double gamma) {
    return std::get<1>(differentiate(
        [=](auto x) {
          return RangeNode<decltype(x)>{0.0f, 1.0f, float(gamma), 0.0f, 1.0f}(x);
        },
        0.0));
  };
  CHECK(slope(1) == Approx(1));
  CHECK(slope(2) == Approx(1000).epsilon(1e-3));  // the chord to 1e-6
}
TEST_CASE("tint nodes: one value and right slopes in every number", "[nodes][gradient]") {
  const auto right = [](const char* name, auto f, auto away, auto node, const How& how) {
    using Point = std::tuple<decltype(node), Colors<double>>;
    Hard<Point> greys{"black, grey, white, saturated, ties of two channels", {}};
    for (const vec3<double>& c : {vec3<double>(0.0), vec3<double>(0.5), vec3<double>(1.0), vec3<double>{1, 0, 0},
                                  vec3<double>{0, 1, 1}, vec3<double>{0.3, 0.3, 0.9}, vec3<double>{1e-8, 0, 1}})
      greys.points.push_back(Point{node, {c, c}});
    holds(name, f, within(away, node, Colors<double>()), how, greys);
  };
  const auto at_hue = [](const auto& node, const auto& c) { return hue_is_plain(c.a, node.amount.x); };
  right("HsvAdjust", tints, at_hue, HsvAdjust<double>(), {.rounding = 1e-4, .step = 2e-3});
  right("Contrast", tints, anywhere, Contrast<double>(), {});
  right("Luminance", tints, anywhere, Luminance<double>(), {});
  right("Saturate", tints, anywhere, Saturate<double>(), {});
  right("Remap", tints, anywhere, Remap<double>(), {.rounding = 1e-4});
  const auto off_inlow = [](const auto& node, const auto& c) {
    return std::min({std::fabs(c.a.x - node.inlow), std::fabs(c.a.y - node.inlow), std::fabs(c.a.z - node.inlow)}) >
           0.05;
  };
  right("RangeNode", tints, off_inlow, RangeNode<double>(), {.rounding = 1e-3, .step = 2e-3});
  right(
      "RangeNode", [](const auto& node, const auto& c) { return node.clamped(c.a); },
      [&](const auto& node, const auto& c) {
        const auto y = node(c.a);
        const auto off = [&](double v) {
          return std::fabs(v - node.outlow) > 0.05 && std::fabs(v - node.outhigh) > 0.05;
        };
        return off_inlow(node, c) && node.outlow < node.outhigh && off(y.x) && off(y.y) && off(y.z);
      },
      RangeNode<double>(), {.rounding = 1e-3, .step = 1e-3});
  right("ColorCorrect", tints,
        [](const auto& node, const auto& c) {
          if (!hue_is_plain(c.a, node.hue)) return false;
          const auto s = Saturate<double>{node.saturation}(hsvadjust(c.a, vec3<double>{node.hue, 1, 1}));
          return std::min({std::fabs(s.x), std::fabs(s.y), std::fabs(s.z)}) > 0.05;
        },
        ColorCorrect<double>(), {.rounding = 1e-3, .step = 1e-3});
}
TEST_CASE("tint nodes: recorded by the compiler, recorded at run time and taped they are the same",
          "[nodes][agreement]") {
  constexpr auto look = [](const auto& node, const auto& c) { return mixture(node(c.a)); };
  players_agree<Colors>(look, HsvAdjust<float>{{0.21f, 1.3f, 0.8f}});
  players_agree<Colors>(look, ColorCorrect<float>{0.1f, 1.2f, 1.4f, 0.05f, 0.9f, 1.1f, 0.4f, 0.3f}, 300, 1e-4);
}
