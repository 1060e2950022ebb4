// burnish/light/pyramid.h -- a lat-long map blurred on the sphere, to be looked up at any direction and any width
// SPDX-License-Identifier: Apache-2.0
//
// Level 0 is the map; level j >= 1 is the map convolved with (4 G(s) - G(2 s)) / 3, G(s) a spherical Gaussian of
// standard deviation s = 2^(j-1) texels of the map, held at half the size of the level before from j = 2 on. That
// kernel has no second moment: wide as its samples are, their sum still follows a lobe that bends within their width.
// Blurring on the sphere has no poles and no seam.
#pragma once
#include <array>
#include <burnish/ad/parallel.h>
#include <burnish/light/environment.h>

namespace burnish {

class Pyramid {
public:
  Pyramid() : Pyramid(EnvironmentLight()) {}
  /// All cores; the same bits for any number of them.
  explicit Pyramid(const EnvironmentLight& e) : turn_(e.yaw * 0.15915494f) {
    const int w = e.map.width, h = e.map.height;
    const double step = 3.141592653589793 / h;
    texel_ = float(step);
    Level level{w, h, step * step / 6, {}};
    for (int c = 0; c < 3; ++c) level.plane[c].assign(e.map.plane(c), e.map.plane(c) + std::size_t(w) * h);
    store(level);
    double sigma = step;  // of the level to come
    Level before;         // blurred, not stored yet
    for (int j = 1; j < most_levels && sigma < 1.2; ++j, sigma *= 2) {
      const int width = j == 1 ? w : std::max(16, level.width / 2);
      const double tent = 3.141592653589793 / (width / 2);
      const double more = sigma * sigma - level.variance - tent * tent / 6;
      level = blurred(level, width, std::sqrt(std::max(more, 1e-12)));
      level.variance = sigma * sigma;
      if (j > 1) store(sharpened(before, level));
      before = level;
    }
    store(level);
  }

  /// Radiance from a world direction of any length, averaged over the kernel above with s^2 = variance (rad^2 per
  /// axis), linear in the variance between levels; the last level is a plain Gaussian. At variance 0 it is the bilinear
  /// map. Beside a bright light it may be negative.
  vec3<float> fetch(const vec3<float>& d, float variance) const {
    float x[16] = {d.x}, y[16] = {d.y}, z[16] = {d.z}, s[16] = {variance}, r[16], g[16], b[16];
    const unsigned only = 1;
    fetch(Packet<float, 16>::load(x), Packet<float, 16>::load(y), Packet<float, 16>::load(z),
          Packet<float, 16>::load(s), only, r, g, b);
    return {r[0], g[0], b[0]};
  }
  /// Sixteen at once; a lane whose bit in `wanted` is off gives 0.
  void fetch(Packet<float, 16> x, Packet<float, 16> y, Packet<float, 16> z, Packet<float, 16> variance, unsigned wanted,
             float* r, float* g, float* b) const {
    using P = Packet<float, 16>;
    P u = atan2(x, -z) * 0.15915494f + turn_;
    u = u - floor(u);
    const P v = min(atan2(sqrt(x * x + z * z), y) * 0.31830989f, 1.0f);
    // Between levels j and j + 1 the weights are linear in the variance, which is texel^2 4^(j-1) at level j.
    const P wide = max(variance * (1 / (texel_ * texel_)), 1e-12f);
    const P level = min(max(floor(log2(wide) * 0.5f) + 1.0f, 0.0f), float(levels_ - 2));
    const P below = select(level < 0.5f, P(1.0f / 6), exp2(level * 2.0f - 2.0f)), above = exp2(level * 2.0f);
    const P part = min(max((wide - below) / (above - below), 0.0f), 1.0f);
    for (int k = 0; k < 16; ++k) {
      Texel sum = {0, 0, 0, 0};
      if (wanted >> k & 1) {
        const int j = int(level[k]);
        sum = bilinear(j, u[k], v[k]) * (1 - part[k]);
        if (part[k] > 0) sum += bilinear(j + 1, u[k], v[k]) * part[k];
      }
      r[k] = sum[0], g[k] = sum[1], b[k] = sum[2];
    }
  }

private:
  typedef float Texel __attribute__((vector_size(16)));
  static constexpr int most_levels = 12;
  struct Level {
    int width = 0, height = 0;
    double variance = 0;
    std::array<std::vector<float>, 3> plane;
  };
  /// Texels of four floats; one column more than the map (the first again) and a row beyond either pole.
  struct Stored {
    int width = 0, height = 0;
    std::size_t first = 0;
  };
  std::array<Stored, most_levels> level_{};
  Floats texels_;
  int levels_ = 0;
  float turn_ = 0, texel_ = 1;

