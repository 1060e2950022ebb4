// burnish/street/denoise.h -- noise of few paths taken out of an insertion's layers, edges and textures kept
// SPDX-License-Identifier: Apache-2.0
//
// Non-local means whose distances know each pixel's own noise (Rousselle, Knaus and Zwicker 2012), held back by
// pictures without noise (Rousselle, Manzi and Zwicker 2013): what another part, normal, colour or depth tells apart is
// not mixed. Lone pixels far brighter than all about them are dimmed first, so a little light is lost.
#pragma once
#include <burnish/math/color.h>
#include <burnish/street/insert_layers.h>

namespace burnish {

/// Planes without noise, scaled so that a difference of 1 is the edge of something.
struct PlateFeatures {
  std::vector<Mask> planes;
};
/// What the camera sees first at each pixel's centre: part, normal, colour and depth.
template <class Material>
PlateFeatures features(const Raycaster& scene, const Material& material, const Camera& camera) {
  const int w = camera.width, h = camera.height;
  PlateFeatures f;
  f.planes.assign(8, Mask(w, h));
  const GBuffer g = scene.trace(camera, 1);
  parallel_for((g.size() + 255) / 256, [&](int block) {
    for (int i = block * 256; i < std::min(g.size(), (block + 1) * 256); ++i) {
      const std::size_t p = std::size_t(g.pixel[std::size_t(i)]);
      const Surfel<float> at = g.at(i);
      const Surface<float> s = material(at, g.part[std::size_t(i)]);
      const float depth = g.plane[GBuffer::depth][std::size_t(i)];
      const float values[8] = {4.0f + 2 * float(g.part[std::size_t(i)]),
                               at.normal.x * 6,
                               at.normal.y * 6,
                               at.normal.z * 6,
                               std::sqrt(std::max(s.base_color.x, 0.0f)) * 8,
                               std::sqrt(std::max(s.base_color.y, 0.0f)) * 8,
                               std::sqrt(std::max(s.base_color.z, 0.0f)) * 8,
                               20 * std::log(std::max(depth, 1e-3f))};
      for (std::size_t k = 0; k < 8; ++k) f.planes[k].values[p] = values[k];
    }
  });
  return f;
}

namespace detail {
/// Rows y0 to y1 of planes, filtered together: colors, and the variances of their means. patch: pixels to each side
/// that are compared; few keep fine detail, many tell the smooth from its noise.
inline void non_local_means(const std::vector<const float*>& colors, const std::vector<const float*>& variances,
                            const std::vector<Mask>& guides, const std::vector<float*>& out, int w, int h, int y0,
                            int y1, int reach, int patch) {
  const int from = std::max(0, y0 - patch), to = std::min(h, y1 + patch), rows = to - from;
  const std::size_t width = std::size_t(w);
  std::vector<float> d(width * std::size_t(rows)), sums(width), weights(width * std::size_t(y1 - y0)), line(width);
  std::vector<std::vector<float>> total(colors.size(), std::vector<float>(width * std::size_t(y1 - y0)));
  for (int v = -reach; v <= reach; ++v)
    for (int u = -reach; u <= reach; ++u) {
      const int x0 = std::max(0, -u), x1 = std::min(w, w - u);
      if (x0 >= x1) continue;
      // Distances pixel by pixel, less what noise alone would make.
      for (int y = from; y < to; ++y) {
        float* const to_d = &d[std::size_t(y - from) * width];
        std::fill_n(to_d, width, 8.0f);
        if (y + v < 0 || y + v >= h) continue;
        const std::ptrdiff_t p = std::ptrdiff_t(y) * w, q = std::ptrdiff_t(y + v) * w + u;
        std::fill(to_d + x0, to_d + x1, 0.0f);
        for (std::size_t c = 0; c < colors.size(); ++c) {
          const float *const a = colors[c] + p, *const b = colors[c] + q, *const s = variances[c] + p,
                             *const t = variances[c] + q;
          for (int x = x0; x < x1; ++x) {
            const float apart = (a[x] - b[x]) * (a[x] - b[x]) - s[x] - std::min(s[x], t[x]);
            to_d[x] += apart / (1e-8f + 0.25f * (s[x] + t[x]));
          }
        }
      }
      const float per = 1 / float(int(colors.size()) * (2 * patch + 1) * (2 * patch + 1));
      for (int y = std::max(y0, -v); y < std::min(y1, h - v); ++y) {
        std::fill(line.begin(), line.end(), 0.0f);
        for (int j = std::max(y - patch, from); j <= std::min(y + patch, to - 1); ++j)
          for (std::size_t x = 0; x < width; ++x) line[x] += d[std::size_t(j - from) * width + x];
        for (int x = x0; x < x1; ++x) {
          float sum = 0;
          for (int i = std::max(x - patch, 0); i <= std::min(x + patch, w - 1); ++i) sum += line[std::size_t(i)];
          sums[std::size_t(x)] = std::max(sum * per, 0.0f);
        }
        const std::ptrdiff_t p = std::ptrdiff_t(y) * w, q = std::ptrdiff_t(y + v) * w + u;
        std::fill(line.begin(), line.end(), 0.0f);
        for (const Mask& g : guides) {
          const float *const a = g.values.data() + p, *const b = g.values.data() + q;
          for (int x = x0; x < x1; ++x) line[std::size_t(x)] += (a[x] - b[x]) * (a[x] - b[x]);
        }
        float* const weight = &weights[std::size_t(y - y0) * width];
        for (int x = x0; x < x1; ++x) {
          // exp(-x), from above 0 to 8.
          float e = std::max(1 - std::max(sums[std::size_t(x)], line[std::size_t(x)]) * 0.125f, 0.0f);
          e *= e, e *= e, e *= e;
          sums[std::size_t(x)] = e;
          weight[x] += e;
        }
        for (std::size_t c = 0; c < colors.size(); ++c) {
          const float* const b = colors[c] + q;
          float* const t = &total[c][std::size_t(y - y0) * width];
          for (int x = x0; x < x1; ++x) t[x] += sums[std::size_t(x)] * b[x];
        }
      }
    }
  for (std::size_t c = 0; c < colors.size(); ++c)
    for (std::size_t i = 0; i < weights.size(); ++i)
      if (weights[i] > 0) out[c][std::size_t(y0) * width + i] = total[c][i] / weights[i];
}
/// No pixel of much noise is brighter than the brightest of its eight neighbours.
inline void dim_fireflies(Image& image, Image& variance) {
  const Image from = image;
  const int w = image.width, h = image.height;
  parallel_for(h, [&](int y) {
    for (int x = 0; x < w; ++x) {
      const float mine = luminance(from.at(x, y));
      if (!(mine > 0) || variance.at(x, y).y < 0.1f * mine * mine) continue;
      float most = 0;
      for (int j = std::max(0, y - 1); j <= std::min(h - 1, y + 1); ++j)
        for (int i = std::max(0, x - 1); i <= std::min(w - 1, x + 1); ++i)
          if (i != x || j != y) most = std::max(most, luminance(from.at(i, j)));
      if (mine <= most) continue;
      const float k = most / mine;
      image.set(x, y, from.at(x, y) * k), variance.set(x, y, variance.at(x, y) * (k * k));
    }
  });
}
inline void denoise_image(Image& image, Image variance, const std::vector<Mask>& guides, int reach, int patch) {
  const int w = image.width, h = image.height, band = 16;
  dim_fireflies(image, variance);
  Image noisy = image;
  // What few paths say of their own noise is noise itself: the mean of nine pixels.
  Image calm(w, h);
  parallel_for(h, [&](int y) {
    for (int x = 0; x < w; ++x) {
      vec3<float> sum;
      int count = 0;
      for (int j = std::max(0, y - 1); j <= std::min(h - 1, y + 1); ++j)
        for (int i = std::max(0, x - 1); i <= std::min(w - 1, x + 1); ++i) sum += variance.at(i, j), ++count;
      calm.set(x, y, max(sum / float(count), variance.at(x, y) * 0.5f));
    }
  });
  const std::vector<const float*> colors{noisy.plane(0), noisy.plane(1), noisy.plane(2)},
      variances{calm.plane(0), calm.plane(1), calm.plane(2)};
  const std::vector<float*> out{image.plane(0), image.plane(1), image.plane(2)};
  parallel_for((h + band - 1) / band, [&](int b) {
    const int y0 = b * band, y1 = std::min(h, y0 + band);
    bool any = false;
    for (int y = y0; y < y1 && !any; ++y)
      for (int x = 0; x < w && !any; ++x) any = variance.at(x, y).y > 0;
    if (any) non_local_means(colors, variances, guides, out, w, h, y0, y1, reach, patch);
  });
}
}  // namespace detail

/// Takes the noise out of object and shadow, and of kept with them. reach: pixels to each side from which a pixel may
/// take; its cost grows with the square.
inline void denoise(InsertLayers& layers, const PlateFeatures& features, int reach = 6) {
  const int w = layers.object.width, h = layers.object.height;
  std::vector<Mask> guides = features.planes;
  guides.emplace_back(w, h);
  for (int i = 0; i < w * h; ++i) guides.back().values[std::size_t(i)] = 6 * layers.through.plane(1)[i];
  detail::denoise_image(layers.object, layers.object_variance, guides, reach, 1);
  detail::denoise_image(layers.shadow, layers.shadow_variance, {guides.back()}, reach, 2);
  layers.lay_shadow();
}

}  // namespace burnish
