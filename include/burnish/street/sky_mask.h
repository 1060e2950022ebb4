// burnish/street/sky_mask.h -- where in a panorama of eight bits the sky is, and what of it is clipped
// SPDX-License-Identifier: Apache-2.0
//
// Lat-long panoramas as in light/environment.h, linear, white at 1. Found by what is bright, smooth, not green and
// connected to the zenith; no network is asked. The panorama must be level: what lies below the horizon is no sky.
#pragma once
#include <array>
#include <numeric>
#include <burnish/light/environment.h>
#include <burnish/math/color.h>

namespace burnish {

/// A channel from here on is clipped: 0.98 of the coded range.
inline constexpr float clipped_from = 0.9554f;

struct SkyMask {
  Mask sky, clipped;    ///< 0 or 1; clipped: any channel, anywhere in the panorama
  double part = 0;      ///< of the upper half sphere that is sky
  double evidence = 0;  ///< that this is a sky and no ceiling: brighter and bluer than the ground; 0 is undecided
};

namespace detail {
inline double median_of(std::vector<double> v) {
  if (v.empty()) return 0;
  std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
  return v[v.size() / 2];
}
/// Every so manieth texel of a row makes rows count by their solid angle.
inline int row_step(int height, int y) {
  return std::max(1, int(1 / std::sin((y + 0.5) * 3.141592653589793 / height)));
}

/// What the sky is judged by, one texel each.
struct SkyFeatures {
  int width = 0, height = 0;
  std::vector<float> light, blue;  // ln luminance, ln blue/red
  std::vector<char> white, green;  // clipped; the green of plants

  explicit SkyFeatures(const Image& p) : width(p.width), height(p.height) {
    const std::size_t n = std::size_t(width) * height;
    light.resize(n), blue.resize(n), white.resize(n), green.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const vec3<float> c(p.plane(0)[i], p.plane(1)[i], p.plane(2)[i]);
      light[i] = std::log(luminance(c) + 1e-3f);
      blue[i] = std::log((c.z + 2e-3f) / (c.x + 2e-3f));
      white[i] = std::max({c.x, c.y, c.z}) >= clipped_from;
      green[i] = c.y > 1.05f * c.x && c.y > 1.15f * c.z;
    }
  }
  double elevation(int y) const { return 90 - (y + 0.5) * 180 / height; }  // degrees
  /// Medians over the rows between two elevations of what is not clipped and not black, as where no lens saw: ln
  /// luminance and ln blue/red.
  std::array<double, 2> medians(double low, double high, const std::vector<char>* inside = nullptr) const {
    std::vector<double> l, b;
    for (int y = 0; y < height; ++y) {
      if (elevation(y) < low || elevation(y) > high) continue;
      for (int x = 0; x < width; x += row_step(height, y)) {
        const std::size_t i = std::size_t(y) * width + x;
        if (!white[i] && light[i] > -6.8f && (!inside || (*inside)[i])) l.push_back(light[i]), b.push_back(blue[i]);
      }
    }
    return {median_of(l), median_of(b)};
  }
};

/// Grows from the seeds to candidates that differ little from the neighbour they are reached from.
inline void grow_sky(const SkyFeatures& f, const std::vector<char>& may, std::vector<char>& sky) {
  std::vector<int> open;
  for (int i = 0; i < int(sky.size()); ++i) {
    if (sky[std::size_t(i)]) open.push_back(i);
  }
  while (!open.empty()) {
    const int i = open.back(), x = i % f.width, y = i / f.width;
    open.pop_back();
    const int next[4] = {y * f.width + (x + 1) % f.width, y * f.width + (x + f.width - 1) % f.width,
                         y > 0 ? i - f.width : i, y + 1 < f.height ? i + f.width : i};
    for (const int k : next) {
      const std::size_t to = std::size_t(k), from = std::size_t(i);
      if (sky[to] || !may[to]) continue;
      const bool smooth = std::fabs(f.light[to] - f.light[from]) < 0.22f && std::fabs(f.blue[to] - f.blue[from]) < 0.3f;
      if (!(smooth || f.white[to] || f.white[from])) continue;
      sky[to] = 1;
      open.push_back(k);
    }
  }
}
}  // namespace detail

/// The sky of a panorama. Indoors evidence is below 0 and the mask empty.
inline SkyMask find_sky(const Image& panorama) {
  const detail::SkyFeatures f(panorama);
  const std::size_t n = std::size_t(f.width) * f.height;
  const auto ground = f.medians(-90, -15);
  std::vector<char> may(n), sky(n);
  for (int y = 0; y < f.height; ++y) {
    const double up = f.elevation(y);
    for (int x = 0; x < f.width; ++x) {
      const std::size_t i = std::size_t(y) * f.width + x;
      // Lighter than the ground; or much bluer, as the dark side of a clear sky over a sunny street.
      const bool blue = f.blue[i] > 0.15f && f.blue[i] > ground[1] + 0.5 && f.light[i] > ground[0] - 1.5;
      may[i] = up > -1.5 && (f.white[i] || (!f.green[i] && (f.light[i] > ground[0] + 0.1 || blue)));
      sky[i] = may[i] && up > 60;
    }
  }
  detail::grow_sky(f, may, sky);
  // A sky is brighter than the ground, bluer than the ground, and blue.
  const auto above = f.medians(0, 90, &sky);
  double area = 0;
  for (int y = 0; y < f.height; ++y) {
    for (int x = 0; x < f.width; ++x)
      area += sky[std::size_t(y) * f.width + x] * detail::texel_area(f.width, f.height, y) / 6.283185307179586;
  }
  SkyMask out{Mask(f.width, f.height), Mask(f.width, f.height)};
  out.evidence = (above[0] - ground[0]) + above[1] + 0.5 * (above[1] - ground[1]) - 1.15;
  if (area < 0.02) out.evidence = std::min(out.evidence, -1.0);
  if (out.evidence > 0) {
    // Patches between branches that the zenith is cut off from: clipped, or like the sky that lies next above them.
    for (int x = 0; x < f.width; ++x) {
      std::size_t last = n;
      for (int y = 0; y < f.height && f.elevation(y) > 2; ++y) {
        const std::size_t i = std::size_t(y) * f.width + x;
        if (may[i] && !sky[i])
          sky[i] = f.white[i] || (last < n && std::fabs(f.light[i] - f.light[last]) < 0.15f &&
                                  std::fabs(f.blue[i] - f.blue[last]) < 0.1f);
        if (sky[i] && !f.white[i]) last = i;
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    out.clipped.values[i] = f.white[i];
    out.sky.values[i] = out.evidence > 0 ? sky[i] : 0;
  }
  out.part = out.evidence > 0 ? area : 0;
  return out;
}

}  // namespace burnish
