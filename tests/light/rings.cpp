// tests/light/rings.cpp -- the laws of burnish/light/rings.h
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include <burnish/light/rings.h>
using namespace burnish;

TEST_CASE("Rings: the layouts have 183, 321 and 607 directions", "[light][cost]") {
  CHECK(Rings(Rings::Size::small).directions() == 183);
  CHECK(Rings(Rings::Size::medium).directions() == 321);
  CHECK(Rings(Rings::Size::large).directions() == 607);
  CHECK(Rings().padded_directions() % 16 == 0);
}

TEST_CASE("Rings: weights are positive, sum to 1, and their slopes to 0", "[light][energy]") {
  for (const auto size : {Rings::Size::small, Rings::Size::medium, Rings::Size::large}) {
    const Rings rings(size);
    std::vector<double> w(rings.rings()), dw(rings.rings());
    for (double r = 0.02; r <= 1; r *= 1.1) {
      rings.weights(std::pow(r, 4), w.data(), dw.data());
      double sum = 0, d_sum = 0, least = 1;
      for (int k = 0; k < rings.rings(); ++k)
        sum += w[k], d_sum += dw[k] * std::pow(r, 4), least = std::min(least, w[k]);
      CAPTURE(r);
      CHECK(sum == Approx(1).epsilon(1e-12));
      CHECK(d_sum == Approx(0).margin(1e-12));
      CHECK(least >= 0);
    }
  }
}

TEST_CASE("Rings: the slopes of the weights are those that differences find", "[light][gradient]") {
  const Rings rings;
  const int n = rings.rings();
  std::vector<double> w(n), dw(n), up(n), down(n), none(n);
  for (double r = 0.021; r <= 1; r *= 1.07) {
    const double a2 = std::pow(r, 4), h = 1e-4 * a2;
    rings.weights(a2, w.data(), dw.data());
    rings.weights(a2 + h, up.data(), none.data());
    rings.weights(a2 - h, down.data(), none.data());
    double worst = 0;
    for (int k = 0; k < n; ++k) worst = std::max(worst, std::abs((up[k] - down[k]) / (2 * h) - dw[k]) * a2);
    CAPTURE(r);
    CHECK(worst < 1e-7);
  }
}

TEST_CASE("Rings: they integrate the log-linear function of tan theta that they interpolate", "[light][value]") {
  // int 2 y ln(x) / (1 + y)^2 with y = x^2 / alpha^2 over x > 0 is ln alpha: closed form. The inner ring's linear hat
  // and the outermost's flat end are the error.
  const Rings rings;
  std::vector<double> w(rings.rings()), dw(rings.rings());
  for (const double r : {0.2, 0.3, 0.5, 0.7}) {
    rings.weights(std::pow(r, 4), w.data(), dw.data());
    double sum = 0, share = 0;
    for (int i = 1; i < rings.directions(); ++i) {
      const double x = std::sqrt(1 - double(rings.half_z[i]) * rings.half_z[i]) / rings.half_z[i];
      sum += w[rings.ring[i]] * rings.share[i] * std::log(x);
      share += w[rings.ring[i]] * rings.share[i];
    }
    CAPTURE(r);
    CHECK(share == Approx(1).margin(2e-3));
    CHECK(sum == Approx(2 * std::log(r)).margin(0.02));
  }
}
