// burnish/io/decode.h -- numbers of any width in files, as floats
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>
#include <burnish/scene/error.h>

namespace burnish::detail {

static_assert(std::endian::native == std::endian::little, "files are written as the memory has them");

enum class NumberType { boolean, u8, i8, u16, i16, u32, i32, u64, i64, f16, bf16, f32, f64 };
inline std::size_t bytes_of(NumberType t) {
  constexpr std::size_t bytes[] = {1, 1, 1, 2, 2, 4, 4, 8, 8, 2, 2, 4, 8};
  return bytes[std::size_t(t)];
}

/// IEEE 754 binary16; exact.
inline float from_half(std::uint16_t h) {
  const int exponent = (h >> 10) & 31, fraction = h & 1023;
  const float size = exponent == 31  ? (fraction ? std::numeric_limits<float>::quiet_NaN() : HUGE_VALF)
                     : exponent == 0 ? std::ldexp(float(fraction), -24)
                                     : std::ldexp(float(1024 + fraction), exponent - 25);
  return h & 0x8000 ? -size : size;
}

/// The nearest binary16, ties to even; beyond its range infinity, NaN stays.
inline std::uint16_t to_half(float x) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(x), sign = (bits >> 16) & 0x8000u, size = bits & 0x7fffffffu;
  if (size > 0x7f800000u) return std::uint16_t(sign | 0x7e00u);
  if (size >= 0x477ff000u) return std::uint16_t(sign | 0x7c00u);  // 65520 on rounds up to infinity
  if (size < 0x38800000u)  // below 2^-14 in steps of 2^-24: the addition rounds
    return std::uint16_t(sign | (std::bit_cast<std::uint32_t>(std::bit_cast<float>(size) + 0.5f) - 0x3f000000u));
  return std::uint16_t(sign | ((size - 0x38000000u + 0xfffu + ((size >> 13) & 1u)) >> 13));
}

/// How many numbers a shape has; nothing when they would take more than `most` bytes of `width` each.
inline std::optional<std::size_t> count_of(const std::vector<std::size_t>& shape, std::size_t width, std::size_t most) {
  if (std::find(shape.begin(), shape.end(), std::size_t(0)) != shape.end()) return 0;
  std::size_t count = 1;
  for (const std::size_t n : shape) {
    if (n > most / width / count) return std::nullopt;
    count *= n;
  }
  return count * width <= most ? std::optional(count) : std::nullopt;
}

/// `count` numbers from `bytes`, in the other byte order if `swapped`. What float holds is exact; f64 is rounded.
/// Error, after `what`, for an integer beyond 2^24 and for a finite f64 beyond float's range.
inline std::vector<float> decode(NumberType type, const char* bytes, std::size_t count, bool swapped,
                                 const std::string& what) {
  std::vector<float> out(count);
  const auto each = [&]<class X>(X x, auto convert) {
    for (std::size_t i = 0; i < count; ++i) {
      char at[sizeof(X)];
      std::memcpy(at, bytes + i * sizeof x, sizeof x);
      if (swapped) std::reverse(at, at + sizeof x);
      std::memcpy(&x, at, sizeof x);
      out[i] = convert(x);
    }
  };
  const auto whole = [&]<class X>(X x) {
    if (x > X(1 << 24) || (std::is_signed_v<X> && x < X(-(1 << 24))))
      throw Error(what + ": the integer " + std::to_string(x) + ", expected at most 2^24, which floats hold exactly");
    return float(x);
  };
  const auto same = [](auto x) { return float(x); };
  switch (type) {
    case NumberType::boolean:
      each(std::uint8_t(), [](auto x) { return x ? 1.0f : 0.0f; });
      break;
    case NumberType::u8:
      each(std::uint8_t(), same);
      break;
    case NumberType::i8:
      each(std::int8_t(), same);
      break;
    case NumberType::u16:
      each(std::uint16_t(), same);
      break;
    case NumberType::i16:
      each(std::int16_t(), same);
      break;
    case NumberType::u32:
      each(std::uint32_t(), whole);
      break;
    case NumberType::i32:
      each(std::int32_t(), whole);
      break;
    case NumberType::u64:
      each(std::uint64_t(), whole);
      break;
    case NumberType::i64:
      each(std::int64_t(), whole);
      break;
    case NumberType::f16:
      each(std::uint16_t(), from_half);
      break;
    case NumberType::bf16:
      each(std::uint16_t(), [](std::uint16_t x) { return std::bit_cast<float>(std::uint32_t(x) << 16); });
      break;
    case NumberType::f32:
      each(float(), same);
      break;
    case NumberType::f64:
      each(double(), [&](double x) {
        if (std::isfinite(x) && std::fabs(x) > double(std::numeric_limits<float>::max()))
          throw Error(what + ": the number " + std::to_string(x) + ", expected one that floats hold");
        return float(x);
      });
      break;
  }
  return out;
}

/// "[2, 3]"
inline std::string shape_text(const std::vector<std::size_t>& shape) {
  std::string s = "[";
  for (std::size_t i = 0; i < shape.size(); ++i) s += (i ? ", " : "") + std::to_string(shape[i]);
  return s + "]";
}

}  // namespace burnish::detail
