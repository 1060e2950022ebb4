// burnish/twin/window.h -- the part of a photo that holds the vehicle, at the size at which it is looked at
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <burnish/scene/error.h>
#include <burnish/scene/image.h>
#include <burnish/twin/pose.h>

namespace burnish {

/// A rectangle of the photo, seen on width x height pixels. Smaller ones are means over areas.
struct Window {
  int x = 0, y = 0, w = 0, h = 0;  // in the photo's pixels
  int width = 0, height = 0;       // its own pixels

  /// The whole picture.
  static Window whole(int width, int height) { return {0, 0, width, height, width, height}; }
  /// Around what the mask covers, and `margin` of its longer side more where the photo goes on: beyond the photo's
  /// border nobody knows what is there. The window has at most `longest` pixels along its longer side. Error for an
  /// empty mask.
  static Window around(const Mask& mask, int longest, float margin = 0.2f) {
    int x0 = mask.width, y0 = mask.height, x1 = 0, y1 = 0;
    for (int j = 0; j < mask.height; ++j)
      for (int i = 0; i < mask.width; ++i)
        if (mask.at(i, j) > 0.5f)
          x0 = std::min(x0, i), y0 = std::min(y0, j), x1 = std::max(x1, i + 1), y1 = std::max(y1, j + 1);
    if (x1 <= x0) throw Error("the mask is empty, expected a vehicle on it");
    const int more = int(std::ceil(margin * float(std::max(x1 - x0, y1 - y0))));
    x0 = std::max(0, x0 - more), y0 = std::max(0, y0 - more);
    x1 = std::min(mask.width, x1 + more), y1 = std::min(mask.height, y1 + more);
    return Window{x0, y0, x1 - x0, y1 - y0, x1 - x0, y1 - y0}.at_most(longest);
  }
  /// The same rectangle on at most `longest` pixels along its longer side, and never more than it has.
  Window at_most(int longest) const {
    Window out = *this;
    const int side = std::max(w, h);
    out.width = side <= longest ? w : std::max(1, int(std::lround(double(w) * longest / side)));
    out.height = side <= longest ? h : std::max(1, int(std::lround(double(h) * longest / side)));
    return out;
  }
  float across() const { return float(width) / float(w); }  ///< own pixels per pixel of the photo
  float along() const { return float(height) / float(h); }

  /// The window's own camera; the pose is of the whole photo.
  Camera camera(const Pose<float>& pose) const {
    Camera c = pose.camera().cropped(x, y, width, height);
    c.fx *= across(), c.cx *= across(), c.fy *= along(), c.cy *= along();
    return c;
  }
  /// Where the window sees a point; the pose is a Pose or a StretchedPose of any number.
  template <class P> constexpr auto project(const P& pose, const vec3<float>& point) const {
    auto p = pose.project(point);
    p.x = (p.x - float(x)) * across(), p.y = (p.y - float(y)) * along();
    return p;
  }
  Mask of(const Mask& mask) const {
    Mask out(width, height);
    shrink(mask.values.data(), mask.width, out.values.data());
    return out;
  }
  Image of(const Image& image) const {
    Image out(width, height);
    for (int c = 0; c < 3; ++c) shrink(image.plane(c), image.width, out.plane(c));
    return out;
  }

private:
  void shrink(const float* from, int stride, float* to) const {
    const double sx = double(w) / width, sy = double(h) / height;
    for (int j = 0; j < height; ++j)
      for (int i = 0; i < width; ++i) {
        const double x0 = i * sx, x1 = (i + 1) * sx, y0 = j * sy, y1 = (j + 1) * sy;
        double sum = 0;
        for (int v = int(y0); v < std::min(h, int(std::ceil(y1))); ++v)
          for (int u = int(x0); u < std::min(w, int(std::ceil(x1))); ++u)
            sum += double(from[std::size_t(v + y) * std::size_t(stride) + std::size_t(u + x)]) *
                   (std::min(x1, u + 1.0) - std::max(x0, double(u))) *
                   (std::min(y1, v + 1.0) - std::max(y0, double(v)));
        to[std::size_t(j) * std::size_t(width) + std::size_t(i)] = float(sum / (sx * sy));
      }
  }
};

}  // namespace burnish
