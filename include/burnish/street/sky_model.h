// burnish/street/sky_model.h -- clear skies of a few numbers: Preetham's, Hosek and Wilkie's, and the sun in them
// SPDX-License-Identifier: Apache-2.0
//
// World frame: +Y up, the sun a unit vector towards it. Turbidity: how hazy the air is; 2 very clear, 3 clear, 6 light
// haze, 10 haze. Radiance is linear RGB (Rec. 709, white D65), and smooth in everything but the horizon, where a
// direction below it is given what lies on it, and Hosek and Wilkie's whole turbidities, where the slope jumps.
#pragma once
#include <burnish/math/color.h>
#include <burnish/street/hosek_wilkie_table.h>

namespace burnish {

namespace detail {
/// The angle between unit vectors; at zero its slope is zero.
template <class T> constexpr T angle_between(const vec3<T>& a, const vec3<T>& b) {
  const vec3<T> c = cross(a, b);
  return atan2(sqrt(dot(c, c) + 1e-20f), dot(a, b));
}
/// Angle of the sun above the horizon, rad; at least 0.0006, for there the models end.
template <class T> constexpr T sun_elevation(const vec3<T>& sun) {
  return max(atan2(sun.y, sqrt(sun.x * sun.x + sun.z * sun.z + 1e-20f)), 6e-4f);
}
/// (1 + A e^(B / cos theta)) (1 + C e^(D gamma) + E cos^2 gamma), Perez, Seals and Michalsky (1993).
template <class T> constexpr T perez(const std::array<T, 5>& k, const T& cos_theta, const T& gamma) {
  const T c = cos(gamma);
  return (1.0f + k[0] * exp(k[1] / max(cos_theta, 1e-3f))) * (1.0f + k[2] * exp(k[3] * gamma) + k[4] * c * c);
}
}  // namespace detail

/// The sky of Preetham, Shirley and Smits (1999). Good for turbidities from 2 to 10.
template <class T> struct PreethamSky {
  T turbidity = 3.0f;
  vec3<T> sun = {0.0f, 0.8f, 0.6f};

  static constexpr auto parameters() {
    return std::tuple{Param{"turbidity", &PreethamSky::turbidity, Range{1.7f, 10}},
                      Param{"sun", &PreethamSky::sun, Range{-1, 1}}};
  }
};
/// Radiance from a unit direction, in kcd/m^2: its luminance() is that of the paper's appendix.
template <class T> constexpr vec3<T> clear_sky_radiance(const PreethamSky<T>& s, const vec3<same<T>>& d) {
  const T t = s.turbidity, z = 0.5f * pi - detail::sun_elevation(s.sun), gamma = detail::angle_between(s.sun, d);
  const std::array<T, 5> ky = {0.1787f * t - 1.4630f, -0.3554f * t + 0.4275f, -0.0227f * t + 5.3251f,
                               0.1206f * t - 2.5771f, -0.0670f * t + 0.3703f};
  const std::array<T, 5> kx = {-0.0193f * t - 0.2592f, -0.0665f * t + 0.0008f, -0.0004f * t + 0.2125f,
                               -0.0641f * t - 0.8989f, -0.0033f * t + 0.0452f};
  const std::array<T, 5> kv = {-0.0167f * t - 0.2608f, -0.0950f * t + 0.0092f, -0.0079f * t + 0.2102f,
                               -0.0441f * t - 1.6537f, -0.0109f * t + 0.0529f};
  const T z2 = z * z, z3 = z2 * z;
  const T zenith =
      (4.0453f * t - 4.9710f) * tan((4.0f / 9.0f - t * (1.0f / 120.0f)) * (pi - 2.0f * z)) - 0.2155f * t + 2.4192f;
  const T zenith_x = t * t * (0.00166f * z3 - 0.00375f * z2 + 0.00209f * z) +
                     t * (-0.02903f * z3 + 0.06377f * z2 - 0.03202f * z + 0.00394f) +
                     (0.11693f * z3 - 0.21196f * z2 + 0.06052f * z + 0.25886f);
  const T zenith_y = t * t * (0.00275f * z3 - 0.00610f * z2 + 0.00317f * z) +
                     t * (-0.04214f * z3 + 0.08970f * z2 - 0.04153f * z + 0.00516f) +
                     (0.15346f * z3 - 0.26756f * z2 + 0.06670f * z + 0.26688f);
  const auto part = [&](const std::array<T, 5>& k) {
    return detail::perez(k, d.y, gamma) / detail::perez(k, T(1.0f), z);
  };
  // For low suns and clear air the zenith's luminance falls below zero: held above.
  const T luminance_ = max(zenith, 0.05f) * part(ky), x = zenith_x * part(kx), y = zenith_y * part(kv);
  const T over = luminance_ / y;
  return rgb_from_xyz(vec3<T>(x * over, luminance_, (1.0f - x - y) * over));
}

/// The sky of Hosek and Wilkie (2012) in RGB. albedo: that of the ground.
template <class T> struct HosekWilkieSky {
  T turbidity = 3.0f, albedo = 0.2f;
  vec3<T> sun = {0.0f, 0.8f, 0.6f};

  static constexpr auto parameters() {
    return std::tuple{Param{"turbidity", &HosekWilkieSky::turbidity, Range{1, 10}},
                      Param{"albedo", &HosekWilkieSky::albedo, unit}, Param{"sun", &HosekWilkieSky::sun, Range{-1, 1}}};
  }
};
/// What of the model does not depend on the direction; made once, asked for many directions.
template <class T> struct HosekWilkieLobes {
  std::array<vec3<T>, 9> k;  ///< A .. F, G, I, H in the paper's equation 8
  vec3<T> radiance, sun;     ///< radiance in W / (m^2 sr) in the channel

  static constexpr auto parameters() {
    return std::tuple{Param{"k", &HosekWilkieLobes::k}, Param{"radiance", &HosekWilkieLobes::radiance},
                      Param{"sun", &HosekWilkieLobes::sun, Range{-1, 1}}};
  }
};
/// Linear in turbidity (between the whole ones) and albedo, a Bezier curve of degree five in the cube root of the sun's
/// elevation: as the paper's section 5 has it.
template <class T> constexpr HosekWilkieLobes<T> hosek_wilkie_lobes(const HosekWilkieSky<T>& s) {
  const T x = pow(detail::sun_elevation(s.sun) * (2.0f / pi), T(1.0f / 3.0f)), u = 1.0f - x, x2 = x * x, u2 = u * u;
  const std::array<T, 6> bezier = {u2 * u2 * u,         5.0f * u2 * u2 * x, 10.0f * u2 * u * x2,
                                   10.0f * u2 * x2 * x, 5.0f * u * x2 * x2, x2 * x2 * x};
  std::array<std::array<T, 10>, 3> sum;
  for (auto& channel : sum) channel.fill(T(0.0f));
  for (int t = 0; t < 10; ++t) {
    const T near = max(1.0f - abs(s.turbidity - float(t + 1)), 0.0f);
    for (int a = 0; a < 2; ++a) {
      for (std::size_t i = 0; i < 6; ++i) {
        const T weight = near * (a ? s.albedo : 1.0f - s.albedo) * bezier[i];
        for (std::size_t c = 0; c < 3; ++c) {
          for (std::size_t k = 0; k < 10; ++k) sum[c][k] += weight * detail::hosek_wilkie_table[t][a][i][c][k];
        }
      }
    }
  }
  HosekWilkieLobes<T> lobes;
  for (std::size_t k = 0; k < 9; ++k) lobes.k[k] = {sum[0][k], sum[1][k], sum[2][k]};
  lobes.radiance = {sum[0][9], sum[1][9], sum[2][9]};
  lobes.sun = s.sun;
  return lobes;
}
/// Radiance from a unit direction, W / (m^2 sr) in the channel; times 0.683 it is kcd/m^2 as Preetham's (equation 8).
template <class T> constexpr vec3<T> clear_sky_radiance(const HosekWilkieLobes<T>& s, const vec3<same<T>>& d) {
  const T up = max(d.y, 0.0f), gamma = detail::angle_between(s.sun, d), c = cos(gamma), root = sqrt(up + 1e-12f);
  const auto channel = [&](const T& A, const T& B, const T& C, const T& D, const T& E, const T& F, const T& G,
                           const T& I, const T& H, const T& radiance) {
    const T w = max(1.0f + H * H - 2.0f * H * c, 1e-6f);
    return (1.0f + A * exp(B / (up + 0.01f))) *
           (C + D * exp(E * gamma) + F * c * c + G * (1.0f + c * c) / (w * sqrt(w)) + I * root) * radiance;
  };
  const auto& k = s.k;
  return {channel(k[0].x, k[1].x, k[2].x, k[3].x, k[4].x, k[5].x, k[6].x, k[7].x, k[8].x, s.radiance.x),
          channel(k[0].y, k[1].y, k[2].y, k[3].y, k[4].y, k[5].y, k[6].y, k[7].y, k[8].y, s.radiance.y),
          channel(k[0].z, k[1].z, k[2].z, k[3].z, k[4].z, k[5].z, k[6].z, k[7].z, k[8].z, s.radiance.z)};
}
template <class T> constexpr vec3<T> clear_sky_radiance(const HosekWilkieSky<T>& s, const vec3<same<T>>& d) {
  return clear_sky_radiance(hosek_wilkie_lobes(s), d);
}

/// What the sun gives a surface that faces it, through clear air of that turbidity, klx as linear RGB: the
/// attenuation by molecules, haze and ozone of Preetham's appendix A.1 at seven wavelengths, the sun a black body of
/// 5778 K (126 klx above the air), seen by the eye of CIE 1931 (Wyman, Sloan and Shirley's curves, 2013). At the
/// horizon and below it is what the horizon has.
template <class T> constexpr vec3<T> sun_irradiance(const T& turbidity, const vec3<same<T>>& sun) {
  constexpr float wavelength[7] = {0.40f, 0.45f, 0.50f, 0.55f, 0.60f, 0.65f, 0.70f};  // micrometres
  constexpr float ozone[7] = {0, 0.003f, 0.030f, 0.085f, 0.125f, 0.067f, 0.023f};     // per cm; there are 0.35 cm
  constexpr float rgb[3][7] = {{2.771f, 2.475f, -34.742f, 5.017f, 111.225f, 50.225f, 2.805f},
                               {-2.508f, -4.971f, 42.091f, 74.873f, 17.347f, -3.516f, -0.047f},
                               {19.195f, 85.333f, 23.605f, -7.905f, -4.416f, -0.581f, -0.051f}};
  const T elevation = detail::sun_elevation(sun);
  // Relative path through the air (Kasten); beta is Angstrom's turbidity.
  const T path = 1.0f / (sin(elevation) + 0.15f * pow(elevation * (180 / pi) + 3.885f, T(-1.253f)));
  const T beta = max(0.04608f * turbidity - 0.04586f, 0.0f);
  T sum[3] = {T(0.0f), T(0.0f), T(0.0f)};
  for (int i = 0; i < 7; ++i) {
    const float l = wavelength[i];
    const T through =
        exp(-path * (0.008735f * float(detail::constant::exp(-4.08 * detail::constant::log(l))) +
                     beta * float(detail::constant::exp(-1.3 * detail::constant::log(l))) + 0.35f * ozone[i]));
    for (int c = 0; c < 3; ++c) sum[c] += rgb[c][i] * through;
  }
  return {sum[0], sum[1], sum[2]};
}

}  // namespace burnish
