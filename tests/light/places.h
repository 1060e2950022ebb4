// tests/light/places.h -- two places made by functions, and what the table says of them against a quadrature in double
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/light/illuminate.h>
#include "../../bench/specular_reference.h"
#include "reference.h"

namespace places {
using burnish::Image, burnish::Illumination, burnish::vec3;
using specular_reference::Pair;

/// Blue above, bright haze along the horizon and about a sun of 0.01 rad, grey ground.
inline Image sky_with_sun() {
  const vec3<double> sun = normalize(vec3<double>(0.4, 0.7, -0.5));
  return reference::panorama(
      [&](const vec3<double>& d) {
        const double from_sun = std::acos(std::min(1.0, dot(d, sun)));
        const double sky = d.y > 0 ? 0.6 + 1.4 * std::exp(-6 * d.y) + 3 * std::exp(-8 * from_sun) : 0.25 + 0.1 * d.x;
        return sky + (from_sun < 0.01 ? 2e4 : 0.0);
      },
      128);
}
/// Grey walls and a darker floor; two windows, two lines of small lamps in the ceiling.
inline Image room() {
  return reference::panorama(
      [](const vec3<double>& d) {
        const double azimuth = std::atan2(d.x, -d.z), elevation = std::asin(d.y);
        if (std::abs(elevation - 0.2) < 0.25 && std::abs(azimuth - 0.8) < 0.45) return 12.0;
        if (std::abs(elevation - 0.1) < 0.3 && std::abs(azimuth + 1.9) < 0.15) return 20.0;
        if (d.y > 0.3) {
          const double x = d.x / d.y, z = d.z / d.y, nearest = std::round(z / 0.7) * 0.7;
          if (std::abs(std::abs(x) - 0.6) < 0.06 && std::abs(z - nearest) < 0.12) return 40.0;
        }
        return d.y < -0.3 ? 0.15 : 0.35 + 0.2 * d.y + 0.1 * d.z;
      },
      128);
}

inline constexpr double roughnesses[5] = {0.02, 0.1, 0.3, 0.6, 1};
/// Views (specular_reference.h) as surfels.
struct Surfels {
  std::vector<specular_reference::View> all;
  struct At {
    vec3<float> normal, view;
  };
  int size() const { return int(all.size()); }
  At at(int i) const { return {vec3<float>(all[i].n), vec3<float>(all[i].v)}; }
};
/// F0 A + B of the table and of the suns, with its slope.
inline Pair seen(const Illumination& light, const std::vector<burnish::Sun<float>>& suns, const Surfels& s, int i,
                 double r) {
  constexpr double f0 = specular_reference::f0;
  const double d[12] = {f0, 0, 0, 1};
  const auto of_suns = [&](double roughness) {
    double sum = 0;
    const auto& at = s.all[i];
    for (const auto& sun : suns) {
      const vec3<double> l(sun.direction), h = normalize(l + at.v);
      const double nl = dot(at.n, l);
      if (nl <= 0) continue;
      sum += ggx_d_spot(at.n, at.v, l, roughness, double(sun.variance)) *
             burnish::ggx_v_smith_correlated(roughness, nl, at.nv) *
             (f0 + (1 - f0) * reference::power5(1 - dot(at.v, h))) * nl * sun.power.x;
    }
    return sum;
  };
  double y[12];
  light.table(double(i), r, 12, y);
  const double h = 1e-4 * r;
  return {f0 * y[0] + y[3] + of_suns(r),
          light.table_slope(double(i), r, 12, d) + (of_suns(r + h) - of_suns(r - h)) / (2 * h)};
}
struct Errors {
  double rms = 0;    // the largest of the five roughnesses'
  double wrong = 0;  // share of slopes with the wrong sign where |d ln V/dr| > .1
  long points = 0;
};
/// Of surfels first to last - 1 against the quadrature of `truth`. scale(i, r, truth): what an error is a part of.
template <class Scale> Errors errors(const Illumination& light, const std::vector<burnish::Sun<float>>& suns,
                                     const Surfels& s, int first, int last, const Image& truth, Scale scale) {
  const specular_reference::Panorama panorama(truth);
  const specular_reference::Quadrature exact(panorama, 1 << 11, 0);
  double worst = 0;
  int steep = 0, wrong = 0;
  for (const double r : roughnesses) {
    double sum = 0;
    for (int i = first; i < last; ++i) {
      const Pair t = exact.integral<specular_reference::Ggx>(s.all[i], r), found = seen(light, suns, s, i, r);
      sum += std::pow((found.value - t.value) / scale(i, r, t.value), 2) / (last - first);
      if (std::abs(t.slope) <= 0.1 * t.value) continue;
      ++steep, wrong += found.slope * t.slope <= 0;
    }
    worst = std::max(worst, std::sqrt(sum));
  }
  return {worst, double(wrong) / steep, 5L * (last - first)};
}
}  // namespace places
