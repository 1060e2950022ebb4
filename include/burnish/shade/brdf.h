// burnish/shade/brdf.h -- how a Surface reflects: clear coat over metal and dielectric
// SPDX-License-Identifier: Apache-2.0
//
// With x(c) = (1 - c)^5, D the GGX density and V its height-correlated visibility:
//   coat      D_c V_c F_c(vh)                                 F_c(c) = coat_weight * Schlick's curve of coat_ior
//   specular  T_c(nl) T_c(nv) tint D_b V_b F_b(vh)            T_c(c) = 1 - F_c(c)
//   diffuse   T_c(nl) T_c(nv) T_b(nl) T_b(nv) tint albedo/pi  T_b(c) = 1 - F_dielectric(c), by channel
// Reciprocal as it stands. Every factor of l but D V is a polynomial in x(nl) or x(vh), so an environment's light needs
// a few integrals that know nothing of colours, weights and indices (Moments), and is exact. Base and coat may have
// normals of their own.
//
// What single scattering and a coat's returns lose stays lost. In a white furnace a metal reflects .995 at roughness
// .2, .94 at .4, .80 at .6 and .41 at 1; a white diffuse base of ior 1.5 .91, under a smooth coat of ior 1.6 .85; a
// white metal of roughness .3 under it .90. Nothing reflects more than 1.001.
#pragma once
#include <burnish/shade/coat.h>
#include <burnish/shade/diffuse.h>
#include <burnish/shade/ggx.h>

