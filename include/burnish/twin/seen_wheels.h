// burnish/twin/seen_wheels.h -- wheels in a photo: dark rings with something lighter in them, and the ground below
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>
#include <burnish/scene/image.h>
#include <burnish/twin/box.h>

namespace burnish {

/// An upright ellipse around a tyre, in pixels.
struct SeenWheel {
  float x = 0, y = 0, rx = 0, ry = 0;
  float score = 0;  // in sRGB codes of contrast; below 12 it is hardly one

  float bottom() const { return y + ry; }
  bool contains(float px, float py) const {
    const float u = (px - x) / rx, v = (py - y) / ry;
    return u * u + v * v <= 1;
  }
};

/// Places that may be wheels of the vehicle in a box, at most four, apart from each other, the surest first. grey: encoded,
/// a pixel's colour is the vehicle's than the background's, as a logarithm; below a wheel is ground.
/// Every ellipse of a raster is tried: its ring must be dark and even, lighter inside and below.
inline std::vector<SeenWheel> wheel_places(const Mask& grey, const Mask& vehicle, const PixelBox& box) {
  constexpr int around = 24;
  std::array<float, around> cosine, sine;
  for (int i = 0; i < around; ++i) {
    const float angle = 6.2831853f * float(i) / around;
    cosine[std::size_t(i)] = std::cos(angle), sine[std::size_t(i)] = std::sin(angle);
  }
  const float h = box.height();
  std::vector<SeenWheel> found;
  for (int size = 0; size < 10; ++size)
    for (const float aspect : {0.4f, 0.55f, 0.7f, 0.85f, 1.0f}) {
      SeenWheel e;
      e.ry = h * (0.09f + 0.02f * float(size)), e.rx = aspect * e.ry;
      if (e.rx < 3) continue;
      const auto at = [&](const Mask& m, float radius, int i) {
        const int x = int(e.x + radius * e.rx * cosine[std::size_t(i)]),
                  y = int(e.y + radius * e.ry * sine[std::size_t(i)]);
        return m.at(std::clamp(x, 0, m.width - 1), std::clamp(y, 0, m.height - 1));
      };
      for (e.y = box.y0 + 0.55f * h; e.y < box.y1 - 0.7f * e.ry; e.y += 2)
        for (e.x = box.x0 + 0.8f * e.rx; e.x < box.x1 - 0.8f * e.rx; e.x += 2) {
          float ring = 0, square = 0, inner = 0, below = 0, odds = 0;
          for (int i = 0; i < around; ++i) {
            for (const float r : {0.8f, 0.9f}) {
              const float v = at(grey, r, i);
              ring += v, square += v * v;
            }
            for (const float r : {0.15f, 0.35f, 0.5f}) inner += at(grey, r, i);
            if (sine[std::size_t(i)] > 0.45f) below += at(grey, 1.15f, i), odds += at(vehicle, 1.2f, i);
          }
          constexpr float lower = 9;  // angles that look down
          ring /= 2 * around, square /= 2 * around, inner /= 3 * around, below /= lower, odds /= lower;
          if (odds > 0.25f) continue;
          const float spread = std::sqrt(std::max(square - ring * ring, 0.0f));
          const float contrast = inner - ring - spread + 0.5f * std::min(below - ring, 0.24f);
          e.score = 255 * contrast * std::sqrt(e.ry / h);
          if (e.score > 4) found.push_back(e);
        }
    }
  std::stable_sort(found.begin(), found.end(),
                   [](const SeenWheel& a, const SeenWheel& b) { return a.score > b.score; });
  std::vector<SeenWheel> kept;
  for (const SeenWheel& e : found) {
    const bool apart = std::all_of(kept.begin(), kept.end(), [&](const SeenWheel& k) {
      return std::hypot((e.x - k.x) / (e.rx + k.rx), (e.y - k.y) / (e.ry + k.ry)) > 0.9f;
    });
    if (apart) kept.push_back(e);
    if (kept.size() == 4) break;
  }
  return kept;
}

/// How far below the ground a place is that two wheels touch, in pixels, across their line; negative above.
inline float below_ground(const SeenWheel& a, const SeenWheel& b, float x, float y) {
  const float dx = b.x - a.x, dy = b.bottom() - a.bottom();
  const float across = (dx * (y - a.bottom()) - dy * (x - a.x)) / std::max(std::hypot(dx, dy), 1e-6f);
  return dx < 0 ? -across : across;
}

/// Two wheels that can be those of one side, with no more than a hundredth of the box that looks like the vehicle below the
/// ground that they touch; or else the surest one, or none.
inline std::vector<SeenWheel> seen_wheels(const Mask& grey, const Mask& vehicle, const PixelBox& box) {
  constexpr float sure = 15;
  const std::vector<SeenWheel> all = wheel_places(grey, vehicle, box);
  std::vector<SeenWheel> best;
  float most = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      const SeenWheel &a = all[i], &b = all[j];
      if (b.score < sure || std::fabs(a.x - b.x) < 1.5f * (a.rx + b.rx) || a.score + b.score < most) continue;
      int below = 0;
      for (int y = std::max(0, int(box.y0)); y < std::min(int(box.y1), vehicle.height); ++y)
        for (int x = std::max(0, int(box.x0)); x < std::min(int(box.x1), vehicle.width); ++x)
          below += vehicle.at(x, y) > 0.5f && below_ground(a, b, float(x), float(y)) > 0.1f * std::max(a.ry, b.ry);
      if (float(below) < 0.01f * box.area()) best = {a, b}, most = a.score + b.score;
    }
  if (best.empty() && !all.empty() && all[0].score >= sure) best = {all[0]};
  return best;
}

}  // namespace burnish
