// tests/shade/fresnel.cpp -- the laws of burnish/shade/fresnel.h
// SPDX-License-Identifier: Apache-2.0
#include <burnish/math/color.h>
#include <burnish/shade/fresnel.h>
#include <complex>
#include <differences.h>
#include "corners.h"
using namespace differences;

namespace {
/// From the complex refracted cosine, as written in any text on optics.
double by_complex_numbers(double c, std::complex<double> n) {
  const std::complex<double> t = std::sqrt(1.0 - (1 - c * c) / (n * n)), s = (c - n * t) / (c + n * t);
  const std::complex<double> p = (n * c - t) / (n * c + t);
  return 0.5 * (std::norm(s) + std::norm(p));
}
/// 2 times the integral of f(c) c, by Simpson's rule; cosine-weighted mean.
template <class F> double mean(F f) {
  const int n = 20000;
  double sum = 0;
  for (int i = 0; i <= n; ++i) sum += (i == 0 || i == n ? 1 : i % 2 ? 4 : 2) * f(double(i) / n) * (2.0 * i / n);
  return sum / (3 * n);
}
}  // namespace

TEST_CASE("Fresnel: dielectric and conductor are those of complex optics", "[shade][value]") {
  for (const double c : {0.01, 0.1, 0.35, 0.7, 0.99, 1.0}) {
    for (const double eta : {1.1, 1.5, 2.5}) {
      CHECK(fresnel_dielectric(c, eta) == Approx(by_complex_numbers(c, eta)).epsilon(1e-12));
      for (const double k : {0.5, 2.0, 6.0})
        CHECK(fresnel_conductor(c, 0.2 * eta, k) == Approx(by_complex_numbers(c, {0.2 * eta, k})).epsilon(1e-10));
    }
    CHECK(fresnel_conductor(c, 1.5, 0.0) == Approx(fresnel_dielectric(c, 1.5)).epsilon(1e-10));
  }
  CHECK(fresnel_dielectric(1.0, 1.5) == Approx(0.04).epsilon(1e-12));
  CHECK(fresnel_dielectric(0.0, 1.5) == Approx(1));
  CHECK(f0_from_ior(1.5) == Approx(0.04).epsilon(1e-12));
  CHECK(f0_from_ior(1 / 1.5) == Approx(0.04).epsilon(1e-12));
}

TEST_CASE("Fresnel: from the denser side there is total reflection, and the rest is the way back", "[shade][limit]") {
  const double eta = 1.5;
  CHECK(fresnel_dielectric(0.5, 1 / eta) == 1);  // sin = .866 > 1/1.5
  CHECK(fresnel_dielectric(0.0, 1 / eta) == 1);
  for (const double c : {0.0, 0.5}) {
    const auto [y, d_c, d_eta] = differentiate([](auto a, auto b) { return fresnel_dielectric(a, b); }, c, 1 / eta);
    CHECK((y == 1 && d_c == 0 && d_eta == 0));
  }
  for (const double c : {0.3, 0.6, 0.95}) {
    const double inside = std::sqrt(1 - (1 - c * c) / (eta * eta));
    CHECK(fresnel_dielectric(inside, 1 / eta) == Approx(fresnel_dielectric(c, eta)).epsilon(1e-10));
  }
}

TEST_CASE("Fresnel: Schlick's ends, and an interface that is none reflects nothing", "[shade][limit]") {
  CHECK(fresnel_schlick(1.0, 0.3) == 0.3);
  CHECK(fresnel_schlick(0.0, 0.3) == 1);
  CHECK(fresnel_schlick(0.0, 0.3, 0.7) == 0.7);
  CHECK(fresnel_schlick(0.5, vec3<double>(0.1, 0.2, 0.3)).y == Approx(0.2 + 0.8 / 32).epsilon(1e-14));
  CHECK(f90_from_f0(f0_from_ior(1.0)) == 0);
  CHECK(f90_from_f0(f0_from_ior(1.33)) == Approx(1).margin(1e-4));
  CHECK(f90_from_f0(0.04) == 1);
}

