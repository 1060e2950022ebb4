// burnish/street/refine_sun.h -- where a sun stands that has clipped the sky about it: by the fall of the glow around
// SPDX-License-Identifier: Apache-2.0
//
// Perez' thought, a radiance that is a product of what depends on the height above the horizon and what depends on the
// angle from the sun, without his formula: for a sun tried anywhere, ln radiance of each channel is a least-squares
// sum of smooth functions of both. The sun is where the rest is least. Each channel counts where it is not clipped:
// blue comes nearest to a low sun.
#pragma once
#include <burnish/ad/parallel.h>
#include <burnish/street/find_sun.h>

namespace burnish {

struct RefinedSun {
  vec3<double> direction;
  double sigma = 0;     ///< rad, of the larger of its two angles
  double residual = 0;  ///< robust rms of ln radiance
};

namespace detail {
/// What the misfit is made of: texels near the sun, and how much each counts.
struct GlowTexels {
  std::vector<vec3<double>> direction;
  std::vector<double> ln_radiance, weight;
};
/// Least squares of a few functions of the angle from `sun` and of the height; the robust mean of the misfit. With
/// `weights` they are what robustness has made of them on entry, and are made anew.
inline double glow_misfit(const GlowTexels& t, const vec3<double>& sun, std::vector<double>* weights = nullptr) {
  constexpr int n = 7;
  const std::size_t count = t.direction.size();
  std::vector<std::array<double, n>> basis(count);
  double a[n][n + 1] = {};
  for (std::size_t i = 0; i < count; ++i) {
    const vec3<double>& d = t.direction[i];
    const double g = std::acos(std::clamp(dot(d, sun), -1.0, 1.0)), up = std::asin(std::clamp(d.y, -1.0, 1.0));
    basis[i] = {1, std::log(g + 0.03), g, g * g, up, up * up, std::exp(-up / 0.08)};
    const double w = weights ? (*weights)[i] : t.weight[i];
    for (int k = 0; k < n; ++k) {
      for (int l = k; l < n; ++l) a[k][l] += w * basis[i][std::size_t(k)] * basis[i][std::size_t(l)];
      a[k][n] += w * basis[i][std::size_t(k)] * t.ln_radiance[i];
    }
  }
  for (int k = 0; k < n; ++k) {
    for (int l = 0; l < k; ++l) a[k][l] = a[l][k];
  }
  for (int k = 0; k < n; ++k) a[k][k] += k ? 1e-3 : 1e-9;
  for (int k = 0; k < n; ++k) {
    for (int l = 0; l < n; ++l) {
      const double f = l == k ? 0 : a[l][k] / a[k][k];
      for (int j = k; l != k && j <= n; ++j) a[l][j] -= f * a[k][j];
    }
  }
  constexpr double core = 0.08;
  double sum = 0, all = 0;
  for (std::size_t i = 0; i < count; ++i) {
    double r = t.ln_radiance[i];
    for (int k = 0; k < n; ++k) r -= a[k][n] / a[k][k] * basis[i][std::size_t(k)];
    const double q = r * r / core / core;
    sum += t.weight[i] * std::log1p(q), all += t.weight[i];
    if (weights) (*weights)[i] = t.weight[i] / (1 + q);
  }
  return sum / std::max(all, 1e-9);
}
}  // namespace detail

/// Between a spot's circle and the fall of the glow about it, each as sure as it is.
inline RefinedSun refine_sun(const Image& panorama, const SkyMask& m, const SunSpot& spot) {
  const int w = m.sky.width, h = m.sky.height;
  const double reach = spot.radius + 0.5;
  detail::GlowTexels channel[3];
  for (int y = 0; y < h / 2; ++y) {
    const int step = 4 * detail::row_step(h, y);
    for (int x = (y % 2) * step / 2; x < w; x += step) {
      const vec3<double> d = latlong_direction((x + 0.5) / w, (y + 0.5) / h);
      const double angle = std::acos(std::clamp(dot(d, spot.direction), -1.0, 1.0));
      if (m.sky.at(x, y) < 0.5f || angle > reach || d.y < 0.05) continue;
      for (int c = 0; c < 3; ++c) {
        const float v = panorama.plane(c)[std::size_t(y) * w + x];
        if (v >= clipped_from || v < 0.004f) continue;
        channel[c].direction.push_back(d);
        channel[c].ln_radiance.push_back(std::log(double(v)));
        channel[c].weight.push_back(1 - angle / reach);
      }
    }
  }
  const vec3<double> side = normalize(cross(vec3<double>(0, 1, 0), spot.direction)), over = cross(spot.direction, side);
  const auto place = [&](double a, double b) { return normalize(spot.direction + side * a + over * b); };
  std::vector<double> weights[3];
  const auto misfit = [&](double a, double b) {
    const vec3<double> sun = place(a, b);
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      if (channel[c].direction.size() < 100) continue;
      std::vector<double> own = weights[c];
      sum += detail::glow_misfit(channel[c], sun, &own);
    }
    return sum + (sun.y < -0.02 ? 10 * (-0.02 - sun.y) : 0);
  };
  for (int c = 0; c < 3; ++c) weights[c] = channel[c].weight;
  // Coarse to fine; the robust weights are those of the best place so far.
  double a = 0, b = 0, best = 0;
  for (double step = std::clamp(spot.radius / 3, 0.03, 0.1); step > 0.002; step /= 2) {
    for (int c = 0; c < 3; ++c) {
      if (channel[c].direction.size() < 100) continue;
      for (int k = 0; k < 3; ++k) detail::glow_misfit(channel[c], place(a, b), &weights[c]);
    }
    constexpr int side_n = 7;
    std::array<double, side_n * side_n> cost;
    parallel_for(side_n * side_n, [&](int i) {
      cost[std::size_t(i)] = misfit(a + (i % side_n - 3) * step, b + (i / side_n - 3) * step);
    });
    const int i = int(std::min_element(cost.begin(), cost.end()) - cost.begin());
    best = cost[std::size_t(i)];
    a += (i % side_n - 3) * step, b += (i / side_n - 3) * step;
  }
  RefinedSun out;
  out.residual = 0.08 * std::sqrt(std::expm1(best / 3));
  // How sure: where the mean misfit has grown by 2 % (texels are not independent).
  const auto width = [&](double da, double db) {
    double r = 0.005;
    while (r < 0.3 && misfit(a + da * r, b + db * r) < 1.02 * best) r *= 1.3;
    return r;
  };
  const double sure_a = std::max(width(1, 0), width(-1, 0)), sure_b = std::max(width(0, 1), width(0, -1));
  // Together with the circle. Its middle stands well in azimuth; but a spot that reaches down to the horizon, where the
  // haze takes its lower part away, lies too high by a third of its radius, more or less.
  const bool low = std::asin(spot.direction.y) - spot.radius < 0.05;
  const double circle_a = std::hypot(spot.sigma, 0.15 * spot.radius);
  const double circle_b = std::hypot(spot.sigma, (low ? 0.4 : 0.3) * spot.radius), lift = low ? -0.35 * spot.radius : 0;
  const auto weight = [](double sigma) { return 1 / (sigma * sigma); };
  out.direction = place(a * weight(sure_a) / (weight(sure_a) + weight(circle_a)),
                        (b * weight(sure_b) + lift * weight(circle_b)) / (weight(sure_b) + weight(circle_b)));
  if (out.direction.y < 0.01) out.direction = normalize(vec3<double>(out.direction.x, 0.01, out.direction.z));
  out.sigma = std::sqrt(1 / std::min(weight(sure_a) + weight(circle_a), weight(sure_b) + weight(circle_b)));
  return out;
}

}  // namespace burnish
