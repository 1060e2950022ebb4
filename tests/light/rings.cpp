// tests/light/rings.cpp -- the laws of burnish/light/rings.h
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include <record.h>
#include <burnish/light/rings.h>
using namespace burnish;

TEST_CASE("Rings: the layouts have 162, 302 and 578 directions", "[light][cost]") {
  CHECK(Rings(Rings::Size::small).directions() == 162);
  CHECK(Rings(Rings::Size::medium).directions() == 302);
  CHECK(Rings(Rings::Size::large).directions() == 578);
  CHECK(Rings().padded_directions() % 16 == 0);
}

TEST_CASE("Rings: weights are positive and sum to 1, their slopes to 0, but for what lies beyond the last ring",
          "[light][energy]") {
  // int D dot(n, h) dh = 1. The last ring lies at tan theta_h = 6 or 8: beyond it is alpha^2 / (alpha^2 + 36).
  for (const auto size : {Rings::Size::small, Rings::Size::medium, Rings::Size::large}) {
    const Rings rings(size);
    std::vector<double> w(rings.rings()), dw(rings.rings());
    double off = 0, d_off = 0, least = 1;
    for (double r = 0.02; r <= 1; r *= 1.1) {
      const double a2 = std::pow(r, 4), beyond = a2 / (a2 + 36);
      rings.weights(a2, w.data(), dw.data());
      double sum = 0, d_sum = 0;
      for (int k = 0; k < rings.rings(); ++k) sum += w[k], d_sum += dw[k] * a2, least = std::min(least, w[k]);
      off = std::max(off, std::abs(1 - sum) - beyond), d_off = std::max(d_off, std::abs(d_sum) - beyond);
    }
    record::claim("Rings::weights", "value", "integral of D dot(n, h) = 1", 3e-4, off, 42);
    record::claim("Rings::weights", "gradient", "integral of D dot(n, h) = 1", 3e-4, d_off, 42);
    CHECK(least >= 0);
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

TEST_CASE("Rings: they integrate the logarithm of tan theta as the closed form does", "[light][value]") {
  // int 2 y ln(x) / (1 + y)^2 dx / x with y = x^2 / alpha^2 over x > 0 is ln alpha. Only the ends are an error: what
  // lies within the first ring has no logarithm here, and beyond the last is nothing.
  const Rings rings;
  std::vector<double> w(rings.rings()), dw(rings.rings());
  double worst = 0;
  for (const double r : {0.2, 0.3, 0.5, 0.7}) {
    rings.weights(std::pow(r, 4), w.data(), dw.data());
    double sum = 0;
    for (int i = 1; i < rings.directions(); ++i) {
      const double x = std::sqrt(1 - double(rings.half_z[i]) * rings.half_z[i]) / rings.half_z[i];
      sum += w[rings.ring[i]] * rings.share[i] * std::log(x);
    }
    worst = std::max(worst, std::abs(sum - 2 * std::log(r)));
  }
  record::claim("Rings::weights", "value", "integral of D dot(n, h) ln tan theta = ln alpha", 0.01, worst, 4);
}
