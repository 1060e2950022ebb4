// tests/math/smooth.cpp -- soft edges are sharp outside their width and have slopes inside
// SPDX-License-Identifier: Apache-2.0
#include <burnish/math/smooth.h>
#include <differences.h>

using namespace differences;

namespace {
template <class T> struct Soft {
  T x, a, width;
  static constexpr auto parameters() {
    return std::tuple{Param{"x", &Soft::x, Range{-1, 2}}, Param{"a", &Soft::a, unit},
                      Param{"width", &Soft::width, Range{0.05f, 0.3f}}};
  }
};
const auto off = [](const auto& s) {  // the ends of the soft part, where the second derivative jumps
  return std::fabs(std::fabs(s.x - s.a) - s.width) > 0.04 && std::fabs(std::fabs(s.x) - s.width) > 0.04;
};
}  // namespace

TEST_CASE("Soft edges: outside the width they are the sharp functions", "[math][limit]") {
  for (double x = -2; x <= 2; x += 0.0625) {
    if (std::fabs(x - 0.25) >= 0.125) {
      CHECK(smooth_step(x, 0.25, 0.125) == (x > 0.25));
      CHECK(smooth_max(x, 0.25, 0.125) == std::max(x, 0.25));
      CHECK(smooth_min(x, 0.25, 0.125) == std::min(x, 0.25));
    }
    if (std::fabs(x) >= 0.125) CHECK(smooth_abs(x, 0.125) == std::fabs(x));
    if (std::fabs(x) >= 0.125 && std::fabs(x - 1) >= 0.125)
      CHECK(smooth_clamp(x, 0, 1, 0.125) == Approx(std::clamp(x, 0.0, 1.0)));
    CHECK(soft_threshold(x, 0.25, 0.01) == Approx(1 / (1 + std::exp(-(x - 0.25) / 0.01))).margin(1e-12));
  }
  CHECK(smooth_max(1.0, 1.0, 0.2) == Approx(1.05));
  CHECK(smooth_min(1.0, 1.0, 0.2) == Approx(0.95));
  CHECK(smooth_abs(0.0, 0.2) == Approx(0.1));
  CHECK(smooth_pulse(0.5, 0.25, 0.75, 0.1) == 1);
  CHECK(smooth_pulse(0.25, 0.25, 0.75, 0.1) == Approx(0.5));
}
TEST_CASE("Soft edges: slopes are continuous over the ends of the soft part and right at its middle",
          "[math][gradient]") {
  const auto slope = [](auto f, double x) { return std::get<1>(differentiate(f, x)); };
  const auto top = [](auto x) { return smooth_max(x, 0.25f, 0.125f); };
  const auto bend = [](auto x) { return smooth_abs(x, 0.125f); };
  const auto step = [](auto x) { return smooth_step(x, 0.25f, 0.125f); };
  for (const double e : {0.125, 0.375}) {
    CHECK(std::fabs(slope(top, e - 1e-9) - slope(top, e + 1e-9)) < 1e-7);
    CHECK(std::fabs(slope(step, e - 1e-9) - slope(step, e + 1e-9)) < 1e-6);
  }
  for (const double e : {-0.125, 0.125}) CHECK(std::fabs(slope(bend, e - 1e-9) - slope(bend, e + 1e-9)) < 1e-7);
  CHECK(slope(top, 0.25) == Approx(0.5));
  CHECK(slope(bend, 0) == 0);
  CHECK(slope(step, 0.25) == Approx(6));
}
TEST_CASE("Soft edges: one value and right slopes in every number", "[math][gradient]") {
  const auto beside = [](double middle) {  // the same about a second edge
    return [=](const auto& s) { return off(s) && std::fabs(std::fabs(s.x - s.a - middle) - s.width) > 0.04; };
  };
  const auto near = [](const auto& s) {
    return std::fabs(s.x - s.a) < 9 * s.width;  // beyond, the slope is lost in the rounding of the value
  };
  const Soft<double> any{};
  const Hard<std::tuple<Soft<double>>> ends{
      "both ends and the middle of the soft part",
      {{{0.5, 0.25, 0.25}}, {{0.0, 0.25, 0.25}}, {{0.25, 0.25, 0.25}}, {{0.25, 0.0, 0.25}}, {{0.0, 0.0, 0.25}}}};
  holds(
      "smooth_step", [](const auto& s) { return smooth_step(s.x, s.a, s.width); }, within(off, any), {}, ends);
  holds(
      "smooth_max", [](const auto& s) { return smooth_max(s.x, s.a, s.width); }, within(off, any), {}, ends);
  holds(
      "smooth_min", [](const auto& s) { return smooth_min(s.x, s.a, s.width); }, within(off, any), {}, ends);
  holds(
      "smooth_abs", [](const auto& s) { return smooth_abs(s.x, s.width); }, within(off, any), {}, ends);
  holds(
      "smooth_pulse", [](const auto& s) { return smooth_pulse(s.x, s.a, s.a + 0.6f, s.width); },
      within(beside(0.6), any), {}, ends);
  holds(
      "smooth_clamp", [](const auto& s) { return smooth_clamp(s.x, s.a, s.a + 0.7f, s.width); },
      within(beside(0.7), any), {}, ends);
  holds(
      "soft_threshold", [](const auto& s) { return soft_threshold(s.x, s.a, s.width); }, within(near, any), {}, ends);
}
TEST_CASE("bias and gain: keep the ends, meet their middle and have right slopes", "[math][gradient]") {
  for (double a = 0.1; a < 1; a += 0.1) {
    CHECK(bias(0.0, a) == 0);
    CHECK(bias(1.0, a) == Approx(1));
    CHECK(bias(0.5, a) == Approx(a));
    CHECK(gain(0.5, a) == Approx(0.5));
    CHECK(gain(0.25, a) == Approx(1 - gain(0.75, a)));
    CHECK(std::get<1>(differentiate([](auto x, auto y) { return gain(x, y); }, 0.5, a)) == Approx(1 / a - 1));
  }
  CHECK(bias(0.3, 0.5) == Approx(0.3));
  const auto off_middle = [](const auto& s) {
    return s.x > 0.02 && s.x < 0.98 && std::fabs(s.x - 0.5) > 0.02 && s.a > 0.1 && s.a < 0.9;
  };
  const Hard<std::tuple<Soft<double>>> ends{"both ends and the middle",
                                            {{{0, 0.3, 0}}, {{1, 0.3, 0}}, {{0.5, 0.3, 0}}}};
  holds(
      "bias", [](const auto& s) { return bias(s.x, s.a); }, within(off_middle, Soft<double>()), {}, ends);
  holds(
      "gain", [](const auto& s) { return gain(s.x, s.a); }, within(off_middle, Soft<double>()), {}, ends);
}
