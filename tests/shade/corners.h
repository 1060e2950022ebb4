// tests/shade/corners.h -- the corners of what shade/ is given, each with each
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/nodes/surface.h>
#include <differences.h>

namespace corners {
using namespace burnish;

/// All in one frame with its normal along z.
struct Corner {
  Surface<double> surface;
  vec3<double> v, l;
  double c = 0, eta = 1.5;  ///< v.z; the surface's ior or its reciprocal
};
inline std::vector<Corner> all() {
  std::vector<Corner> list;
  for (const double extreme : {0.0, 1.0})
    for (const double r : {0.0, 0.01, double(min_roughness), 1.0})
      for (const double ior : {1.0, 1.6, 3.0})
        for (const double c : {0.0, 1e-8, 1e-3, 1.0})
          for (const double c2 : {-0.5, 0.0, 1e-8, 1.0, 2.0})  // 2: opposite the viewer
            for (const double side : {1.0, -1.0}) {
              Corner k;
              Surface<double>& s = k.surface;
              s.base_color = s.specular_color = s.coat_color = vec3<double>(extreme);
              s.base_weight = s.specular_weight = s.base_metalness = s.coat_weight = extreme;
              s.transmission_weight = 1 - extreme, s.base_diffuse_roughness = s.coat_darkening = extreme;
              s.specular_roughness = s.coat_roughness = r, s.specular_ior = s.coat_ior = ior;
              const auto at = [](double x, double y) { return vec3<double>(std::sqrt(1 - x * x) * y, 0, x); };
              k.v = at(c, 1), k.l = c2 > 1 ? -k.v : at(c2, side);
              k.c = c, k.eta = side > 0 ? ior : 1 / ior;
              list.push_back(k);
            }
  return list;
}
/// arguments(corner): a tuple, the arguments of a function there; stated(corner): it has no slope there.
template <class F, class Stated = bool (*)(const Corner&)> auto of(
    F arguments, Stated stated = [](const Corner&) { return false; }) {
  differences::Hard<decltype(arguments(Corner()))> hard{
      "grazing, opposite, below the horizon; roughness 0 and .01; black, white; metal, dielectric; ior 1", {}};
  for (const Corner& k : all()) (stated(k) ? hard.stated : hard.points).push_back(arguments(k));
  return hard;
}
}  // namespace corners
