// burnish/ad/operations.h -- the table: every operation's value and slopes, once
// SPDX-License-Identifier: Apache-2.0
//
// value(a, b) gives y. back(d, y, a, b) gives d times the slope of y by each input. Where a slope does not exist the comment
// says what is returned.
#pragma once
#include <array>
#include <burnish/ad/packet.h>

namespace burnish {

/// Base of an arithmetic operation with N inputs.
template <int N> struct Operation {
  static constexpr int inputs = N, outputs = 1;
};
template <class T, int N> using Back = std::array<T, N>;

namespace op {
struct Add : Operation<2> {
  template <class T> static constexpr T value(T a, T b) { return a + b; }
  template <class T> static constexpr Back<T, 2> back(T d, T, T, T) { return {d, d}; }
};
struct Sub : Operation<2> {
  template <class T> static constexpr T value(T a, T b) { return a - b; }
  template <class T> static constexpr Back<T, 2> back(T d, T, T, T) { return {d, -d}; }
};
struct Mul : Operation<2> {
  template <class T> static constexpr T value(T a, T b) { return a * b; }
  template <class T> static constexpr Back<T, 2> back(T d, T, T a, T b) { return {d * b, d * a}; }
};
struct Div : Operation<2> {
  template <class T> static constexpr T value(T a, T b) { return a / b; }
  template <class T> static constexpr Back<T, 2> back(T d, T y, T, T b) {
    const T q = d / b;
    return {q, -q * y};
  }
};
/// 1 / a. What a recording makes of quotients: the way back then needs no division.
struct Reciprocal : Operation<1> {
  template <class T> static constexpr T value(T a) { return 1.0f / a; }
  template <class T> static constexpr Back<T, 1> back(T d, T y, T) { return {-d * y * y}; }
};
/// a b + c.
struct MulAdd : Operation<3> {
  template <class T> static constexpr T value(T a, T b, T c) { return a * b + c; }
  template <class T> static constexpr Back<T, 3> back(T d, T, T a, T b, T) { return {d * b, d * a, d}; }
};
/// a b - c.
struct MulSub : Operation<3> {
  template <class T> static constexpr T value(T a, T b, T c) { return a * b - c; }
  template <class T> static constexpr Back<T, 3> back(T d, T, T a, T b, T) { return {d * b, d * a, -d}; }
};
/// c - a b.
struct SubMul : Operation<3> {
  template <class T> static constexpr T value(T a, T b, T c) { return c - a * b; }
  template <class T> static constexpr Back<T, 3> back(T d, T, T a, T b, T) { return {-d * b, -d * a, d}; }
};
/// a^2, as the way back of a product with itself.
struct Square : Operation<1> {
  template <class T> static constexpr T value(T a) { return a * a; }
  template <class T> static constexpr Back<T, 1> back(T d, T, T a) { return {2.0f * d * a}; }
};
/// a b + c d + e f.
struct Dot3 : Operation<6> {
  template <class T> static constexpr T value(T a, T b, T c, T d, T e, T f) { return a * b + c * d + e * f; }
  template <class T> static constexpr Back<T, 6> back(T d_y, T, T a, T b, T c, T d, T e, T f) {
    return {d_y * b, d_y * a, d_y * d, d_y * c, d_y * f, d_y * e};
  }
};
struct Neg : Operation<1> {
  template <class T> static constexpr T value(T a) { return -a; }
  template <class T> static constexpr Back<T, 1> back(T d, T, T) { return {-d}; }
};
/// No slope at zero; 0 is returned there.
struct Sqrt : Operation<1> {
  template <class T> static constexpr T value(T a) { return sqrt(a); }
  template <class T> static constexpr Back<T, 1> back(T d, T y, T) {
    return {select(y > 0.0f, d * 0.5f / y, T(0.0f))};
  }
};
struct Rsqrt : Operation<1> {
  template <class T> static constexpr T value(T a) { return rsqrt(a); }
  template <class T> static constexpr Back<T, 1> back(T d, T y, T) { return {d * -0.5f * y * y * y}; }
};
struct Exp : Operation<1> {
  template <class T> static constexpr T value(T a) { return exp(a); }
  template <class T> static constexpr Back<T, 1> back(T d, T y, T) { return {d * y}; }
};
struct Log : Operation<1> {
  template <class T> static constexpr T value(T a) { return log(a); }
  template <class T> static constexpr Back<T, 1> back(T d, T, T a) { return {d / a}; }
};
struct Exp2 : Operation<1> {
  template <class T> static constexpr T value(T a) { return exp2(a); }
  template <class T> static constexpr Back<T, 1> back(T d, T y, T) { return {d * y * T(0.693147180559945309)}; }
};
struct Log2 : Operation<1> {
  template <class T> static constexpr T value(T a) { return log2(a); }
  template <class T> static constexpr Back<T, 1> back(T d, T, T a) { return {d * T(1.44269504088896341) / a}; }
};
/// a >= 0; at a = 0 both slopes are given as 0.
struct Pow : Operation<2> {
  template <class T> static constexpr T value(T a, T b) { return pow(a, b); }
  template <class T> static constexpr Back<T, 2> back(T d, T y, T a, T b) {
    return {select(a > 0.0f, d * b * y / a, T(0.0f)), select(a > 0.0f, d * y * log(a), T(0.0f))};
  }
};
struct Sin : Operation<1> {
  template <class T> static constexpr T value(T a) { return sin(a); }
  template <class T> static constexpr Back<T, 1> back(T d, T, T a) { return {d * cos(a)}; }
};
struct Cos : Operation<1> {
  template <class T> static constexpr T value(T a) { return cos(a); }
  template <class T> static constexpr Back<T, 1> back(T d, T, T a) { return {-d * sin(a)}; }
};
struct Tan : Operation<1> {
  template <class T> static constexpr T value(T a) { return tan(a); }
  template <class T> static constexpr Back<T, 1> back(T d, T y, T) { return {d * (1.0f + y * y)}; }
};
/// At the ends -1 and 1 the slope is given as 3162, that of the point 5e-8 inside.
struct Asin : Operation<1> {
  template <class T> static constexpr T value(T a) { return asin(a); }
  template <class T> static constexpr Back<T, 1> back(T d, T, T a) { return {d / sqrt(max(1.0f - a * a, T(1e-7f)))}; }
};
struct Acos : Operation<1> {
  template <class T> static constexpr T value(T a) { return acos(a); }
  template <class T> static constexpr Back<T, 1> back(T d, T, T a) { return {-d / sqrt(max(1.0f - a * a, T(1e-7f)))}; }
};
/// The angle of (x, y); 0 at the origin, with slopes given as 0 there.
struct Atan2 : Operation<2> {
  template <class T> static constexpr T value(T y, T x) { return atan2(y, x); }
  template <class T> static constexpr Back<T, 2> back(T d, T, T y, T x) {
    const T r2 = x * x + y * y, q = select(r2 > 0.0f, d / r2, T(0.0f));
    return {q * x, -q * y};
  }
};
struct Tanh : Operation<1> {
  template <class T> static constexpr T value(T a) { return tanh(a); }
  template <class T> static constexpr Back<T, 1> back(T d, T y, T) { return {d * (1.0f - y * y)}; }
};
/// At 0 the slope is given as 1.
struct Abs : Operation<1> {
  template <class T> static constexpr T value(T a) { return abs(a); }
  template <class T> static constexpr Back<T, 1> back(T d, T, T a) { return {select(a < 0.0f, -d, d)}; }
};
/// At a tie value and slope go to b.
struct Max : Operation<2> {
  template <class T> static constexpr T value(T a, T b) { return max(a, b); }
  template <class T> static constexpr Back<T, 2> back(T d, T, T a, T b) {
    return {select(a > b, d, T(0.0f)), select(a > b, T(0.0f), d)};
  }
};
struct Min : Operation<2> {
  template <class T> static constexpr T value(T a, T b) { return min(a, b); }
  template <class T> static constexpr Back<T, 2> back(T d, T, T a, T b) {
    return {select(a < b, d, T(0.0f)), select(a < b, T(0.0f), d)};
  }
};
/// Its slope is zero wherever it exists.
struct Floor : Operation<1> {
  static constexpr bool active = false;
  template <class T> static constexpr T value(T a) { return floor(a); }
  template <class T> static constexpr Back<T, 1> back(T, T, T) { return {T(0.0f)}; }
};
/// 1 or 0.
struct Less : Operation<2> {
  static constexpr bool active = false;
  template <class T> static constexpr T value(T a, T b) { return select(a < b, T(1.0f), T(0.0f)); }
  template <class T> static constexpr Back<T, 2> back(T, T, T, T) { return {T(0.0f), T(0.0f)}; }
};
/// a where c is above a half, else b.
struct Select : Operation<3> {
  template <class T> static constexpr T value(T c, T a, T b) { return select(c > 0.5f, a, b); }
  template <class T> static constexpr Back<T, 3> back(T d, T, T c, T, T) {
    return {T(0.0f), select(c > 0.5f, d, T(0.0f)), select(c > 0.5f, T(0.0f), d)};
  }
};
}  // namespace op

}  // namespace burnish
