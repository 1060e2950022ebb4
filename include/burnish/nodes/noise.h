// burnish/nodes/noise.h -- the noise nodes of MaterialX: noise2d, noise3d, fractal2d, fractal3d
// SPDX-License-Identifier: Apache-2.0
//
// Each gives its number at a texcoord or position, and with height() the number with its slopes, for a normal. The
// values are MaterialX's; octaves may be fractional here, and is a parameter like any other (math/noise.h names its
// edges).
#pragma once
#include <burnish/math/noise.h>

namespace burnish {

/// amplitude * noise + pivot over uv.
template <class T> struct Noise2d {
  T amplitude = 1.0f, pivot = 0.0f;
  static constexpr auto parameters() {
    return std::tuple{Param{"amplitude", &Noise2d::amplitude, Range{0, 2}},
                      Param{"pivot", &Noise2d::pivot, Range{-1, 1}}};
  }
  constexpr T operator()(const vec2<T>& texcoord) const { return height(texcoord).value; }
  constexpr Height<T> height(const vec2<T>& texcoord) const { return noise2d(texcoord) * amplitude + pivot; }
};
/// amplitude * noise + pivot in space.
template <class T> struct Noise3d {
  T amplitude = 1.0f, pivot = 0.0f;
  static constexpr auto parameters() {
    return std::tuple{Param{"amplitude", &Noise3d::amplitude, Range{0, 2}},
                      Param{"pivot", &Noise3d::pivot, Range{-1, 1}}};
  }
  constexpr T operator()(const vec3<T>& position) const { return height(position).value; }
  constexpr Height3<T> height(const vec3<T>& position) const { return noise3d(position) * amplitude + pivot; }
};
/// octaves of noise, each lacunarity times finer and diminish times as strong as the one before, over uv.
template <class T> struct Fractal2d {
  T amplitude = 1.0f, octaves = 3.0f, lacunarity = 2.0f, diminish = 0.5f;
  static constexpr auto parameters() {
    return std::tuple{Param{"amplitude", &Fractal2d::amplitude, Range{0, 2}},
                      Param{"octaves", &Fractal2d::octaves, Range{1, 8}},
                      Param{"lacunarity", &Fractal2d::lacunarity, Range{1.5f, 3}},
                      Param{"diminish", &Fractal2d::diminish, Range{0.1f, 0.9f}}};
  }
  constexpr T operator()(const vec2<T>& texcoord) const { return height(texcoord).value; }
  constexpr Height<T> height(const vec2<T>& texcoord) const {
    return fractal2d(texcoord, octaves, lacunarity, diminish) * amplitude;
  }
};
/// The same in space.
template <class T> struct Fractal3d {
  T amplitude = 1.0f, octaves = 3.0f, lacunarity = 2.0f, diminish = 0.5f;
  static constexpr auto parameters() {
    return std::tuple{Param{"amplitude", &Fractal3d::amplitude, Range{0, 2}},
                      Param{"octaves", &Fractal3d::octaves, Range{1, 8}},
                      Param{"lacunarity", &Fractal3d::lacunarity, Range{1.5f, 3}},
                      Param{"diminish", &Fractal3d::diminish, Range{0.1f, 0.9f}}};
  }
  constexpr T operator()(const vec3<T>& position) const { return height(position).value; }
  constexpr Height3<T> height(const vec3<T>& position) const {
    return fractal3d(position, octaves, lacunarity, diminish) * amplitude;
  }
};

}  // namespace burnish
