// bench/specular_grid.h -- the 8 x 16 grid over the hemisphere that published inverse renderers shade with
// SPDX-License-Identifier: Apache-2.0
//
// The rendering layer of InvRenderNet (Li et al. 2020), its formulas and clamps as published, specular part: directions
// at azimuth (i + .5) / 16 2 pi and elevation (j + .5) / 8 pi / 2 from the normal, each weighed by sin(elevation)
// pi^2 / 128; k = (r + 1)^2 / 8; the denominator 4 pi nom0^2 nom1 nom2 is clamped to 1e-6 .. 4 pi, its slope then 0.
// F0 is .04 here. A direction's radiance is the panorama's mean over its cell, the best that a grid can know of it.
#pragma once
#include "specular_reference.h"

namespace specular_grid {
using burnish::vec3;
using specular_reference::Pair, specular_reference::View, specular_reference::f0, specular_reference::pi;
constexpr int columns = 16, rows = 8;

struct Directions {
  vec3<double> x, y, z;  // the published frame: y is up laid into the surface
  explicit Directions(const vec3<double>& n) : z(n) {
    const vec3<double> up = std::abs(n.y) < 0.9999 ? vec3<double>(0, 1, 0) : vec3<double>(1, 0, 0);
    y = normalize(up - n * dot(up, n));
    x = cross(y, n) * -1.0;
  }
  vec3<double> at(int row, int column) const {
    const double a = ((column + 0.5) / columns - 0.5) * 2 * pi, e = (row + 0.5) / rows * pi / 2;
    return x * (std::cos(a) * std::sin(e)) + y * (std::sin(a) * std::sin(e)) + z * std::cos(e);
  }
};
using Cells = std::array<double, std::size_t(rows) * columns>;

/// Mean luminance of every cell.
inline Cells means(const specular_reference::Panorama& p, const View& view) {
  const Directions f(view.n);
  Cells light{}, area{};
  for (int j = 0; j < p.height; ++j) {
    for (int i = 0; i < p.width; ++i) {
      const vec3<double> d = specular_reference::Panorama::direction({(i + 0.5) / p.width, (j + 0.5) / p.height});
      const double nl = dot(d, f.z);
      if (nl <= 0) continue;
      const int row = std::min(rows - 1, int(std::acos(std::min(nl, 1.0)) / (pi / 2) * rows));
      const int column = std::min(columns - 1, int((std::atan2(dot(d, f.y), dot(d, f.x)) / (2 * pi) + 0.5) * columns));
      light[row * columns + column] += p.luminance[std::size_t(j) * p.width + i] * p.sine(j);
      area[row * columns + column] += p.sine(j);
    }
  }
  for (std::size_t k = 0; k < light.size(); ++k) light[k] /= std::max(area[k], 1e-12);
  return light;
}
inline Pair specular(const Cells& light, const View& view, double r) {
  const Directions f(view.n);
  const double a2 = r * r * r * r, d_a2 = 4 * r * r * r, k = (r + 1) * (r + 1) / 8, d_k = (r + 1) / 4;
  Pair sum;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const vec3<double> l = f.at(row, column), h = normalize((l + view.v) * 0.5);
      const double nl = dot(view.n, l), nv = view.nv, nh = dot(view.n, h), vh = dot(view.v, h);
      const double fresnel = f0 + (1 - f0) * std::exp2((-5.55472 * vh - 6.98316) * vh);
      const double nom0 = nh * nh * (a2 - 1) + 1, nom1 = nv * (1 - k) + k, nom2 = nl * (1 - k) + k,
                   nom = 4 * pi * nom0 * nom0 * nom1 * nom2, clamped = std::clamp(nom, 1e-6, 4 * pi);
      const double value = a2 * fresnel / clamped * nl * light[row * columns + column] *
                           std::sin((row + 0.5) / rows * pi / 2) * pi * pi / (columns * rows);
      const double d_log_nom =
          nom == clamped ? 2 * nh * nh * d_a2 / nom0 + ((1 - nv) / nom1 + (1 - nl) / nom2) * d_k : 0;
      sum.value += value, sum.slope += value * (d_a2 / a2 - d_log_nom);
    }
  }
  return sum;
}
}  // namespace specular_grid
