// burnish/math/noise.h -- gradient noise and its fractal sums, with their slopes by position
// SPDX-License-Identifier: Apache-2.0
//
// Perlin's gradient noise (1985) with the quintic fade of 2002, on the lattice of MaterialX's noise2d and noise3d: the
// same hash of the lattice point (the final mix of Jenkins' lookup3, 2006), the same gradients chosen by its low bits,
// the same scale. A value so differs from MaterialX's by rounding only. Value and slopes come out together, so that a
// height gives a normal without differences; the adjoint knows the second derivatives. The lattice has no parameters:
// positions, lacunarity, diminish and octaves have slopes, seeds there are none.
//
// Positions beyond 2^31 have no lattice point (in float, positions beyond 1e5 have few points between two of them).
#pragma once
#include <burnish/math/vec.h>

namespace burnish {

/// A number over a plane or a space: its value and its slopes by the position, V = vec2<T> or vec3<T>.
template <class T, class V> struct Sloped {
  T value;
  V slope;

  friend constexpr Sloped operator+(const Sloped& a, const Sloped& b) { return {a.value + b.value, a.slope + b.slope}; }
  friend constexpr Sloped operator-(const Sloped& a, const Sloped& b) { return {a.value - b.value, a.slope - b.slope}; }
  friend constexpr Sloped operator*(const Sloped& a, const Sloped& b) {
    return {a.value * b.value, a.slope * b.value + b.slope * a.value};
  }
  friend constexpr Sloped operator-(const Sloped& a) { return {-a.value, -a.slope}; }
  friend constexpr Sloped operator+(const Sloped& a, const T& s) { return {a.value + s, a.slope}; }
  friend constexpr Sloped operator+(const T& s, const Sloped& a) { return a + s; }
  friend constexpr Sloped operator-(const Sloped& a, const T& s) { return {a.value - s, a.slope}; }
  friend constexpr Sloped operator-(const T& s, const Sloped& a) { return {s - a.value, -a.slope}; }
  friend constexpr Sloped operator*(const Sloped& a, const T& s) { return {a.value * s, a.slope * s}; }
  friend constexpr Sloped operator*(const T& s, const Sloped& a) { return a * s; }
  friend constexpr Sloped mix(const Sloped& a, const Sloped& b, const T& t) { return a + (b - a) * t; }

  /// f(value), where f has the slope d_f there: with y = a.value * a.value, a.through(y, 2 * a.value) is a squared.
  constexpr Sloped through(const T& f, const T& d_f) const { return {f, slope * d_f}; }
};
/// A height over uv, slopes by u and v.
template <class T> using Height = Sloped<T, vec2<T>>;
/// A number in space, slopes by x, y and z.
template <class T> using Height3 = Sloped<T, vec3<T>>;

namespace detail {

/// The lattice coordinate as 32 bits in every lane; a double packet has as many lanes of them.
template <class T> [[gnu::always_inline]] inline auto lattice_bits(T whole_number) {
  if constexpr (Plain<T>) return std::uint32_t(to_int(whole_number));
  else return convert<typename vectors<float, T::size>::U>(to_int(whole_number));
}
/// The bits of a float in every lane, as T.
template <class T, class U> [[gnu::always_inline]] inline T real_from_bits(U u) {
  if constexpr (Plain<T>) return T(bits<float>(u));
  else if constexpr (std::is_same_v<typename T::Scalar, float>) return bits<T>(u);
  else return T(convert<typename T::V>(bits<typename vectors<float, T::size>::V>(u)));
}
/// a where the bit pattern is not 0, else b.
template <class U> [[gnu::always_inline]] inline U choose(U bit, U a, U b) { return blend(bit != 0, a, b); }

template <int K, class U> [[gnu::always_inline]] inline U rotated(U x) { return U(x << K | x >> (32 - K)); }
/// The last rounds of lookup3 (Jenkins 2006).
template <class U> [[gnu::always_inline]] inline U lattice_hash(U a, U b, U c) {
  c ^= b, c -= rotated<14>(b);
  a ^= c, a -= rotated<11>(c);
  b ^= a, b -= rotated<25>(a);
  c ^= b, c -= rotated<16>(b);
  a ^= c, a -= rotated<4>(c);
  b ^= a, b -= rotated<14>(a);
  c ^= b, c -= rotated<24>(b);
  return c;
}
/// The gradient that a hash names. 2D: (+-1, +-2) and (+-2, +-1); 3D: towards the edges of a cube.
template <class T, class U> [[gnu::always_inline]] inline void lattice_gradient(U h, T (&g)[2]) {
  const U one = (h & 1u) << 31 | 0x3f800000u, two = (h & 2u) << 30 | 0x40000000u, swap = h & 4u;
  g[0] = real_from_bits<T>(choose(swap, two, one));
  g[1] = real_from_bits<T>(choose(swap, one, two));
}
template <class T, class U> [[gnu::always_inline]] inline void lattice_gradient(U h, T (&g)[3]) {
  const U u = (h & 1u) << 31 | 0x3f800000u, v = (h & 2u) << 30 | 0x3f800000u, none = h & 0u;
  const U high = h & 8u, middle = h & 4u, x_again = choose(U((h & 13u) ^ 12u), none, U(none + 1u));  // 12 and 14
  g[0] = real_from_bits<T>(choose(high, choose(x_again, v, none), u));
  g[1] = real_from_bits<T>(choose(high, u, choose(middle, none, v)));
  g[2] = real_from_bits<T>(choose(U(high | middle), choose(x_again, none, v), none));
}

/// One corner's ramp at the point, and what the corners are blended to, axis after axis.
template <class T, int D> struct Ramp {
  T value, slope[D];
  T along, along_slope[D];  // d[0] value + d[1..] . slope, and its own slopes; used by the adjoint only
};

/// Noise at x: value and slopes; with `second`, for d[0..D], `along` and its slopes as well.
template <int D, bool second, class T> [[gnu::always_inline]] inline Ramp<T, D> noise(const T* x, const T* d) {
  using U = decltype(lattice_bits(x[0]));
  constexpr std::uint32_t seed = 0xdeadbeefu + (std::uint32_t(D) << 2) + 13u;
  constexpr float scale = D == 2 ? 0.6616f : 0.9820f;
  T t[D], fade[D], d_fade[D], dd_fade[D];
  U key[2][3];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) key[0][i] = key[1][i] = U{} + seed;
#pragma GCC unroll 3
  for (int i = 0; i < D; ++i) {
    const T low = floor(x[i]);
    key[0][i] += lattice_bits(low);
    key[1][i] = key[0][i] + 1u;
    t[i] = x[i] - low;
    fade[i] = t[i] * t[i] * t[i] * (t[i] * (t[i] * 6.0f - 15.0f) + 10.0f);
    d_fade[i] = 30.0f * (t[i] * (t[i] - 1.0f)) * (t[i] * (t[i] - 1.0f));
    dd_fade[i] = 60.0f * t[i] * (t[i] - 1.0f) * (2.0f * t[i] - 1.0f);
  }
  Ramp<T, D> ramp[1 << D];
#pragma GCC unroll 8
  for (int c = 0; c < 1 << D; ++c) {
    Ramp<T, D>& r = ramp[c];
    lattice_gradient(lattice_hash(key[c & 1][0], key[c >> 1 & 1][1], key[c >> 2 & 1][2]), r.slope);
    r.value = T(0.0f);
    if constexpr (second) r.along = T(0.0f);
#pragma GCC unroll 3
    for (int i = 0; i < D; ++i) {
      r.value += r.slope[i] * (c >> i & 1 ? t[i] - 1.0f : t[i]);
      if constexpr (second) r.along += r.slope[i] * d[i + 1], r.along_slope[i] = r.slope[i] * d[0];
    }
    if constexpr (second) r.along += r.value * d[0];
  }
#pragma GCC unroll 3
  for (int axis = 0; axis < D; ++axis)
#pragma GCC unroll 4
    for (int c = 0; c < 1 << (D - 1 - axis); ++c) {
      const Ramp<T, D> low = ramp[2 * c], high = ramp[2 * c + 1];
      Ramp<T, D>& r = ramp[c];
      const T f = fade[axis], df = d_fade[axis], rise = high.value - low.value;
      r.value = low.value + f * rise;
#pragma GCC unroll 3
      for (int i = 0; i < D; ++i) r.slope[i] = low.slope[i] + f * (high.slope[i] - low.slope[i]);
      r.slope[axis] += df * rise;
      if constexpr (second) {
        const T k = d[axis + 1], k_df = k * df, along_rise = high.along - low.along;
        r.along = low.along + f * along_rise + k_df * rise;
#pragma GCC unroll 3
        for (int i = 0; i < D; ++i)
          r.along_slope[i] = low.along_slope[i] + f * (high.along_slope[i] - low.along_slope[i]) +
                             k_df * (high.slope[i] - low.slope[i]);
        r.along_slope[axis] += df * along_rise + k * dd_fade[axis] * rise;
      }
    }
  Ramp<T, D>& r = ramp[0];
  r.value *= scale;
  if constexpr (second) r.along *= scale;
  for (int i = 0; i < D; ++i) {
    r.slope[i] *= scale;
    if constexpr (second) r.along_slope[i] *= scale;
  }
  return r;
}

/// Whether any lane of a is above b.
template <class T> bool any_above(const T& a, float b) {
  if constexpr (Plain<T>) return a > b;
  else {
    bool any = false;
    for (int i = 0; i < T::size; ++i) any |= a[i] > b;
    return any;
  }
}

}  // namespace detail