  void store(const Level& l) {
    Stored& s = level_[levels_++];
    s = {l.width, l.height, texels_.size()};
    texels_.resize(texels_.size() + std::size_t(l.width + 1) * (l.height + 2) * 4);
    for (int c = 0; c < 3; ++c) {
      for (int y = -1; y <= l.height; ++y) {
        const float* row = l.plane[c].data() + std::size_t(std::clamp(y, 0, l.height - 1)) * l.width;
        // The row beyond a pole is what makes the pole itself, half-way to it, the row's mean from every side.
        const bool pole = y < 0 || y == l.height;
        double mean = 0;
        for (int x = 0; x < l.width && pole; ++x) mean += row[x] / l.width;
        float* to = texels_.data() + s.first + std::size_t(y + 1) * (l.width + 1) * 4 + c;
        for (int x = 0; x <= l.width; ++x) to[4 * x] = pole ? float(2 * mean) - row[x % l.width] : row[x % l.width];
      }
    }
  }
  Texel bilinear(int j, float u, float v) const {
    const Stored& s = level_[j];
    float x = u * float(s.width) - 0.5f;
    x = x < 0 ? x + float(s.width) : x;
    const float y = v * float(s.height) + 0.5f;
    const int i = std::min(int(x), s.width - 1), k = int(y);
    const float fx = x - float(i), fy = y - float(k);
    const float* p = texels_.data() + s.first + (std::size_t(k) * (s.width + 1) + i) * 4;
    Texel a, b, c, d;
    __builtin_memcpy(&a, p, 16);
    __builtin_memcpy(&b, p + 4, 16);
    __builtin_memcpy(&c, p + 4 * (s.width + 1), 16);
    __builtin_memcpy(&d, p + 4 * (s.width + 1) + 4, 16);
    const Texel top = a + (b - a) * fx, bottom = c + (d - c) * fx;
    return top + (bottom - top) * fy;
  }

  /// (4 fine - coarse) / 3, coarse bilinear between its texels; it is as large as fine or half of it.
  static Level sharpened(Level fine, const Level& coarse) {
    const int ratio = fine.width / coarse.width, w = coarse.width, h = coarse.height;
    for (int c = 0; c < 3; ++c) {
      const auto at = [&](int x, int y) {  // beyond a pole the meridian goes on half-way round
        const int over = y < 0 || y >= h ? w / 2 : 0;
        return coarse.plane[c][std::size_t(std::clamp(y, 0, h - 1)) * w + (x + over + w) % w];
      };
      for (int y = 0; y < fine.height; ++y) {
        const float v = (float(y) + 0.5f) / float(ratio) - 0.5f, row = std::floor(v), fy = v - row;
        for (int x = 0; x < fine.width; ++x) {
          const float u = (float(x) + 0.5f) / float(ratio) - 0.5f, column = std::floor(u), fx = u - column;
          const int i = int(column), k = int(row);
          const float top = at(i, k) + (at(i + 1, k) - at(i, k)) * fx;
          const float low = at(i, k + 1) + (at(i + 1, k + 1) - at(i, k + 1)) * fx;
          float& to = fine.plane[c][std::size_t(y) * fine.width + x];
          to = (4 * to - (top + (low - top) * fy)) / 3;
        }
      }
    }
    return fine;
  }
  /// from convolved on the sphere with exp((cos angle - 1) / sigma^2), at width x width / 2 texels; width is that of
  /// from or half of it. A row of the result is one item of work.
  static Level blurred(const Level& from, int width, double sigma) {
    constexpr double pi_ = 3.141592653589793;
    const int height = width / 2, ratio = from.width / width;
    Level to{width, height, 0, {}};
    for (auto& p : to.plane) p.resize(std::size_t(width) * height);
    const double step = pi_ / from.height, reach = std::min(3.2 * sigma, pi_), middle = 0.5 * ratio - 0.5;
    parallel_for(height, [&](int y) {
      const double t = (y + 0.5) * pi_ / height, sine = std::sin(t), cosine = std::cos(t);
      struct Taps {
        int row, first;
        std::vector<double> weight;
      };
      std::vector<Taps> taps;
      double sum = 0;
      for (int j = 0; j < from.height; ++j) {
        const double s = (j + 0.5) * step, both = cosine * std::cos(s), cross = sine * std::sin(s);
        const double least = (std::cos(reach) - both) / cross;  // cosine of the largest difference in azimuth
        if (least >= 1) continue;
        int n = from.width / 2;
        if (least > -1) n = std::min(n, int(std::ceil(std::acos(least) / (2 * pi_) * from.width)));
        Taps row{j, int(std::ceil(middle - n)), {}};
        for (int i = 0; i < std::min(2 * n + 1, from.width); ++i) {
          const double angle = (row.first + i - middle) * 2 * pi_ / from.width;
          row.weight.push_back(std::sin(s) * std::exp((both + cross * std::cos(angle) - 1) / (sigma * sigma)));
          sum += row.weight.back();
        }
        taps.push_back(std::move(row));
      }
      // Of every source row its even and odd texels apart, three times round, so that a tap is one straight loop by x.
      std::vector<float> round(std::size_t(ratio) * 3 * width), out(width);
      for (int c = 0; c < 3; ++c) {
        std::fill(out.begin(), out.end(), 0.0f);
        for (const Taps& row : taps) {
          const float* source = from.plane[c].data() + std::size_t(row.row) * from.width;
          for (int phase = 0; phase < ratio; ++phase) {
            for (int k = 0; k < 3 * width; ++k)
              round[std::size_t(phase) * 3 * width + k] = source[ratio * (k % width) + phase];
          }
          for (int i = 0; i < int(row.weight.size()); ++i) {
            const int at = row.first + i + from.width, phase = at % ratio;  // width texels further on: never negative
            const float* p = round.data() + std::size_t(phase) * 3 * width + (at - phase) / ratio;
            const float w = float(row.weight[i] / sum);
            for (int x = 0; x < width; ++x) out[x] += w * p[x];
          }
        }
        std::copy(out.begin(), out.end(), to.plane[c].begin() + std::size_t(y) * width);
      }
    });
    return to;
  }
};

}  // namespace burnish
