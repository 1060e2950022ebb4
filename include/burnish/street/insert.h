// burnish/street/insert.h -- a rendered vehicle laid into a photo as if its camera had taken both
// SPDX-License-Identifier: Apache-2.0
//
// All in linear RGB. plate: the photo without the vehicle. The shadow is laid on as a ratio (what the ground gets with
// the vehicle by what it gets without), so that no albedo is needed; what a wet ground mirrors is added (Debevec 1998,
// "Rendering Synthetic Objects into Real Scenes", in the two forms of his differential rendering).
#pragma once
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>
#include <burnish/math/color.h>
#include <burnish/street/insert_layers.h>

namespace burnish {

/// What a camera did to light on its way into the plate.
struct PlateLook {
  vec3<float> exposure = {1, 1, 1};  ///< plate = exposure * radiance; white balance in it
  float noise = 0;                   ///< standard deviation at mid grey, in display values (sRGB)
  float blur = 0;                    ///< standard deviation of its point spread, pixels
};

/// object + plate * kept + added, the rendered part exposed as the plate. Images of one size.
inline Image composite(const Image& plate, const InsertLayers& layers, const vec3<float>& exposure = {1, 1, 1}) {
  Image out(plate.width, plate.height);
  for (int y = 0; y < plate.height; ++y)
    for (int x = 0; x < plate.width; ++x) {
      const vec3<float> c = plate.at(x, y) * layers.kept.at(x, y) +
                            (layers.object.at(x, y) + layers.added.at(x, y)) * exposure;
      out.set(x, y, {std::max(c.x, 0.0f), std::max(c.y, 0.0f), std::max(c.z, 0.0f)});
    }
  return out;
}
/// The derivative of a loss by the object's light, given that by the composite: visibility and shadow are held.
inline Image composite_backward(const Image& d_composite, const vec3<float>& exposure = {1, 1, 1}) {
  Image d_object = d_composite;
  for (int y = 0; y < d_object.height; ++y)
    for (int x = 0; x < d_object.width; ++x) d_object.set(x, y, d_composite.at(x, y) * exposure);
  return d_object;
}

namespace detail {
inline float median_of(std::vector<float>& v) {
  if (v.empty()) return 0;
  std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
  return v[v.size() / 2];
}
/// A Gaussian, separable, its borders repeated.
inline Image blurred(const Image& image, float deviation) {
  if (deviation < 0.2f) return image;
  const int r = int(std::ceil(3 * deviation)), w = image.width, h = image.height;
  std::vector<float> tap;
  float sum = 0;
  for (int k = -r; k <= r; ++k) {
    tap.push_back(std::exp(-0.5f * float(k * k) / (deviation * deviation)));
    sum += tap.back();
  }
  Image lines(w, h), out(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      vec3<float> c;
      for (int k = -r; k <= r; ++k)
        c += image.at(std::clamp(x + k, 0, w - 1), y) * (tap[std::size_t(k + r)] / sum);
      lines.set(x, y, c);
    }
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      vec3<float> c;
      for (int k = -r; k <= r; ++k)
        c += lines.at(x, std::clamp(y + k, 0, h - 1)) * (tap[std::size_t(k + r)] / sum);
      out.set(x, y, c);
    }
  return out;
}
}  // namespace detail

