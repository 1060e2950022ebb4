// burnish/light/sun.h -- a small bright light as a spherical Gaussian, and its closed form through a GGX lobe
// SPDX-License-Identifier: Apache-2.0
//
// World frame: +Y up. Everything here is a smooth function of all its arguments, the light's direction included.
#pragma once
#include <cmath>
#include <burnish/math/vec.h>

namespace burnish {

/// A light infinitely far away whose radiance is power / (2 pi variance) exp(-angle^2 / (2 variance)).
template <class T> struct Sun {
  vec3<T> direction = {0.0f, 1.0f, 0.0f};  // unit, from the surface to the light
  vec3<T> power = {1.0f, 1.0f, 1.0f};      // radiance x solid angle: the irradiance of a surface that faces it
  T variance = 5.4e-6f;                    // per axis, rad^2; the default is that of the sun's disc
  T index = 0.0f;                          // its place in the list of suns: by it its shadow is found; not to be fitted

  static constexpr auto parameters() {
    return std::tuple{Param{"direction", &Sun::direction, Range{-1, 1}}, Param{"power", &Sun::power, Range{0, 1e6f}},
                      Param{"variance", &Sun::variance, Range{1e-7f, 0.1f}}, Param{"index", &Sun::index, Range{0, 0}}};
  }
};

/// Ray i of `count` towards a sun, spread as its Gaussian is, along a golden spiral.
inline vec3<float> sun_ray(const Sun<float>& s, int i, int count) {
  const vec3<float>& d = s.direction;
  const vec3<float> x = normalize(cross(std::abs(d.y) < 0.9f ? vec3<float>(0, 1, 0) : vec3<float>(1, 0, 0), d)),
                    y = cross(d, x);
  const float u = (float(i) + 0.5f) / float(count), r = std::sqrt(-2 * s.variance * std::log(1 - u)),
              a = 2.3999632f * float(i);
  return normalize(d + x * (r * std::cos(a)) + y * (r * std::sin(a)));
}

/// The GGX density D (per steradian of half vectors) at the half vector of v and l, averaged over a Gaussian light of
/// that variance (rad^2 per axis) around l: what replaces D when the light is no point. n, v, l unit; 0 < roughness <=
/// 1 is perceptual. Finite for every direction; dot(n, l) <= 0 means nothing and must be masked by the caller.
///
/// In slopes m = h_xy / h_z GGX is a mixture of Gaussians, alpha^2/pi / (alpha^2 + m^2)^2 =
/// int e^-t N(m; alpha^2/(2t) I) dt (Student's t), and the light adds its covariance S = variance J J^T, J = d m / d l,
/// to each of them. The integral by t is a 5-node Gauss-Laguerre rule in t beta, where beta makes it exact in both
/// limits, light << lobe and lobe << light. Between them it is off by up to 7 % of its peak (measured; light and lobe
/// alike, three widths out). For variances up to 1e-3: the light is taken as flat, and beyond that it bends.
template <class T>
constexpr T ggx_d_spot(const vec3<T>& n, const vec3<T>& v, const vec3<T>& l, const T& roughness, const T& variance) {
  constexpr float node[5] = {0.263560320f, 1.413403059f, 3.596425771f, 7.085810006f, 12.64080084f};
  constexpr float weight[5] = {0.521755611f, 0.398666811f, 0.0759424497f, 0.00361175868f, 2.33699724e-5f};
  const T a2 = (roughness * roughness) * (roughness * roughness);
  const vec3<T> sum = v + l;
  const T up = max(dot(n, sum), 1e-3f), over = 1.0f / up, nl = dot(n, l);
  const vec3<T> across = cross(cross(n, sum), n);  // the part of v + l in the plane: no difference of large numbers
  const vec3<T> m = across * over;
  // S = k X, and all that is needed of X are three invariants, each a sum of positive numbers: trace and determinant
  // (the last by the change of solid angle, dl = 4 vh dh), and m^T adj(X) m.
  const T k = variance * over * over, m2 = dot(m, m), ml = dot(m, l), size2 = dot(sum, sum), root = 0.5f * size2 * over;
  const T trace = 1.0f + nl * nl + m2 * (1.0f - nl * nl) + 2.0f * nl * ml, across_m = m2 * nl * nl + ml * ml;
  const T along = k * max(trace - across_m / (m2 + 1e-12f), 0.0f);  // variance of the light in the direction of m
  // beta = 1 + m2 / (a2 + 2 along / beta), the root above 1, written for either sign of p so that nothing cancels.
  const T p = a2 + m2 - 2.0f * along, s = sqrt(p * p + 8.0f * a2 * along);
  const T beta = max(select(p > 0.0f, (p + s) / (2.0f * a2), 4.0f * along / max(s - p, 1e-30f)), 1.0f),
          slower = 1.0f / beta;
  T density = 0.0f;
  for (int i = 0; i < 5; ++i) {
    const T t = node[i] * slower, b = 2.0f * t * k, det = a2 * a2 + b * (a2 * trace + b * root * root);
    const T exponent = (a2 * m2 + b * across_m) / det;
    density += weight[i] * t * rsqrt(det) * exp(node[i] - t * (1.0f + exponent));
  }
  const T h_z2 = size2 * over * over;  // 1 / cos^2 of the half vector
  return density * slower * inverse_pi * (h_z2 * h_z2);
}

}  // namespace burnish
