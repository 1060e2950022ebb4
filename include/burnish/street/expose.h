// burnish/street/expose.h -- what a camera of eight bits makes of a panorama in HDR: for tests, benches and shows
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/light/environment.h>
#include <burnish/math/color.h>

namespace burnish {

/// Negative texels, and those that are no numbers, become black: some files have them.
inline Image without_flaws(Image p) {
  for (float& x : p.values) x = x > 0 && x < std::numeric_limits<float>::infinity() ? x : 0;
  return p;
}
/// The factor that makes the mean luminance, of what is recorded and so clipped at 1, this; by solid angle.
inline float metered_exposure(const Image& panorama, float mean = 0.18f) {
  double low = 1e-8, high = 1e8;
  for (int step = 0; step < 60; ++step) {
    const double e = std::sqrt(low * high);
    double sum = 0;
    for (int y = 0; y < panorama.height; ++y) {
      double row = 0;
      for (int x = 0; x < panorama.width; ++x) row += std::min(1.0, e * double(luminance(panorama.at(x, y))));
      sum += row * detail::texel_area(panorama.width, panorama.height, y) / 12.566370614359172;
    }
    (sum < double(mean) ? low : high) = e;
  }
  return float(std::sqrt(low * high));
}
/// Times exposure, clipped at 1, coded in 8-bit sRGB and made linear again.
inline Image photographed(const Image& panorama, float exposure) {
  Image out = panorama;
  for (float& x : out.values)
    x = linear_from_srgb(std::round(255 * srgb_from_linear(std::clamp(x * exposure, 0.0f, 1.0f))) / 255);
  return out;
}

}  // namespace burnish
