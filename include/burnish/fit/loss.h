// burnish/fit/loss.h -- how far an image is from a photo: the value, and its derivative by the image
// SPDX-License-Identifier: Apache-2.0
//
// Each loss has a form that adds weight times its derivative to an image of derivatives, so that several can be combined,
// and one that gives {loss, d_image}. Images are compared as they are: in whatever space, linear or display, they come.
#pragma once
#include <array>
#include <utility>
#include <burnish/scene/image.h>

namespace burnish {

/// weight * sum of mask |image - photo| / (3 sum of mask); 0 for an empty mask. All of one size; mask 0 to 1.
/// At image = photo the slope is given as 0.
inline double masked_l1(const Image& image, const Image& photo, const Mask& mask, double weight, Image& d_image) {
  const std::size_t n = std::size_t(image.width) * std::size_t(image.height);
  double area = 0, sum = 0;
  for (std::size_t i = 0; i < n; ++i) area += double(mask.values[i]);
  if (area == 0) return 0;
  const float scale = float(weight / (3 * area));
  for (int c = 0; c < 3; ++c) {
    const float *a = image.plane(c), *b = photo.plane(c), *m = mask.values.data();
    float* const d = d_image.plane(c);
    for (std::size_t i = 0; i < n; ++i) {
      if (m[i] == 0) continue;
      const float e = a[i] - b[i];
      sum += double(m[i]) * double(std::fabs(e));
      d[i] += scale * m[i] * (e > 0 ? 1.0f : e < 0 ? -1.0f : 0.0f);
    }
  }
  return weight * sum / (3 * area);
}
inline std::pair<double, Image> masked_l1(const Image& image, const Image& photo, const Mask& mask) {
  Image d(image.width, image.height);
  const double loss = masked_l1(image, photo, mask, 1, d);
  return {loss, std::move(d)};
}

/// Mean and variance of each channel under a mask.
struct Statistics {
  std::array<double, 3> mean{}, variance{};
  double area = 0;  ///< sum of the mask

  Statistics() = default;
  Statistics(const Image& image, const Mask& mask) {
    const std::size_t n = std::size_t(image.width) * std::size_t(image.height);
    for (std::size_t i = 0; i < n; ++i) area += double(mask.values[i]);
    if (area == 0) return;
    for (int c = 0; c < 3; ++c) {
      const float* const a = image.plane(c);
      double first = 0, second = 0;
      for (std::size_t i = 0; i < n; ++i) first += double(mask.values[i]) * double(a[i]);
      mean[std::size_t(c)] = first /= area;
      for (std::size_t i = 0; i < n; ++i)
        if (mask.values[i] != 0) second += double(mask.values[i]) * (double(a[i]) - first) * (double(a[i]) - first);
      variance[std::size_t(c)] = second / area;
    }
  }
};

/// weight * sum over channels of |mean - mean| + |variance - variance|: image under mask against what was found of the
/// photo's part, which need not lie on the same pixels (Yeh et al. 2022, PhotoScene). 0 where either part is empty.
inline double part_statistics(const Image& image, const Mask& mask, const Statistics& photo, double weight, Image& d_image) {
  const Statistics own(image, mask);
  if (own.area == 0 || photo.area == 0) return 0;
  const auto sign = [](double x) { return x > 0 ? 1.0 : x < 0 ? -1.0 : 0.0; };
  double loss = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double e = own.mean[c] - photo.mean[c], v = own.variance[c] - photo.variance[c];
    loss += std::fabs(e) + std::fabs(v);
    const double by_mean = weight * sign(e) / own.area, by_variance = 2 * weight * sign(v) / own.area;
    const float* const a = image.plane(int(c));
    float* const d = d_image.plane(int(c));
    for (std::size_t i = 0; i < std::size_t(image.width) * std::size_t(image.height); ++i)
      if (mask.values[i] != 0) d[i] += float(double(mask.values[i]) * (by_mean + by_variance * (double(a[i]) - own.mean[c])));
  }
  return weight * loss;
}
inline std::pair<double, Image> part_statistics(const Image& image, const Mask& mask, const Statistics& photo) {
  Image d(image.width, image.height);
  const double loss = part_statistics(image, mask, photo, 1, d);
  return {loss, std::move(d)};
}

}  // namespace burnish
