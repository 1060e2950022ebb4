// tests/light/sun.cpp -- the laws of burnish/light/sun.h
// SPDX-License-Identifier: Apache-2.0
#include <burnish/light/sun.h>
#include <burnish/shade/ggx.h>
#include <differences.h>
#include "reference.h"
using namespace differences;

namespace {
const vec3<double> up(0, 0, 1);
/// D averaged over directions l' spread as the light's Gaussian about l, by brute force: whichever is wider, light or
/// lobe, is what the narrower one is drawn against.
double averaged(const vec3<double>& v, const vec3<double>& l, double r, double sd) {
  const reference::Frame f(l), n(up);
  const double alpha = r * r;
  const int samples = 1 << 15;
  double sum = 0;
  for (int i = 0; i < samples; ++i) {
    const double u = (i + 0.5) / samples, angle = 2.399963229728653 * i;
    if (2 * alpha >= sd) {
      const double d = sd * std::sqrt(-2 * std::log(1 - u));
      const vec3<double> h = normalize(v + normalize(f.world(d * std::cos(angle), d * std::sin(angle), 1)));
      sum += ggx_d(r, up, h) / samples;
    } else {
      const double t = alpha * std::sqrt(u / (1 - u)), hz = 1 / std::sqrt(1 + t * t);
      const vec3<double> h = n.world(t * hz * std::cos(angle), t * hz * std::sin(angle), hz);
      const double vh = dot(v, h), c = dot(h * (2 * vh) - v, l);
      if (vh <= 0 || c <= 0) continue;
      const vec3<double> away = (h * (2 * vh) - v) / c - l;
      sum += 4 * vh / hz / samples * std::exp(-dot(away, away) / (2 * sd * sd)) /
             (2 * reference::pi * sd * sd * c * c * c);
    }
  }
  return sum;
}
}  // namespace

TEST_CASE("ggx_d_spot: a light without extent leaves D as it is", "[light][limit]") {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const vec3<double> v = upward(random, 0.1), l = upward(random, 0.05);
    const double r = between(random, 0.02, 1);
    CHECK(ggx_d_spot(up, v, l, r, 1e-14) == Approx(ggx_d(r, up, normalize(v + l))).epsilon(1e-6));
  }
}

TEST_CASE("ggx_d_spot: D averaged over the light, at most 7 % of its peak off, 1 % where lobe or light is far wider",
          "[light][value]") {
  Random random(2);
  for (const auto& [sd, r, bound] : {std::tuple(0.0025, 0.02, 0.08),
                                     {0.0025, 0.1, 0.01},
                                     {0.0025, 0.4, 0.01},
                                     {0.01, 0.02, 0.01},
                                     {0.01, 0.05, 0.07},
                                     {0.01, 0.2, 0.01},
                                     {0.03, 0.02, 0.015},
                                     {0.03, 0.2, 0.04}}) {
    double worst = 0;
    for (int i = 0; i < 40; ++i) {
      const vec3<double> v = upward(random, 0.2);
      const double t = r * r * std::pow(10, between(random, -1, 1)), a = between(random, -3.14, 3.14);
      const vec3<double> h = normalize(vec3<double>(t * std::cos(a), t * std::sin(a), 1)), l = h * (2 * dot(v, h)) - v;
      if (l.z < 0.1) continue;
      const vec3<double> mirror(-v.x, -v.y, v.z);
      const double peak = ggx_d_spot(up, v, mirror, r, sd * sd);
      worst = std::max(worst, std::abs(ggx_d_spot(up, v, l, r, sd * sd) - averaged(v, l, r, sd)) / peak);
    }
    CAPTURE(sd, r);
    CHECK(worst < bound);
  }
}

TEST_CASE("ggx_d_spot: it depends on angles only, not on the frame", "[light][symmetry]") {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const vec3<double> v = upward(random, 0.1), l = upward(random, 0.1);
    const reference::Frame f(upward(random, -1));
    const auto moved = [&](const vec3<double>& d) { return f.world(d.x, d.y, d.z); };
    const double r = between(random, 0.05, 1);
    CHECK(ggx_d_spot(moved(up), moved(v), moved(l), r, 1e-4) == Approx(ggx_d_spot(up, v, l, r, 1e-4)).epsilon(1e-9));
    CHECK(ggx_d_spot(up, l, v, r, 1e-12) == Approx(ggx_d_spot(up, v, l, r, 1e-12)).epsilon(1e-6));
  }
}

TEST_CASE("ggx_d_spot: one value in every number, and right slopes by everything", "[light][gradient]") {
  // Edge: v and l opposite (dot(n, v + l) = 1e-3); drawn well above it.
  holds(
      "ggx_d_spot",
      [](const auto& n, const auto& v, const auto& l, const auto& r, const auto& variance) {
        return ggx_d_spot(n, v, l, r, variance);
      },
      [](Random& random) {
        return std::tuple(upward(random, 0.95), upward(random, 0.3), upward(random, 0.3), between(random, 0.2, 0.9),
                          between(random, 1e-3, 1e-2));
      },
      {.rounding = 1e-4, .scale = 1e-3, .step = 1e-3},
      {"grazing, along the normal, roughness .02",
       {{up, up, up, 0.02, 1e-3},
        {up, up, up, 1.0, 1e-7},
        {up, {1, 0, 0}, {0, 0.6, 0.8}, 0.02, 5.4e-6},
        {up, {0, 0, 1}, {1, 0, 0}, 0.5, 0.1}},
       {{up, {0, 0.6, 0.8}, {0, -0.6, -0.8}, 0.02, 1e-3}, {up, {1, 0, 0}, {-1, 0, 0}, 1.0, 1e-7}}});  // opposite
}

TEST_CASE("ggx_d_spot: finite in float for every light, view and roughness", "[light][limit]") {
  Random random(4);
  for (int i = 0; i < 20000; ++i) {
    const vec3<float> n(up), v(upward(random, i % 3 ? 0.0 : 0.999)), l(i % 5 ? upward(random, -1) : -vec3<double>(v));
    const float r = float(between(random, 0.02, 1)), variance = float(std::pow(10, between(random, -7, -1)));
    const float d = ggx_d_spot(n, v, l, r, variance);
    REQUIRE(std::isfinite(d));
    REQUIRE(d >= 0);
    const auto slopes = differentiate([](const auto& a, const auto& b, const auto& c,
                                         const auto& e) { return ggx_d_spot(a, b, c, e, decltype(e)(1e-5f)); },
                                      n, v, l, r);
    REQUIRE(std::isfinite(std::get<1>(slopes).x + std::get<2>(slopes).y + std::get<3>(slopes).z + std::get<4>(slopes)));
  }
}
