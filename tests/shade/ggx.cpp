// tests/shade/ggx.cpp -- the laws of burnish/shade/ggx.h
// SPDX-License-Identifier: Apache-2.0
#include <burnish/shade/ggx.h>
#include <differences.h>
#include "corners.h"
#include "quadrature.h"
using namespace differences;
using quadrature::over_half_vectors;
using quadrature::tau;
using quadrature::viewer;

namespace {
/// Integral over the upper half of h of f(h), midpoints in ln tan(theta); no formula of the lobe is in it.
template <class F> double over_normals(F f) {
  const int n = 4000, m = 64;
  double sum = 0;
  const double low = -16, high = 12, step = (high - low) / n;
  for (int i = 0; i < n; ++i) {
    const double t = std::exp(low + (i + 0.5) * step), c = 1 / std::sqrt(1 + t * t), s = t * c;
    double ring = 0;
    for (int j = 0; j < m; ++j)
      ring += f(vec3<double>(s * std::cos(tau * (j + 0.5) / m), s * std::sin(tau * (j + 0.5) / m), c));
    sum += ring / m * tau * s * s * c * step;  // d theta = s c d ln t
  }
  return sum;
}
const vec3<double> z(0, 0, 1);
}  // namespace

TEST_CASE("GGX: the projected microfacets cover the surface once", "[shade][energy]") {
  for (const double r : {0.0, 0.02, 0.05, 0.2, 0.5, 1.0})
    CHECK(over_normals([&](const vec3<double>& h) { return ggx_d(r, z, h) * h.z; }) == Approx(1).epsilon(1e-6));
}

TEST_CASE("GGX: the microfacets that a viewer sees cover what the viewer sees", "[shade][energy]") {
  for (const double r : {0.1, 0.4, 1.0})
    for (const double nv : {0.2, 0.6, 0.95}) {
      const vec3<double> v = viewer(nv);
      const auto seen = [&](const vec3<double>& h) {
        return ggx_g1(r, nv) * std::max(dot(v, h), 0.0) * ggx_d(r, z, h);
      };
      CHECK(over_normals(seen) == Approx(nv).epsilon(2e-4));
      const auto pdf = [&](const vec3<double>& h) { return ggx_visible_normal_pdf(r, nv, dot(v, h), ggx_d(r, z, h)); };
      CHECK(over_normals(pdf) == Approx(1).epsilon(2e-4));
    }
}

TEST_CASE("GGX: visibility is masking over 4 nl nv, symmetric, and correlation lets more through",
          "[shade][symmetry]") {
  for (const double r : {0.02, 0.3, 0.8})
    for (const double nl : {0.05, 0.5, 1.0})
      for (const double nv : {0.1, 0.7, 1.0}) {
        const double separable = ggx_v_smith_separable(r, nl, nv), correlated = ggx_v_smith_correlated(r, nl, nv);
        CHECK(separable == Approx(ggx_g1(r, nl) * ggx_g1(r, nv) / (4 * nl * nv)).epsilon(1e-12));
        // Heitz 2014: G2 = 1 / (1 + Lambda(v) + Lambda(l)), G1 = 1 / (1 + Lambda).
        const double g2 = 1 / (1 / ggx_g1(r, nl) + 1 / ggx_g1(r, nv) - 1);
        CHECK(correlated == Approx(g2 / (4 * nl * nv)).epsilon(1e-12));
        CHECK(correlated == ggx_v_smith_correlated(r, nv, nl));
        CHECK(correlated >= separable);
      }
  CHECK(ggx_g1(0.5, 0.0) == 0);
  CHECK(ggx_g1(0.5, 1.0) == 1);
}

TEST_CASE("GGX: in float the sharpest lobe keeps its digits", "[shade][agreement]") {
  for (const float r : {0.02f, 0.05f})
    for (const float part : {0.3f, 1.0f, 3.0f}) {  // of the lobe's half width
      const float angle = part * r * r, x = 0.6f * std::sin(angle), y = 0.8f * std::sin(angle);
      const vec3<float> h(x, y, std::cos(angle)), n(0, 0, 1);
      const double exact = ggx_d(double(r), z, vec3<double>(x, y, std::sqrt(1 - double(x) * x - double(y) * y)));
      CHECK(ggx_d(r, n, h) == Approx(exact).epsilon(1e-5));
      // The usual form, 1 - nh^2 (1 - alpha^2), has lost them.
      const float a2 = r * r * r * r, k = 1 - h.z * h.z * (1 - a2);
      if (r < 0.03f) CHECK(std::abs(a2 * inverse_pi / (k * k) / float(exact) - 1) > 1e-2f);
    }
}

