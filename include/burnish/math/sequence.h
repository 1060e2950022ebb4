// burnish/math/sequence.h -- places spread evenly in a square: numbers for paths, and for a pixel's rays
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>
#include <burnish/math/vec.h>

namespace burnish {

namespace detail {
constexpr std::uint32_t reversed_bits(std::uint32_t x) {
  x = x << 16 | x >> 16;
  x = (x & 0x00ff00ffu) << 8 | (x & 0xff00ff00u) >> 8;
  x = (x & 0x0f0f0f0fu) << 4 | (x & 0xf0f0f0f0u) >> 4;
  x = (x & 0x33333333u) << 2 | (x & 0xccccccccu) >> 2;
  return (x & 0x55555555u) << 1 | (x & 0xaaaaaaaau) >> 1;
}
/// Owen's scrambling of a number whose bits are reversed, by hashing: each bit is flipped by those before it (Laine and
/// Karras 2011; constants of Burley 2020, "Practical Hash-based Owen Scrambling").
constexpr std::uint32_t scrambled_reversed(std::uint32_t x, std::uint32_t seed) {
  x += seed;
  x ^= x * 0x6c50b47cu;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  return x ^ x * 0x8d22f6e6u;
}
constexpr std::uint32_t mixed_bits(std::uint32_t x) {  // a hash: PCG's output function (O'Neill 2014)
  x = x * 747796405u + 2891336453u;
  x = ((x >> ((x >> 28) + 4)) ^ x) * 277803737u;
  return x >> 22 ^ x;
}
}  // namespace detail

/// The numbers of one path: pairs in [0, 1)^2, each of which, over the paths 0, 1, 2, ... of a pixel, fills the square as
/// evenly as the first two of Sobol's dimensions do; different pairs and pixels know nothing of each other. The same
/// on every machine.
class PathNumbers {
public:
  constexpr PathNumbers(std::uint32_t pixel, std::uint32_t path, std::uint32_t seed)
      : path_(path), seed_(detail::mixed_bits(pixel ^ detail::mixed_bits(seed))) {}

  constexpr vec2<float> pair() {
    const std::uint32_t key = detail::mixed_bits(seed_ + 0x9e3779b9u * ++count_);
    // The paths' order is scrambled, too, so that pairs are not bound to each other.
    const std::uint32_t backward = detail::scrambled_reversed(detail::reversed_bits(path_), key);
    std::uint32_t index = detail::reversed_bits(backward), second = 0;
    for (std::uint32_t v = 0x80000000u; index; index >>= 1, v ^= v >> 1)
      if (index & 1) second ^= v;
    const std::uint32_t x = detail::scrambled_reversed(detail::reversed_bits(backward), key ^ 0x68bc21ebu),
                        y = detail::scrambled_reversed(detail::reversed_bits(second), key ^ 0x02e5be93u);
    return {unit(detail::reversed_bits(x)), unit(detail::reversed_bits(y))};
  }
  constexpr float operator()() { return pair().x; }

private:
  std::uint32_t path_, seed_, count_ = 0;
  static constexpr float unit(std::uint32_t x) { return float(x >> 8) * 0x1p-24f; }
};

/// n x n places in the unit square, one in each cell of n x n and one in each of n^2 rows and of n^2 columns (Chiu,
/// Shirley and Wang 1994, without the jitter); none for n < 2.
inline std::vector<vec2<float>> spread_places(int n) {
  std::vector<vec2<float>> places;
  const float cell = 1.0f / float(std::max(n, 1));
  for (int j = 0; j < n && n > 1; ++j) {
    for (int i = 0; i < n; ++i)
      places.emplace_back((float(i) + (float(j) + 0.5f) * cell) * cell, (float(j) + (float(i) + 0.5f) * cell) * cell);
  }
  return places;
}

}  // namespace burnish
