// burnish/light/sky.h -- a soft sky of a few numbers, to be fitted: spherical harmonics
// SPDX-License-Identifier: Apache-2.0
//
// World frame: +Y up, and the harmonics' pole is +Y. Coefficients are linear RGB radiance x sr^(1/2), the l-th band's
// m-th harmonic named l<l>m<m>, n for minus: l2mn1. A sum of harmonics rings: near a bright light's far side it may be
// negative.
#pragma once
#include <burnish/light/environment.h>
#include <burnish/math/sh.h>

namespace burnish {

/// Bands 0 to 2: irradiance to 1 .. 4 % of what real skies without their sun give (Ramamoorthi and Hanrahan 2001).
template <class T> struct HarmonicSky2 {
  static constexpr int order = 2;
  vec3<T> l0m0 = vec3<T>(T(3.5449077f));  // radiance 1 from everywhere
  vec3<T> l1mn1, l1m0, l1m1, l2mn2, l2mn1, l2m0, l2m1, l2m2;

  static constexpr auto parameters() {
    using S = HarmonicSky2;
    return std::tuple{Param{"l0m0", &S::l0m0}, Param{"l1mn1", &S::l1mn1}, Param{"l1m0", &S::l1m0},
                      Param{"l1m1", &S::l1m1}, Param{"l2mn2", &S::l2mn2}, Param{"l2mn1", &S::l2mn1},
                      Param{"l2m0", &S::l2m0}, Param{"l2m1", &S::l2m1},   Param{"l2m2", &S::l2m2}};
  }
};
/// Bands 0 to 4: irradiance to 0.5 .. 2 %.
template <class T> struct HarmonicSky4 {
  static constexpr int order = 4;
  vec3<T> l0m0 = vec3<T>(T(3.5449077f));
  vec3<T> l1mn1, l1m0, l1m1, l2mn2, l2mn1, l2m0, l2m1, l2m2, l3mn3, l3mn2, l3mn1, l3m0, l3m1, l3m2, l3m3;
  vec3<T> l4mn4, l4mn3, l4mn2, l4mn1, l4m0, l4m1, l4m2, l4m3, l4m4;

  static constexpr auto parameters() {
    using S = HarmonicSky4;
    return std::tuple{
        Param{"l0m0", &S::l0m0},   Param{"l1mn1", &S::l1mn1}, Param{"l1m0", &S::l1m0},   Param{"l1m1", &S::l1m1},
        Param{"l2mn2", &S::l2mn2}, Param{"l2mn1", &S::l2mn1}, Param{"l2m0", &S::l2m0},   Param{"l2m1", &S::l2m1},
        Param{"l2m2", &S::l2m2},   Param{"l3mn3", &S::l3mn3}, Param{"l3mn2", &S::l3mn2}, Param{"l3mn1", &S::l3mn1},
        Param{"l3m0", &S::l3m0},   Param{"l3m1", &S::l3m1},   Param{"l3m2", &S::l3m2},   Param{"l3m3", &S::l3m3},
        Param{"l4mn4", &S::l4mn4}, Param{"l4mn3", &S::l4mn3}, Param{"l4mn2", &S::l4mn2}, Param{"l4mn1", &S::l4mn1},
        Param{"l4m0", &S::l4m0},   Param{"l4m1", &S::l4m1},   Param{"l4m2", &S::l4m2},   Param{"l4m3", &S::l4m3},
        Param{"l4m4", &S::l4m4}};
  }
};

namespace detail {
/// 2 pi int_0^1 c (1 - c)^power P_l(c) dc, l <= 4: what the lobe c (1 - c)^power makes of band l. Exact, by Beta
/// integrals.
constexpr float zonal(int l, int power) {
  constexpr double legendre[5][5] = {
      {1, 0, 0, 0, 0}, {0, 1, 0, 0, 0}, {-0.5, 0, 1.5, 0, 0}, {0, -1.5, 0, 2.5, 0}, {0.375, 0, -3.75, 0, 4.375}};
  double sum = 0;
  for (int i = 0; i <= l; ++i) sum += legendre[l][i] * factorial(i + 1) * factorial(power) / factorial(i + 2 + power);
  return float(6.283185307179586 * sum);
}
/// sum over the sky's coefficients of factor(band) harmonic(d) coefficient.
template <template <class> class Sky, class T, class F>
constexpr vec3<T> harmonic_sum(const Sky<T>& sky, const vec3<same<T>>& d, F factor) {
  const auto y = spherical_harmonics<Sky<T>::order>(vec3<T>(d.z, d.x, d.y));  // their z is our y
  vec3<T> sum;
  const auto add = [&](const vec3<T>& coefficient, int i) {
    int l = 0;
    while ((l + 1) * (l + 1) <= i) ++l;
    sum += coefficient * (y[std::size_t(i)] * factor(l));
  };
  std::apply(
      [&](auto... p) {
        int i = 0;
        (add(sky.*(p.member), i++), ...);
      },
      Sky<T>::parameters());
  return sum;
}
}  // namespace detail

/// Radiance from a unit world direction.
template <template <class> class Sky, class T>
constexpr vec3<T> sky_radiance(const Sky<T>& sky, const vec3<same<T>>& d) {
  return detail::harmonic_sum(sky, d, [](int) { return 1.0f; });
}
/// int L nl (1 - nl)^(5k) over directions l for the unit world normal n, k = 0, 1, 2: the irradiance, and E5 and E10 of
/// Moments (shade/brdf.h). Exact for this sky.
template <int K = 0, template <class> class Sky, class T>
constexpr vec3<T> sky_irradiance(const Sky<T>& sky, const vec3<same<T>>& n) {
  static_assert(K >= 0 && K <= 2);
  return detail::harmonic_sum(sky, n, [](int l) { return detail::zonal(l, 5 * K); });
}
/// The least-squares sky of an environment. suns: whether they are in it, each as a point.
template <template <class> class Sky> Sky<float> project_sky(const EnvironmentLight& e, bool suns = false) {
  std::array<vec3<double>, std::size_t(sh_count(Sky<float>::order))> sum{};
  const auto add = [&](const vec3<double>& d, const vec3<double>& power) {
    const auto y = spherical_harmonics<Sky<float>::order>(vec3<double>(d.z, d.x, d.y));
    for (std::size_t i = 0; i < y.size(); ++i) sum[i] += power * y[i];
  };
  for (int y = 0; y < e.map.height; ++y) {
    const double area = detail::texel_area(e.map.width, e.map.height, y);
    for (int x = 0; x < e.map.width; ++x) {
      add(turned(latlong_direction((x + 0.5) / e.map.width, (y + 0.5) / e.map.height), double(e.yaw)),
          vec3<double>(e.map.at(x, y)) * area);
    }
  }
  for (const Sun<float>& s : e.suns) {
    if (suns) add(vec3<double>(s.direction), vec3<double>(s.power));
  }
  Sky<float> sky;
  std::apply(
      [&](auto... p) {
        std::size_t i = 0;
        ((sky.*(p.member) = vec3<float>(sum[i++])), ...);
      },
      Sky<float>::parameters());
  return sky;
}

}  // namespace burnish