TEST_CASE("GGX: samples of visible normals follow their density", "[shade][value]") {
  for (const double r : {0.1, 0.4, 1.0})
    for (const double nv : {0.15, 0.8, 1.0}) {
      const vec3<double> v = viewer(nv);
      vec3<double> mean(0.0), exact(0.0);
      double reflected = 0;
      const int n = 400;
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const vec3<double> h = ggx_sample_visible_normal(r, v, vec2<double>((i + 0.5) / n, (j + 0.5) / n));
          const double vh = dot(v, h), nl = 2 * vh * h.z - nv;
          mean = mean + h / double(n * n);
          if (nl > 0) reflected += ggx_v_smith_separable(r, nl, nv) * 4 * nl * nv / ggx_g1(r, nv) / (n * n);
        }
      const auto pdf = [&](const vec3<double>& h) { return ggx_visible_normal_pdf(r, nv, dot(v, h), ggx_d(r, z, h)); };
      exact = {over_normals([&](const vec3<double>& h) { return pdf(h) * h.x; }), 0,
               over_normals([&](const vec3<double>& h) { return pdf(h) * h.z; })};
      CHECK(length(mean - exact) < 1e-3);
      // What a white separable lobe reflects, by samples of visible and of all normals.
      const double all = over_half_vectors(r, v, 300, [&](const vec3<double>& l, const vec3<double>& h) {
        return ggx_d(r, z, h) * ggx_v_smith_separable(r, l.z, nv) * l.z;
      });
      CHECK(reflected == Approx(all).epsilon(5e-3));
    }
}

TEST_CASE("GGX: below the least roughness nothing changes, at it the slope is the lobe's", "[shade][limit]") {
  CHECK(ggx_d(0.0, z, z) == ggx_d(double(min_roughness), z, z));
  const auto peak = [](auto r) { return ggx_d(r, 1.0f, 0.0f); };
  CHECK(std::get<1>(differentiate(peak, 0.01)) == 0);
  const auto [y, slope] = differentiate(peak, double(min_roughness));
  CHECK(slope == Approx(-4 * y / double(min_roughness)).epsilon(1e-9));  // D(peak) = 1 / (pi r^4)
}

TEST_CASE("GGX: all numbers agree and the slopes are right", "[shade][gradient]") {
  using corners::Corner;
  const How fine{.rounding = 1e-5, .scale = 1e-3};
  const auto lobe = [](Random& r) {
    const double nh = between(r, 0.3, 0.999);
    return std::tuple{between(r, 0.1, 1), nh, 1 - nh * nh};
  };
  const auto three = [](Random& r) { return std::tuple{between(r, 0.1, 1), between(r, 0.05, 1), between(r, 0.05, 1)}; };
  holds(
      "ggx_d", [](auto r, auto nh, auto sin2) { return ggx_d(r, nh, sin2); }, lobe, fine,
      corners::of([](const Corner& k) {
        return std::tuple{k.surface.specular_roughness, k.c, 1 - k.c * k.c};
      }));
  const auto by_vectors = [](auto r, const auto& n, const auto& h) { return ggx_d(r, n, h); };
  const auto halfway = corners::of([](const Corner& k) {
    const vec3<double> h = k.v + k.l;  // 0 where they are opposite
    return std::tuple{k.surface.specular_roughness, z, length(h) > 0 ? normalize(h) : h};
  });
  holds(
      "ggx_d", by_vectors,
      [](Random& r) {
        return std::tuple{between(r, 0.3, 1), upward(r, 0.5), upward(r, 0.5)};
      },
      fine, halfway);
  // A sharp lobe, inside of it, in steps that it can bear.
  holds("ggx_d", by_vectors,
        [](Random& r) {
          const double rough = between(r, 0.03, 0.3), a = rough * rough, x = a * between(r, -1, 1),
                       y = a * between(r, -1, 1);
          return std::tuple{rough, vec3<double>(0, 0, 1), vec3<double>(x, y, std::sqrt(1 - x * x - y * y))};
        },
        {.rounding = 2e-5, .scale = 1e-3, .step = 1e-3});
  const auto seen = corners::of([](const Corner& k) {
    return std::tuple{k.surface.specular_roughness, k.c, std::max(k.l.z, 1e-4)};  // not both 0
  });
  holds(
      "ggx_g1", [](auto r, auto c, auto) { return ggx_g1(r, c); }, three, fine, seen);
  holds(
      "ggx_v_smith_separable", [](auto r, auto nl, auto nv) { return ggx_v_smith_separable(r, nl, nv); }, three, fine,
      corners::of([](const Corner& k) {
        return std::tuple{k.surface.specular_roughness, k.c, k.c};
      }));
  holds(
      "ggx_v_smith_correlated", [](auto r, auto nl, auto nv) { return ggx_v_smith_correlated(r, nl, nv); }, three, fine,
      seen);
  holds(
      "ggx_visible_normal_pdf", [](auto r, auto nv, auto vh) { return ggx_visible_normal_pdf(r, nv, vh, 2.0f * vh); },
      three, fine, seen);
  // Off the edges: v along the normal, u = 0, the rim of the disc.
  holds(
      "ggx_sample_visible_normal",
      [](auto r, const auto& v, const auto& u) {
        const auto h = ggx_sample_visible_normal(r, v, u);
        return h.x + 2.0f * h.y + 3.0f * h.z;
      },
      [](Random& r) {
        vec3<double> v = upward(r, 0.2);
        while (v.z > 0.95) v = upward(r, 0.2);
        return std::tuple{between(r, 0.1, 1), v, vec2<double>(between(r, 0.05, 0.9), between(r, 0.05, 0.95))};
      },
      {.rounding = 1e-5}, corners::of([](const Corner& k) {
        return std::tuple{k.surface.specular_roughness, vec3<double>(k.v.x, k.v.y, std::max(k.v.z, 1e-3)),
                          vec2<double>(k.c, k.surface.base_weight)};
      }));
}
