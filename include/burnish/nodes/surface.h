// burnish/nodes/surface.h -- what a material says about a point: the socket that every material answers
// SPDX-License-Identifier: Apache-2.0
//
// Names and defaults are those of OpenPBR 1.1; the members here are the part of it that shade/ implements. A base of
// metal and dielectric, the dielectric being diffuse or a thin clear wall, lies under a clear coat.
#pragma once
#include <burnish/math/vec.h>

namespace burnish {

/// The least perceptual roughness: below it a lobe stays as it is there and its slope by roughness is zero; at it, and
/// above, the slope is the lobe's own.
inline constexpr float min_roughness = 0.02f;

/// Colours are linear RGB in [0, 1]. Roughnesses are perceptual: alpha = roughness^2. Normals are unit and in the
/// tangent frame of the hit: x along +u, y along the bitangent cross(normal, tangent), z along the shading normal.
template <class T> struct Surface {
  T base_weight = 1.0f;
  vec3<T> base_color = {0.8f, 0.8f, 0.8f};  ///< albedo of the diffuse base, reflectance at normal incidence of metal
  T base_diffuse_roughness = 0.0f;          ///< 0: Lambert
  T base_metalness = 0.0f;
  T specular_weight = 1.0f;  ///< scales the dielectric's reflectance at normal incidence, and all of metal's
  vec3<T> specular_color = {1.0f, 1.0f, 1.0f};  ///< tints the dielectric's reflection
  T specular_roughness = 0.3f;
  T specular_ior = 1.5f;
  T transmission_weight = 0.0f;  ///< 1: the dielectric is a thin clear wall instead of a diffuse body
  vec3<T> transmission_color = {1.0f, 1.0f, 1.0f};  ///< what one crossing of the wall leaves
  T coat_weight = 0.0f;
  vec3<T> coat_color = {1.0f, 1.0f, 1.0f};  ///< what the way in and out through the coat leaves
  T coat_roughness = 0.0f;
  T coat_ior = 1.6f;
  T coat_darkening = 1.0f;  ///< how much of the light caught between coat and base is accounted for
  vec3<T> geometry_normal = {0.0f, 0.0f, 1.0f};
  vec3<T> geometry_coat_normal = {0.0f, 0.0f, 1.0f};

  static constexpr auto parameters() {
    constexpr Range roughness{min_roughness, 1}, ior{1, 3}, direction{-1, 1};
    return std::tuple{Param{"base_weight", &Surface::base_weight, unit},
                      Param{"base_color", &Surface::base_color, unit},
                      Param{"base_diffuse_roughness", &Surface::base_diffuse_roughness, unit},
                      Param{"base_metalness", &Surface::base_metalness, unit},
                      Param{"specular_weight", &Surface::specular_weight, unit},
                      Param{"specular_color", &Surface::specular_color, unit},
                      Param{"specular_roughness", &Surface::specular_roughness, roughness},
                      Param{"specular_ior", &Surface::specular_ior, ior},
                      Param{"transmission_weight", &Surface::transmission_weight, unit},
                      Param{"transmission_color", &Surface::transmission_color, unit},
                      Param{"coat_weight", &Surface::coat_weight, unit},
                      Param{"coat_color", &Surface::coat_color, unit},
                      Param{"coat_roughness", &Surface::coat_roughness, roughness},
                      Param{"coat_ior", &Surface::coat_ior, ior},
                      Param{"coat_darkening", &Surface::coat_darkening, unit},
                      Param{"geometry_normal", &Surface::geometry_normal, direction},
                      Param{"geometry_coat_normal", &Surface::geometry_coat_normal, direction}};
  }
};

}  // namespace burnish