TEST_CASE("Fresnel: F82 takes its tint at 82 degrees and never goes below nothing", "[shade][value]") {
  for (const double f0 : {0.1, 0.5, 0.95})
    for (const double tint : {0.3, 0.8, 1.0})
      CHECK(fresnel_f82(1.0 / 7, f0, tint) == Approx(tint * fresnel_schlick(1.0 / 7, f0)).epsilon(1e-6));
  CHECK(fresnel_f82(1.0, 0.5, 0.2) == 0.5);
  CHECK(fresnel_f82(0.4, 0.6, 1.0) == Approx(fresnel_schlick(0.4, 0.6)).epsilon(1e-14));
  double least = 1;
  for (double c = 0; c <= 1; c += 0.01) least = std::min(least, fresnel_f82(c, 0.0, 0.0));
  CHECK(least >= 0);
}

TEST_CASE("Fresnel: the mean over the hemisphere is that of quadrature, seen from both sides", "[shade][value]") {
  for (const double ior : {1.02, 1.1, 1.3, 1.5, 1.6, 2.0, 3.0}) {
    const double outside = mean([&](double c) { return fresnel_dielectric(c, ior); });
    CHECK(fresnel_average(ior) == Approx(outside).epsilon(0.005));
    const double inside = mean([&](double c) { return fresnel_dielectric(c, 1 / ior); });
    CHECK(inside == Approx(1 - (1 - outside) / (ior * ior)).epsilon(1e-3));
  }
  CHECK(fresnel_average(1.0) == 0);
}

TEST_CASE("Fresnel: all numbers agree and the slopes are right", "[shade][gradient]") {
  // Off the edges: total reflection, the end of f90_from_f0 at .02, f82 reaching 0, q = 0 of the conductor with k = 0.
  using corners::Corner;
  const How fine{.rounding = 1e-5, .scale = 1e-3};
  holds(
      "fresnel_schlick, schlick_weight, f0_from_ior",
      [](auto c, auto f0) { return fresnel_schlick(c, f0) + f0_from_ior(1.0f + f0); },
      [](Random& r) {
        return std::tuple{between(r, 0.02, 0.98), between(r, 0.05, 0.95)};
      },
      fine, corners::of([](const Corner& k) {
        return std::tuple{k.c, k.surface.base_weight};
      }));
  holds(
      "f90_from_f0", [](auto f0) { return f90_from_f0(f0); },
      [](Random& r) { return std::tuple{between(r, 0.002, 0.018)}; }, fine,
      {"both ends, beyond", {{0.0}, {0.02}, {1.0}, {-1.0}}});
  const auto interface = corners::of([](const Corner& k) { return std::tuple{k.c, k.eta}; });
  const auto dielectric = [](auto c, auto eta) { return fresnel_dielectric(c, eta); };
  holds(
      "fresnel_dielectric", dielectric,
      [](Random& r) {
        return std::tuple{between(r, 0.1, 0.98), between(r, 1.1, 3)};
      },
      fine, interface);
  holds(
      "fresnel_dielectric", dielectric,
      [](Random& r) {
        return std::tuple{between(r, 0.9, 0.98), between(r, 0.6, 0.9)};
      },
      {.rounding = 1e-4, .scale = 1e-3}, interface);
  holds(
      "fresnel_conductor",
      [](auto c, auto eta, auto k) {
        return luminance(fresnel_conductor(c, vec3{eta, eta * 0.75f, eta}, vec3{k, k, k * 1.5f}));
      },
      [](Random& r) {
        return std::tuple{between(r, 0.05, 0.98), between(r, 0.1, 3), between(r, 0.2, 6)};
      },
      fine,
      corners::of(
          [](const Corner& k) {
            return std::tuple{k.c, k.eta, k.surface.base_metalness};
          },
          [](const Corner& k) { return k.c < 1e-5 && k.eta == 1 && k.surface.base_metalness == 0; }));
  holds(
      "fresnel_f82",
      [](auto c, auto f0, auto tint) {
        return luminance(fresnel_f82(c, vec3{f0, f0 * 0.9f, f0}, vec3{tint, tint, tint * 1.01f}));
      },
      [](Random& r) {
        return std::tuple{between(r, 0.05, 0.98), between(r, 0.3, 0.95), between(r, 0.6, 0.99)};
      },
      fine, corners::of([](const Corner& k) {
        return std::tuple{k.c, k.surface.base_weight, 1 - k.l.z};
      }));
  holds(
      "fresnel_average", [](auto ior) { return fresnel_average(ior); },
      [](Random& r) { return std::tuple{between(r, 1.05, 3)}; }, fine, {"no interface", {{1.0}}});
}
