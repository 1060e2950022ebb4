// tests/reference/inputs.h -- random inputs that generator (inputs.py) and test make alike
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

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
/// In [low, high], rounded to float where inputs.py rounds. Fused, the two operations would decide ties otherwise.
inline double between(std::uint64_t stream, std::uint64_t i, std::uint64_t j, double low, double high) {
  const volatile double part = (high - low) * uniform(stream, i, j);
  return float(low + part);
}

}  // namespace reference
