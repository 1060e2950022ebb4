// tests/nodes/place.cpp -- uv placement: known values, slopes through it, all players
// SPDX-License-Identifier: Apache-2.0
#include <burnish/nodes/noise.h>
#include <burnish/nodes/place.h>
#include <nodes/patterns.h>

using namespace differences;

TEST_CASE("place2d: scale enlarges, rotate turns, offset moves, in MaterialX's two orders", "[nodes][value]") {
  const vec2<double> uv{0.7, 0.4};
  const auto is = [](const vec2<double>& a, const vec2<double>& b) { CHECK(length(a - b) < 1e-7); };
  is(Place2d<double>{}(uv), uv);
  is(Place2d<double>{}.trs(uv), uv);
  is(Place2d<double>{{0, 0}, {2, 4}}(uv), {0.35, 0.1});
  is(Place2d<double>{{0.5, 0.5}, {2, 4}}(uv), {0.6, 0.475});
  is(Place2d<double>{{0, 0}, {1, 1}, 90}(uv), {0.4, -0.7});
  is(Place2d<double>{{0, 0}, {1, 1}, 0, {0.1, 0.2}}(uv), {0.6, 0.2});
  is(Place2d<double>{{0, 0}, {2, 4}, 90, {0.1, 0.2}}(uv), {0.0, -0.55});      // (0.35, 0.1) -> (0.1, -0.35) -> offset
  is(Place2d<double>{{0, 0}, {2, 4}, 90, {0.1, 0.2}}.trs(uv), {0.1, -0.15});  // (0.6, 0.2) -> (0.2, -0.6) -> scale
}
TEST_CASE("place2d: one value and right slopes in every number", "[nodes][gradient]") {
  const auto large = [](const auto& place, const auto&) { return std::min(place.scale.x, place.scale.y) > 0.2; };
  holds("Place2d",
        [](const auto& place, const auto& s) {
          const auto h = noise2d(s.uv);
          return std::array{mixture(place(s.uv)), mixture(place.trs(s.uv)), mixture(place.by_texcoord(h)),
                            mixture(place.by_texcoord_trs(h))};
        },
        within(
            [=](const auto& place, const auto& s) {
              const auto off = [](double x) {
                return std::fabs(x - std::round(x)) > 0.03;
              };  // the noise's lattice lines
              return large(place, s) && off(s.uv.x) && off(s.uv.y);
            },
            Place2d<double>(), Spot<double>()),
        {.rounding = 1e-4}, {"no turn, whole turns, wrapped uv", {{{}, {}}, {{{}, {1, 1}, 360, {}}, {{7, -3}, {}}}}});
}
TEST_CASE("place2d: turns the slopes of what it placed into slopes by texcoord", "[nodes][gradient]") {
  std::mt19937_64 random(8);
  for (int i = 0; i < 1000; ++i) {
    Place2d<double> place;
    Spot<double> s;
    move(random, place, s);
    const auto [n, du, dv] = differentiate(
        [&](auto u, auto v) {
          return noise2d(lift<decltype(u)>(place)(vec2{u, v})).value;
        },
        s.uv.x, s.uv.y);
    const auto h = place.by_texcoord(noise2d(place(s.uv)));
    CHECK(h.value == Approx(n));
    CHECK(h.slope.x == Approx(du).margin(1e-10));
    CHECK(h.slope.y == Approx(dv).margin(1e-10));
    const auto [m, eu, ev] = differentiate(
        [&](auto u, auto v) {
          return noise2d(lift<decltype(u)>(place).trs(vec2{u, v})).value;
        },
        s.uv.x, s.uv.y);
    const auto g = place.by_texcoord_trs(noise2d(place.trs(s.uv)));
    CHECK(g.value == Approx(m));
    CHECK(g.slope.x == Approx(eu).margin(1e-10));
    CHECK(g.slope.y == Approx(ev).margin(1e-10));
  }
}
TEST_CASE("place2d: recorded by the compiler, recorded at run time and taped it is the same", "[nodes][agreement]") {
  players_agree<Spot>(
      [](const auto& place, const auto& s) {
        const auto h = place.by_texcoord(noise2d(place(s.uv)));
        return h.value + 0.2f * h.slope.x * h.slope.y;
      },
      Place2d<float>{{0.3f, 0.2f}, {0.7f, 1.6f}, 25.0f, {0.1f, -0.3f}}, 300, 2e-4);
}
