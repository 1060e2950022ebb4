// tests/shade/quadrature.h -- hemisphere integrals of the layered reflection in double, by rules that share no code
// with it SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <burnish/shade/brdf.h>

namespace quadrature {
using namespace burnish;
using Vec = vec3<double>;
inline constexpr double tau = 6.283185307179586;

inline Vec direction(double c, double phi) {
  const double s = std::sqrt(1 - c * c);
  return {s * std::cos(phi), s * std::sin(phi), c};
}
/// The viewer, in the xz plane around the normal z.
inline Vec viewer(double nv) { return direction(nv, 0); }

/// Integral of f(h, density of h) over half vectors, midpoints of GGX's own distribution; f gives the integrand per
/// steradian of l and is given l as well. Light from below gives nothing.
template <class F> auto over_half_vectors(double roughness, const Vec& v, int n, F f) {
  const double alpha = std::max(roughness, 0.02) * std::max(roughness, 0.02);
  decltype(f(v, v)) sum{};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double u = (i + 0.5) / n, tan2 = alpha * alpha * u / (1 - u), c = 1 / std::sqrt(1 + tan2);
      const Vec h = direction(c, tau * (j + 0.5) / n);
      const double vh = dot(v, h);
      const Vec l = h * (2 * vh) - v;
      if (vh <= 0 || l.z <= 0) continue;
      const double k = 1 + (alpha * alpha - 1) * c * c, d = alpha * alpha * 2 / (tau * k * k);
      sum = sum + f(l, h) * (4 * vh / (d * c * n * n));
    }
  return sum;
}
/// Integral of f(l) over the hemisphere, midpoints in l.z and azimuth.
template <class F> auto over_hemisphere(int n, F f) {
  decltype(f(Vec())) sum{};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) sum = sum + f(direction((i + 0.5) / n, tau * (j + 0.5) / n)) * (tau / (n * n));
  return sum;
}

/// The reflected share of a white sky, rgb: coat, specular and diffuse, each by the rule that suits it. radiance(l) may
/// stand in for the white sky.
template <class L> Vec reflected_light(const Surface<double>& s, double nv, int n, L radiance) {
  const Vec v = viewer(nv), z(0, 0, 1);
  const Layers<double> a = layers(s);
  const auto at = [&](const Vec& l, double base, double coat) {
    const Vec h = normalize(v + l);
    return brdf_cos_with(a, Cosines<double>{l.z, nv, l.z, nv, dot(v, h)}, base * ggx_d(a.base_roughness, z, h),
                         coat * ggx_d(a.coat_roughness, z, h));
  };
  const Vec diffuse = over_hemisphere(n, [&](const Vec& l) { return at(l, 0, 0) * radiance(l); });
  const Vec base = over_half_vectors(
      a.base_roughness, v, n, [&](const Vec& l, const Vec&) { return (at(l, 1, 0) - at(l, 0, 0)) * radiance(l); });
  const Vec coat = over_half_vectors(
      a.coat_roughness, v, n, [&](const Vec& l, const Vec&) { return (at(l, 0, 1) - at(l, 0, 0)) * radiance(l); });
  return diffuse + base + coat;
}
inline Vec albedo(const Surface<double>& s, double nv, int n) {
  return reflected_light(s, nv, n, [](const Vec&) { return 1.0; });
}
}  // namespace quadrature
