// burnish/light/environment.h -- a panorama as light: a map without its brightest texels, and those as suns
// SPDX-License-Identifier: Apache-2.0
//
// World frame: +Y up. Lat-long: u = atan2(d.x, -d.z) / (2 pi), v = acos(d.y) / pi; u = 0 looks to -Z, u = 1/4 to +X;
// row 0 is the zenith, texel centres lie at (i + 0.5) / width. Radiance is linear RGB.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>
#include <burnish/light/sun.h>
#include <burnish/scene/image.h>

namespace burnish {

/// The place of a unit direction in an unturned panorama; u in [0, 1], v in [0, 1].
inline vec2<double> latlong(const vec3<double>& d) {
  const double u = std::atan2(d.x, -d.z) * 0.15915494309189534;
  return {u - std::floor(u), std::atan2(std::sqrt(d.x * d.x + d.z * d.z), d.y) * 0.3183098861837907};
}
inline vec3<double> latlong_direction(double u, double v) {
  const double p = u * 6.283185307179586, t = v * 3.141592653589793;
  return {std::sin(t) * std::sin(p), std::cos(t), -std::sin(t) * std::cos(p)};
}
/// d turned by yaw radians about +Y; a positive yaw turns -Z towards -X.
template <class T> constexpr vec3<T> turned(const vec3<T>& d, const T& yaw) {
  const T c = cos(yaw), s = sin(yaw);
  return {c * d.x + s * d.z, d.y, c * d.z - s * d.x};
}

namespace detail {
/// Solid angle of a texel in that row, sr.
inline double texel_area(int width, int height, int row) {
  constexpr double pi_ = 3.141592653589793;
  return (std::cos(pi_ * row / height) - std::cos(pi_ * (row + 1) / height)) * 2 * pi_ / width;
}

/// The panorama as height x 2 height texels, averaged by solid angle, so that radiance x solid angle is kept. Texels
/// that are negative or no numbers count as black.
inline Image resampled_panorama(const Image& from, int height) {
  constexpr double pi_ = 3.141592653589793;
  const int width = 2 * height;
  Image to(width, height);
  if (from.width < 1 || from.height < 1) return to;
  const auto clean = [](float x) { return x > 0 && x < std::numeric_limits<float>::infinity() ? double(x) : 0.0; };
  std::vector<double> rows(std::size_t(from.height) * width);
  for (int c = 0; c < 3; ++c) {
    for (int y = 0; y < from.height; ++y) {
      for (int x = 0; x < width; ++x) {
        const double x0 = double(x) * from.width / width, x1 = double(x + 1) * from.width / width;
        double sum = 0;
        for (int i = int(x0); i < std::min(from.width, int(std::ceil(x1))); ++i) {
          const double overlap = std::min(x1, i + 1.0) - std::max(x0, double(i));
          sum += overlap * clean(from.plane(c)[std::size_t(y) * from.width + i]);
        }
        rows[std::size_t(y) * width + x] = sum / (x1 - x0);
      }
    }
    for (int y = 0; y < height; ++y) {
      const double y0 = double(y) * from.height / height, y1 = double(y + 1) * from.height / height;
      const auto depth = [&](double a, double b) {
        return std::cos(pi_ * a / from.height) - std::cos(pi_ * b / from.height);
      };
      for (int x = 0; x < width; ++x) {
        double sum = 0;
        for (int j = int(y0); j < std::min(from.height, int(std::ceil(y1))); ++j) {
          sum += depth(std::max(y0, double(j)), std::min(y1, j + 1.0)) * rows[std::size_t(j) * width + x];
        }
        to.plane(c)[std::size_t(y) * width + x] = float(sum / depth(y0, y1));
      }
    }
  }
  return to;
}
}  // namespace detail

/// Light from infinitely far away. map x solid angle + the suns' powers is the panorama's whole energy.
struct EnvironmentLight {
  /// Brightest texels that may become suns, and how many times the mean radiance they must exceed.
  static constexpr int sun_texels = 64;
  static constexpr float sun_threshold = 8;
  /// Texels nearer to each other than this are one sun, rad.
  static constexpr double sun_merge = 0.01;
  /// What shines with less than this part of the whole energy stays in the map, and all but the strongest few.
  static constexpr double sun_part = 1e-4;
  static constexpr int most_suns = 8;

  Image map;                     // without the suns; height is a power of two, 16 to 512, width twice that
  std::vector<Sun<float>> suns;  // in the world, yaw applied; strongest first
  float yaw = 0;                 // a world direction d is looked up in the map at turned(d, -yaw)

