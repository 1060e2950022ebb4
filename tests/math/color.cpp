// tests/math/color.cpp -- colour spaces: known values, round trips, slopes, and grey
// SPDX-License-Identifier: Apache-2.0
#include <burnish/math/color.h>
#include <differences.h>

using namespace differences;

namespace {
template <class T> struct Color {
  vec3<T> c, amount;
  static constexpr auto parameters() {
    return std::tuple{Param{"c", &Color::c, unit}, Param{"amount", &Color::amount, Range{0.1f, 2}}};
  }
};
/// No two channels nearer than 0.02, none nearer to 0 than that.
const auto apart = [](const auto& x) {
  const auto& c = x.c;
  return std::min({c.x, c.y, c.z, std::fabs(c.x - c.y), std::fabs(c.y - c.z), std::fabs(c.z - c.x)}) > 0.02;
};
const vec3<double> ties[] = {vec3<double>(0.5), vec3<double>(0.0), {0.7, 0.7, 0.2},  {0.1, 0.6, 0.6},
                             {1, 0, 0},         {0.3, 0.3, 0.9},   {0.2, 0.5, 0.2},  {0, 1, 1},
                             {1, 0, 1},         {0.6, 0.1, 0.1},   vec3<double>(0.9)};
/// A hue off the sixths of a turn.
const auto off_sixths = [](double hue) { return std::fabs(hue * 6 - std::round(hue * 6)) > 0.1; };

/// Foley and van Dam's procedures, by their case distinctions.
vec3<double> hsv_by_cases(vec3<double> c) {
  const double top = std::max({c.x, c.y, c.z}), d = top - std::min({c.x, c.y, c.z});
  if (d == 0) return {0, 0, top};
  double h = c.x == top ? (c.y - c.z) / d : c.y == top ? 2 + (c.z - c.x) / d : 4 + (c.x - c.y) / d;
  if (h < 0) h += 6;
  return {h / 6, d / top, top};
}
vec3<double> rgb_by_cases(vec3<double> c) {
  const double h = 6 * (c.x - std::floor(c.x)), f = h - std::floor(h);
  const double p = c.z * (1 - c.y), q = c.z * (1 - c.y * f), t = c.z * (1 - c.y * (1 - f));
  const vec3<double> sixths[] = {{c.z, t, p}, {q, c.z, p}, {p, c.z, t}, {p, q, c.z}, {t, p, c.z}, {c.z, p, q}};
  return sixths[int(h)];
}
double distance(const vec3<double>& a, const vec3<double>& b) { return length(a - b); }
}  // namespace

