// burnish/street/find_sun.h -- the sun as a clipped spot of the sky: the circle about its glare
// SPDX-License-Identifier: Apache-2.0
//
// What the lens and the haze make of the sun is round. So the sun is looked for as the middle of a circle through that
// part of a clipped spot's rim which borders on unclipped sky: a horizon or a roof that cuts the spot does not pull.
#pragma once
#include <burnish/street/sky_mask.h>

namespace burnish {

struct SunSpot {
  vec3<double> direction;  ///< unit, towards the sun
  double sigma = 0;        ///< rad: standard deviation of the direction, of each of its two angles
  double radius = 0;       ///< of the clipped spot, rad
  double plausible = 0;    ///< 0 to 1: round, glowing, of a likely size
};

namespace detail {
struct Spot {
  std::vector<int> texels, rim;
  double area = 0;
  vec3<double> middle;
};
/// Connected clipped texels of the sky, largest first. Of the rim only what borders on sky that has sky around it.
inline std::vector<Spot> clipped_spots(const std::vector<char>& white, const SkyMask& m) {
  const int w = m.sky.width, h = m.sky.height;
  const auto open_sky = [&](int x, int y) {
    if (y > h * 0.49) return false;
    for (int dy = -2; dy <= 2; ++dy) {
      for (int dx = -2; dx <= 2; ++dx) {
        if (m.sky.at((x + dx + w) % w, std::clamp(y + dy, 0, h - 1)) < 0.5f) return false;
      }
    }
    return true;
  };
  std::vector<char> seen(white.size());
  std::vector<Spot> spots;
  for (int start = 0; start < w * h; ++start) {
    if (!white[std::size_t(start)] || seen[std::size_t(start)] || m.sky.values[std::size_t(start)] < 0.5f) continue;
    Spot s;
    seen[std::size_t(start)] = 1;
    s.texels.push_back(start);
    for (std::size_t at = 0; at < s.texels.size(); ++at) {
      const int i = s.texels[at], x = i % w, y = i / w;
      const double area = texel_area(w, h, y);
      s.area += area;
      s.middle += latlong_direction((x + 0.5) / w, (y + 0.5) / h) * area;
      bool edge = false;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          if (y + dy < 0 || y + dy >= h) continue;
          const int k = (y + dy) * w + (x + dx + w) % w;
          if (m.sky.values[std::size_t(k)] < 0.5f) continue;
          if (!white[std::size_t(k)]) edge = edge || open_sky(k % w, k / w);
          else if (!seen[std::size_t(k)]) seen[std::size_t(k)] = 1, s.texels.push_back(k);
        }
      }
      if (edge) s.rim.push_back(i);
    }
    s.middle = normalize(s.middle);
    spots.push_back(std::move(s));
  }
  std::stable_sort(spots.begin(), spots.end(), [](const Spot& a, const Spot& b) { return a.area > b.area; });
  return spots;
}

/// A circle on the sphere by points of its rim: Gauss-Newton on their distances, far ones counted less (Cauchy).
/// Gives the middle, the radius, the rms distance from it (robust), and the middle's standard deviation.
struct Circle {
  vec3<double> middle;
  double radius = 0, rms = 0, sigma = 0;
};
inline Circle fit_circle(const std::vector<vec3<double>>& rim, const vec3<double>& start) {
  Circle c{start};
  const auto angle = [](const vec3<double>& a, const vec3<double>& b) {
    return std::atan2(length(cross(a, b)), dot(a, b));
  };
  for (int step = 0; step < 40; ++step) {
    const vec3<double> x = normalize(cross(std::fabs(c.middle.y) < 0.9 ? vec3<double>(0, 1, 0) : vec3<double>(1, 0, 0),
                                           c.middle)),
                       y = cross(c.middle, x);
    std::vector<double> distance;
    for (const auto& p : rim) distance.push_back(angle(p, c.middle));
    if (step == 0) c.radius = median_of(distance);
    std::vector<double> off;
    for (const double d : distance) off.push_back(std::fabs(d - c.radius));
    const double spread = std::max(1.5 * median_of(off), 1e-3);
    double a[3][3] = {{1e-3, 0, 0}, {0, 1e-3, 0}, {0, 0, 1e-9}}, b[3] = {}, weights = 0, squares = 0;
    for (std::size_t i = 0; i < rim.size(); ++i) {
      const vec3<double> toward = rim[i] - c.middle * dot(rim[i], c.middle);
      const double s = std::max(length(toward), 1e-9), r = distance[i] - c.radius,
                   w = 1 / (1 + r * r / spread / spread);
      const double j[3] = {-dot(toward, x) / s, -dot(toward, y) / s, -1};
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) a[k][l] += w * j[k] * j[l];
        b[k] -= w * j[k] * r;
      }
      weights += w, squares += w * r * r;
    }
    c.rms = std::sqrt(squares / std::max(weights, 1e-9));
    // Symmetric 3 x 3 by cofactors; the inverse also tells how sure the middle is.
    const auto cofactor = [&](int i, int k) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
      return a[i1][k1] * a[i2][k2] - a[i1][k2] * a[i2][k1];
    };
    const double det = a[0][0] * cofactor(0, 0) + a[0][1] * cofactor(0, 1) + a[0][2] * cofactor(0, 2);
    double move[3] = {};
    for (int k = 0; k < 3; ++k) {
      for (int l = 0; l < 3; ++l) move[k] += cofactor(l, k) / det * b[l];
    }
    const double size = std::hypot(move[0], move[1]), most = 0.1 / std::max(size, 0.1);
    c.middle = normalize(c.middle + x * (move[0] * most) + y * (move[1] * most));
    c.radius += move[2] * most;
    // Neighbours on a rim are not independent: a tenth of them counts.
    c.sigma = c.rms * std::sqrt(10 * std::max(cofactor(0, 0), cofactor(1, 1)) / det);
    if (size < 1e-6) break;
  }
  return c;
}
}  // namespace detail

