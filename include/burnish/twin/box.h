// burnish/twin/box.h -- a rectangle in a photo
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>

namespace burnish {

/// In pixels, x to the right and y down; a pixel i reaches from i to i + 1.
struct PixelBox {
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  float width() const { return x1 - x0; }
  float height() const { return y1 - y0; }
  float area() const { return std::max(width(), 0.0f) * std::max(height(), 0.0f); }
  bool contains(float x, float y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
  /// Larger by a share of its size on each side, within a picture of w x h.
  PixelBox grown(float share, int w, int h) const {
    const float dx = share * width(), dy = share * height();
    return {std::max(x0 - dx, 0.0f), std::max(y0 - dy, 0.0f), std::min(x1 + dx, float(w)), std::min(y1 + dy, float(h))};
  }
};

/// Intersection over union, 0 .. 1.
inline float iou(const PixelBox& a, const PixelBox& b) {
  const PixelBox both{std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
  const float sum = a.area() + b.area() - both.area();
  return sum > 0 ? both.area() / sum : 0;
}

}  // namespace burnish
