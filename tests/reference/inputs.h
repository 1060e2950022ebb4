// tests/reference/inputs.h -- random inputs that generator (inputs.py) and test make alike
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <cstdint>
#include <utility>
#include <burnish/math/vec.h>

namespace reference {

/// Output number `counter` (from 0) of splitmix64 (Steele, Lea and Flood 2014) whose state began at 0.
constexpr std::uint64_t splitmix64(std::uint64_t counter) {
  std::uint64_t z = (counter + 1) * 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}
/// Number j of point i in a stream, in [0, 1) and exact in float.
constexpr double uniform(std::uint64_t stream, std::uint64_t i, std::uint64_t j) {
  return double(splitmix64((stream << 48) + (i << 8) + j) >> 40) / 16777216;
}
/// x rounded to float. Volatile, for g++ 12's vectoriser forgets that rounding where neighbours go to float and back.
inline double rounded(double x) {
  const volatile float y = float(x);
  return y;
}
inline burnish::vec3<double> rounded(const burnish::vec3<double>& v) {
  return {rounded(v.x), rounded(v.y), rounded(v.z)};
}
/// In [low, high], rounded to float where inputs.py rounds. Fused, the two operations would decide ties otherwise.
inline double between(std::uint64_t stream, std::uint64_t i, std::uint64_t j, double low, double high) {
  const volatile double part = (high - low) * uniform(stream, i, j);
  return rounded(low + part);
}
/// A vector of plain numbers in the number U.
template <class U> burnish::vec3<U> constant(const burnish::vec3<double>& v) { return {U(v.x), U(v.y), U(v.z)}; }

/// Unit, z > 0.035: from a box, so that square roots are all that is rounded.
inline burnish::vec3<double> upward(std::uint64_t stream, std::uint64_t i, std::uint64_t j) {
  const double x = 2 * uniform(stream, i, j) - 1, y = 2 * uniform(stream, i, j + 1) - 1,
               z = 0.05 + 0.95 * uniform(stream, i, j + 2), r = std::sqrt(x * x + y * y + z * z);
  return {x / r, y / r, z / r};
}
/// To the viewer and to the light, rounded to float; numbers 0 to 7. As `directions` of inputs.py says.
inline std::pair<burnish::vec3<double>, burnish::vec3<double>> directions(std::uint64_t stream, std::uint64_t i,
                                                                        double alpha) {
  using burnish::vec3;
  const vec3<double> v = upward(stream, i, 0), l = upward(stream, i, 3);
  const double x = 3 * alpha * (2 * uniform(stream, i, 6) - 1), y = 3 * alpha * (2 * uniform(stream, i, 7) - 1),
               r = std::sqrt(x * x + y * y + 1);
  const vec3<double> h(x / r, y / r, 1 / r), mirrored = h * (2 * (v.x * h.x + v.y * h.y + v.z * h.z)) - v;
  return {rounded(v), rounded(i % 2 == 1 && mirrored.z > 0.05 ? mirrored : l)};
}

}  // namespace reference