/// What of the clipped spots of the sky may be the sun, the most plausible first, five degrees apart at least.
/// panorama: as given to find_sky.
inline std::vector<SunSpot> find_suns(const Image& panorama, const SkyMask& m) {
  const int w = m.sky.width, h = m.sky.height;
  std::vector<SunSpot> all;
  // Where all channels are clipped the spot is smaller and rounder; with fewer, a sun in haze may still be seen.
  for (int channels = 3; channels >= 1; --channels) {
    std::vector<char> white(std::size_t(w) * h);
    for (std::size_t i = 0; i < white.size(); ++i) {
      int n = 0;
      for (int c = 0; c < 3; ++c) n += panorama.plane(c)[i] >= clipped_from;
      white[i] = n >= channels;
    }
    const auto spots = detail::clipped_spots(white, m);
    for (std::size_t k = 0; k < spots.size() && k < 8; ++k) {
      const detail::Spot& s = spots[k];
      std::vector<vec3<double>> rim;
      for (const int i : s.rim) rim.push_back(latlong_direction((i % w + 0.5) / w, (i / w + 0.5) / h));
      if (rim.size() < 3) continue;
      detail::Circle c = detail::fit_circle(rim, s.middle);
      const double texel = 3.141592653589793 / h;
      // A circle that leaves the spot, or is far larger, is none: the spot's middle then.
      const double even = std::sqrt(s.area / 3.14159);
      if (s.rim.size() < 8 || !(dot(c.middle, s.middle) > std::cos(std::min(1.5 * even + texel, 1.5))) ||
          c.radius > 2 * even + texel) {
        c.middle = s.middle, c.radius = even, c.sigma = 0.5 * even;
      }
      // Glow: how much lighter the sky is just outside than further off.
      double near = 0, far = 0, near_n = 1e-9, far_n = 1e-9;
      for (int y = 0; y < h; ++y) {
        for (int x = 0; x < w; ++x) {
          if (m.sky.at(x, y) < 0.5f || m.clipped.at(x, y) > 0.5f) continue;
          const double a =
              std::acos(std::clamp(dot(latlong_direction((x + 0.5) / w, (y + 0.5) / h), c.middle), -1.0, 1.0));
          const double l = double(luminance(panorama.at(x, y))), area = detail::texel_area(w, h, y);
          if (a < c.radius + 0.15) near += l * area, near_n += area;
          else if (a > c.radius + 0.5) far += l * area, far_n += area;
        }
      }
      const double glow = std::clamp((near / near_n) / std::max(far / far_n, 1e-3) - 1, 0.0, 1.5) / 1.5;
      const double roundness = 1 / (1 + std::pow(c.rms / (0.3 * c.radius + texel), 2));
      const double size = 1 / (1 + std::pow(std::log(std::max(c.radius, texel) / 0.12) / 1.5, 2));
      const double large = std::pow(s.area / spots[0].area, 0.25);
      const double plausible = large * roundness * size * (0.25 + 0.75 * glow) *
                               (channels == 3   ? 1
                                : channels == 2 ? 0.9
                                                : 0.8);
      if (c.middle.y > -0.02) all.push_back({c.middle, std::hypot(c.sigma, 0.5 * texel), c.radius, plausible});
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const SunSpot& a, const SunSpot& b) { return a.plausible > b.plausible; });
  std::vector<SunSpot> apart;
  for (const SunSpot& s : all) {
    if (std::none_of(apart.begin(), apart.end(),
                     [&](const SunSpot& o) { return dot(o.direction, s.direction) > 0.9962; }))
      apart.push_back(s);
  }
  return apart;
}

}  // namespace burnish
