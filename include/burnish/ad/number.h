// burnish/ad/number.h -- the elementary functions of plain numbers, callable in constant expressions too
// SPDX-License-Identifier: Apache-2.0
//
// Every number type of the library answers the same unqualified names: + - * /, sqrt, rsqrt, exp, log, exp2, log2, pow,
// sin, cos, tan, asin, acos, atan2, tanh, abs, floor, min, max, clamp, mix, smoothstep and select. This file gives them
// to float and double. The compiler evaluates them while it records a function, where the C library cannot be called.
#pragma once
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace burnish {

/// The type of a later argument, when the first one decides: max(x, 0) is right for every number.
template <class T> using same = std::type_identity_t<T>;

/// float or double.
template <class T> concept Plain = std::is_floating_point_v<T>;

inline constexpr float pi = 3.14159265358979f, inverse_pi = 0.318309886183791f;

namespace detail::constant {  // to about 1e-15 relative, for the compiler only
constexpr double ln2 = 0.693147180559945309417, half_pi = 1.57079632679489661923;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

constexpr double floor(double x) {
  if (!(x > -9e15 && x < 9e15)) return x;
  const double t = double(std::int64_t(x));
  return t > x ? t - 1 : t;
}
constexpr double sqrt(double x) {
  if (!(x > 0) || x == infinity) return x == 0 || x == infinity ? x : nan;
  double scale = 1;
  for (; x < 0.25; x *= 4) scale /= 2;
  for (; x >= 1; x /= 4) scale *= 2;
  double y = 1;
  for (int i = 0; i < 8; ++i) y = 0.5 * (y + x / y);
  return y * scale;
}
constexpr double exp(double x) {
  if (x != x) return x;
  if (x > 709.7) return infinity;
  if (x < -745) return 0;
  const double n = floor(x / ln2 + 0.5), r = (x - n * 0.6931471803691238) - n * 1.9082149292705877e-10;
  double sum = 1, term = 1;
  for (int i = 1; i < 20; ++i) sum += term *= r / i;
  for (int i = 0; i < n; ++i) sum *= 2;
  for (int i = 0; i > n; --i) sum /= 2;
  return sum;
}
constexpr double log(double x) {
  if (!(x > 0)) return x == 0 ? -infinity : nan;
  if (x == infinity) return x;
  int n = 0;
  for (; x < 0.70710678; x *= 2) --n;
  for (; x > 1.41421357; x /= 2) ++n;
  const double z = (x - 1) / (x + 1), z2 = z * z;
  double sum = 0, power = z;
  for (int i = 1; i < 44; i += 2, power *= z2) sum += power / i;
  return 2 * sum + n * ln2;
}
constexpr double sin(double x) {
  const double n = floor(x / (2 * half_pi) + 0.5), r = (x - n * 3.14159265160560607910) - n * 1.98418714791870343e-9;
  double sum = r, term = r;
  for (int i = 2; i < 24; i += 2) sum += term *= -r * r / (i * (i + 1));
  return n - 2 * floor(n / 2) != 0 ? -sum : sum;
}
constexpr double cos(double x) { return sin(x + half_pi); }
constexpr double atan(double x) {
  if (x < 0) return -atan(-x);
  if (x > 1) return half_pi - atan(1 / x);
  for (int i = 0; i < 3; ++i) x = x / (1 + sqrt(1 + x * x));
  double sum = 0, power = x;
  for (int i = 1; i < 40; i += 2, power *= -x * x) sum += power / i;
  return 8 * sum;
}
constexpr double atan2(double y, double x) {
  if (x == 0 && y == 0) return 0;
  const double a = y < 0 ? -y : y, b = x < 0 ? -x : x, t = b > a ? atan(a / b) : half_pi - atan(b / a);
  const double q = x < 0 ? 2 * half_pi - t : t;
  return y < 0 ? -q : q;
}
}  // namespace detail::constant

#define BURNISH_PLAIN(name, at_run_time, at_compile_time) \
  template <Plain T> constexpr T name(T x) {              \
    if (std::is_constant_evaluated()) {                   \
      namespace c = detail::constant;                     \
      return T(at_compile_time);                          \
    }                                                     \
    return at_run_time;                                   \
  }
BURNISH_PLAIN(sqrt, std::sqrt(x), c::sqrt(double(x)))
BURNISH_PLAIN(exp, std::exp(x), c::exp(double(x)))
BURNISH_PLAIN(log, std::log(x), c::log(double(x)))
BURNISH_PLAIN(exp2, std::exp2(x), c::exp(double(x) * c::ln2))
BURNISH_PLAIN(log2, std::log2(x), c::log(double(x)) / c::ln2)
BURNISH_PLAIN(sin, std::sin(x), c::sin(double(x)))
BURNISH_PLAIN(cos, std::cos(x), c::cos(double(x)))
BURNISH_PLAIN(tan, std::tan(x), c::sin(double(x)) / c::cos(double(x)))
BURNISH_PLAIN(asin, std::asin(x), c::atan2(double(x), c::sqrt((1 - double(x)) * (1 + double(x)))))
BURNISH_PLAIN(acos, std::acos(x), c::atan2(c::sqrt((1 - double(x)) * (1 + double(x))), double(x)))
BURNISH_PLAIN(tanh, std::tanh(x), 1 - 2 / (c::exp(2 * double(x)) + 1))
BURNISH_PLAIN(floor, std::floor(x), c::floor(double(x)))
#undef BURNISH_PLAIN

template <Plain T> constexpr T rsqrt(T x) { return 1 / burnish::sqrt(x); }
/// x > 0.
template <Plain T> constexpr T pow(T x, same<T> y) {
  if (std::is_constant_evaluated()) return T(detail::constant::exp(double(y) * detail::constant::log(double(x))));
  return std::pow(x, y);
}
template <Plain T> constexpr T atan2(T y, same<T> x) {
  if (std::is_constant_evaluated()) return T(detail::constant::atan2(double(y), double(x)));
  return std::atan2(y, x);
}
template <Plain T> constexpr T abs(T x) { return x < 0 ? -x : x; }
/// At a tie, and where a is NaN, b.
template <Plain T> constexpr T max(T a, same<T> b) { return a > b ? a : b; }
template <Plain T> constexpr T min(T a, same<T> b) { return a < b ? a : b; }
template <Plain T> constexpr T select(bool condition, T a, same<T> b) { return condition ? a : b; }

/// Whole numbers beside a T: int for a plain number, a vector of them for a packet.
template <class T> struct whole;
template <Plain T> struct whole<T> {
  using type = int;
};
template <class T> using int_t = typename whole<T>::type;

/// Toward zero; -2^31 for NaN and where |x| >= 2^31, as the processor's instruction gives for packets.
template <Plain T> constexpr int to_int(T x) {
  return x >= T(-2147483648.0) && x < T(2147483648.0) ? int(x) : std::numeric_limits<int>::min();
}
template <Plain T> constexpr T to_real(int i) { return T(i); }
/// from[i]: gather<T>(from, i).
template <Plain T> constexpr T gather(const float* from, int i) { return T(from[i]); }

}  // namespace burnish