TEST_CASE("sRGB: known values, there and back, right slopes", "[math][gradient]") {
  CHECK(linear_from_srgb(0.5) == Approx(0.214041140).epsilon(1e-6));  // ((0.5 + 0.055) / 1.055)^2.4
  CHECK(linear_from_srgb(0.02) == Approx(0.02 / 12.92));
  CHECK(srgb_from_linear(0.18) == Approx(0.461356130).epsilon(1e-6));
  CHECK(linear_from_srgb(1.0) == Approx(1));
  CHECK(linear_from_srgb(-0.1) == Approx(-0.1 / 12.92));
  for (double x = -0.1; x < 2; x += 0.01) CHECK(srgb_from_linear(linear_from_srgb(x)) == Approx(x).margin(2e-6));
  const auto off_edge = [](const auto& p) {
    return std::min({std::fabs(p.x - 0.04045), std::fabs(p.y - 0.04045), std::fabs(p.z - 0.04045),
                     std::fabs(p.x - 0.0031308), std::fabs(p.y - 0.0031308), std::fabs(p.z - 0.0031308)}) > 0.005;
  };
  const Hard<std::tuple<vec3<double>>> ends{"black, white, beyond both, the edges",
                                            {{{0, 1, -1}}, {{4, -0.0, 0.04045f}}, {{0.0031308f, 100, -100}}}};
  holds(
      "linear_from_srgb", [](const auto& c) { return linear_from_srgb(c); }, within(off_edge, vec3<double>()),
      {.step = 1e-3}, ends);
  holds(
      "srgb_from_linear", [](const auto& c) { return srgb_from_linear(c); }, within(off_edge, vec3<double>()),
      {.step = 1e-3}, ends);
  holds(
      "luminance", [](const auto& c) { return luminance(c); }, within(anywhere, vec3<double>()));
  CHECK(luminance(vec3<double>(1)) == Approx(1));
}
TEST_CASE("HSV: agrees with the procedures by cases, there and back", "[math][value]") {
  std::mt19937_64 random(4);
  for (int i = 0; i < 1000; ++i) {
    Color<double> p;
    move(random, p);
    CHECK(distance(rgbtohsv(p.c), hsv_by_cases(p.c)) < 1e-6);
    CHECK(distance(hsvtorgb(rgbtohsv(p.c)), p.c) < 1e-6);
    const vec3<double> hsv{p.amount.x * 2 - 1.5, p.c.x, p.c.y};
    CHECK(distance(hsvtorgb(hsv), rgb_by_cases(hsv)) < 1e-6);
    auto adjusted = hsv_by_cases(p.c);
    adjusted = {adjusted.x + p.amount.x - 1, adjusted.y * p.amount.y, adjusted.z * p.amount.z};
    const auto turned = hsvadjust(p.c, vec3<double>{p.amount.x - 1, p.amount.y, p.amount.z});
    CHECK(distance(turned, rgb_by_cases(adjusted)) < 1e-6);
  }
  CHECK(distance(rgbtohsv(vec3<double>(0)), {0, 0, 0}) == 0);
  CHECK(distance(rgbtohsv(vec3<double>(0.4)), {0, 0, 0.4}) == 0);
  CHECK(distance(hsvtorgb(vec3<double>{1 / 3.0, 1, 1}), {0, 1, 0}) < 1e-6);
}
TEST_CASE("HSV: one value and right slopes in every number", "[math][gradient]") {
  Hard<std::tuple<Color<double>>> hard{"black, grey, white, saturated, ties of two channels, whole turns", {}},
      by_hue = hard;
  for (const vec3<double>& c : ties)
    for (const double hue : {-1.0, 0.0, 0.5, 1.0})
      for (const Color<double>& x : {Color<double>{c, {hue, 0, 1}}, Color<double>{c, {hue, 2, 0}}}) {
        hard.points.push_back({x});
        (c.x == c.y && c.y == c.z ? by_hue.stated : by_hue.points).push_back({x});
      }
  holds(
      "rgbtohsv", [](const auto& x) { return rgbtohsv(x.c); }, within(apart, Color<double>()),
      {.rounding = 1e-4, .step = 3e-3}, by_hue);
  holds(
      "hsvtorgb",
      [](const auto& x) {
        return hsvtorgb(vec3{x.amount.x, x.c.y, x.c.z});
      },
      within([](const auto& x) { return off_sixths(x.amount.x); }, Color<double>()), {.step = 3e-3}, hard);
  holds(
      "hsvadjust", [](const auto& x) { return hsvadjust(x.c, x.amount); },
      within([](const auto& x) { return apart(x) && off_sixths(hsv_by_cases(x.c).x + x.amount.x); }, Color<double>()),
      {.step = 3e-3}, hard);
}
TEST_CASE("hsvadjust: the identity has the slopes of the identity, at grey too", "[math][limit]") {
  for (const vec3<double>& c : ties) {
    CAPTURE(c.x, c.y, c.z);
    const auto channel = [](int i) {
      return [i](const auto& x) {
        using T = std::remove_cvref_t<decltype(x.x)>;
        const auto y = hsvadjust(x, vec3<T>{T(0.0f), T(1.0f), T(1.0f)});
        return i == 0 ? y.x : i == 1 ? y.y : y.z;
      };
    };
    for (int i = 0; i < 3; ++i) {
      const auto [y, d] = differentiate(channel(i), c);
      CHECK(y == Approx(i == 0 ? c.x : i == 1 ? c.y : c.z).margin(1e-15));
      CHECK(d.x == Approx(i == 0).margin(1e-12));
      CHECK(d.y == Approx(i == 1).margin(1e-12));
      CHECK(d.z == Approx(i == 2).margin(1e-12));
    }
  }
  const auto [h, d] = differentiate([](const auto& c) { return mixture(rgbtohsv(c)); }, vec3<double>(0.4));
  CHECK(std::isfinite(d.x + d.y + d.z));
}
TEST_CASE("XYZ and Lab: white, known values, there and back, right slopes", "[math][gradient]") {
  // Red of sRGB: L 53.2408, a 80.0925, b 67.2032 (Lindbloom's calculator, D65).
  CHECK(distance(lab_from_rgb(vec3<double>(1)), {100, 0, 0}) < 1e-3);
  CHECK(distance(lab_from_rgb(vec3<double>{1, 0, 0}), {53.2408, 80.0925, 67.2032}) < 2e-3);
  CHECK(distance(lab_from_rgb(vec3<double>(0.18)), {49.4961, 0, 0}) < 1e-3);  // 116 cbrt(0.18) - 16
  CHECK(xyz_from_rgb(vec3<double>(1)).y == Approx(1).epsilon(1e-6));
  CHECK(distance(lab_from_rgb(vec3<double>(0)), {0, 0, 0}) < 1e-4);
  std::mt19937_64 random(4);
  for (int i = 0; i < 1000; ++i) {
    Color<double> p;
    move(random, p);
    CHECK(distance(rgb_from_xyz(xyz_from_rgb(p.c)), p.c) < 2e-6);
    CHECK(distance(rgb_from_lab(lab_from_rgb(p.c)), p.c) < 5e-6);
  }
  // At (6/29)^3 = 0.008856 of X, Y, Z over white only the second derivative jumps.
  const Hard<std::tuple<Color<double>>> ends{"black, white, below black",
                                             {{{vec3<double>(0.0), vec3<double>(0.0)}},
                                              {{vec3<double>(1.0), vec3<double>(1.0)}},
                                              {{vec3<double>(-1.0), vec3<double>(-1.0)}}}};
  const auto off_black = within([](const auto& x) { return std::min({x.c.x, x.c.y, x.c.z}) > 0.02; }, Color<double>());
  holds(
      "lab_from_rgb", [](const auto& x) { return lab_from_rgb(x.c); }, off_black, {.rounding = 1e-4, .step = 3e-3},
      ends);
  holds(
      "lab_from_xyz", [](const auto& x) { return lab_from_xyz(x.amount); }, within(anywhere, Color<double>()),
      {.rounding = 1e-4, .step = 3e-3}, ends);
  holds(
      "rgb_from_lab, xyz_from_lab", [](const auto& x) { return rgb_from_lab(x.c * 60.0f); },
      within([](const auto& x) { return x.c.x > 0.4; }, Color<double>()), {.rounding = 1e-4, .step = 3e-3}, ends);
  holds(
      "rgb_from_xyz, xyz_from_rgb", [](const auto& x) { return rgb_from_xyz(xyz_from_rgb(x.amount)); },
      within(anywhere, Color<double>()));
}
