// burnish/twin/superpixels.h -- a picture in small pieces of one colour each
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>
#include <burnish/math/color.h>
#include <burnish/scene/image.h>

namespace burnish {

/// Pieces of about step x step pixels.
struct Superpixels {
  int count = 0;
  std::vector<int> label;  // height x width: the piece of each pixel, 0 .. count - 1
};

/// k-means in colour and place, each centre within reach of its neighbours (SLIC: Achanta et al. 2012, section 3);
/// compactness: how many units of CIELAB a whole step weighs. Pieces that are cut off from their own are given to a
/// neighbour, so each is connected.
inline Superpixels superpixels(const Image& image, int step, float compactness = 10, int rounds = 6) {
  const int w = image.width, h = image.height;
  struct Center {
    float l, a, b, x, y;
  };
  std::vector<vec3<float>> lab(std::size_t(w) * h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) lab[std::size_t(y) * w + x] = lab_from_rgb(image.at(x, y));
  std::vector<Center> centers;
  const int nx = std::max(1, (w + step / 2) / step), ny = std::max(1, (h + step / 2) / step);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const float x = (float(i) + 0.5f) * float(w) / float(nx), y = (float(j) + 0.5f) * float(h) / float(ny);
      const vec3<float>& c = lab[std::size_t(y) * w + std::size_t(x)];
      centers.push_back({c.x, c.y, c.z, x, y});
    }
  Superpixels out;
  out.label.assign(lab.size(), 0);
  std::vector<float> nearest(lab.size());
  const float place = compactness * compactness / float(step * step);
  for (int round = 0; round < rounds; ++round) {
    std::fill(nearest.begin(), nearest.end(), 1e30f);
    for (int k = 0; k < int(centers.size()); ++k) {
      const Center& c = centers[std::size_t(k)];
      const int x0 = std::max(0, int(c.x) - 2 * step), x1 = std::min(w, int(c.x) + 2 * step + 1);
      const int y0 = std::max(0, int(c.y) - 2 * step), y1 = std::min(h, int(c.y) + 2 * step + 1);
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
          const std::size_t i = std::size_t(y) * w + x;
          const float dl = lab[i].x - c.l, da = lab[i].y - c.a, db = lab[i].z - c.b;
          const float dx = float(x) + 0.5f - c.x, dy = float(y) + 0.5f - c.y;
          const float d = dl * dl + da * da + db * db + place * (dx * dx + dy * dy);
          if (d < nearest[i]) nearest[i] = d, out.label[i] = k;
        }
    }
    std::vector<Center> sum(centers.size(), Center{});
    std::vector<float> n(centers.size(), 0);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const std::size_t i = std::size_t(y) * w + x, k = std::size_t(out.label[i]);
        sum[k].l += lab[i].x, sum[k].a += lab[i].y, sum[k].b += lab[i].z;
        sum[k].x += float(x) + 0.5f, sum[k].y += float(y) + 0.5f, n[k] += 1;
      }
    for (std::size_t k = 0; k < centers.size(); ++k)
      if (n[k] > 0) centers[k] = {sum[k].l / n[k], sum[k].a / n[k], sum[k].b / n[k], sum[k].x / n[k], sum[k].y / n[k]};
  }
  // Numbered anew by connected pieces; one below a quarter of a step's area goes to the piece that was met before it.
  std::vector<int> fresh(out.label.size(), -1), piece;
  for (int start = 0; start < w * h; ++start) {
    if (fresh[std::size_t(start)] >= 0) continue;
    const int old = out.label[std::size_t(start)];
    int before = -1;
    piece.assign(1, start);
    fresh[std::size_t(start)] = out.count;
    for (std::size_t q = 0; q < piece.size(); ++q) {
      const int x = piece[q] % w, y = piece[q] / w;
      const int side[4][2] = {{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}};
      for (const auto& s : side) {
        if (s[0] < 0 || s[0] >= w || s[1] < 0 || s[1] >= h) continue;
        const int i = s[1] * w + s[0];
        if (fresh[std::size_t(i)] >= 0) {
          if (fresh[std::size_t(i)] != out.count) before = fresh[std::size_t(i)];
        } else if (out.label[std::size_t(i)] == old) {
          fresh[std::size_t(i)] = out.count;
          piece.push_back(i);
        }
      }
    }
    if (before >= 0 && int(piece.size()) * 4 < step * step) {
      for (const int i : piece) fresh[std::size_t(i)] = before;
    } else ++out.count;
  }
  out.label = std::move(fresh);
  return out;
}

}  // namespace burnish