namespace burnish {

/// All of a Surface that does not depend on directions.
template <class T> struct Layers {
  T coat_f0, coat_f90, coat_roughness;    ///< Fresnel ends with coat_weight in
  vec3<T> base_f0, base_f90;              ///< with the tint that the coat leaves the base
  T base_roughness;                       ///< as seen through the coat
  vec3<T> dielectric_f0, dielectric_f90;  ///< what the diffuse light misses
  vec3<T> albedo, diffuse;                ///< of the diffuse base; its weight, with the coat's tint
  T diffuse_roughness;

  /// T_c and T_b.
  constexpr T coat_passes(const T& c) const { return 1.0f - fresnel_schlick(c, coat_f0, coat_f90); }
  constexpr vec3<T> dielectric_passes(const T& c) const {
    return vec3<T>(T(1.0f)) - fresnel_schlick(c, dielectric_f0, dielectric_f90);
  }
};

template <class T> constexpr Layers<T> layers(const Surface<T>& s) {
  const vec3<T> white(T(1.0f)), color = s.base_color * s.base_weight;
  const T f0c = f0_from_ior(s.coat_ior), f0 = f0_from_ior(s.specular_ior) * s.specular_weight;
  // Both faces of a thin wall reflect: 2 F / (1 + F).
  const T f0d = mix(f0, 2.0f * f0 / (1.0f + f0), s.transmission_weight), opaque = 1.0f - s.transmission_weight;
  const vec3<T> d0 = s.specular_color * f0d, d90 = s.specular_color * f90_from_f0(f0);

  const vec3<T> seen = color * mix(opaque, s.specular_weight, s.base_metalness);
  const T k = coat_internal_reflectance(s.coat_ior, mix(T(1.0f), s.specular_roughness, s.base_metalness));
  const vec3<T> tint =
      mix(white, s.coat_color, s.coat_weight) * mix(white, coat_darkening(seen, k), s.coat_weight * s.coat_darkening);
  return {f0c * s.coat_weight,
          f90_from_f0(f0c) * s.coat_weight,
          max(T(min_roughness), s.coat_roughness),
          tint * mix(d0, color * s.specular_weight, s.base_metalness),
          tint * mix(d90, vec3<T>(s.specular_weight), s.base_metalness),
          coated_roughness(s.specular_roughness, s.coat_roughness, s.coat_weight),
          d0,
          d90,
          color,
          tint * ((1.0f - s.base_metalness) * opaque),
          s.base_diffuse_roughness};
}

/// Between unit vectors: n the base's, c the coat's normal, h half way from v to l.
template <class T> struct Cosines { T nl, nv, cl, cv, vh; };

/// f_r * cosine, per steradian. d_base and d_coat: the densities D, or what a light with an extent makes of them. Light
/// from below a layer's horizon gives 0 there. A view below it counts as at nv = 1e-4, so that a bumped pixel is not
/// black.
template <class T>
constexpr vec3<T> brdf_cos_with(const Layers<T>& s, const Cosines<T>& at, const T& d_base, const T& d_coat) {
  const T nl = max(at.nl, 1e-4f), nv = max(at.nv, 1e-4f), cl = max(at.cl, 1e-4f), cv = max(at.cv, 1e-4f);
  const T through = s.coat_passes(cl) * s.coat_passes(cv);
  const T coat =
      d_coat * ggx_v_smith_correlated(s.coat_roughness, cl, cv) * fresnel_schlick(at.vh, s.coat_f0, s.coat_f90);
  const vec3<T> specular =
      fresnel_schlick(at.vh, s.base_f0, s.base_f90) * (d_base * ggx_v_smith_correlated(s.base_roughness, nl, nv));
  const vec3<T> diffuse = s.diffuse * s.dielectric_passes(nl) * s.dielectric_passes(nv) *
                          oren_nayar(s.albedo, s.diffuse_roughness, nl, nv, 2.0f * at.vh * at.vh - 1.0f);
  return (specular + diffuse) * (through * max(at.nl, 0.0f)) + vec3<T>(coat * max(at.cl, 0.0f));
}

/// f_r * cosine, per steradian; base and coat each by its own normal n, c. v to the viewer, l to the light; all unit
/// and in one frame, whichever.
template <class T> constexpr vec3<T> brdf_cos(const Layers<T>& s, const vec3<same<T>>& n, const vec3<same<T>>& c,
                                              const vec3<same<T>>& v, const vec3<same<T>>& l) {
  const vec3<T> sum = v + l, h = sum * rsqrt(max(dot(sum, sum), 1e-12f));
  return brdf_cos_with(s, Cosines<T>{dot(n, l), dot(n, v), dot(c, l), dot(c, v), dot(v, h)},
                       ggx_d(s.base_roughness, n, h), ggx_d(s.coat_roughness, c, h));
}
/// The same around one normal for both; the surface's geometry normals are not looked at.
template <class T> constexpr vec3<T> brdf_cos(const Surface<T>& s, const vec3<same<T>>& n, const vec3<same<T>>& v,
                                              const vec3<same<T>>& l) {
  return brdf_cos(layers(s), n, n, v, l);
}
/// A normal given in the tangent frame of n and t, in the frame they are given in; the bitangent is cross(n, t).
template <class T>
constexpr vec3<T> from_tangent_frame(const vec3<T>& local, const vec3<same<T>>& n, const vec3<same<T>>& t) {
  return t * local.x + cross(n, t) * local.y + n * local.z;
}
/// The same with the surface's geometry normals about the shading normal n and the tangent t.
template <class T> constexpr vec3<T> brdf_cos(const Surface<T>& s, const vec3<same<T>>& n, const vec3<same<T>>& t,
                                              const vec3<same<T>>& v, const vec3<same<T>>& l) {
  return brdf_cos(layers(s), from_tangent_frame(s.geometry_normal, n, t),
                  from_tangent_frame(s.geometry_coat_normal, n, t), v, l);
}

/// What a thin wall lets through in a straight line, rgb: one crossing's tint, less what coat and wall reflect.
template <class T> constexpr vec3<T> transmittance(const Surface<T>& s, const same<T>& nv) {
  const Layers<T> a = layers(s);
  const T c = max(nv, 0.0f);
  return s.transmission_color * mix(vec3<T>(T(1.0f)), s.coat_color, s.coat_weight) * a.dielectric_passes(c) *
         (a.coat_passes(c) * s.transmission_weight * (1.0f - s.base_metalness));
}

/// Integrals of radiance L over directions l, one normal for base and coat, V the height-correlated visibility:
/// a: L D V nl (1 - x(vh)), b: L D V nl x(vh); with a 5, times x(nl). e0 e5 e10: L nl x(nl)^k, k = 0, 1, 2.
template <class T> struct Moments { vec3<T> coat_a, coat_b, base_a, base_b, base_a5, base_b5, e0, e5, e10; };
/// The integral of L brdf_cos over all l, exactly, of a surface with base_diffuse_roughness 0.
template <class T> constexpr vec3<T> reflected(const Layers<T>& s, const same<T>& nv, const Moments<T>& m) {
  const vec3<T> white(T(1.0f));
  const T c = max(nv, 1e-4f), p = 1.0f - s.coat_f0, q = s.coat_f90 - s.coat_f0;  // T_c = p - q x
  const vec3<T> pb = white - s.dielectric_f0, qb = s.dielectric_f90 - s.dielectric_f0;
  const vec3<T> specular = s.base_f0 * (m.base_a * p - m.base_a5 * q) + s.base_f90 * (m.base_b * p - m.base_b5 * q);
  const vec3<T> diffuse = s.diffuse * s.albedo * s.dielectric_passes(c) * T(inverse_pi) *
                          (pb * p * m.e0 - (qb * p + pb * q) * m.e5 + qb * q * m.e10);
  return (specular + diffuse) * s.coat_passes(c) + m.coat_a * s.coat_f0 + m.coat_b * s.coat_f90;
}

}  // namespace burnish
