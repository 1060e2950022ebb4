// burnish/shade/diffuse.h -- diffuse reflection
// SPDX-License-Identifier: Apache-2.0
//
// All return f_r per steradian, without the cosine. albedo is linear RGB in [0, 1], roughness in [0, 1].
#pragma once
#include <burnish/math/vec.h>
#include <burnish/shade/fresnel.h>

namespace burnish {

template <class T> constexpr vec3<T> lambert(const vec3<T>& albedo) { return albedo * T(inverse_pi); }

namespace detail {
/// 1/2 - 2/(3 pi), and 2/3 - 28/(15 pi).
inline constexpr float fon_1 = 0.287793409f, fon_2 = 0.0724882124f;
/// fon_1 minus Fujii's albedo curve G / pi by the cosine: the fit of Portsmouth et al. 2025, its last coefficient moved
/// by 5e-4 so that it is exact at c = 0; 0 there and positive above.
template <class T> constexpr T fon_rest(const T& c) {
  const T m = 1.0f - c;
  return fon_1 - m * (0.0571085289f + m * (0.491881867f + m * (-0.332181442f + m * 0.0709844551f)));
}
}  // namespace detail

/// Rough diffuse after Oren and Nayar that keeps its energy: EON (Portsmouth, Kutz and Hill 2025). Its albedo is
/// exactly `albedo` at 1, darker and more saturated in between; roughness 0 is exactly lambert. Their
/// multiple-scattering term is written so that no 0/0 is left at roughness 0. nl, nv >= 0. Edges: vl = nl nv and, where
/// vl > nl nv, nl = nv.
template <class T> constexpr vec3<T> oren_nayar(const vec3<T>& albedo, const same<T>& roughness, const same<T>& nl,
                                                const same<T>& nv, const same<T>& vl) {
  const T s = vl - nl * nv, st = select(s > 0.0f, s / max(max(nl, nv), 1e-4f), s);
  const T a = 1.0f / (1.0f + detail::fon_1 * roughness);
  const T mean = a * (1.0f + detail::fon_2 * roughness);
  const T once = a * (1.0f + roughness * st);
  const T again =
      roughness * a * detail::fon_rest(nl) * detail::fon_rest(nv) * (1.0f / (detail::fon_1 - detail::fon_2));
  const vec3<T> tint = albedo * mean / (vec3<T>(T(1.0f)) - albedo * (1.0f - mean));
  return albedo * (vec3<T>(once) + tint * again) * T(inverse_pi);
}

/// Burley 2012, section 5.3. Not bounded: at roughness 1 a white surface seen grazing reflects up to 1.5 times what it
/// gets.
template <class T> constexpr vec3<T> burley(const vec3<T>& albedo, const same<T>& roughness, const same<T>& nl,
                                            const same<T>& nv, const same<T>& vh) {
  const T f90 = 0.5f + 2.0f * roughness * vh * vh;
  return albedo * (T(inverse_pi) * fresnel_schlick(nl, T(1.0f), f90) * fresnel_schlick(nv, T(1.0f), f90));
}

}  // namespace burnish
