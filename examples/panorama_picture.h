// examples/panorama_picture.h -- what 11_panorama shows: the mask, the sun's mark, and a grey ball under a panorama
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/light/illuminate.h>
#include <burnish/scene/gbuffer.h>
#include <burnish/street/hdr.h>

namespace panorama {
using namespace burnish;

inline Image times(Image image, float factor) {
  for (float& x : image.values) x *= factor;
  return image;
}
/// The sky blue, what is clipped red, over a darkened panorama.
inline Image shown_mask(const Image& p, const SkyMask& m) {
  Image out = times(p, 0.4f);
  const Mask sky = resized(m.sky, p.width, p.height), clipped = resized(m.clipped, p.width, p.height);
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x)
      out.set(x, y, out.at(x, y) + vec3<float>(0.6f * clipped.at(x, y), 0, 0.4f * sky.at(x, y)));
  return out;
}
/// A ring of 4 degrees about a direction.
inline void mark(Image& p, const vec3<float>& direction, const vec3<float>& color) {
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      const vec3<double> d = latlong_direction((x + 0.5) / p.width, (y + 0.5) / p.height);
      const double off = std::acos(std::clamp(dot(d, vec3<double>(direction)), -1.0, 1.0)) - 0.07;
      if (std::fabs(off) < 4.0 / p.height) p.set(x, y, color);
    }
}
/// A ball of albedo 0.5 with a dielectric's gloss, seen from the side that a camera at the panorama's middle of the
/// picture sees: from -`toward`. Nothing is in the way of the light. width x height, the ball in the middle.
inline Image ball(const Image& panorama, int width, int height, const vec3<float>& toward = {0, 0, -1}) {
  GBuffer g;
  g.width = width, g.height = height;
  const vec3<float> v = toward * -1.0f, right = normalize(cross(toward, vec3<float>(0, 1, 0))),
                    up = cross(right, toward);
  std::vector<std::pair<int, vec3<float>>> seen;
  const float r = 0.46f * float(height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float a = (float(x) + 0.5f - 0.5f * float(width)) / r, b = (0.5f * float(height) - float(y) - 0.5f) / r;
      if (a * a + b * b < 0.995f)
        seen.emplace_back(y * width + x, right * a + up * b + v * std::sqrt(1 - a * a - b * b));
    }
  g.resize(int(seen.size()));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const vec3<float> n = seen[i].second, t = normalize(cross(up, n));
    const float values[3][3] = {{n.x, n.y, n.z}, {t.x, t.y, t.z}, {v.x, v.y, v.z}};
    g.pixel[i] = seen[i].first;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 3; ++c) g.plane[3 + 3 * k + c][i] = values[k][c];
  }
  g.close();
  const EnvironmentLight sky(panorama);
  const LightOf<float> light(sky, g);
  Surface<float> grey;
  grey.base_color = {0.5f, 0.5f, 0.5f}, grey.specular_roughness = 0.35f;
  Image out(width, height, {0.02f, 0.02f, 0.02f});
  for (int i = 0; i < g.size(); ++i)
    out.set(g.pixel[std::size_t(i)] % width, g.pixel[std::size_t(i)] / width,
            illuminate(grey, g.at(i), light, List<Sun, float>{sky.suns}, LightStrength<float>{}));
  return out;
}

}  // namespace panorama
