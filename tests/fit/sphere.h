// tests/fit/sphere.h -- a G-buffer without a ray caster: a sphere seen from afar
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <burnish/math/frame.h>
#include <burnish/scene/gbuffer.h>

namespace sphere {
using namespace burnish;

/// Radius 1 m at the origin, seen along -z, n x n pixels; covered in full wherever a pixel's centre hits it.
inline GBuffer seen(int n) {
  std::vector<int> hit;
  const auto at = [&](int p) {
    return vec2<float>(2 * (float(p % n) + 0.5f) / float(n) - 1, 1 - 2 * (float(p / n) + 0.5f) / float(n));
  };
  for (int p = 0; p < n * n; ++p)
    if (dot(at(p), at(p)) < 0.97f) hit.push_back(p);
  GBuffer g;
  g.width = g.height = n;
  g.resize(int(hit.size()));
  for (std::size_t i = 0; i < hit.size(); ++i) {
    const vec2<float> xy = at(hit[i]);
    const vec3<float> normal(xy.x, xy.y, std::sqrt(1 - dot(xy, xy)));
    const Frame<float> frame = frame_of(normal, vec3<float>(1, 0, 0));
    g.pixel[i] = hit[i];
    const auto put = [&](std::size_t first, const vec3<float>& v) {
      g.plane[first][i] = v.x, g.plane[first + 1][i] = v.y, g.plane[first + 2][i] = v.z;
    };
    put(0, normal), put(3, normal), put(6, frame.t), put(9, {0, 0, 1}), put(GBuffer::geometric, normal);
    g.plane[12][i] = 0.5f + 0.5f * xy.x, g.plane[13][i] = 0.5f + 0.5f * xy.y;
    g.plane[GBuffer::coverage][i] = 1;
  }
  g.close();
  return g;
}

}  // namespace sphere
