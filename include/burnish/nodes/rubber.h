// burnish/nodes/rubber.h -- tyres, seals and dark trim: a rough dark dielectric
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/nodes/surface.h>

namespace burnish {

/// The same everywhere. Defaults as of OpenPBR's tyre.
template <class T> struct Rubber {
  vec3<T> base_color = {0.023f, 0.023f, 0.023f};
  T specular_roughness = 0.7f;
  T specular_ior = 1.5f;

  static constexpr auto parameters() {
    return std::tuple{Param{"base_color", &Rubber::base_color, Range{0, 0.3f}},
                      Param{"specular_roughness", &Rubber::specular_roughness, Range{0.2f, 1}},
                      Param{"specular_ior", &Rubber::specular_ior, Range{1.4f, 1.7f}}};
  }
  template <class At> constexpr Surface<T> operator()(const At&) const {
    Surface<T> s;
    s.base_color = base_color;
    s.specular_roughness = specular_roughness;
    s.specular_ior = specular_ior;
    return s;
  }
};

}  // namespace burnish
