// tests/nodes/normal.cpp -- normals: from heights against differences, coded ones, blends
// SPDX-License-Identifier: Apache-2.0
#include <burnish/nodes/noise.h>
#include <burnish/nodes/normal.h>
#include <burnish/nodes/place.h>
#include <nodes/patterns.h>

using namespace differences;

namespace {
template <class T> struct Normals {
  vec3<T> a, b;
  static constexpr auto parameters() {
    return std::tuple{Param{"a", &Normals::a, Range{0.05f, 0.95f}}, Param{"b", &Normals::b, Range{0.05f, 0.95f}}};
  }
};
/// Tilted upwards and unit.
constexpr auto upwards = [](const auto& coded) {
  using T = std::remove_cvref_t<decltype(coded.x)>;
  return normalize(vec3<T>{coded.x * 2.0f - 1.0f, coded.y * 2.0f - 1.0f, coded.z + 0.2f});
};
}  // namespace

TEST_CASE("heighttonormal: a plane tilts the normal by its slope, flat is up", "[nodes][value]") {
  const auto ramp = [](const vec2<double>& uv) { return Height<double>{0.75 * uv.x, {0.75, 0}}; };
  const auto n = HeightToNormal<double>{}(ramp, vec2<double>{0.3, 0.4});
  CHECK(length(n - vec3<double>{-0.6, 0, 0.8}) < 1e-15);
  CHECK(length(HeightToNormal<double>{0}(ramp, vec2<double>{0.3, 0.4}) - vec3<double>{0, 0, 1}) == 0);
  CHECK(HeightToNormal<double>{2}(Height<double>{0, {0, 1}}).y == Approx(-2 / std::sqrt(5.0)));
}
TEST_CASE("heighttonormal: agrees with the cross product of differenced tangents", "[nodes][value]") {
  std::mt19937_64 random(12);
  const Fractal2d<double> bumps{0.2, 3.5};
  for (int i = 0; i < 300; ++i) {
    Spot<double> s;
    move(random, s);
    constexpr double step = 1e-5;
    const auto h = [&](double du, double dv) { return bumps(vec2<double>{s.uv.x + du, s.uv.y + dv}); };
    const vec3<double> along_u{2 * step, 0, h(step, 0) - h(-step, 0)}, along_v{0, 2 * step, h(0, step) - h(0, -step)};
    const auto n = HeightToNormal<double>{}([&](const vec2<double>& uv) { return bumps.height(uv); }, s.uv);
    CHECK(length(n - normalize(cross(along_u, along_v))) < 1e-7);
    CHECK(length(n) == Approx(1));
  }
}
TEST_CASE("bent_normal: agrees with heighttonormal over a plane, and with differences over a sphere",
          "[nodes][value]") {
  const Height<double> flat{0.3, {0.4, -0.7}};
  const Height3<double> solid{0.3, {0.4, -0.7, 5.0}};  // the slope along the normal does not count
  CHECK(length(bent_normal(vec3<double>{0, 0, 1}, solid, 0.5) - HeightToNormal<double>{0.5}(flat)) < 1e-15);
  // A sphere of radius 1 moved out by a thousandth of noise: the normal of that surface, by differences along it.
  std::mt19937_64 random(13);
  constexpr double scale = 1e-3, step = 1e-5;
  for (int i = 0; i < 200; ++i) {
    vec3<double> p;
    move(random, p);
    p = normalize(p);
    const auto f = frame_of(p);
    const auto moved = [&](const vec3<double>& q) {
      return normalize(q) * (1 + scale * noise3d(normalize(q) * 3.0).value);
    };
    const auto t = moved(p + f.t * step) - moved(p - f.t * step), b = moved(p + f.b * step) - moved(p - f.b * step);
    auto h = noise3d(p * 3.0);
    h.slope = h.slope * 3.0;
    CHECK(length(bent_normal(p, h, scale) - normalize(cross(t, b))) < 3e-5);  // the moved sphere's curvature: scale^2
  }
}
TEST_CASE("normalmap: decodes, scales the tilt, survives empty texels", "[nodes][value]") {
  CHECK(length(NormalMap<double>{}(vec3<double>{0.5, 0.5, 1}) - vec3<double>{0, 0, 1}) < 1e-15);
  CHECK(length(NormalMap<double>{}(vec3<double>{0.8, 0.5, 0.9}) - vec3<double>{0.6, 0, 0.8}) < 1e-7);
  CHECK(length(NormalMap<double>{2}(vec3<double>{0.8, 0.5, 0.9}) - normalize(vec3<double>{1.2, 0, 0.8})) < 1e-7);
  for (const double grey : {0.0, 0.5}) {
    const auto [y, d] = differentiate(
        [](const auto& c) { return mixture(NormalMap<std::remove_cvref_t<decltype(c.x)>>{}(c)); }, vec3<double>(grey));
    CHECK(y == Approx(0.875));
    CHECK(std::isfinite(d.x + d.y + d.z));
  }
  const auto f = frame_of(normalize(vec3<double>{1, 2, 3}));
  CHECK(length(NormalMap<double>{}(vec3<double>{0.5, 0.5, 1}, f) - f.n) < 1e-15);
}
TEST_CASE("normal blend: flat detail leaves the base, a flat base leaves the detail, length stays 1",
          "[nodes][symmetry]") {
  std::mt19937_64 random(14);
  const vec3<double> up{0, 0, 1};
  for (int i = 0; i < 300; ++i) {
    Normals<double> n;
    move(random, n);
    const auto a = upwards(n.a), b = upwards(n.b);
    CHECK(length(NormalBlend<double>{}(up, b) - b) < 1e-14);
    CHECK(length(NormalBlend<double>{}(a, up) - a) < 1e-14);
    CHECK(length(NormalBlend<double>{0}(a, b) - b) < 1e-14);
    const auto r = NormalBlend<double>{}(a, b);
    CHECK(length(r) == Approx(1));
    CHECK(dot(r, b) == Approx(a.z));  // the detail keeps its angle to what it lies on
  }
}
TEST_CASE("normal nodes: one value and right slopes in every number", "[nodes][gradient]") {
  const auto off_lattice = [](const auto&, const auto& s) {
    const auto off = [](double x) { return std::fabs(x - std::round(x)) > 0.02; };
    return off(s.uv.x) && off(s.uv.y) && off(s.position.x) && off(s.position.y) && off(s.position.z);
  };
  const Spot<double> corner, line{{1, 0.5}, {-1, 0.25, 2}};
  const Hard<std::tuple<HeightToNormal<double>, Spot<double>>> lattice{"lattice corners and lines, scale 0",
                                                                       {{{1}, corner}, {{5}, line}, {{0}, line}}};
  holds(
      "HeightToNormal",
      [](const auto& node, const auto& s) { return node([](const auto& uv) { return noise2d(uv); }, s.uv); },
      within(off_lattice, HeightToNormal<double>(), Spot<double>()), {.rounding = 1e-4}, lattice);
  holds(
      "bent_normal",
      [](const auto& node, const auto& s) {
        using T = std::remove_cvref_t<decltype(node.scale)>;
        return bent_normal(vec3<T>{T(0.6f), T(0.0f), T(0.8f)}, noise3d(s.position), node.scale);
      },
      within(off_lattice, HeightToNormal<double>(), Spot<double>()), {.rounding = 1e-4}, lattice);
  const vec3<double> black, grey(0.5), up{0.5, 0.5, 1}, flat{1, 0.5, 0.5}, down{0.5, 0.5, 0};
  holds("NormalMap", [](const auto& node, const auto& n) { return node(n.a) + node(n.b, frame_of(node(n.a))); },
        within(
            [](const auto& node, const auto& n) {
              const auto long_enough = [](const auto& c) { return length(c * 2.0 - vec3<double>(1)) > 0.3; };
              return node.scale > 0.1 && long_enough(n.a) && long_enough(n.b) && std::fabs(n.a.z - 0.5) > 0.1;
            },
            NormalMap<double>(), Normals<double>()),
        {.step = 2e-3},
        {"black, middle grey, flat, up, down, scale 0",
         {{{1}, {black, grey}}, {{1}, {grey, black}}, {{1}, {up, flat}}, {{0}, {flat, up}}, {{2}, {down, down}}}});
  holds("NormalBlend", [](const auto& node, const auto& n) { return node(upwards(n.a), upwards(n.b)); },
        within(anywhere, NormalBlend<double>(), Normals<double>()), {},
        {"up, horizontal, amount 0", {{{1}, {up, up}}, {{0}, {up, flat}}, {{2}, {{1, 1, 0}, {0, 0, 0}}}}});
}
TEST_CASE("normal nodes: recorded by the compiler, recorded at run time and taped they are the same",
          "[nodes][agreement]") {
  players_agree<Spot>(
      [](const auto& node, const auto& s) {
        return mixture(node([](const auto& uv) { return noise2d(uv * 1.5f); }, s.uv));
      },
      HeightToNormal<float>{0.6f}, 300, 1e-4);
  players_agree<Normals>([](const auto& node, const auto& n) { return mixture(node(upwards(n.a), upwards(n.b))); },
                         NormalBlend<float>{0.8f});
}
