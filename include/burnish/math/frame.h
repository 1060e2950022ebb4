// burnish/math/frame.h -- orthonormal frames, mirror and refracted directions
// SPDX-License-Identifier: Apache-2.0
//
// Right-handed, local z along the normal. All directions are unit vectors and point away from the surface.
#pragma once
#include <burnish/math/vec.h>

namespace burnish {

/// Tangent t (local x), bitangent b = cross(n, t) (local y), normal n (local z).
template <class T> struct Frame {
  vec3<T> t, b, n;

  constexpr vec3<T> to_world(const vec3<T>& v) const { return t * v.x + b * v.y + n * v.z; }
  constexpr vec3<T> to_local(const vec3<T>& v) const { return {dot(v, t), dot(v, b), dot(v, n)}; }
};

/// A frame from its normal alone (Duff et al. 2017, "Building an Orthonormal Basis, Revisited"). Edge: at n.z = 0 the
/// tangents turn over; there the side n.z > 0 is taken.
template <class T> constexpr Frame<T> frame_of(const vec3<T>& n) {
  const T sign = select(n.z >= T(0.0f), T(1.0f), T(-1.0f)), a = T(-1.0f) / (sign + n.z), b = n.x * n.y * a;
  return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}
/// A frame from a normal and a direction along +u, which need be neither unit nor quite tangential. Edge: where the
/// direction runs along the normal to within 1e-6 of its length, frame_of(n) is returned.
template <class T> constexpr Frame<T> frame_of(const vec3<T>& n, const vec3<T>& along) {
  const Frame<T> own = frame_of(n);
  const vec3<T> flat = along - n * dot(n, along);
  const auto usable = dot(flat, flat) > 1e-12f * dot(along, along);
  const auto pick = [&](const T& a, const T& b) { return select(usable, a, b); };
  const vec3<T> t = normalize(vec3<T>{pick(flat.x, own.t.x), pick(flat.y, own.t.y), pick(flat.z, own.t.z)});
  return {t, cross(n, t), n};
}

/// The mirror direction of v.
template <class T> constexpr vec3<T> reflect(const vec3<T>& v, const vec3<T>& n) { return n * (2.0f * dot(n, v)) - v; }

/// Where light from v goes below a surface, v and n on the same side; eta = index on v's side over that below (air to
/// glass: 1 / 1.5). Snell 1621. Edge: total reflection, eta^2 (1 - (n.v)^2) >= 1, has no such direction; the one that
/// grazes the surface is returned, to 1e-6.
template <class T> constexpr vec3<T> refract(const vec3<T>& v, const vec3<T>& n, const same<T>& eta) {
  const T nv = dot(n, v), s2 = max(1.0f - nv * nv, T(1e-12f)), k = 1.0f - eta * eta * (1.0f - nv * nv);
  const T c = sqrt(max(k, T(1e-12f))), bend = select(k > T(0.0f), eta, rsqrt(s2));
  return n * (bend * nv - c) - v * bend;
}

}  // namespace burnish
