// burnish/nodes/tint.h -- colour adjustments: hue, contrast, saturation, ranges, a whole colour correction
// SPDX-License-Identifier: Apache-2.0
//
// MaterialX's adjustment nodes by name and default. Colours are linear RGB; saturation weighs channels by lumacoeffs,
// by default those of ACEScg as in MaterialX.
#pragma once
#include <burnish/math/color.h>

namespace burnish {

/// Hue turned by amount.x (1 is once round), saturation times amount.y, value times amount.z, of a colour >= 0. It has
/// slopes at grey; math/color.h says which, and names the edges.
template <class T> struct HsvAdjust {
  vec3<T> amount = {0.0f, 1.0f, 1.0f};
  static constexpr auto parameters() { return std::tuple{Param{"amount", &HsvAdjust::amount, Range{-0.5f, 2}}}; }
  constexpr vec3<T> operator()(const vec3<T>& in) const { return hsvadjust(in, amount); }
};

/// (in - pivot) * amount + pivot.
template <class T> struct Contrast {
  T amount = 1.0f, pivot = 0.5f;
  static constexpr auto parameters() {
    return std::tuple{Param{"amount", &Contrast::amount, Range{0, 2}}, Param{"pivot", &Contrast::pivot, unit}};
  }
  constexpr T operator()(const T& in) const { return (in - pivot) * amount + pivot; }
  constexpr vec3<T> operator()(const vec3<T>& in) const { return {(*this)(in.x), (*this)(in.y), (*this)(in.z)}; }
};

/// The weighted sum of the channels.
template <class T> struct Luminance {
  vec3<T> lumacoeffs = {0.2722287f, 0.6740818f, 0.0536895f};
  static constexpr auto parameters() { return std::tuple{Param{"lumacoeffs", &Luminance::lumacoeffs, unit}}; }
  constexpr T operator()(const vec3<T>& in) const { return dot(in, lumacoeffs); }
};

/// Away from grey for amount > 1, grey at 0; the weighted sum of the channels stays.
template <class T> struct Saturate {
  T amount = 1.0f;
  vec3<T> lumacoeffs = {0.2722287f, 0.6740818f, 0.0536895f};
  static constexpr auto parameters() {
    return std::tuple{Param{"amount", &Saturate::amount, Range{0, 2}},
                      Param{"lumacoeffs", &Saturate::lumacoeffs, unit}};
  }
  constexpr vec3<T> operator()(const vec3<T>& in) const { return mix(vec3<T>(dot(in, lumacoeffs)), in, amount); }
};

/// inlow to outlow and inhigh to outhigh along a straight line; inlow and inhigh differ.
template <class T> struct Remap {
  T inlow = 0.0f, inhigh = 1.0f, outlow = 0.0f, outhigh = 1.0f;
  static constexpr auto parameters() {
    return std::tuple{Param{"inlow", &Remap::inlow, Range{-1, 0.4f}}, Param{"inhigh", &Remap::inhigh, Range{0.6f, 2}},
                      Param{"outlow", &Remap::outlow, Range{-1, 1}}, Param{"outhigh", &Remap::outhigh, Range{-1, 2}}};
  }
  constexpr T operator()(const T& in) const { return outlow + (in - inlow) * (outhigh - outlow) / (inhigh - inlow); }
  constexpr vec3<T> operator()(const vec3<T>& in) const { return {(*this)(in.x), (*this)(in.y), (*this)(in.z)}; }
};

/// MaterialX's `range`: Remap with the power 1 / gamma between, of the magnitude. Within 1e-6 of inlow (a part of the
/// range) the power is a straight line, so that its slope is finite and, for gamma = 1, 1. Edges: inlow, and for
/// clamped() outlow and outhigh, where the slope is that outside.
template <class T> struct RangeNode {
  T inlow = 0.0f, inhigh = 1.0f, gamma = 1.0f, outlow = 0.0f, outhigh = 1.0f;
  static constexpr auto parameters() {
    return std::tuple{
        Param{"inlow", &RangeNode::inlow, Range{-1, 0.4f}}, Param{"inhigh", &RangeNode::inhigh, Range{0.6f, 2}},
        Param{"gamma", &RangeNode::gamma, Range{0.2f, 3}}, Param{"outlow", &RangeNode::outlow, Range{-1, 1}},
        Param{"outhigh", &RangeNode::outhigh, Range{-1, 2}}};
  }
  /// doclamp = false.
  constexpr T operator()(const T& in) const {
    const T x = (in - inlow) / (inhigh - inlow);
    return outlow + x * pow(max(abs(x), T(1e-6f)), 1.0f / gamma - 1.0f) * (outhigh - outlow);
  }
  /// doclamp = true; outlow <= outhigh.
  constexpr T clamped(const T& in) const { return min(max((*this)(in), outlow), outhigh); }
  constexpr vec3<T> operator()(const vec3<T>& in) const { return {(*this)(in.x), (*this)(in.y), (*this)(in.z)}; }
  constexpr vec3<T> clamped(const vec3<T>& in) const { return {clamped(in.x), clamped(in.y), clamped(in.z)}; }
};

/// In this order: hue turned, saturation, gamma, lift, gain, contrast about contrastpivot, times 2^exposure; of a
/// colour >= 0. Edges: those of HsvAdjust, and a channel at 0 before gamma.
template <class T> struct ColorCorrect {
  T hue = 0.0f, saturation = 1.0f, gamma = 1.0f, lift = 0.0f, gain = 1.0f, contrast = 1.0f, contrastpivot = 0.5f,
    exposure = 0.0f;
  static constexpr auto parameters() {
    return std::tuple{Param{"hue", &ColorCorrect::hue, Range{-0.5f, 1}},
                      Param{"saturation", &ColorCorrect::saturation, Range{0, 2}},
                      Param{"gamma", &ColorCorrect::gamma, Range{0.2f, 3}},
                      Param{"lift", &ColorCorrect::lift, unit},
                      Param{"gain", &ColorCorrect::gain, Range{0, 2}},
                      Param{"contrast", &ColorCorrect::contrast, Range{0, 2}},
                      Param{"contrastpivot", &ColorCorrect::contrastpivot, unit},
                      Param{"exposure", &ColorCorrect::exposure, Range{-1, 1}}};
  }
  constexpr vec3<T> operator()(const vec3<T>& in) const {
    const vec3<T> turned = hsvadjust(in, vec3<T>{hue, T(1.0f), T(1.0f)});
    const vec3<T> bent = RangeNode<T>{0.0f, 1.0f, gamma, 0.0f, 1.0f}(Saturate<T>{saturation}(turned));
    const vec3<T> lifted = bent * (1.0f - lift) + vec3<T>(lift);
    return Contrast<T>{contrast, contrastpivot}(lifted * gain) * exp2(exposure);
  }
};

}  // namespace burnish
