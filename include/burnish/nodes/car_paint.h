// burnish/nodes/car_paint.h -- car paint: pigment and metal flakes under a clear coat
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/math/noise.h>
#include <burnish/nodes/surface.h>
#include <burnish/nodes/tint.h>

namespace burnish {

/// Metal flakes lying in the paint, each tilted a little: the slopes of a gradient noise in space. What of them a pixel
/// can resolve bends the base's normal; what it cannot widens the base's lobe, by the same variance of slopes.
template <class T> struct Flakes {
  T size = 0.001f;    ///< metres between neighbours
  T amount = 0.05f;   ///< rms slope of a flake against the paint, along each of the two directions
  T resolved = 0.0f;  ///< part of the slope drawn flake by flake: 0 if a pixel is wider than a flake, 1 close up

  static constexpr auto parameters() {
    return std::tuple{Param{"size", &Flakes::size, Range{0.0002f, 0.01f}},
                      Param{"amount", &Flakes::amount, Range{0, 0.5f}}, Param{"resolved", &Flakes::resolved, unit}};
  }
  /// Unit, in the tangent frame of a place: its position in metres, unit normal and tangent.
  constexpr vec3<T> normal(const vec3<T>& position, const vec3<T>& n, const vec3<T>& t) const {
    constexpr float rms = 0.6917f;  // of noise3d's slope along one direction
    const vec3<T> slope = noise3d(position / size).slope * (amount * resolved * (1.0f / rms));
    return normalize(vec3<T>(-dot(slope, t), -dot(slope, cross(n, t)), T(1.0f)));
  }
  /// A base's roughness with the unresolved rest: alpha^2 grows by twice the variance of the slopes. Edge: reaching 1.
  constexpr T roughness(const T& base) const {
    const T r = max(T(min_roughness), base), r2 = r * r, rest = amount * amount * (1.0f - resolved * resolved);
    return sqrt(sqrt(min(r2 * r2 + 2.0f * rest, T(1.0f))));
  }
};

/// A paint's uneven colour: darker by up to `amount`, in patches of `size` metres.
template <class T> struct Mottle {
  T size = 0.02f, amount = 0.02f;
  static constexpr auto parameters() {
    return std::tuple{Param{"size", &Mottle::size, Range{0.002f, 0.2f}},
                      Param{"amount", &Mottle::amount, Range{0, 0.5f}}};
  }
  /// A factor between 1 - amount and 1.
  constexpr T operator()(const vec3<T>& position) const {
    return 1.0f - amount * (0.5f + 0.5f * noise3d(position / size).value);
  }
};

/// Called with a place `at` that has position (metres, in the vehicle's own frame), normal and tangent (unit): a
/// Surfel, or a host's own struct. The coat's normal stays smooth above the flakes.
template <class T> struct CarPaint {
  vec3<T> base_color = {0.5f, 0.08f, 0.06f};  ///< linear RGB, before the tint
  HsvAdjust<T> tint;                          ///< cut off at 1, an edge
  Mottle<T> mottle;
  T base_metalness = 0.4f;
  T specular_roughness = 0.3f;
  Flakes<T> flakes;
  T coat_weight = 1.0f;
  T coat_roughness = 0.03f;
  T coat_ior = 1.5f;

  static constexpr auto parameters() {
    return std::tuple{Param{"base_color", &CarPaint::base_color, unit},
                      Param{"tint", &CarPaint::tint},
                      Param{"mottle", &CarPaint::mottle},
                      Param{"base_metalness", &CarPaint::base_metalness, unit},
                      Param{"specular_roughness", &CarPaint::specular_roughness, Range{0.1f, 1}},
                      Param{"flakes", &CarPaint::flakes},
                      Param{"coat_weight", &CarPaint::coat_weight, unit},
                      Param{"coat_roughness", &CarPaint::coat_roughness, Range{min_roughness, 0.5f}},
                      Param{"coat_ior", &CarPaint::coat_ior, Range{1.3f, 2}}};
  }
  template <class At> constexpr Surface<T> operator()(const At& at) const {
    const vec3<T> position(at.position);
    Surface<T> s;
    s.base_color = min(vec3<T>(T(1.0f)), tint(base_color)) * mottle(position);
    s.base_metalness = base_metalness;
    s.specular_roughness = flakes.roughness(specular_roughness);
    s.coat_weight = coat_weight;
    s.coat_roughness = coat_roughness;
    s.coat_ior = coat_ior;
    s.geometry_normal = flakes.normal(position, vec3<T>(at.normal), vec3<T>(at.tangent));
    return s;
  }
};

}  // namespace burnish
