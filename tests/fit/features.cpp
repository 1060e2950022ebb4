// tests/fit/features.cpp -- the filter bank: values in closed form, the way back, what lies outside the mask
// SPDX-License-Identifier: Apache-2.0
#include "features.h"
using namespace burnish;
using namespace features_test;

namespace {
double smooth_size(double x, double knee = double(0.01f)) { return std::sqrt(x * x + knee * knee) - knee; }
/// f over the picture in all three channels, each a little apart.
template <class F> FeatureMap<double> drawn(int w, int h, F f) {
  FeatureMap<double> image(3, w, h);
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) image.plane(c)[y * w + x] = f(x, y) + 0.1 * c;
  return image;
}
}  // namespace

TEST_CASE("FilterBank: a part of one colour has that colour and no derivatives, up to its border on every octave",
          "[fit][value]") {
  FilterBank::Trace<double> t;
  const Mask mask = disc(64, 48, 1);
  FilterBank().forward(drawn(64, 48, [](int, int) { return 0.25; }), mask, t);
  REQUIRE(t.layers.size() == 4);
  int counted = 0;
  for (const auto& l : t.layers)
    for (std::size_t i = 0; i < l.weight.stride(); ++i)
      for (int c = 0; c < FilterBank::channels && l.weight.values[i] > 0; ++c) {
        const double expected = c % FilterBank::per_channel ? 0 : 0.25 + 0.1 * (c / FilterBank::per_channel);
        CHECK(l.maps.plane(c)[i] == Approx(expected).margin(1e-12));
        ++counted;
      }
  CHECK(counted > 27 * 800);
}
TEST_CASE("FilterBank: on a ramp the first derivatives are its slope along each direction, by the octave's step",
          "[fit][value]") {
  const double sx = 0.011, sy = -0.004;
  FilterBank::Trace<double> t;
  FilterBank().forward(drawn(96, 80, [&](int x, int y) { return 0.3 + sx * x + sy * y; }), Mask(96, 80, 1), t);
  for (std::size_t k = 0; k < t.layers.size(); ++k) {
    CAPTURE(k);
    const auto& maps = t.layers[k].maps;
    const int i = maps.height / 2 * maps.width + maps.width / 2;  // far enough from the borders
    const double step = double(1 << k), along[] = {sx, (sx + sy) / std::sqrt(2), sy, (sy - sx) / std::sqrt(2)};
    for (int c = 0; c < 3; ++c)
      for (int n = 0; n < 4; ++n) {
        CHECK(maps.plane(c * FilterBank::per_channel + 1 + n)[i] == Approx(smooth_size(step * along[n])).epsilon(1e-9));
        CHECK(maps.plane(c * FilterBank::per_channel + 5 + n)[i] == Approx(0).margin(1e-9));
      }
  }
}
TEST_CASE("FilterBank: on a paraboloid the second derivatives are its curvature along each direction", "[fit][value]") {
  const double xx = 0.0021, yy = -0.0013, xy = 0.0008;  // of x^2, y^2 and x y
  FilterBank::Trace<double> t;
  FilterBank().forward(drawn(96, 80, [&](int x, int y) { return xx * x * x + yy * y * y + xy * x * y; }),
                       Mask(96, 80, 1), t);
  for (std::size_t k = 0; k < t.layers.size(); ++k) {
    CAPTURE(k);
    const auto& maps = t.layers[k].maps;
    const int i = maps.height / 2 * maps.width + maps.width / 2;
    const double area = double(1 << 2 * k), along[] = {2 * xx, xx + yy + xy, 2 * yy, xx + yy - xy};
    for (int n = 0; n < 4; ++n)
      CHECK(maps.plane(5 + n)[i] == Approx(smooth_size(area * along[n])).epsilon(1e-9));
  }
}
TEST_CASE("FilterBank: a weight is the least of the blurred mask's around it; an octave below 3 x 3 is left out",
          "[fit][value]") {
  FilterBank::Trace<double> t;
  Mask mask(9, 5, 1);
  mask.at(1, 2) = 0.25f;
  FilterBank().forward(drawn(9, 5, [](int, int) { return 0.5; }), mask, t);
  REQUIRE(t.layers.size() == 2);  // 9 x 5 and 5 x 3; then 3 x 2
  const auto& w = t.layers[0].weight;
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 9; ++x) {
      const bool border = x == 0 || x == 8 || y == 0 || y == 4, near = x <= 2 && y >= 1 && y <= 3;
      CHECK(w.plane(0)[y * 9 + x] == (border ? 0 : near ? 0.25 : 1));
    }
  FilterBank::Trace<double> none;
  FilterBank().forward(drawn(2, 9, [](int, int) { return 0.5; }), Mask(2, 9, 1), none);
  CHECK(none.layers.empty());
}
TEST_CASE("FilterBank: its slopes by the image are those of differences", "[fit][gradient]") {
  goes_back("FilterBank", FilterBank(), 29, 23, 1e-7);
  goes_back("FilterBank", FilterBank(), 16, 33, 1e-7);
}
TEST_CASE("FilterBank: float gives what double gives", "[fit][agreement]") {
  is_one_in_float("FilterBank", FilterBank(), 2e-5);
}
TEST_CASE("FilterBank: what lies outside the mask is neither read nor touched", "[fit][limit]") {
  sees_nothing_outside(FilterBank());
}
TEST_CASE("FilterBank: the same bits for any number of threads", "[fit][agreement]") {
  is_one_on_all_threads(FilterBank());
}
