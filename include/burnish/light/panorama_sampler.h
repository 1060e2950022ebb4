// burnish/light/panorama_sampler.h -- directions drawn where a panorama is bright
// SPDX-License-Identifier: Apache-2.0
//
// For Monte Carlo integration (Pharr, Jakob and Humphreys 2023, 12.5.2). Frame and lat-long as in light/environment.h;
// radiance between texel centres is bilinear, round the seam as well. Not differentiable.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>
#include <burnish/light/environment.h>

namespace burnish {

/// A panorama of any size, turned by yaw radians about +Y, suns left in it.
class PanoramaSampler {
public:
  struct Sample {
    vec3<float> direction;  ///< unit, world
    vec3<float> radiance;
    float density = 0;      ///< per steradian; 0: nothing shines
  };

  PanoramaSampler() = default;
  /// rows: of the table that directions are drawn by, at most; the radiance keeps the panorama's own texels.
  explicit PanoramaSampler(const Image& panorama, float yaw = 0, int rows = 1024)
      : map_(panorama), turn_(yaw), height_(std::clamp(panorama.height, 1, rows)), width_(2 * height_) {
    for (float& x : map_.values) x = x > 0 && x < 1e30f ? x : 0;
    const bool same_size = map_.height == height_ && map_.width == width_;
    const Image coarse = same_size ? map_ : detail::resampled_panorama(map_, height_);
    // A texel's weight: the brightest of what bilinear interpolation makes of it, so that the density is nowhere small
    // where the radiance is large.
    std::vector<float> bright(std::size_t(width_) * std::size_t(height_));
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        const vec3<float> c = coarse.at(x, y);
        bright[index(x, y)] = 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
      }
    double sum = 0;
    std::vector<double> weight(bright.size());
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        float mean = 0;
        for (int j = -1; j <= 1; ++j)
          for (int i = -1; i <= 1; ++i)
            mean += (i == 0 ? 2.0f : 1.0f) * (j == 0 ? 2.0f : 1.0f) / 16 *
                    bright[index((x + i + width_) % width_, std::clamp(y + j, 0, height_ - 1))];
        weight[index(x, y)] = double(mean) * detail::texel_area(width_, height_, y);
        sum += weight[index(x, y)];
      }
    // A tenth of all directions are drawn evenly: what the table's mean misses is found still.
    columns_.resize(weight.size() + std::size_t(height_)), rows_.resize(std::size_t(height_) + 1);
    part_.resize(weight.size());
    double above = 0;
    for (int y = 0; y < height_; ++y) {
      const double area = detail::texel_area(width_, height_, y) / 12.566370614359172;
      double left = 0;
      const std::size_t first = std::size_t(y) * std::size_t(width_ + 1);
      for (int x = 0; x < width_; ++x) {
        const double p = sum > 0 ? 0.9 * weight[index(x, y)] / sum + 0.1 * area : area;
        part_[index(x, y)] = float(p / area * 0.07957747154594767);
        columns_[first + std::size_t(x)] = left, left += p;
      }
      columns_[first + std::size_t(width_)] = left;
      rows_[std::size_t(y)] = above, above += left;
    }
    rows_[std::size_t(height_)] = above;
  }

  bool empty() const { return part_.empty(); }
  /// Irradiance on a plane with that unit normal, nothing in between.
  vec3<float> irradiance(const vec3<float>& normal) const {
    vec3<double> sum;
    for (int y = 0; y < map_.height; ++y)
      for (int x = 0; x < map_.width; ++x) {
        const vec3<double> d =
            turned(latlong_direction((x + 0.5) / map_.width, (y + 0.5) / map_.height), double(turn_));
        const double cosine = dot(d, vec3<double>(normal));
        if (cosine > 0) sum += vec3<double>(map_.at(x, y)) * (cosine * detail::texel_area(map_.width, map_.height, y));
      }
    return vec3<float>(sum);
  }
  float yaw() const { return turn_; }

  /// What arrives from a unit direction.
  vec3<float> radiance(const vec3<float>& direction) const {
    const vec2<double> uv = latlong(turned(vec3<double>(direction), double(-turn_)));
    const double x = uv.x * map_.width - 0.5, y = std::clamp(uv.y * map_.height - 0.5, 0.0, map_.height - 1.0);
    const int i = int(std::floor(x)), j = std::min(int(y), map_.height - 1), k = std::min(j + 1, map_.height - 1);
    const int l = (i + map_.width) % map_.width, r = (i + 1) % map_.width;
    const float u = float(x - i), v = float(y - j);
    return mix(mix(map_.at(l, j), map_.at(r, j), u), mix(map_.at(l, k), map_.at(r, k), u), v);
  }
  /// Of sample(), per steradian.
  float density(const vec3<float>& direction) const {
    const vec2<double> uv = latlong(turned(vec3<double>(direction), double(-turn_)));
    const int x = std::clamp(int(uv.x * width_), 0, width_ - 1), y = std::clamp(int(uv.y * height_), 0, height_ - 1);
    return part_[index(x, y)];
  }
  /// From u in [0, 1)^2.
  Sample sample(const vec2<float>& u) const {
    const double all = rows_.back();
    const auto row = std::upper_bound(rows_.begin() + 1, rows_.end() - 1, double(u.y) * all);
    const int y = int(row - rows_.begin()) - 1;
    const double in_row = rows_[std::size_t(y) + 1] - rows_[std::size_t(y)];
    const double v = std::clamp((double(u.y) * all - rows_[std::size_t(y)]) / in_row, 0.0, 1.0);
    const double* const c = &columns_[std::size_t(y) * std::size_t(width_ + 1)];
    const double target = double(u.x) * c[width_];
    const int x = int(std::upper_bound(c + 1, c + width_, target) - c) - 1;
    const double s = std::clamp((target - c[x]) / (c[x + 1] - c[x]), 0.0, 1.0);
    // Evenly over the texel's solid angle.
    const double step = 3.141592653589793 / height_, top = std::cos(step * y), bottom = std::cos(step * (y + 1));
    const double cosine = top + (bottom - top) * v, sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const double phi = 6.283185307179586 * (x + s) / width_;
    const vec3<double> d = turned(vec3<double>(sine * std::sin(phi), cosine, -sine * std::cos(phi)), double(turn_));
    const vec3<float> direction = normalize(vec3<float>(d));
    return {direction, radiance(direction), part_[index(x, y)]};
  }

private:
  Image map_;
  float turn_ = 0;
  int height_ = 0, width_ = 0;
  std::vector<double> rows_, columns_;  // summed probabilities: above each row, left of each texel in its row
  std::vector<float> part_;             // density in each texel, per steradian

  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width_) + std::size_t(x); }
};

}  // namespace burnish
