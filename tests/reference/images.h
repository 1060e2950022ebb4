// tests/reference/images.h -- the car, the camera, the loss and the sky of images.py, and how pictures are compared
// SPDX-License-Identifier: Apache-2.0
//
// Mitsuba's conventions beside ours: its camera looks along +z with x to the left and y up, so both pictures are the
// same; `depth` is a distance from the near plane and not along the axis; shading normals are not turned to the viewer;
// shapes are numbered by a registry; an envmap's first and last rows are the poles, where ours are half a texel away.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>
#include <record.h>
#include <burnish/light/environment.h>
#include <burnish/scene/raycast.h>
#include "npy.h"

namespace images {
using namespace burnish;
inline const std::string mitsuba = "Mitsuba 3.9.1 ";

inline Mesh car() {
  const reference::Array v = reference::load("car_vertices"), t = reference::load("car_triangles");
  Mesh m;
  for (std::size_t i = 0; i < v.shape[0]; ++i) {
    const auto at = [&](std::size_t k) { return float(v(i, k)); };
    m.add({at(0), at(1), at(2)}, {at(3), at(4), at(5)}, {at(6), at(7)});
  }
  for (std::size_t i = 0; i < t.shape[0]; ++i) {
    m.triangles.push_back({int(t(i, 0)), int(t(i, 1)), int(t(i, 2))});
    m.part.push_back(int(t(i, 3)));
  }
  for (const char* name : {"body", "windows", "wheels", "ground"}) m.parts.push_back({.name = name, .material = name});
  return m;
}
inline constexpr int parts = 4;
inline Camera camera(int width, int height) {
  return Camera::look_at({3.4f, 2.3f, 4.6f}, {0.05f, 0.5f, 0}, {0, 1, 0}, 42, width, height, Fov::horizontal);
}
/// Which row of a stored picture a pixel has, -1 where it has none; from the picture of part numbers. Pictures of light
/// have no row either where the interpolated normal looks away from the viewer: Mitsuba is black there, ours is bent.
inline std::vector<int> rows(const reference::Array& part) {
  std::vector<int> row(part.size(), -1);
  int n = 0;
  for (std::size_t p = 0; p < row.size(); ++p)
    if (part.values[p] < 255) row[p] = n++;
  return row;
}
/// The surfels of one part whose pixels have a row; they keep their places in the tables of the whole.
inline GBuffer only(const GBuffer& g, int part, const std::vector<int>& row) {
  std::vector<int> chosen;
  for (int i = 0; i < g.size(); ++i)
    if (g.part[std::size_t(i)] == part && row[std::size_t(g.pixel[std::size_t(i)])] >= 0) chosen.push_back(i);
  return g.picked(chosen, false);
}
/// d loss / d picture: the loss is the sum of these times the picture.
inline Image weights(int width, int height) {
  Image d(width, height);
  for (int p = 0; p < width * height; ++p)
    for (int c = 0; c < 3; ++c) d.plane(c)[p] = 0.2f + 0.1f * float((7 * p + 3 * c) % 11);
  return d;
}
/// Radiance by unit direction: blue above, warm below, a bright bump 2.6 degrees wide.
inline vec3<double> sky(const vec3<double>& d) {
  const double above = 0.5 + 0.5 * std::tanh(6 * d.y),
               bump = std::exp((dot(d, normalize(vec3<double>(0.48, 0.62, 0.62))) - 1) / 0.002);
  return vec3<double>(0.5, 0.75, 1.2) * (above * (0.7 - 0.4 * d.y)) + vec3<double>(0.3, 0.21, 0.12) * (1 - above) +
         vec3<double>(42, 36, 27) * bump;
}
inline Image panorama(int height) {
  Image image(2 * height, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < 2 * height; ++x)
      image.set(x, y, vec3<float>(sky(latlong_direction((x + 0.5) / (2 * height), (y + 0.5) / height))));
  }
  return image;
}

/// Of many numbers: what they differ by from the reference.
struct Difference {
  std::vector<double> off, reference;
  void add(double a, double r) { off.push_back(a - r), reference.push_back(r); }
  void add(const vec3<float>& a, const vec3<double>& r) {
    add(double(a.x), r.x), add(double(a.y), r.y), add(double(a.z), r.z);
  }
  long count() const { return long(off.size()); }
  /// Root mean square of the reference.
  double size() const { return rms(reference); }
  double worst() const {
    double w = 0;
    for (const double x : off) w = std::abs(x) <= w ? w : std::abs(x);  // so NaN stays
    return w;
  }
  /// The worst |difference| / max(|reference|, size()).
  double relative() const {
    double w = 0;
    const double least = size();
    for (std::size_t i = 0; i < off.size(); ++i) {
      const double x = std::abs(off[i]) / std::max(std::abs(reference[i]), least);
      w = x <= w ? w : x;
    }
    return w;
  }
  /// Root mean square of the difference by that of the reference.
  double relative_rms() const { return rms(off) / size(); }

private:
  static double rms(const std::vector<double>& x) {
    double sum = 0;
    for (const double y : x) sum += y * y;
    return std::sqrt(sum / double(x.size()));
  }
};

}  // namespace images