namespace op {

/// (position) -> (value, slopes by the position), in D = 2 or 3 dimensions. Value and slopes are continuous everywhere;
/// the second derivatives, too.
template <int D> struct Noise {
  static constexpr int inputs = D, outputs = D + 1;
  static constexpr bool active = true, back_reads_outputs = false;

  template <class T> static void value(const T* x, T* y) {
    const auto n = detail::noise<D, false>(x, static_cast<const T*>(nullptr));
    y[0] = n.value;
    for (int i = 0; i < D; ++i) y[i + 1] = n.slope[i];
  }
  template <class T> static void back(const T* x, const T*, const T* d_y, T* d_x) {
    const auto n = detail::noise<D, true>(x, d_y);
    for (int i = 0; i < D; ++i) d_x[i] = n.along_slope[i];
  }
};
using Noise2d = Noise<2>;
using Noise3d = Noise<3>;

/// (position, octaves, lacunarity, diminish) -> (value, slopes by the position) of
///   sum over i of weight_i diminish^i noise(position lacunarity^i),  weight_i = octaves - i, held within [0, 1].
/// One loop inside one operation: its cost follows the largest number of octaves in a packet, and no recording grows.
template <int D> struct Fractal {
  static constexpr int inputs = D + 3, outputs = D + 1, most = 16;
  static constexpr bool active = true, back_reads_outputs = false;

  template <class T> static void value(const T* x, T* y) {
    T power = T(1.0f), scale = T(1.0f), p[D];
    for (int i = 0; i <= D; ++i) y[i] = T(0.0f);
    for (int octave = 0; octave < most && detail::any_above(x[D], float(octave)); ++octave) {
      for (int i = 0; i < D; ++i) p[i] = x[i] * scale;
      const auto n = detail::noise<D, false>(p, static_cast<const T*>(nullptr));
      const T a = power * weight(x[D], octave);
      y[0] += a * n.value;
      for (int i = 0; i < D; ++i) y[i + 1] += a * scale * n.slope[i];
      scale *= x[D + 1];
      power *= x[D + 2];
    }
  }
  template <class T> static void back(const T* x, const T*, const T* d_y, T* d_x) {
    // d_power and d_scale are the slopes of the octave's power by diminish and of its scale by lacunarity.
    T power = T(1.0f), scale = T(1.0f), d_power = T(0.0f), d_scale = T(0.0f), p[D], d[D + 1];
    for (int i = 0; i < inputs; ++i) d_x[i] = T(0.0f);
    for (int octave = 0; octave < most && detail::any_above(x[D], float(octave)); ++octave) {
      d[0] = d_y[0];
      for (int i = 0; i < D; ++i) p[i] = x[i] * scale, d[i + 1] = d_y[i + 1] * scale;
      const auto n = detail::noise<D, true>(p, d);
      const T w = weight(x[D], octave), a = power * w;
      T by_scale = T(0.0f);
      for (int i = 0; i < D; ++i) {
        d_x[i] += a * scale * n.along_slope[i];
        by_scale += x[i] * n.along_slope[i] + d_y[i + 1] * n.slope[i];
      }
      const auto fading = x[D] > float(octave) && x[D] <= float(octave + 1);
      d_x[D] += select(fading, power * n.along, T(0.0f));
      d_x[D + 1] += a * d_scale * by_scale;
      d_x[D + 2] += d_power * w * n.along;
      d_scale = d_scale * x[D + 1] + scale, d_power = d_power * x[D + 2] + power;
      scale *= x[D + 1], power *= x[D + 2];
    }
  }

private:
  template <class T> static T weight(T octaves, int octave) {
    return max(min(octaves - float(octave), T(1.0f)), T(0.0f));
  }
};
using Fractal2d = Fractal<2>;
using Fractal3d = Fractal<3>;

}  // namespace op

