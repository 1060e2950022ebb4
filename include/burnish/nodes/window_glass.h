// burnish/nodes/window_glass.h -- a car's window: a thin tinted pane, and what can be seen on or behind it
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/nodes/surface.h>

namespace burnish {

/// The same everywhere. Reflection is the two faces' together; shade/brdf.h's transmittance() is what comes through.
template <class T> struct WindowGlass {
  vec3<T> transmission_color = {0.75f, 0.8f, 0.77f};  ///< one crossing at normal incidence, less the reflection
  T transmission_weight = 0.95f;                      ///< the rest is diffuse: dust on the pane, or seats behind it
  vec3<T> base_color = {0.1f, 0.1f, 0.1f};            ///< of that rest
  T specular_roughness = 0.02f;
  T specular_ior = 1.52f;

  static constexpr auto parameters() {
    return std::tuple{Param{"transmission_color", &WindowGlass::transmission_color, unit},
                      Param{"transmission_weight", &WindowGlass::transmission_weight, unit},
                      Param{"base_color", &WindowGlass::base_color, unit},
                      Param{"specular_roughness", &WindowGlass::specular_roughness, Range{min_roughness, 0.3f}},
                      Param{"specular_ior", &WindowGlass::specular_ior, Range{1.4f, 1.8f}}};
  }
  template <class At> constexpr Surface<T> operator()(const At&) const {
    Surface<T> s;
    s.base_color = base_color;
    s.transmission_color = transmission_color;
    s.transmission_weight = transmission_weight;
    s.specular_roughness = specular_roughness;
    s.specular_ior = specular_ior;
    return s;
  }
};

}  // namespace burnish
