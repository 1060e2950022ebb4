// burnish/light/lamps.h -- the bright parts of a map as points, and the dimmer map that they leave
// SPDX-License-Identifier: Apache-2.0
//
// Windows, lamps, the glow about a sun: too large to be suns, too bright to be met by a few wide samples. Seen from far
// off a lobe's middle, where the lobe is smooth, each is a few points.
#pragma once
#include <burnish/light/environment.h>

namespace burnish {

/// all + rest is the map of an EnvironmentLight (suns apart), its energy kept.
struct Lamps {
  /// Light of one direction: unit, in the world; radiance x solid angle.
  struct Lamp {
    vec3<float> direction, power;
  };
  static constexpr int most = 128, rows = 32;  // rows of the cells whose excess becomes a lamp each
  static constexpr double threshold = 2;       // times the mean radiance is what the map keeps of a texel

  std::vector<Lamp> all;  // strongest first
  EnvironmentLight rest;  // at most 128 rows: it is for wide samples

  explicit Lamps(const EnvironmentLight& e) {
    rest.yaw = e.yaw;
    rest.map = detail::resampled_panorama(e.map, std::min(128, e.map.height));
    const int w = rest.map.width, h = rest.map.height;
    const auto luminance = [](const vec3<float>& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; };
    double limit = 0;
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x)
        limit += threshold * luminance(rest.map.at(x, y)) * detail::texel_area(w, h, y) / 12.566370614359172;
    }
    struct Cell {
      vec3<double> direction, power;
      double excess = 0;
      std::vector<std::pair<int, float>> texels;  // and what part of each goes into the lamp
    };
    std::vector<Cell> cells(std::size_t(rows) * 2 * rows);  // fewer a row towards the poles
    for (int y = 0; y < h; ++y) {
      const int row = y * rows / h;
      const int columns = std::max(3, int(2 * rows * std::sin((row + 0.5) / rows * 3.141592653589793)));
      for (int x = 0; x < w; ++x) {
        const vec3<float> color = rest.map.at(x, y);
        const double l = luminance(color);
        if (l <= limit) continue;
        Cell& cell = cells[std::size_t(row) * 2 * rows + std::size_t(x * columns / w)];
        const double part = 1 - limit / l, excess = part * l * detail::texel_area(w, h, y);
        cell.direction += latlong_direction((x + 0.5) / w, (y + 0.5) / h) * excess;
        cell.power += vec3<double>(color) * (part * detail::texel_area(w, h, y));
        cell.excess += excess;
        cell.texels.emplace_back(y * w + x, float(part));
      }
    }
    std::erase_if(cells, [](const Cell& c) { return c.excess <= 0; });
    std::stable_sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) { return a.excess > b.excess; });
    if (cells.size() > std::size_t(most)) cells.resize(most);
    for (const Cell& c : cells) {
      all.push_back({vec3<float>(turned(normalize(c.direction), double(e.yaw))), vec3<float>(c.power)});
      for (const auto& [i, part] : c.texels) rest.map.set(i % w, i / w, rest.map.at(i % w, i / w) * (1 - part));
    }
  }
};

}  // namespace burnish
