// burnish/light/irradiance.h -- the unblocked irradiance of every normal, as a small map
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <burnish/ad/packet.h>
#include <burnish/ad/parallel.h>
#include <burnish/light/environment.h>

namespace burnish {

/// E0, E5, E10 = int L nl (1 - nl)^(5k) over directions l for k = 0, 1, 2, each RGB, of an EnvironmentLight without its
/// suns: summed over the texels of the map for 64 x 32 normals, bilinear between them.
class IrradianceMap {
public:
  static constexpr int channels = 9;

  /// All cores; the same bits for any number of them.
  explicit IrradianceMap(const EnvironmentLight& e) : turn_(e.yaw) {
    // Always 128 rows: coarser texels are too large for the narrow x(nl)^2 lobe, finer ones a waste. A packet is 16
    // normals.
    const Image map = detail::resampled_panorama(e.map, 128);
    const int n = map.width * map.height;
    std::vector<vec3<float>> direction(n);
    std::vector<float> area(map.height);
    for (int y = 0; y < map.height; ++y) {
      area[y] = float(detail::texel_area(map.width, map.height, y));
      for (int x = 0; x < map.width; ++x) {
        direction[std::size_t(y) * map.width + x] =
            vec3<float>(latlong_direction((x + 0.5) / map.width, (y + 0.5) / map.height));
      }
    }
    parallel_for(height, [&](int row) {
      for (int column = 0; column < width; column += 16) {
        vec3<P> normal;
        for (int k = 0; k < 16; ++k) {
          const vec3<double> d = latlong_direction((column + k + 0.5) / width, (row + 0.5) / height);
          normal.x.v[k] = float(d.x), normal.y.v[k] = float(d.y), normal.z.v[k] = float(d.z);
        }
        P sum[channels] = {};
        for (int i = 0; i < n; ++i) {
          const vec3<float>& d = direction[i];
          const P nl = max(normal.x * d.x + normal.y * d.y + normal.z * d.z, 0.0f), u = max(1.0f - nl, 0.0f);
          const P x = (u * u) * (u * u) * u,
                  w[3] = {nl * area[i / map.width], nl * area[i / map.width] * x, nl * area[i / map.width] * x * x};
          for (int k = 0; k < 3; ++k) {
            for (int c = 0; c < 3; ++c) sum[3 * k + c] += w[k] * map.plane(c)[i];
          }
        }
        for (int c = 0; c < channels; ++c) {
          for (int k = 0; k < 16; ++k) at(row, column + k)[c] = sum[c][k];
        }
      }
    });
  }
  /// Of a unit world normal.
  std::array<float, channels> operator()(const vec3<float>& normal) const {
    const vec2<double> place = latlong(turned(vec3<double>(normal), -double(turn_)));
    const double x = place.x * width - 0.5, y = place.y * height - 0.5;
    const int column = int(std::floor(x)), row = int(std::floor(y));
    const float fx = float(x - column), fy = float(y - row);
    std::array<float, channels> e;
    for (int c = 0; c < channels; ++c) {
      const auto line = [&](int r) {
        // Beyond a pole the meridian goes on half-way round.
        const int over = r < 0 || r >= height ? width / 2 : 0, inside = r < 0 ? 0 : std::min(r, height - 1);
        const float a = at(inside, (column + over + width) % width)[c],
                    b = at(inside, (column + 1 + over + width) % width)[c];
        return a + (b - a) * fx;
      };
      const float top = line(row), bottom = line(row + 1);
      e[c] = top + (bottom - top) * fy;
    }
    return e;
  }

private:
  using P = Packet<float, 16>;
  static constexpr int width = 64, height = 32;
  std::array<float, std::size_t(width) * height * channels> values_{};
  float turn_ = 0;
  float* at(int row, int column) { return &values_[(std::size_t(row) * width + column) * channels]; }
  const float* at(int row, int column) const { return &values_[(std::size_t(row) * width + column) * channels]; }
};

}  // namespace burnish
