// examples/looks.h -- what is fitted of a vehicle, and how it looks: paint, panes and rubber in a camera's picture
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/io/photo.h>
#include <burnish/light/illuminate.h>
#include <burnish/math/color.h>
#include <burnish/nodes/car_paint.h>
#include <burnish/nodes/rubber.h>
#include <burnish/nodes/window_glass.h>

namespace looks {
using namespace burnish;

/// What a camera makes of linear light: a shoulder above 0.8 instead of a hard clip, then the sRGB curve.
inline constexpr auto developed = []<class T>(const vec3<T>& light) {
  const auto film = [](const T& x) {
    const T over = max(x - 0.8f, 0.0f);
    return srgb_from_linear(min(x, 0.8f) + 0.2f * (1.0f - exp(over * -5.0f)));
  };
  return vec3<T>(film(light.x), film(light.y), film(light.z));
};
/// The light that a camera made this of; white itself is taken as 2.6.
inline float undeveloped(float x) {
  const float y = detail::from_srgb(x);
  return y < 0.8f ? y : 0.8f - 0.2f * std::log(std::max(1 - 5 * (y - 0.8f), 1e-4f));
}

inline constexpr auto painted = [](const auto& paint, const auto& at, const auto& light, const auto& suns,
                                   const auto& strength) {
  return developed(illuminate(paint(at), at, light, suns, strength));
};

/// A pane; the light that comes through it from behind, as a part of the sky's; and what it mirrors, as a part of the
/// panorama's: the real place is another one.
template <class T> struct Window {
  WindowGlass<T> glass;
  vec3<T> behind = {0.1f, 0.1f, 0.1f};
  T mirrored = 0.7f;
  static constexpr auto parameters() {
    return std::tuple{Param{"glass", &Window::glass}, Param{"behind", &Window::behind, unit},
                      Param{"mirrored", &Window::mirrored, unit}};
  }
};
inline constexpr auto glazed = [](const auto& window, const auto& at, const auto& light, const auto& suns,
                                  const auto& strength) {
  const auto surface = window.glass(at);
  const auto through = transmittance(surface, dot(at.normal, at.view)) * window.behind * strength.sky;
  return developed(illuminate(surface, at, light, suns, strength) * window.mirrored + through);
};
/// A look that is recorded when it runs: builds faster and plays slower; for the small parts.
template <class Look> struct AtRunTime {
  const Look* look;
  template <class... X> constexpr auto operator()(const X&... x) const { return (*look)(x...); }
};

/// The materials of a vehicle.
struct Vehicle {
  CarPaint<float> paint;
  Window<float> window;
  Rubber<float> rubber;
};

/// Red, so that one sees what the fit does; hardly metallic, as most paints.
inline CarPaint<float> first_paint() {
  CarPaint<float> paint;
  paint.base_metalness = 0.1f;
  return paint;
}


}  // namespace looks