/// Measured on the plate: exposure and white balance by the ground, its medians in the plate where `on` says so and in
/// the panorama all round from 3 to 37 degrees below the horizon (it need not be of the same place), the balance within
/// a quarter of grey; noise by the median absolute deviation of its finest differences (Immerkaer 1996) where it is
/// flat, blur by its sharpest edges.
inline PlateLook plate_look(const Image& plate, const Mask& on, const Camera& camera, const PanoramaSampler& sky) {
  PlateLook look;
  std::vector<float> seen[3], shone[3];
  const auto add = [](std::vector<float>* to, const vec3<float>& c) {
    to[0].push_back(c.x), to[1].push_back(c.y), to[2].push_back(c.z);
  };
  for (int y = 0; y < plate.height; y += 2)
    for (int x = 0; x < plate.width; x += 2) {
      const vec3<float> p = plate.at(x, y);
      const bool ground = camera.ray(float(x) + 0.5f, float(y) + 0.5f).direction.y < -0.02f;
      if (ground && on.at(x, y) > 0.5f && std::max({p.x, p.y, p.z}) < 0.95f) add(seen, p);
    }
  for (float height = -0.6f; height < -0.05f; height += 0.02f)
    for (int k = 0; k < 90; ++k) {
      const float a = float(k) * pi / 45, r = std::sqrt(1 - height * height);
      add(shone, sky.radiance({r * std::cos(a), height, r * std::sin(a)}));
    }
  const auto by = [&](int c) { return detail::median_of(seen[c]) / std::max(detail::median_of(shone[c]), 1e-5f); };
  if (seen[0].size() >= 50 && detail::median_of(shone[1]) > 1e-5f) {
    const vec3<float> found(by(0), by(1), by(2));
    // Both cameras were balanced about right: what differs more in hue is another ground, not another balance.
    const float grey = std::max(luminance(found), 1e-6f);
    look.exposure = min(max(found, vec3<float>(0.8f * grey)), vec3<float>(1.25f * grey));
  }

  // The operator 1 -2 1 / -2 4 -2 / 1 -2 1 leaves noise of 6 standard deviations and of smooth pictures nothing.
  std::vector<float> rough, steep;
  const auto grey = [&](int x, int y) {
    const vec3<float> c = plate.at(x, y);
    return srgb_from_linear(std::clamp(0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z, 0.0f, 1.0f));
  };
  for (int y = 2; y + 2 < plate.height; y += 2)
    for (int x = 2; x + 2 < plate.width; x += 2) {
      const float a = grey(x - 1, y), b = grey(x + 1, y), c = grey(x, y - 1), d = grey(x, y + 1), m = grey(x, y);
      const float slope = std::hypot(b - a, d - c) / 2;
      if (m > 0.08f && m < 0.92f && slope < 0.02f)
        rough.push_back(std::abs(4 * m - 2 * (a + b + c + d) + grey(x - 1, y - 1) + grey(x + 1, y - 1) +
                                 grey(x - 1, y + 1) + grey(x + 1, y + 1)));
      // An edge blurred by s rises by its height / (s sqrt(2 pi)) a pixel.
      const float height =
          std::max(std::abs(grey(x + 2, y) - grey(x - 2, y)), std::abs(grey(x, y + 2) - grey(x, y - 2)));
      if (height > 0.25f) steep.push_back(height / (2.5066283f * std::max(slope, 1e-3f)));
    }
  look.noise = detail::median_of(rough) / (0.6744898f * 6);
  if (steep.size() >= 50) {
    std::nth_element(steep.begin(), steep.begin() + std::ptrdiff_t(steep.size() / 10), steep.end());
    const float s = steep[steep.size() / 10];
    // A sharp step, half of it in the difference over two pixels, looks like one blurred by 2 / sqrt(2 pi).
    look.blur = std::sqrt(std::max(s * s - 0.636620f, 0.0f));
  }
  return look;
}

/// The layers as the plate's camera would have them: blurred, then noise on what is rendered. The same for the same
/// seed.
inline void match_look(InsertLayers& layers, const PlateLook& look, std::uint32_t seed = 1) {
  for (Image* image : {&layers.object, &layers.through, &layers.kept, &layers.added})
    *image = detail::blurred(*image, look.blur);
  if (look.noise <= 0) return;
  for (int y = 0; y < layers.object.height; ++y)
    for (int x = 0; x < layers.object.width; ++x) {
      const vec3<float> left = layers.through.at(x, y);
      const float part = 1 - (left.x + left.y + left.z) / 3;
      if (part <= 0) continue;
      std::mt19937 random(seed * 9781u + std::uint32_t(y * layers.object.width + x));
      const auto shaken = [&](float light, float exposure) {
        // Twelve even numbers less six are normal enough, and the same on every platform.
        float n = -6;
        for (int k = 0; k < 12; ++k) n += float(random() >> 8) * 0x1p-24f;
        const float shown = srgb_from_linear(std::clamp(light * exposure, 0.0f, 1.0f)) + part * look.noise * n;
        return light * exposure >= 1 ? light : linear_from_srgb(std::max(shown, 0.0f)) / std::max(exposure, 1e-6f);
      };
      const vec3<float> c = layers.object.at(x, y);
      layers.object.set(x, y, {shaken(c.x, look.exposure.x), shaken(c.y, look.exposure.y),
                               shaken(c.z, look.exposure.z)});
    }
}

}  // namespace burnish
