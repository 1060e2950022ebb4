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

  /// Which direction is drawn how often.
  class Table {
    friend PanoramaSampler;
    int height = 0, width = 0;
    std::vector<double> rows, columns;  // summed probabilities: above each row, left of each texel in its row
    std::vector<float> part;            // density in each texel, per steradian
    std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
  };

  PanoramaSampler() = default;
  /// rows: of the table that directions are drawn by, at most; the radiance keeps the panorama's own texels.
  explicit PanoramaSampler(const Image& panorama, float yaw = 0, int rows = 1024)
      : map_(panorama), turn_(yaw), cos_(std::cos(yaw)), sin_(std::sin(yaw)),
        height_(std::clamp(panorama.height, 1, rows)) {
    for (int y = 0; y <= height_; ++y) tops_.push_back(float(std::cos(3.141592653589793 * y / height_)));
    for (float& x : map_.values) x = x > 0 && x < 1e30f ? x : 0;
    texels_.reserve(std::size_t(map_.width) * std::size_t(map_.height));
    for (int y = 0; y < map_.height; ++y)
      for (int x = 0; x < map_.width; ++x) {
        const vec3<float> c = map_.at(x, y);
        texels_.emplace_back(c.x, c.y, c.z, 0.0f);
      }
    all_ = table([](const vec3<double>&) { return 1.0; });
  }
  /// For a plane with that unit normal on which something stands: by radiance times the root of the cosine. By the
  /// cosine itself, low directions would come too seldom; it is there that light is hidden.
  Table facing(const vec3<float>& normal) const {
    return table([&](const vec3<double>& d) {
      return std::sqrt(std::max(0.0, dot(turned(d, double(turn_)), vec3<double>(normal))));
    });
  }

  bool empty() const { return all_.part.empty(); }
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
    const vec2<float> at = place(direction);
    const float x = at.x * float(map_.width) - 0.5f,
                y = std::clamp(at.y * float(map_.height) - 0.5f, 0.0f, float(map_.height) - 1);
    const int i = int(std::floor(x)), j = int(y), k = std::min(j + 1, map_.height - 1);
    const int l = i < 0 ? i + map_.width : i, r = i + 1 >= map_.width ? i + 1 - map_.width : i + 1;
    const float u = x - float(i), v = y - float(j);
    const auto texel = [&](int column, int row) -> const vec4<float>& {
      return texels_[std::size_t(row) * std::size_t(map_.width) + std::size_t(column)];
    };
    const vec4<float> c = mix(mix(texel(l, j), texel(r, j), u), mix(texel(l, k), texel(r, k), u), v);
    return {c.x, c.y, c.z};
  }
  /// By radiance alone.
  const Table& everywhere() const { return all_; }
  /// Of sample(), per steradian.
  float density(const vec3<float>& direction) const { return density(direction, all_); }
  float density(const vec3<float>& direction, const Table& by) const {
    const vec2<float> at = place(direction);
    return by.part[by.index(std::clamp(int(at.x * float(by.width)), 0, by.width - 1),
                            std::clamp(int(at.y * float(by.height)), 0, by.height - 1))];
  }
  /// From u in [0, 1)^2, by radiance; or by a table of facing().
  Sample sample(const vec2<float>& u) const { return sample(u, all_); }
  Sample sample(const vec2<float>& u, const Table& by) const {
    const double all = by.rows.back();
    const auto row = std::upper_bound(by.rows.begin() + 1, by.rows.end() - 1, double(u.y) * all);
    const int y = int(row - by.rows.begin()) - 1;
    const double in_row = by.rows[std::size_t(y) + 1] - by.rows[std::size_t(y)];
    const float v = float(std::clamp((double(u.y) * all - by.rows[std::size_t(y)]) / in_row, 0.0, 1.0));
    const double* const c = &by.columns[std::size_t(y) * std::size_t(by.width + 1)];
    const double target = double(u.x) * c[by.width];
    const int x = int(std::upper_bound(c + 1, c + by.width, target) - c) - 1;
    const float s = float(std::clamp((target - c[x]) / (c[x + 1] - c[x]), 0.0, 1.0));
    // Evenly over the texel's solid angle.
    const float top = tops_[std::size_t(y)], cosine = top + (tops_[std::size_t(y) + 1] - top) * v;
    const float sine = std::sqrt(std::max(0.0f, (1 - cosine) * (1 + cosine)));
    const float phi = 2 * pi * (float(x) + s) / float(by.width);
    const float a = sine * std::sin(phi), b = -sine * std::cos(phi);
    const vec3<float> direction = normalize(vec3<float>(cos_ * a + sin_ * b, cosine, cos_ * b - sin_ * a));
    return {direction, radiance(direction), density(direction, by)};
  }

