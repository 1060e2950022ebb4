// tests/shade/diffuse.cpp -- the laws of burnish/shade/diffuse.h
// SPDX-License-Identifier: Apache-2.0
#include <burnish/shade/diffuse.h>
#include <differences.h>
#include "corners.h"
#include "quadrature.h"
using namespace differences;
using quadrature::over_hemisphere;
using quadrature::viewer;

namespace {
double eon_albedo(double albedo, double r, double nv) {
  const vec3<double> v = viewer(nv);
  return over_hemisphere(
      200, [&](const vec3<double>& l) { return oren_nayar(vec3<double>(albedo), r, l.z, nv, dot(v, l)).x * l.z; });
}
}  // namespace

TEST_CASE("Oren-Nayar: roughness 0 is exactly Lambert", "[shade][limit]") {
  const vec3<float> albedo(0.8f, 0.3f, 0.0f), a = lambert(albedo), b = oren_nayar(albedo, 0.0f, 0.3f, 0.7f, 0.5f);
  CHECK((a.x == b.x && a.y == b.y && a.z == b.z));
  CHECK(over_hemisphere(50, [](const vec3<double>& l) { return lambert(vec3<double>(0.5)).x * l.z; }) == Approx(0.5));
}

TEST_CASE("Oren-Nayar: white reflects all, whatever the roughness and view", "[shade][energy]") {
  for (const double r : {0.1, 0.5, 1.0})
    for (const double nv : {0.02, 0.1, 0.3, 0.7, 1.0}) CHECK(eon_albedo(1, r, nv) == Approx(1).epsilon(1.5e-3));
  for (const double albedo : {0.2, 0.8})
    for (const double nv : {0.1, 0.7}) CHECK(eon_albedo(albedo, 1, nv) < albedo * 1.03);
}

TEST_CASE("Oren-Nayar: the albedo curve is that of its single scattering", "[shade][value]") {
  // As albedo goes to 0 only single scattering is left: A (1 + roughness G), G by quadrature of s / t.
  for (const double nv : {0.05, 0.2, 0.5, 0.9, 1.0}) {
    const vec3<double> v = viewer(nv);
    const double g = over_hemisphere(400, [&](const vec3<double>& l) {
      const double s = dot(v, l) - l.z * nv;
      return (s > 0 ? s / std::max(l.z, nv) : s) * l.z / (quadrature::tau / 2);
    });
    CHECK(detail::fon_rest(nv) == Approx(double(detail::fon_1) - g).margin(6e-4));
    CHECK(detail::fon_rest(nv) >= 0);
  }
  CHECK(detail::fon_rest(0.0f) == Approx(0).margin(1e-7));
}

TEST_CASE("Diffuse: reflection is reciprocal", "[shade][symmetry]") {
  const vec3<double> albedo(0.9, 0.5, 0.1);
  for (const double r : {0.0, 0.4, 1.0})
    for (const double nl : {0.1, 0.6})
      for (const double vl : {-0.3, 0.4, 0.9}) {
        CHECK(oren_nayar(albedo, r, nl, 0.7, vl).x == Approx(oren_nayar(albedo, r, 0.7, nl, vl).x).epsilon(1e-14));
        CHECK(burley(albedo, r, nl, 0.7, 0.8).y == Approx(burley(albedo, r, 0.7, nl, 0.8).y).epsilon(1e-14));
      }
}

TEST_CASE("Burley: the numbers of its paper's formula, and how far it oversteps", "[shade][value]") {
  // Retroreflection at grazing incidence: (1 + (F90 - 1))^2 = F90^2, F90 = 1/2 + 2 r.
  CHECK(burley(vec3<double>(1.0), 1.0, 0.0, 0.0, 1.0).x * (quadrature::tau / 2) == Approx(6.25).epsilon(1e-6));
  CHECK(burley(vec3<double>(1.0), 0.3, 1.0, 1.0, 0.4).x * (quadrature::tau / 2) == Approx(1).epsilon(1e-6));
  double most = 0;
  for (double nv = 0.01; nv <= 1; nv += 0.03) {
    const vec3<double> v = viewer(nv);
    most = std::max(most, over_hemisphere(100, [&](const vec3<double>& l) {
                      return burley(vec3<double>(1.0), 1.0, l.z, nv, dot(v, normalize(v + l))).x * l.z;
                    }));
  }
  CHECK(most == Approx(1.54).epsilon(0.02));
}

TEST_CASE("Diffuse: all numbers agree and the slopes are right", "[shade][gradient]") {
  // Off the edges of oren_nayar: vl = nl nv, and nl = nv.
  const auto draw = [](Random& r) {
    for (;;) {
      const double nl = between(r, 0.05, 1), nv = between(r, 0.05, 1), vl = between(r, -0.9, 0.9);
      if (std::abs(vl - nl * nv) > 0.03 && std::abs(nl - nv) > 0.03)
        return std::tuple{vec3<double>(between(r, 0, 1), between(r, 0, 1), between(r, 0, 1)), between(r, 0.02, 1), nl,
                          nv, vl};
    }
  };
  const auto hard = corners::of([](const corners::Corner& k) {
    return std::tuple{k.surface.base_color, k.surface.base_diffuse_roughness, k.c, std::max(k.l.z, 0.0), dot(k.v, k.l)};
  });
  holds(
      "oren_nayar",
      [](const auto& a, auto r, auto nl, auto nv, auto vl) {
        const auto f = oren_nayar(a, r, nl, nv, vl);
        return f.x + 2.0f * f.y + 3.0f * f.z;
      },
      draw, {.rounding = 1e-5, .scale = 0.1}, hard);  // what crosses a rough surface at grazing is a difference near 0
  holds(
      "burley, lambert",
      [](const auto& a, auto r, auto nl, auto nv, auto vh) {
        const auto f = burley(a, r, nl, nv, vh) + lambert(a);
        return f.x + 2.0f * f.y + 3.0f * f.z;
      },
      draw, {.rounding = 1e-5, .scale = 1e-3}, hard);
}