  EnvironmentLight() : EnvironmentLight(Image()) {}
  /// A lat-long panorama of any size, turned by yaw radians about +Y (a positive yaw turns what lies at -Z towards -X).
  explicit EnvironmentLight(const Image& panorama, float turn = 0, bool split_suns = true) : yaw(turn) {
    int height = 16;
    while (height < 512 && height < panorama.height) height *= 2;
    map = detail::resampled_panorama(panorama, height);
    if (split_suns) split();
  }
  /// All light of the panorama, radiance x solid angle, the suns included.
  vec3<double> energy() const {
    vec3<double> sum;
    for (int y = 0; y < map.height; ++y) {
      for (int x = 0; x < map.width; ++x)
        sum += vec3<double>(map.at(x, y)) * detail::texel_area(map.width, map.height, y);
    }
    for (const Sun<float>& s : suns) sum += vec3<double>(s.power);
    return sum;
  }

private:
  static double luminance(const vec3<float>& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

  /// What the brightest texels have above the threshold goes into suns, merged within sun_merge.
  void split() {
    struct Texel {
      int index;
      double luminance;
    };
    std::vector<Texel> order(std::size_t(map.width) * map.height);
    double mean = 0;
    for (int i = 0; i < int(order.size()); ++i) {
      order[i] = {i, luminance(map.at(i % map.width, i / map.width))};
      mean += order[i].luminance * detail::texel_area(map.width, map.height, i / map.width) / 12.566370614359172;
    }
    const auto brighter = [](const Texel& a, const Texel& b) {
      return a.luminance != b.luminance ? a.luminance > b.luminance : a.index < b.index;
    };
    std::partial_sort(order.begin(), order.begin() + sun_texels + 1, order.end(), brighter);
    const double threshold = std::max(order[sun_texels].luminance, sun_threshold * mean),
                 step = 3.141592653589793 / map.height;
    struct Cluster {
      vec3<double> direction, power;
      double variance;
      std::vector<std::pair<int, vec3<float>>> texels;  // as they were
      double strength = 0;                              // luminance of the power
    };
    std::vector<Cluster> clusters;
    for (int k = 0; k < sun_texels && order[k].luminance > threshold; ++k) {
      const int x = order[k].index % map.width, y = order[k].index / map.width;
      const vec3<float> color = map.at(x, y);
      const double part = 1 - threshold / order[k].luminance, sine = std::sin((y + 0.5) * step);
      map.set(x, y, color * float(1 - part));
      // The variance of a bilinear texel, a tent in both directions, meaned over them.
      const Cluster c{latlong_direction((x + 0.5) / map.width, (y + 0.5) / map.height),
                      vec3<double>(color) * (part * detail::texel_area(map.width, map.height, y)),
                      step * step / 6 * (1 + sine * sine) / 2,
                      {{order[k].index, color}}};
      Cluster* nearest = nullptr;
      double best = sun_merge * sun_merge;
      for (Cluster& o : clusters) {
        const vec3<double> d = o.direction - c.direction;
        if (const double d2 = dot(d, d); d2 < best) best = d2, nearest = &o;
      }
      if (!nearest) {
        clusters.push_back(c);
        continue;
      }
      Cluster& o = *nearest;
      const double a = luminance(vec3<float>(o.power)), b = luminance(vec3<float>(c.power)), wa = a / (a + b),
                   wb = b / (a + b);
      o.variance = wa * o.variance + wb * c.variance + wa * wb * best / 2;
      o.direction = normalize(o.direction * wa + c.direction * wb);
      o.power += c.power;
      o.texels.push_back(c.texels[0]);
    }
    // Kept, and not computed as they are compared: a compiler that fuses one side's products and not the other's would
    // find either of two like suns the brighter.
    for (Cluster& c : clusters) c.strength = luminance(vec3<float>(c.power));
    std::sort(clusters.begin(), clusters.end(), [](const Cluster& a, const Cluster& b) {
      return a.strength != b.strength ? a.strength > b.strength : a.texels[0].first < b.texels[0].first;
    });
    for (const Cluster& c : clusters) {
      if (int(suns.size()) == most_suns || c.strength < sun_part * 12.566370614359172 * mean) {
        for (const auto& [index, color] : c.texels) map.set(index % map.width, index / map.width, color);
        continue;
      }
      Sun<float> s;
      s.direction = vec3<float>(turned(c.direction, double(yaw)));
      s.power = vec3<float>(c.power);
      s.variance = float(c.variance);
      s.index = float(suns.size());
      suns.push_back(s);
    }
  }
};

}  // namespace burnish
