// burnish/math/smooth.h -- edges made soft, so that they have slopes: steps, maxima, thresholds, bias and gain
// SPDX-License-Identifier: Apache-2.0
//
// width > 0 is a half-width in the unit of the argument: outside [edge - width, edge + width] value and slope are those
// of the sharp function, to rounding; inside, value and slope are continuous. The slopes by width are right, too, so a
// softness can be fitted.
#pragma once
#include <burnish/ad/model.h>

namespace burnish {

/// 0 below edge - width, 1 above edge + width, a cubic between.
template <Number T> constexpr T smooth_step(const T& x, const same<T>& edge, const same<T>& width) {
  return smoothstep<T>(edge - width, edge + width, x);
}
/// 1 within [low, high], 0 outside, both edges soft.
template <Number T>
constexpr T smooth_pulse(const T& x, const same<T>& low, const same<T>& high, const same<T>& width) {
  return smooth_step<T>(x, low, width) * (1.0f - smooth_step<T>(x, high, width));
}
/// max(a, b), but a parabola where they are nearer than width; at a = b it lies width / 4 above.
template <Number T> constexpr T smooth_max(const T& a, const same<T>& b, const same<T>& width) {
  const T t = clamp((a - b) / (2.0f * width) + 0.5f, T(0.0f), T(1.0f));
  return b + (a - b) * t + width * t * (1.0f - t);
}
/// min(a, b), width / 4 below it at a = b.
template <Number T> constexpr T smooth_min(const T& a, const same<T>& b, const same<T>& width) {
  return -smooth_max<T>(-a, -b, width);
}
/// |x|; width / 2 at 0, for |x| < width a parabola.
template <Number T> constexpr T smooth_abs(const T& x, const same<T>& width) {
  const T t = clamp(x / width, T(-1.0f), T(1.0f));
  return x * t + 0.5f * width * (1.0f - t * t);
}
/// Within [low, high], with rounded corners; low + 2 width < high.
template <Number T>
constexpr T smooth_clamp(const T& x, const same<T>& low, const same<T>& high, const same<T>& width) {
  return smooth_min<T>(smooth_max<T>(x, low, width), high, width);
}
/// The logistic curve: a step at edge that has a slope everywhere, 1 / (4 width) in its middle.
template <Number T> constexpr T soft_threshold(const T& x, const same<T>& edge, const same<T>& width) {
  return 0.5f + 0.5f * tanh((x - edge) / (2.0f * width));
}

/// x in [0, 1] bent so that the middle meets amount in (0, 1); 0.5 bends nothing (Schlick 1994).
template <Number T> constexpr T bias(const T& x, const same<T>& amount) {
  return x / ((1.0f / amount - 2.0f) * (1.0f - x) + 1.0f);
}
/// x in [0, 1] bent like an S about its middle, where its slope is 1 / amount - 1: steep for amount < 0.5, flat above
/// (Schlick 1994). Edge: at x = 0.5 the second derivative jumps.
template <Number T> constexpr T gain(const T& x, const same<T>& amount) {
  const auto lower = x < T(0.5f);
  const T half = bias<T>(select(lower, 2.0f * x, 2.0f - 2.0f * x), amount) * 0.5f;
  return select(lower, half, 1.0f - half);
}

}  // namespace burnish
