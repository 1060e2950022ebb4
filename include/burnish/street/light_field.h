// burnish/street/light_field.h -- light that varies along a street: panoramas with places, the nearest serves
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/light/environment.h>
#include <burnish/scene/error.h>

namespace burnish {

/// Light, and where it was seen: world metres.
template <class Light> struct PlacedLight {
  vec3<float> position;
  Light light;
};
/// A small set of lights of any type (EnvironmentLight, PanoramaSampler, a file's name); an insertion takes the
/// nearest, as the paper does.
template <class Light> struct LightField {
  std::vector<PlacedLight<Light>> lights;

  /// Of equally near ones the first. Error when there is none.
  const PlacedLight<Light>& nearest(const vec3<float>& position) const {
    if (lights.empty()) throw Error("a light field without panoramas, expected one at least");
    const auto distance2 = [&](const PlacedLight<Light>& p) {
      return dot(p.position - position, p.position - position);
    };
    return *std::min_element(lights.begin(), lights.end(),
                             [&](const auto& a, const auto& b) { return distance2(a) < distance2(b); });
  }
};

/// The paper's light without an estimate: six equal ones along the positive and negative axes, here infinitely far, and
/// nothing else. irradiance: what each gives a surface that faces it.
inline EnvironmentLight six_lights(const vec3<float>& irradiance = {1, 1, 1}) {
  EnvironmentLight e;
  const vec3<float> directions[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (const vec3<float>& d : directions) {
    Sun<float> s;
    s.direction = d, s.power = irradiance, s.index = float(e.suns.size());
    e.suns.push_back(s);
  }
  return e;
}
/// As much light as the panorama gives, from those six directions: to be compared with it.
inline EnvironmentLight six_lights(const EnvironmentLight& as_bright) {
  return six_lights(vec3<float>(as_bright.energy() * (1.0 / 6)));
}

/// The same for a path tracer: a black panorama with six discs of 4 degrees' radius that give a level plane the
/// irradiance asked for.
inline Image six_lights_panorama(const vec3<float>& level_irradiance, int height = 512) {
  Image p(2 * height, height);
  const double edge = std::cos(0.07);
  double up = 0;  // irradiance of a level plane by radiance 1
  for (const bool fill : {false, true})
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < 2 * height; ++x) {
        const vec3<double> d = latlong_direction((x + 0.5) / (2 * height), (y + 0.5) / height);
        if (std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) < edge) continue;
        if (!fill) up += std::max(d.y, 0.0) * detail::texel_area(2 * height, height, y);
        else p.set(x, y, level_irradiance * float(1 / up));
      }
  return p;
}

}  // namespace burnish
