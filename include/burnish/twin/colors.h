// burnish/twin/colors.h -- what colours the parts of a photo's vehicle have: mixtures, and the paint's main colour
// SPDX-License-Identifier: Apache-2.0
//
// Colours are CIE Lab, lightness 0 to 100 (math/color.h).
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>
#include <burnish/math/vec.h>

namespace burnish {

namespace detail {
/// Gaussians with axes along L, a and b.
struct Mixture {
  struct One {
    float weight = 0;
    vec3<float> mean, variance;
  };
  std::vector<One> parts;

  static float density(const One& g, const vec3<float>& c) {
    const vec3<float> d = c - g.mean;
    const float q = d.x * d.x / g.variance.x + d.y * d.y / g.variance.y + d.z * d.z / g.variance.z;
    return g.weight * std::exp(-0.5f * q) / std::sqrt(g.variance.x * g.variance.y * g.variance.z);
  }
  /// A little everywhere, for colours that were not seen.
  float operator()(const vec3<float>& c) const {
    float sum = 1e-7f;
    for (const One& g : parts) sum += density(g, c);
    return sum;
  }
  /// One step to what the weighted colours are; at first apart by lightness.
  void fit(const std::vector<vec3<float>>& colors, const std::vector<float>& weights, int count) {
    if (parts.empty()) {
      std::vector<std::pair<float, float>> order;
      double all = 0;
      for (std::size_t i = 0; i < colors.size(); ++i)
        if (weights[i] > 0.02f) order.emplace_back(colors[i].x, weights[i]), all += double(weights[i]);
      if (order.empty()) return;
      std::sort(order.begin(), order.end());
      double sum = 0;
      for (const auto& [lightness, weight] : order) {
        sum += double(weight);
        if (int(parts.size()) < count && sum >= all * (double(parts.size()) + 0.5) / count)
          parts.push_back({1 / float(count), {lightness, 0, 0}, {100, 400, 400}});
      }
    }
    struct Sum {
      double weight = 0;
      vec3<double> first, second;
    };
    std::vector<Sum> sums(parts.size());
    double all = 0;
    std::vector<float> p(parts.size());
    for (std::size_t i = 0; i < colors.size(); ++i) {
      if (weights[i] <= 1e-4f) continue;
      float total = 1e-12f;
      for (std::size_t k = 0; k < parts.size(); ++k) total += p[k] = density(parts[k], colors[i]);
      for (std::size_t k = 0; k < parts.size(); ++k) {
        const double w = double(weights[i] * p[k] / total);
        const vec3<double> c(colors[i].x, colors[i].y, colors[i].z);
        sums[k].weight += w, sums[k].first = sums[k].first + c * w, sums[k].second = sums[k].second + c * c * w;
        all += w;
      }
    }
    for (std::size_t k = 0; k < parts.size() && all > 0; ++k) {
      const double w = sums[k].weight;
      parts[k].weight = float(w / all);
      if (w < 1e-3) continue;
      const vec3<double> m = sums[k].first / w, v = sums[k].second / w - m * m;
      parts[k].mean = {float(m.x), float(m.y), float(m.z)};
      parts[k].variance = {float(std::max(v.x, 9.0)), float(std::max(v.y, 4.0)), float(std::max(v.z, 4.0))};
    }
  }
};
}  // namespace detail

/// The colour that a painted body has most of, in CIE Lab. Panes, lamps, tyres and a roof of another colour are grey as
/// a rule; so where three tenths or more of the pixels have a colour (chroma above 20), it is the hue of most of that;
/// else what is grey and as light as most.
struct MainColor {
  bool colorful = false;
  float hue = 0, lightness = 0;  // radians, 0 to 100

  explicit MainColor(const std::vector<vec3<float>>& lab) {
    std::array<float, 36> hues{};
    std::array<int, 26> steps{};  // of lightness, 4 each
    std::size_t colored = 0;
    for (const vec3<float>& c : lab) {
      const float chroma = std::hypot(c.y, c.z);
      if (chroma > 20) ++colored, hues[std::size_t((std::atan2(c.z, c.y) / 6.2831853f + 1) * 36) % 36] += chroma;
      else ++steps[std::size_t(std::clamp(c.x / 4, 0.0f, 25.0f))];
    }
    const auto most = [](const auto& h) { return float(std::max_element(h.begin(), h.end()) - h.begin()); };
    colorful = 10 * colored >= 3 * lab.size() && !lab.empty();
    hue = (most(hues) + 0.5f) * 6.2831853f / 36, lightness = 4 * most(steps) + 2;
  }
  /// Within 40 degrees of the hue, or 30 of the lightness.
  bool like(const vec3<float>& c) const {
    const float chroma = std::hypot(c.y, c.z);
    if (!colorful) return chroma <= 20 && std::abs(c.x - lightness) <= 30;
    return chroma > 12 && std::abs(std::remainder(std::atan2(c.z, c.y) - hue, 6.2831853f)) < 0.75f;
  }
};

}  // namespace burnish