/// MaterialX's noise2d at a point of the plane: about -1 to 1, mean 0, one feature per unit.
template <class T> constexpr Height<T> noise2d(const vec2<T>& p) {
  const auto y = apply<op::Noise2d>(p.x, p.y);
  return {y[0], {y[1], y[2]}};
}
/// MaterialX's noise3d.
template <class T> constexpr Height3<T> noise3d(const vec3<T>& p) {
  const auto y = apply<op::Noise3d>(p.x, p.y, p.z);
  return {y[0], {y[1], y[2], y[3]}};
}
/// MaterialX's fractal2d for a whole number of octaves; between two, the last octave is faded in proportion. An edge
/// lies at every whole number of octaves: there the slope by octaves is that from below, so that a fit that starts on
/// one can leave it. Up to 16 octaves; below 0 none.
template <class T> constexpr Height<T> fractal2d(const vec2<T>& p, const same<T>& octaves, const same<T>& lacunarity,
                                                 const same<T>& diminish) {
  const auto y = apply<op::Fractal2d>(p.x, p.y, octaves, lacunarity, diminish);
  return {y[0], {y[1], y[2]}};
}
/// The same in space.
template <class T> constexpr Height3<T> fractal3d(const vec3<T>& p, const same<T>& octaves, const same<T>& lacunarity,
                                                  const same<T>& diminish) {
  const auto y = apply<op::Fractal3d>(p.x, p.y, p.z, octaves, lacunarity, diminish);
  return {y[0], {y[1], y[2], y[3]}};
}

}  // namespace burnish
