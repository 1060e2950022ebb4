// burnish/scene/image.h -- pictures as planes of floats
// SPDX-License-Identifier: Apache-2.0
//
// A picture is height x width, row by row, the first row on top. Every channel is a plane of its own that begins on a
// 64-byte boundary and is padded with zeros to a multiple of 16 floats, so that packets may run over its end.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <new>
#include <vector>
#include <burnish/math/vec.h>

namespace burnish {

/// The standard allocator on 64-byte boundaries.
template <class T> struct Aligned {
  using value_type = T;
  static constexpr std::align_val_t boundary{64};
  Aligned() = default;
  template <class U> constexpr Aligned(const Aligned<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), boundary)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, boundary); }
  friend constexpr bool operator==(const Aligned&, const Aligned&) { return true; }
};
using Floats = std::vector<float, Aligned<float>>;

/// n rounded up to a multiple of step.
constexpr std::size_t padded(std::size_t n, std::size_t step = 16) { return (n + step - 1) / step * step; }

/// One channel, height x width; as a mask 0 (out) to 1 (in).
struct Mask {
  int width = 0, height = 0;
  Floats values;

  Mask() = default;
  Mask(int w, int h, float value = 0) : width(w), height(h), values(padded(std::size_t(w) * h)) {
    if (value != 0) std::fill_n(values.begin(), std::size_t(w) * h, value);  // values begin as zeros
  }
  float& at(int x, int y) { return values[std::size_t(y) * width + x]; }
  float at(int x, int y) const { return values[std::size_t(y) * width + x]; }
};

/// Linear RGB (Rec. 709 primaries), scene-referred: 1 is the white of the photo, more is allowed.
struct Image {
  int width = 0, height = 0;
  Floats values;  // red plane, green plane, blue plane

  Image() = default;
  Image(int w, int h, vec3<float> color = {}) : width(w), height(h), values(3 * padded(std::size_t(w) * h)) {
    const float rgb[3] = {color.x, color.y, color.z};
    for (int c = 0; c < 3; ++c) std::fill_n(plane(c), std::size_t(w) * h, rgb[c]);
  }
  /// Floats from one plane to the next.
  std::size_t stride() const { return padded(std::size_t(width) * height); }
  float* plane(int channel) { return values.data() + channel * stride(); }
  const float* plane(int channel) const { return values.data() + channel * stride(); }
  vec3<float> at(int x, int y) const {
    const std::size_t i = std::size_t(y) * width + x;
    return {plane(0)[i], plane(1)[i], plane(2)[i]};
  }
  void set(int x, int y, const vec3<float>& color) {
    const std::size_t i = std::size_t(y) * width + x;
    plane(0)[i] = color.x, plane(1)[i] = color.y, plane(2)[i] = color.z;
  }
};

namespace detail {
/// For each of the n new places along a line of length m: the first old place and its weights, a tent as wide as the
/// coarser of the two steps (so bilinear when it enlarges, and free of aliases when it shrinks). Weights sum to 1.
struct Tent {
  std::vector<int> first;
  std::vector<float> weights;
  int count = 0;

  Tent(int m, int n) : first(n) {
    const double step = double(m) / n, reach = std::max(step, 1.0);
    count = std::min(m, int(std::ceil(2 * reach)) + 1);
    weights.assign(std::size_t(n) * count, 0.0f);
    for (int i = 0; i < n; ++i) {
      const double center = (i + 0.5) * step - 0.5;
      first[i] = std::clamp(int(std::ceil(center - reach)), 0, m - count);
      const auto weight = [&](int k) { return std::max(0.0, 1 - std::abs(first[i] + k - center) / reach); };
      double sum = 0, mean = 0, spread = 0;
      for (int k = 0; k < count; ++k) sum += weight(k), mean += weight(k) * (first[i] + k - center);
      mean /= sum;
      for (int k = 0; k < count; ++k) spread += weight(k) / sum * std::pow(first[i] + k - center - mean, 2);
      // Sampled, a tent leans a little to one side; away from the border it is set upright, so that a ramp stays one.
      const bool inside = center >= reach && center + reach <= m - 1;
      const double lean = inside && spread > 0 ? mean / spread : 0;
      for (int k = 0; k < count; ++k) {
        const double x = first[i] + k - center - mean;
        weights[std::size_t(i) * count + k] = float(weight(k) / sum * (1 - lean * x));
      }
    }
  }
};
inline void resize_plane(const float* from, int w, int h, float* to, int new_w, int new_h) {
  const Tent across(w, new_w), down(h, new_h);
  std::vector<float> rows(std::size_t(h) * new_w);
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < new_w; ++x) {
      float sum = 0;
      for (int k = 0; k < across.count; ++k) {
        sum += across.weights[std::size_t(x) * across.count + k] * from[std::size_t(y) * w + across.first[x] + k];
      }
      rows[std::size_t(y) * new_w + x] = sum;
    }
  }
  for (int y = 0; y < new_h; ++y) {
    for (int x = 0; x < new_w; ++x) {
      float sum = 0;
      for (int k = 0; k < down.count; ++k) {
        sum += down.weights[std::size_t(y) * down.count + k] * rows[std::size_t(down.first[y] + k) * new_w + x];
      }
      to[std::size_t(y) * new_w + x] = sum;
    }
  }
}
}  // namespace detail

/// The window of w x h pixels whose first is (x, y); beyond the picture its edge goes on.
inline Image cropped(const Image& image, int x, int y, int w, int h) {
  Image out(w, h);
  for (int j = 0; j < h; ++j) {
    for (int i = 0; i < w; ++i)
      out.set(i, j, image.at(std::clamp(x + i, 0, image.width - 1), std::clamp(y + j, 0, image.height - 1)));
  }
  return out;
}
/// Beyond the picture a mask is 0.
inline Mask cropped(const Mask& mask, int x, int y, int w, int h) {
  Mask out(w, h);
  for (int j = 0; j < h; ++j) {
    for (int i = 0; i < w; ++i) {
      if (x + i >= 0 && x + i < mask.width && y + j >= 0 && y + j < mask.height) out.at(i, j) = mask.at(x + i, y + j);
    }
  }
  return out;
}

/// The same picture in another size: bilinear when larger, a tent over all pixels it covers when smaller.
inline Image resized(const Image& image, int width, int height) {
  Image out(width, height);
  for (int c = 0; c < 3; ++c) {
    detail::resize_plane(image.plane(c), image.width, image.height, out.plane(c), width, height);
  }
  return out;
}
inline Mask resized(const Mask& mask, int width, int height) {
  Mask out(width, height);
  detail::resize_plane(mask.values.data(), mask.width, mask.height, out.values.data(), width, height);
  return out;
}

}  // namespace burnish
