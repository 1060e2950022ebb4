// burnish/nodes/normal.h -- normals from heights, from coded images, and one laid over another
// SPDX-License-Identifier: Apache-2.0
//
// Normals are unit vectors in the tangent frame of the hit: x along +u, y along +v, z along the shading normal.
#pragma once
#include <burnish/math/frame.h>
#include <burnish/math/noise.h>

namespace burnish {

/// The normal of the surface (u, v, scale h(u, v)): (-scale dh/du, -scale dh/dv, 1) made unit. The slopes come from the
/// height itself, no texture or screen is differenced. MaterialX's heighttonormal has a further factor 1/16 for
/// likeness with a Sobel filter, and codes its result into [0, 1]: its scale is 16 times this one.
template <class T> struct HeightToNormal {
  T scale = 1.0f;
  static constexpr auto parameters() { return std::tuple{Param{"scale", &HeightToNormal::scale, Range{0, 5}}}; }
  constexpr vec3<T> operator()(const Height<T>& h) const {
    return normalize(vec3<T>{-scale * h.slope.x, -scale * h.slope.y, T(1.0f)});
  }
  /// height(texcoord) gives a Height.
  template <class F> constexpr vec3<T> operator()(const F& height, const vec2<T>& texcoord) const {
    return (*this)(height(texcoord));
  }
};

/// A unit normal n bent by a height over space: the height is scale h, slopes by position in n's own frame (Mikkelsen
/// 2010, the surface gradient). n and the result are in that frame, not in the tangent one.
template <class T> constexpr vec3<T> bent_normal(const vec3<T>& n, const Height3<T>& h, const same<T>& scale) {
  return normalize(n - (h.slope - n * dot(n, h.slope)) * scale);
}

/// A normal coded as colour, 0.5 + 0.5 normal; its tilt times scale. As in MaterialX black (0, 0, 0), which codes
/// nothing, gives (0, 0, 1), and so does middle grey, of length 0.
template <class T> struct NormalMap {
  T scale = 1.0f;
  static constexpr auto parameters() { return std::tuple{Param{"scale", &NormalMap::scale, Range{0, 2}}}; }
  constexpr vec3<T> operator()(const vec3<T>& in) const {
    const vec3<T> v = in * T(2.0f) - vec3<T>(T(1.0f)), tilted{v.x * scale, v.y * scale, v.z};
    const auto empty = dot(in, in) <= T(0.0f) || dot(tilted, tilted) < T(1e-12f);
    const vec3<T> up{T(0.0f), T(0.0f), T(1.0f)};
    return normalize(
        vec3<T>{select(empty, up.x, tilted.x), select(empty, up.y, tilted.y), select(empty, up.z, tilted.z)});
  }
  /// In the frame's own space, MaterialX's normal, tangent and bitangent.
  constexpr vec3<T> operator()(const vec3<T>& in, const Frame<T>& frame) const { return frame.to_world((*this)(in)); }
};

/// A detail normal laid on a base normal, both in the tangent frame: the detail turned as z is turned to the base
/// (reoriented normal mapping, Barre-Brisebois and Hill 2012). amount tilts the detail less (0: the base alone) or
/// more. Edge: a base that looks straight down, z = -1.
template <class T> struct NormalBlend {
  T amount = 1.0f;
  static constexpr auto parameters() { return std::tuple{Param{"amount", &NormalBlend::amount, Range{0, 2}}}; }
  constexpr vec3<T> operator()(const vec3<T>& detail, const vec3<T>& base) const {
    const vec3<T> t{base.x, base.y, base.z + 1.0f},
        u = normalize(vec3<T>{-amount * detail.x, -amount * detail.y, detail.z});
    return t * (dot(t, u) / t.z) - u;
  }
};

}  // namespace burnish
