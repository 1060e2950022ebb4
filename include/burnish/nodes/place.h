// burnish/nodes/place.h -- where a pattern lies: scale, rotation and offset of texture coordinates
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/math/noise.h>

namespace burnish {

/// MaterialX's place2d. Scale enlarges the pattern (the coordinates are divided by it, so it is not 0), rotate is in
/// degrees, all about pivot. All four are parameters; positions have slopes, too.
template <class T> struct Place2d {
  vec2<T> pivot = {0.0f, 0.0f}, scale = {1.0f, 1.0f};
  T rotate = 0.0f;
  vec2<T> offset = {0.0f, 0.0f};
  static constexpr auto parameters() {
    return std::tuple{Param{"pivot", &Place2d::pivot, unit}, Param{"scale", &Place2d::scale, Range{0.05f, 20}},
                      Param{"rotate", &Place2d::rotate, Range{-180, 180}},
                      Param{"offset", &Place2d::offset, Range{-1, 1}}};
  }
  /// operationorder 0 (SRT), the default: scale, rotate, then offset. Unequal scales shear a turned pattern.
  constexpr vec2<T> operator()(const vec2<T>& texcoord) const {
    return turn((texcoord - pivot) / scale) - offset + pivot;
  }
  /// operationorder 1 (TRS): offset, rotate, then scale.
  constexpr vec2<T> trs(const vec2<T>& texcoord) const { return turn(texcoord - pivot - offset) / scale + pivot; }

  /// A height that was computed at (*this)(texcoord), with its slopes turned into those by texcoord.
  constexpr Height<T> by_texcoord(const Height<T>& h) const { return {h.value, turn_back(h.slope) / scale}; }
  /// The same for trs(texcoord).
  constexpr Height<T> by_texcoord_trs(const Height<T>& h) const { return {h.value, turn_back(h.slope / scale)}; }

private:
  static constexpr float degree = 0.0174532925f;
  constexpr vec2<T> turn(const vec2<T>& p) const {
    const T c = cos(rotate * degree), s = sin(rotate * degree);
    return {c * p.x + s * p.y, c * p.y - s * p.x};
  }
  constexpr vec2<T> turn_back(const vec2<T>& p) const {
    const T c = cos(rotate * degree), s = sin(rotate * degree);
    return {c * p.x - s * p.y, c * p.y + s * p.x};
  }
};

}  // namespace burnish
