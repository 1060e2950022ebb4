// burnish/shade/principled.h -- the principled BRDF with Disney's parameters, as Mitsuba 3 evaluates it
// SPDX-License-Identifier: Apache-2.0
//
// Burley 2012, with names and formulas of Mitsuba 3.9.1's `principled` where they differ. For scenes and fits that come
// from or go to such a renderer; the library's own material is Surface with brdf.h. Reflection from the front only: no
// spec_trans, and black where v or l is below the horizon. A sum of lobes; nothing is taken from one for another.
//   base       F D G1(v) G1(l) / (4 nv), anisotropic GGX, alpha_x = max(.001, roughness^2 / aspect), alpha_y =
//              max(.001, roughness^2 aspect), aspect = sqrt(1 - .9 anisotropic). Burley's G has a roughness of its own
//   F          (1 - metallic) ((1 - spec_tint) F_dielectric(vh, ior) + spec_tint Schlick(tint F0)) + metallic
//              Schlick(base_color); F0 = .08 specular, the ior is the one it belongs to. Burley has one Schlick curve
//   diffuse    (1 - metallic) base_color / pi times Burley's, flatness being his subsurface
//   sheen      (1 - metallic) sheen mix(1, tint, sheen_tint) (1 - vh)^5, as Burley
//   clearcoat  clearcoat / 4 Schlick(.04) GTR1 G1(v) G1(l), alpha = mix(.1, .001, clearcoat_gloss) in GTR1 and .25 in
//              G1. Burley, as microfacets must, divides by 4 nl nv; Mitsuba does not: principled_cos is Mitsuba's,
//              principled_normalized_cos Burley's
// tint is base_color / luminance, white for black. Of specular = 0 Mitsuba makes black whatever metallic is; here metal
// stays. Edges: alpha at .001 (roughness .03, or .056 fully anisotropic); specular below 1.25e-7 has no slope.
#pragma once
#include <burnish/shade/diffuse.h>

