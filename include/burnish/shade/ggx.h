// burnish/shade/ggx.h -- the Trowbridge-Reitz (GGX) microfacet lobe
// SPDX-License-Identifier: Apache-2.0
//
// Trowbridge and Reitz 1975; Walter et al. 2007; Heitz 2014. Isotropic. roughness is perceptual and alpha =
// roughness^2; below min_roughness it counts as min_roughness (nodes/surface.h). n, v, l, h are unit; nl, nv, vh their
// dot products.
#pragma once
#include <burnish/nodes/surface.h>

namespace burnish {

namespace detail {
/// alpha^2; the slope at min_roughness itself is that of the side above.
template <class T> constexpr T ggx_alpha2(const T& roughness) {
  const T r = max(T(min_roughness), roughness), a = r * r;
  return a * a;
}
/// sqrt(alpha^2 + (1 - alpha^2) c^2)
template <class T> constexpr T ggx_root(const T& a2, const T& c) { return sqrt(a2 + (1.0f - a2) * c * c); }
}  // namespace detail

/// The density of microfacet normals, per steradian; times nh it integrates to 1 over the hemisphere. nh > 0;
/// sin2 = |n x h|^2 = 1 - nh^2, wanted apart: in float, 1 - nh * nh has no digit left where a sharp lobe lives. h = 0,
/// which is what opposite v and l have, gives a finite number.
template <class T> constexpr T ggx_d(const T& roughness, const same<T>& nh, const same<T>& sin2) {
  const T a2 = detail::ggx_alpha2(roughness), k = max(sin2 + nh * nh * a2, 0.5f * a2);
  return a2 * inverse_pi / (k * k);
}
template <class T> constexpr T ggx_d(const T& roughness, const vec3<same<T>>& n, const vec3<same<T>>& h) {
  const vec3<T> x = cross(n, h);
  return ggx_d(roughness, dot(n, h), dot(x, x));
}

/// Smith's share of microfacets that v sees. 0 at nv = 0, 1 at nv = 1.
template <class T> constexpr T ggx_g1(const T& roughness, const same<T>& nv) {
  return 2.0f * nv / (nv + detail::ggx_root(detail::ggx_alpha2(roughness), nv));
}
/// G1(l) G1(v) / (4 nl nv). nl, nv >= 0.
template <class T> constexpr T ggx_v_smith_separable(const T& roughness, const same<T>& nl, const same<T>& nv) {
  const T a2 = detail::ggx_alpha2(roughness);
  return 1.0f / ((nl + detail::ggx_root(a2, nl)) * (nv + detail::ggx_root(a2, nv)));
}
/// G2(l, v) / (4 nl nv), masking and shadowing correlated by height (Heitz 2014, equation 99). nl, nv >= 0, not both 0.
template <class T> constexpr T ggx_v_smith_correlated(const T& roughness, const same<T>& nl, const same<T>& nv) {
  const T a2 = detail::ggx_alpha2(roughness);
  return 0.5f / (nl * detail::ggx_root(a2, nv) + nv * detail::ggx_root(a2, nl));
}

/// A microfacet normal that v sees, from u in [0, 1)^2 (Heitz 2018). v and the result in the tangent frame, v.z > 0.
template <class T>
constexpr vec3<T> ggx_sample_visible_normal(const T& roughness, const vec3<same<T>>& v, const vec2<same<T>>& u) {
  const T a = sqrt(detail::ggx_alpha2(roughness));
  const vec3<T> s = normalize(vec3<T>(a * v.x, a * v.y, v.z));
  const T length2 = s.x * s.x + s.y * s.y, inverse = rsqrt(max(length2, 1e-12f));
  const vec3<T> t1(select(length2 > 1e-12f, -s.y * inverse, T(1.0f)), select(length2 > 1e-12f, s.x * inverse, T(0.0f)),
                   T(0.0f));
  const vec3<T> t2 = cross(s, t1);
  const T r = sqrt(max(u.x, 1e-12f)), phi = (2.0f * pi) * u.y, x = r * cos(phi), half = 0.5f * (1.0f + s.z);
  const T y = mix(sqrt(max(1.0f - x * x, 1e-12f)), r * sin(phi), half);
  const vec3<T> m = t1 * x + t2 * y + s * sqrt(max(1.0f - x * x - y * y, 1e-12f));
  return normalize(vec3<T>(a * m.x, a * m.y, max(m.z, 1e-6f)));
}
/// Density of ggx_sample_visible_normal per steradian of h; of the reflected direction: divide by 4 vh.
template <class T>
constexpr T ggx_visible_normal_pdf(const T& roughness, const same<T>& nv, const same<T>& vh, const same<T>& d) {
  return 2.0f * max(vh, 0.0f) * d / (nv + detail::ggx_root(detail::ggx_alpha2(roughness), nv));
}

}  // namespace burnish
