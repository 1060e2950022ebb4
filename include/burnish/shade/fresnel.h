// burnish/shade/fresnel.h -- how much an interface reflects
// SPDX-License-Identifier: Apache-2.0
//
// c is the cosine between the direction and the (micro)normal, 0 <= c <= 1. All are smooth in every argument but for
// the edges named.
#pragma once
#include <burnish/math/vec.h>

namespace burnish {

/// (1 - c)^5: the way from f0 to f90 (Schlick 1994).
template <class T> constexpr T schlick_weight(const T& c) {
  const T m = 1.0f - c, m2 = m * m;
  return m2 * m2 * m;
}
/// f0 at normal, f90 at grazing incidence (Schlick 1994). T or vec3<T>.
template <class T> constexpr T fresnel_schlick(const T& c, const same<T>& f0, const same<T>& f90 = T(1.0f)) {
  return f0 + (f90 - f0) * schlick_weight(c);
}
template <class T>
constexpr vec3<T> fresnel_schlick(const T& c, const vec3<same<T>>& f0, const vec3<same<T>>& f90 = vec3<T>(T(1.0f))) {
  return f0 + (f90 - f0) * schlick_weight(c);
}

/// Reflectance at normal incidence of a dielectric, ior = n_t / n_i > 0.
template <class T> constexpr T f0_from_ior(const T& ior) {
  const T r = (ior - 1.0f) / (ior + 1.0f);
  return r * r;
}
/// The f90 that belongs to a dielectric's f0: 1 from f0 = 0.02 on (ior 1.33), and 0 for f0 = 0, so that an interface
/// that is none reflects nothing at grazing incidence either. Second derivatives jump at both ends.
template <class T> constexpr T f90_from_f0(const T& f0) { return smoothstep(0.0f, 0.02f, f0); }

/// Exact, unpolarised (Fresnel 1823). eta = n_t / n_i; below 1, light meets the interface from the denser side and is
/// totally reflected for 1 - c^2 >= eta^2: 1 is returned, slope 0. On the near side of that edge the slope is infinite;
/// within 1e-8 of it (in the square of the refracted cosine) the refracted cosine is held.
template <class T> constexpr T fresnel_dielectric(const T& c, const same<T>& eta) {
  const T t2 = 1.0f - (1.0f - c * c) / (eta * eta), t = sqrt(max(t2, 1e-8f));
  const T s = (c - eta * t) / (c + eta * t), p = (eta * c - t) / (eta * c + t);
  return select(t2 > 0.0f, 0.5f * (s * s + p * p), T(1.0f));
}

/// Exact, unpolarised, of a metal with complex index eta + i k relative to the outside (Born & Wolf 1999, 14.2).
/// Edge: k = 0 with eta^2 = 1 - c^2, where total reflection begins; nearer to it than 1e-10 value and slopes are
/// finite, but no more than that.
template <class T> constexpr T fresnel_conductor(const T& c, const same<T>& eta, const same<T>& k) {
  const T c2 = c * c, s2 = 1.0f - c2, e2 = eta * eta, k2 = k * k, q = e2 - k2 - s2, ek = 4.0f * e2 * k2;
  const T both = sqrt(max(q * q + ek, 1e-20f));
  // a^2 = (both + q) / 2 without its cancellation where q < 0.
  const T a2 = select(q > 0.0f, 0.5f * (both + q), 0.5f * ek / max(both - q, 1e-10f));
  const T x = 2.0f * c * sqrt(max(a2, 1e-20f));
  const T s = (both + c2 - x) / (both + c2 + x);
  const T p = s * (both * c2 + s2 * s2 - x * s2) / (both * c2 + s2 * s2 + x * s2);
  return 0.5f * (s + p);
}
template <class T> constexpr vec3<T> fresnel_conductor(const T& c, const vec3<same<T>>& eta, const vec3<same<T>>& k) {
  return {fresnel_conductor(c, eta.x, k.x), fresnel_conductor(c, eta.y, k.y), fresnel_conductor(c, eta.z, k.z)};
}

/// Metal by two colours: f0 at normal incidence, and tint times Schlick's curve at c = 1/7, about 82 degrees (Kutz,
/// Hasan and Edmondson 2021; OpenPBR 1.1). tint 1 is Schlick. Kept above 0 by an edge that only a tint below about 0.5
/// reaches.
template <class T> constexpr T fresnel_f82(const T& c, const same<T>& f0, const same<T>& tint) {
  constexpr float weight_at = 0.462664366f, shape_at = 0.0566527796f;  // (6/7)^5, (6/7)^6 / 7
  const T edge = (f0 + (1.0f - f0) * weight_at) * (1.0f - tint), m = 1.0f - c, w = schlick_weight(c);
  return max(f0 + (1.0f - f0) * w - edge * (1.0f / shape_at) * (c * w * m), 0.0f);
}
template <class T> constexpr vec3<T> fresnel_f82(const T& c, const vec3<same<T>>& f0, const vec3<same<T>>& tint) {
  return {fresnel_f82(c, f0.x, tint.x), fresnel_f82(c, f0.y, tint.y), fresnel_f82(c, f0.z, tint.z)};
}

/// The mean of fresnel_dielectric over the hemisphere, cosine-weighted: a fit of our own, within 0.5 % relative for
/// 1.02 <= ior <= 3, and 0 at 1.
template <class T> constexpr T fresnel_average(const T& ior) {
  const T x = ior - 1.0f;
  return x * (0.32306f + 1.11142f * x) / (1.0f + x * (7.18273f + 0.75438f * x));
}

}  // namespace burnish