namespace burnish {

/// base_color is linear RGB, roughness perceptual; the axes of anisotropic are those of the tangent frame, the lobe
/// being wider along x.
template <class T> struct Principled {
  vec3<T> base_color = {0.5f, 0.5f, 0.5f};
  T roughness = 0.5f;
  T anisotropic = 0.0f;
  T metallic = 0.0f;
  T specular = 0.5f;
  T spec_tint = 0.0f;
  T sheen = 0.0f;
  T sheen_tint = 0.0f;
  T flatness = 0.0f;
  T clearcoat = 0.0f;
  T clearcoat_gloss = 0.0f;

  static constexpr auto parameters() {
    return std::tuple{Param{"base_color", &Principled::base_color, unit},
                      Param{"roughness", &Principled::roughness, Range{0.06f, 1}},
                      Param{"anisotropic", &Principled::anisotropic, unit},
                      Param{"metallic", &Principled::metallic, unit},
                      Param{"specular", &Principled::specular, unit},
                      Param{"spec_tint", &Principled::spec_tint, unit},
                      Param{"sheen", &Principled::sheen, unit},
                      Param{"sheen_tint", &Principled::sheen_tint, unit},
                      Param{"flatness", &Principled::flatness, unit},
                      Param{"clearcoat", &Principled::clearcoat, unit},
                      Param{"clearcoat_gloss", &Principled::clearcoat_gloss, unit}};
  }
};

namespace detail {
/// Smith's G1(v) / (2 v.z) of GGX with two alphas, squared, given.
template <class T> constexpr T smith_over_cosine(const vec3<T>& v, const T& ax2, const T& ay2) {
  return 1.0f / (v.z + sqrt(v.z * v.z + ax2 * v.x * v.x + ay2 * v.y * v.y));
}
template <class T> constexpr vec3<T> half_vector(const vec3<T>& v, const vec3<T>& l) {
  const vec3<T> sum = v + l;
  return sum * rsqrt(max(dot(sum, sum), 1e-12f));
}
/// 1 where both directions are above the horizon, else 0.
template <class T> constexpr T in_front(const vec3<T>& v, const vec3<T>& l) {
  return select(v.z > T(0.0f) && l.z > T(0.0f), T(1.0f), T(0.0f));
}
/// Both directions with z >= 1e-6: the side not taken must be finite, too.
template <class T> constexpr vec3<T> above(const vec3<T>& v) { return {v.x, v.y, max(v.z, 1e-6f)}; }
}  // namespace detail

/// All lobes but the clear coat: f_r times the cosine, per steradian. v to the viewer, l to the light, unit, in the
/// tangent frame.
template <class T>
constexpr vec3<T> principled_base_cos(const Principled<T>& p, const vec3<same<T>>& to_v, const vec3<same<T>>& to_l) {
  const vec3<T> white(T(1.0f)), v = detail::above<T>(to_v), l = detail::above<T>(to_l), h = detail::half_vector(v, l);
  const T nv = v.z, nl = l.z, vh = dot(v, h), grazing = schlick_weight(vh), dielectric = 1.0f - p.metallic;
  const T y = 0.212671f * p.base_color.x + 0.715160f * p.base_color.y + 0.072169f * p.base_color.z;
  const auto lit = y > T(0.0f);
  const vec3<T> per_y = p.base_color * (1.0f / select(lit, y, T(1.0f)));
  const vec3<T> tint{select(lit, per_y.x, T(1.0f)), select(lit, per_y.y, T(1.0f)), select(lit, per_y.z, T(1.0f))};

  const T f0 = 0.08f * p.specular, root = sqrt(max(f0, 1e-8f)), ior = (1.0f + root) / (1.0f - root);
  const vec3<T> f = white * (dielectric * (1.0f - p.spec_tint) * fresnel_dielectric(vh, ior)) +
                    fresnel_schlick(vh, tint * f0) * (dielectric * p.spec_tint) +
                    fresnel_schlick(vh, p.base_color) * p.metallic;
  const T a = p.roughness * p.roughness, aspect = sqrt(1.0f - 0.9f * p.anisotropic);
  const T ax = max(T(0.001f), a / aspect), ay = max(T(0.001f), a * aspect), x = h.x / ax, z = h.y / ay;
  const T k = x * x + z * z + h.z * h.z, d = T(inverse_pi) / (ax * ay * k * k);
  const T g = detail::smith_over_cosine(v, ax * ax, ay * ay) * detail::smith_over_cosine(l, ax * ax, ay * ay);

  const T ss90 = p.roughness * vh * vh - 1.0f;
  const T ss = (1.0f + ss90 * schlick_weight(nl)) * (1.0f + ss90 * schlick_weight(nv));
  const T flat = 1.25f * (ss * (1.0f / (nl + nv) - 0.5f) + 0.5f);
  const vec3<T> rough = burley(p.base_color, p.roughness, nl, nv, vh);
  const vec3<T> diffuse = mix(rough, p.base_color * (flat * T(inverse_pi)), p.flatness) * dielectric;
  const vec3<T> sheen = mix(white, tint, p.sheen_tint) * (p.sheen * dielectric * grazing);
  return (f * (d * g) + diffuse + sheen) * (nl * detail::in_front<T>(to_v, to_l));
}

/// The clear coat times the cosine without its 1 / (4 nl nv).
template <class T>
constexpr T principled_clearcoat_cos(const Principled<T>& p, const vec3<same<T>>& to_v, const vec3<same<T>>& to_l) {
  const vec3<T> v = detail::above<T>(to_v), l = detail::above<T>(to_l), h = detail::half_vector(v, l);
  const T a = mix(T(0.1f), T(0.001f), p.clearcoat_gloss), a2 = a * a;
  // GTR1; 1 + (a2 - 1) nh^2 as a sum of positive terms, for in float the difference has no digit left at the peak.
  const T gtr1 = (a2 - 1.0f) * T(inverse_pi) / (log(a2) * (h.x * h.x + h.y * h.y + a2 * h.z * h.z));
  const T g = 4.0f * v.z * l.z * detail::smith_over_cosine(v, T(0.0625f), T(0.0625f)) *
              detail::smith_over_cosine(l, T(0.0625f), T(0.0625f));
  return 0.25f * p.clearcoat * fresnel_schlick(dot(v, h), T(0.04f)) * gtr1 * g * l.z * detail::in_front<T>(to_v, to_l);
}

/// As Mitsuba 3.9.1: f_r times the cosine, per steradian; directions as above.
template <class T>
constexpr vec3<T> principled_cos(const Principled<T>& p, const vec3<same<T>>& v, const vec3<same<T>>& l) {
  return principled_base_cos(p, v, l) + vec3<T>(principled_clearcoat_cos(p, v, l));
}
/// The same with Burley's clear coat.
template <class T>
constexpr vec3<T> principled_normalized_cos(const Principled<T>& p, const vec3<same<T>>& v, const vec3<same<T>>& l) {
  const T four = 4.0f * detail::above<T>(v).z * detail::above<T>(l).z;
  return principled_base_cos(p, v, l) + vec3<T>(principled_clearcoat_cos(p, v, l) / four);
}

}  // namespace burnish
