// burnish/shade/coat.h -- what a clear coat does to the base beneath it
// SPDX-License-Identifier: Apache-2.0
//
// OpenPBR 1.1, section "Coat". ior is the coat's relative to the outside, >= 1; roughnesses are perceptual.
#pragma once
#include <burnish/nodes/surface.h>
#include <burnish/shade/fresnel.h>

namespace burnish {

/// The base's lobe seen through a coat of weight w: alpha^2 grows by twice the coat's. Both count as min_roughness at
/// least; edge: the sum reaching 1.
template <class T> constexpr T coated_roughness(const T& base, const same<T>& coat, const same<T>& w) {
  const T b = max(T(min_roughness), base), c = max(T(min_roughness), coat), b2 = b * b, c2 = c * c;
  return mix(b, sqrt(sqrt(min(b2 * b2 + 2.0f * c2 * c2, T(1.0f)))), w);
}

/// The share of the light leaving the base that the coat throws back to it: f0 for a mirror-like base (roughness 0),
/// the diffuse internal reflectance 1 - (1 - mean Fresnel) / ior^2 for a diffuse one (1).
template <class T> constexpr T coat_internal_reflectance(const T& ior, const same<T>& roughness) {
  return mix(f0_from_ior(ior), 1.0f - (1.0f - fresnel_average(ior)) / (ior * ior), roughness);
}
/// What remains of a base of the given albedo once that light is absorbed at each return; 1 for a white base. k < 1.
template <class T> constexpr vec3<T> coat_darkening(const vec3<T>& albedo, const same<T>& k) {
  return vec3<T>(1.0f - k) / (vec3<T>(T(1.0f)) - albedo * k);
}

}  // namespace burnish
