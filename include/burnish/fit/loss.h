// burnish/fit/loss.h -- how far an image is from a photo: the value, and its derivative by the image
// SPDX-License-Identifier: Apache-2.0
//
// Each loss has a form that adds weight times its derivative to an image of derivatives, so that several can be
// combined, and one that gives {loss, d_image}. Images are compared as they are: in whatever space, linear or display,
// they come. Image, photo, mask and derivative are of one size; a mask is 0 to 1, and where it is 0 nothing is read or
// touched. Sums are in double, their order always the same.
#pragma once
#include <array>
#include <utility>
#include <burnish/ad/packet.h>
#include <burnish/scene/image.h>

namespace burnish {

namespace detail::losses {

/// Eight pixels of an image; what they sum to is kept in eight doubles.
using Pixels = Packet<float, 8>;
using Sums = Packet<double, 8>;
inline Sums to_double(const Pixels& x) { return Sums(convert<Sums::V>(x.v)); }

// By bits, as g++ 12 takes comparisons apart where a packet is wider than the machine's registers.
inline constexpr std::uint32_t magnitude = 0x7fffffff;
inline Pixels size_of(const Pixels& x) { return bits<Pixels>(Pixels::U(bits<Pixels::U>(x) & magnitude)); }
/// All bits of the lanes that are not 0, and none of the others.
inline Pixels::U nonzero(const Pixels& x) { return Pixels::U(Pixels::I(0u - (bits<Pixels::U>(x) & magnitude)) >> 31); }
/// x in those lanes, 0 in the others, whatever x is there.
inline Pixels only(const Pixels::U& where, const Pixels& x) {
  return bits<Pixels>(Pixels::U(where & bits<Pixels::U>(x)));
}
inline Pixels only(const Pixels::U& where, const Pixels& x, const Pixels& other) {
  return bits<Pixels>(Pixels::U((where & bits<Pixels::U>(x)) | (~where & bits<Pixels::U>(other))));
}
/// size with x's sign; 0 where x is.
inline Pixels with_sign(const Pixels& size, const Pixels& x) {
  return bits<Pixels>(Pixels::U((bits<Pixels::U>(size) ^ (bits<Pixels::U>(x) & ~magnitude)) & nonzero(x)));
}

/// f(first pixel, mask, nonzero(mask)) for every eight pixels that are not all outside. Planes are padded, so the last
/// eight may run over.
template <class F> [[gnu::always_inline]] inline void each_inside(const Mask& mask, F f) {
  for (std::size_t i = 0; i < mask.values.size(); i += std::size_t(Pixels::size)) {
    std::uint64_t any[4];
    __builtin_memcpy(any, mask.values.data() + i, sizeof any);
    if (!(any[0] | any[1] | any[2] | any[3])) continue;
    const Pixels m = Pixels::load(mask.values.data() + i);
    f(i, m, nonzero(m));
  }
}
inline double area(const Mask& mask) {
  Sums sum = 0.0;
  each_inside(mask, [&](std::size_t, const Pixels& m, const auto&) { sum += to_double(m); });
  return sum.sum();
}
inline double sign(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

}  // namespace detail::losses

/// weight * sum of mask |image - photo| / (3 sum of mask); 0 for an empty mask. At image = photo the slope is given
/// as 0.
inline double masked_l1(const Image& image, const Image& photo, const Mask& mask, double weight, Image& d_image) {
  using namespace detail::losses;
  const double area = detail::losses::area(mask);
  if (area == 0) return 0;
  const Pixels scale = float(weight / (3 * area));
  std::array<Sums, 3> sums{};
  each_inside(mask, [&](std::size_t i, const Pixels& m, const Pixels::U& inside) {
    for (std::size_t c = 0; c < 3; ++c) {
      float* const d = d_image.plane(int(c)) + i;
      const Pixels before = Pixels::load(d),
                   e = Pixels::load(image.plane(int(c)) + i) - Pixels::load(photo.plane(int(c)) + i);
      sums[c] += to_double(only(inside, m * size_of(e)));
      only(inside, before + with_sign(m * scale, e), before).store(d);
    }
  });
  return weight * (sums[0] + sums[1] + sums[2]).sum() / (3 * area);
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
  Statistics(const Image& image, const Mask& mask) : area(detail::losses::area(mask)) {
    using namespace detail::losses;
    if (area == 0) return;
    std::array<Sums, 3> first{}, second{};
    each_inside(mask, [&](std::size_t i, const Pixels& m, const Pixels::U& inside) {
      const Sums w = to_double(m);
      for (std::size_t c = 0; c < 3; ++c) {
        const Sums a = to_double(only(inside, Pixels::load(image.plane(int(c)) + i))), wa = w * a;
        first[c] += wa;
        second[c] += wa * a;
      }
    });
    for (std::size_t c = 0; c < 3; ++c) {
      mean[c] = first[c].sum() / area;
      variance[c] = second[c].sum() / area - mean[c] * mean[c];
      if (variance[c] < 0) variance[c] = 0;
    }
  }
};

/// weight * sum over channels of |mean - mean| + |variance - variance|: image under mask against what was found of the
/// photo's part, which need not lie on the same pixels (Yeh et al. 2022, PhotoScene). 0 where either part is empty. Two
/// means or variances that agree, or of which one is no number, have slope 0.
inline double part_statistics(const Image& image, const Mask& mask, const Statistics& photo, double weight,
                              Image& d_image) {
  using namespace detail::losses;
  const Statistics own(image, mask);
  if (own.area == 0 || photo.area == 0) return 0;
  double loss = 0;
  std::array<Pixels, 3> at_zero, rise;  // the slope is at_zero + rise * image
  for (std::size_t c = 0; c < 3; ++c) {
    const double e = own.mean[c] - photo.mean[c], v = own.variance[c] - photo.variance[c];
    loss += std::fabs(e) + std::fabs(v);
    const double by_mean = weight * sign(e) / own.area, by_variance = 2 * weight * sign(v) / own.area;
    at_zero[c] = float(by_variance == 0 ? by_mean : by_mean - by_variance * own.mean[c]);
    rise[c] = float(by_variance);
  }
  each_inside(mask, [&](std::size_t i, const Pixels& m, const Pixels::U& inside) {
    for (std::size_t c = 0; c < 3; ++c) {
      float* const d = d_image.plane(int(c)) + i;
      const Pixels before = Pixels::load(d), a = Pixels::load(image.plane(int(c)) + i);
      only(inside, before + m * (at_zero[c] + rise[c] * a), before).store(d);
    }
  });
  return weight * loss;
}
inline std::pair<double, Image> part_statistics(const Image& image, const Mask& mask, const Statistics& photo) {
  Image d(image.width, image.height);
  const double loss = part_statistics(image, mask, photo, 1, d);
  return {loss, std::move(d)};
}

}  // namespace burnish