private:
  Image map_;
  std::vector<vec4<float>> texels_;     // the same, a texel's channels side by side
  float turn_ = 0, cos_ = 1, sin_ = 0;
  int height_ = 0;           // of the tables
  std::vector<float> tops_;  // cosine of the polar angle above each of their rows, and below the last
  Table all_;

  /// share(direction in the panorama's frame): of the radiance.
  template <class Share> Table table(Share share) const {
    Table t;
    const int h = t.height = height_, w = t.width = 2 * height_;
    const bool same_size = map_.height == h && map_.width == w;
    const Image coarse = same_size ? map_ : detail::resampled_panorama(map_, h);
    // A texel's weight: the mean of what bilinear interpolation makes of it, so that the density is nowhere small
    // where the radiance is large.
    std::vector<float> bright(std::size_t(w) * std::size_t(h));
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const vec3<float> c = coarse.at(x, y);
        bright[t.index(x, y)] = 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
      }
    double sum = 0;
    std::vector<double> weight(bright.size());
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        float mean = 0;
        for (int j = -1; j <= 1; ++j)
          for (int i = -1; i <= 1; ++i)
            mean += (i == 0 ? 2.0f : 1.0f) * (j == 0 ? 2.0f : 1.0f) / 16 *
                    bright[t.index((x + i + w) % w, std::clamp(y + j, 0, h - 1))];
        weight[t.index(x, y)] =
            double(mean) * detail::texel_area(w, h, y) * share(latlong_direction((x + 0.5) / w, (y + 0.5) / h));
        sum += weight[t.index(x, y)];
      }
    // A tenth of all directions are drawn evenly: what the table's mean misses is found still.
    t.columns.resize(weight.size() + std::size_t(h)), t.rows.resize(std::size_t(h) + 1), t.part.resize(weight.size());
    double above = 0;
    for (int y = 0; y < h; ++y) {
      const double area = detail::texel_area(w, h, y) / 12.566370614359172;
      double left = 0;
      const std::size_t first = std::size_t(y) * std::size_t(w + 1);
      for (int x = 0; x < w; ++x) {
        const double p = sum > 0 ? 0.9 * weight[t.index(x, y)] / sum + 0.1 * area : area;
        t.part[t.index(x, y)] = float(p / area * 0.07957747154594767);
        t.columns[first + std::size_t(x)] = left, left += p;
      }
      t.columns[first + std::size_t(w)] = left;
      t.rows[std::size_t(y)] = above, above += left;
    }
    t.rows[std::size_t(h)] = above;
    return t;
  }

  /// Where in the panorama a direction lies: latlong() in floats, fast; u in [0, 1], v in [0, 1].
  vec2<float> place(const vec3<float>& d) const {
    const float x = cos_ * d.x - sin_ * d.z, z = cos_ * d.z + sin_ * d.x;
    const float u = angle(x, -z) * (0.5f * inverse_pi);
    return {u < 0 ? u + 1 : u, angle(std::sqrt(x * x + z * z), d.y) * inverse_pi};
  }
  /// atan2(y, x) to about 1e-7 rad (Abramowitz and Stegun 1964, 4.4.49).
  static float angle(float y, float x) {
    const float a = std::abs(x), b = std::abs(y), most = std::max(a, b);
    if (!(most > 0)) return 0;
    const float t = std::min(a, b) / most, s = t * t;
    float r = t * (1 + s * (-0.3333314528f +
                            s * (0.1999355085f +
                                 s * (-0.1420889944f +
                                      s * (0.1065626393f +
                                           s * (-0.0752896400f +
                                                s * (0.0429096138f + s * (-0.0161657367f + s * 0.0028662257f))))))));
    if (b > a) r = 0.5f * pi - r;
    if (x < 0) r = pi - r;
    return y < 0 ? -r : r;
  }
};

}  // namespace burnish
