// burnish/nodes/blend.h -- two inputs laid over each other: mix and the blend modes
// SPDX-License-Identifier: Apache-2.0
//
// Each is node(fg, bg), for numbers and channel by channel for colours, and gives mix * blended + (1 - mix) * bg: the
// compositing nodes of MaterialX, and its math nodes multiply, max and min with the same amount.
#pragma once
#include <burnish/math/vec.h>

namespace burnish {

#define BURNISH_BLEND(Name, ...)                                                                              \
  template <class T> struct Name {                                                                            \
    T mix = 1.0f;                                                                                             \
    static constexpr auto parameters() { return std::tuple{Param{"mix", &Name::mix, unit}}; }                 \
    constexpr T operator()(const T& fg, const T& bg) const { return burnish::mix(bg, blended(fg, bg), mix); } \
    constexpr vec3<T> operator()(const vec3<T>& fg, const vec3<T>& bg) const {                                \
      return {(*this)(fg.x, bg.x), (*this)(fg.y, bg.y), (*this)(fg.z, bg.z)};                                 \
    }                                                                                                         \
    static constexpr T blended(const T& fg, const T& bg) { __VA_ARGS__ }                                      \
  };

/// fg.
BURNISH_BLEND(Mix, static_cast<void>(bg); return fg;)
/// bg + fg.
BURNISH_BLEND(Plus, return bg + fg;)
/// bg - fg.
BURNISH_BLEND(Minus, return bg - fg;)
/// |bg - fg|. Edge: fg = bg, slopes there as for bg > fg.
BURNISH_BLEND(Difference, return abs(bg - fg);)
/// bg * fg.
BURNISH_BLEND(Multiply, return bg * fg;)
/// The larger. Edge: fg = bg, slopes there go to bg.
BURNISH_BLEND(Max, return max(fg, bg);)
/// The smaller. Edge: fg = bg, slopes there go to bg.
BURNISH_BLEND(Min, return min(fg, bg);)
/// 1 - (1 - fg) (1 - bg).
BURNISH_BLEND(Screen, return 1.0f - (1.0f - fg) * (1.0f - bg);)
/// Multiply below bg = 0.5, screen above, twice as strong. Edge: bg = 0.5, where the slope by bg jumps from 2 fg to
/// 2 - 2 fg; there the upper is given.
BURNISH_BLEND(Overlay, return select(bg >= T(0.5f), 1.0f - 2.0f * (1.0f - fg) * (1.0f - bg), 2.0f * fg * bg);)
/// 1 - (1 - bg) / fg, which is not held within [0, 1]. Edge: fg = 0, the pole; within 1e-8 of it 0 with no slopes.
BURNISH_BLEND(Burn, const auto pole = abs(fg) < T(1e-8f);
              return select(pole, T(0.0f), 1.0f - (1.0f - bg) / select(pole, T(1.0f), fg));)
/// bg / (1 - fg), which is not held within [0, 1]. Edge: fg = 1, the pole; within 1e-8 of it 0 with no slopes.
BURNISH_BLEND(Dodge, const T rest = 1.0f - fg; const auto pole = abs(rest) < T(1e-8f);
              return select(pole, T(0.0f), bg / select(pole, T(1.0f), rest));)

#undef BURNISH_BLEND

}  // namespace burnish
