// burnish/ad/packet.h -- N numbers in step: what a loop over pixels is made of
// SPDX-License-Identifier: Apache-2.0
//
// Compiler vector extensions, so that g++ and clang keep a packet in registers whatever the machine; 16 floats are one
// AVX-512 register, two AVX or four SSE or NEON ones. exp, log, sin, ... are polynomials of our own in float (coefficients
// after Cephes, Moshier 1992), within 2 units in the last place of the exact value unless said otherwise; in double they
// call the C library lane by lane.
#pragma once
#include <burnish/ad/number.h>
#include <burnish/ad/wide.h>
#pragma GCC diagnostic ignored \
    "-Wpsabi"  // packets are passed by value, in memory where the machine has no such register

// g++ fuses a product into the sum that follows it wherever it may; clang only if asked here.
#if defined(__clang__)
#define BURNISH_FUSE _Pragma("clang fp contract(fast)")
#else
#define BURNISH_FUSE
#endif

namespace burnish {

/// Lanes of the packets that images are played with.
inline constexpr int lanes = 16;

namespace detail {
template <class S, int N> struct vectors {
  static_assert(std::is_same_v<S, float> || std::is_same_v<S, double>);
  using V = vector_t<S, N>;
  using I = vector_t<std::conditional_t<sizeof(S) == 4, std::int32_t, std::int64_t>, N>;
  using U = vector_t<std::conditional_t<sizeof(S) == 4, std::uint32_t, std::uint64_t>, N>;
};
}  // namespace detail

/// S is float (8 or 16 lanes) or double (8 lanes).
template <class S, int N> struct Packet {
  using Scalar = S;
  static constexpr int size = N;
  using V = typename detail::vectors<S, N>::V;
  using I = typename detail::vectors<S, N>::I;
  using U = typename detail::vectors<S, N>::U;
  V v;

  Packet() = default;
  Packet(V x) : v(x) {}
  Packet(S x) : v(x - V{}) {}
  template <class A> requires(std::is_arithmetic_v<A> && !std::is_same_v<A, S>) Packet(A x) : Packet(S(x)) {}

  static Packet load(const S* from) { return detail::load<V>(from); }
  void store(S* to) const { detail::store(v, to); }
  S operator[](int lane) const { return v[lane]; }

  friend Packet operator+(Packet a, Packet b) {
    BURNISH_FUSE
    return a.v + b.v;
  }
  friend Packet operator-(Packet a, Packet b) {
    BURNISH_FUSE
    return a.v - b.v;
  }
  friend Packet operator*(Packet a, Packet b) {
    BURNISH_FUSE
    return a.v * b.v;
  }
  friend Packet operator/(Packet a, Packet b) { return a.v / b.v; }
  friend Packet operator-(Packet a) { return -a.v; }
  friend Packet& operator+=(Packet& a, Packet b) { return a = a + b; }
  friend Packet& operator-=(Packet& a, Packet b) { return a = a - b; }
  friend Packet& operator*=(Packet& a, Packet b) { return a = a * b; }
  friend Packet& operator/=(Packet& a, Packet b) { return a = a / b; }

  /// All bits of a lane set: true.
  struct Mask {
    I m;
    friend Mask operator&&(Mask a, Mask b) { return {a.m & b.m}; }
    friend Mask operator||(Mask a, Mask b) { return {a.m | b.m}; }
    friend Mask operator!(Mask a) { return {~a.m}; }
  };
  friend Mask operator<(Packet a, Packet b) { return {a.v < b.v}; }
  friend Mask operator>(Packet a, Packet b) { return {a.v > b.v}; }
  friend Mask operator<=(Packet a, Packet b) { return {a.v <= b.v}; }
  friend Mask operator>=(Packet a, Packet b) { return {a.v >= b.v}; }
  friend Packet select(Mask m, Packet a, Packet b) { return detail::blend(m.m, a.v, b.v); }
  friend Packet max(Packet a, Packet b) { return detail::higher(a.v, b.v); }
  friend Packet min(Packet a, Packet b) { return detail::lower(a.v, b.v); }
  friend Packet abs(Packet a) { return detail::blend(a.v < 0, -a.v, a.v); }

  /// All lanes added, in the order of the lanes.
  S sum() const {
    S lane[N];
    store(lane);
    S s = lane[0];
    for (int i = 1; i < N; ++i) s += lane[i];
    return s;
  }
};

template <class T> inline constexpr bool is_packet = false;
template <class S, int N> inline constexpr bool is_packet<Packet<S, N>> = true;

template <class S, int N> struct whole<Packet<S, N>> {
  using type = typename Packet<S, N>::I;
};
/// Toward zero; |x| < 2^31 in float.
template <class S, int N> typename Packet<S, N>::I to_int(Packet<S, N> a) {
  return detail::convert<typename Packet<S, N>::I>(a.v);
}
template <class T> requires is_packet<T> T to_real(typename T::I a) {
  return T(detail::convert<typename T::V>(a));
}

namespace detail {
template <class P, class F> P each_lane(P a, F f) {
  P r;
  for (int i = 0; i < int(sizeof(P) / sizeof(a.v[0])); ++i) r.v[i] = f(a.v[i]);
  return r;
}
template <class P, class F> P each_lane(P a, P b, F f) {
  P r;
  for (int i = 0; i < int(sizeof(P) / sizeof(a.v[0])); ++i) r.v[i] = f(a.v[i], b.v[i]);
  return r;
}
/// c[0] x^n + ... + c[n].
template <class P, class... C> [[gnu::always_inline]] inline P polynomial(P x, float first, C... c) {
  P r = first;
  ((r = r * x + float(c)), ...);
  return r;
}
}  // namespace detail

template <class S, int N> [[gnu::always_inline]] inline Packet<S, N> sqrt(Packet<S, N> a) {
  if constexpr (sizeof(S) == 8) return detail::each_lane(a, [](S x) { return std::sqrt(x); });
  else return detail::root(a.v);
}
template <class S, int N> Packet<S, N> rsqrt(Packet<S, N> a) { return Packet<S, N>(1) / sqrt(a); }

template <class S, int N> [[gnu::always_inline]] inline Packet<S, N> floor(Packet<S, N> a) {
  if constexpr (sizeof(S) == 8) return detail::each_lane(a, [](S x) { return std::floor(x); });
  else {
    const auto t = to_real<Packet<S, N>>(to_int(a)), f = t - select(t > a, Packet<S, N>(1), Packet<S, N>(0));
    return select(abs(a) < 8388608.0f, f, a);  // beyond 2^23 every float is whole
  }
}
/// from[i] in every lane; i is not checked. gather<T>(from, i) for any T.
template <class T> requires is_packet<T> [[gnu::always_inline]] inline T gather(const float* from, typename T::I i) {
  return detail::gathered<typename T::V>(from, i);
}

/// Overflows to infinity above 88.7, reaches zero below -87.3.
template <class S, int N> [[gnu::always_inline]] inline Packet<S, N> exp(Packet<S, N> a) {
  using P = Packet<S, N>;
  if constexpr (sizeof(S) == 8) return detail::each_lane(a, [](S x) { return std::exp(x); });
  else {
    const P c = min(max(a, -87.33654f), 88.72283f), n = floor(c * 1.44269504f + 0.5f);
    const P x = (c - n * 0.693359375f) + n * 2.12194440e-4f;
    const P p = detail::polynomial(x, 1.9875691500e-4f, 1.3981999507e-3f, 8.3334519073e-3f, 4.1665795894e-2f,
                                   1.6666665459e-1f, 5.0000001201e-1f);
    const P half = detail::bits<P>(typename P::I((to_int(n) + 126) << 23));  // 2^(n-1): 2^128 is no float
    const P y = (p * x * x + x + 1.0f) * half * 2.0f;
    const P high = select(a > 88.72283f, P(std::numeric_limits<float>::infinity()), y);
    return select(a < -87.33654f, P(0.0f), select(a <= a, high, a));
  }
}
/// log(0) = -infinity; NaN below zero. Numbers under 1.2e-38 count as 1.2e-38.
template <class S, int N> [[gnu::always_inline]] inline Packet<S, N> log(Packet<S, N> a) {
  using P = Packet<S, N>;
  if constexpr (sizeof(S) == 8) return detail::each_lane(a, [](S x) { return std::log(x); });
  else {
    const auto b = detail::bits<typename P::I>(max(a, std::numeric_limits<float>::min()));
    const typename P::I e = (b - 0x3f3504f3) >> 23;
    const P f = detail::bits<P>(typename P::I(b - (e << 23))) - 1.0f, z = f * f, n = to_real<P>(e);
    const P p = detail::polynomial(f, 7.0376836292e-2f, -1.1514610310e-1f, 1.1676998740e-1f, -1.2420140846e-1f,
                                   1.4249322787e-1f, -1.6668057665e-1f, 2.0000714765e-1f, -2.4999993993e-1f,
                                   3.3333331174e-1f);
    const P y = f + (p * f * z + n * -2.12194440e-4f - z * 0.5f) + n * 0.693359375f;
    constexpr float infinity = std::numeric_limits<float>::infinity();
    const P inside = select(a < infinity, y, a), edge = select(a >= 0.0f, P(-infinity), P(std::nanf("")));
    return select(a > 0.0f, inside, edge);
  }
}
template <class S, int N> Packet<S, N> exp2(Packet<S, N> a) {
  if constexpr (sizeof(S) == 8) return detail::each_lane(a, [](S x) { return std::exp2(x); });
  else return exp(a * 0.693147181f);
}
template <class S, int N> Packet<S, N> log2(Packet<S, N> a) {
  if constexpr (sizeof(S) == 8) return detail::each_lane(a, [](S x) { return std::log2(x); });
  else return log(a) * 1.44269504f;
}
/// a >= 0; the relative error grows with |b log a|, 1e-7 times it.
template <class S, int N> Packet<S, N> pow(Packet<S, N> a, same<Packet<S, N>> b) {
  if constexpr (sizeof(S) == 8) return detail::each_lane(a, b, [](S x, S y) { return std::pow(x, y); });
  else return select(typename Packet<S, N>::Mask{b.v == 0.0f}, Packet<S, N>(1.0f), exp(b * log(a)));
}
/// Absolute error under 2e-7 for |a| < 8000, and |a| * 1e-7 beyond.
template <class S, int N> [[gnu::always_inline]] inline Packet<S, N> sin(Packet<S, N> a) {
  using P = Packet<S, N>;
  if constexpr (sizeof(S) == 8) return detail::each_lane(a, [](S x) { return std::sin(x); });
  else {
    const P n = floor(a * 0.318309886f + 0.5f);
    const P x = ((a - n * 3.140625f) - n * 9.67502593994140625e-4f) - n * 1.509957990978376e-7f, z = x * x;
    const P p = detail::polynomial(z, 2.6083159810e-06f, -1.981069071917e-4f, 8.333078585565e-3f, -1.666665971265e-1f);
    const P y = p * z * x + x;
    return select(typename P::Mask{(to_int(n) & 1) != 0}, -y, y);
  }
}
template <class S, int N> Packet<S, N> cos(Packet<S, N> a) {
  if constexpr (sizeof(S) == 8) return detail::each_lane(a, [](S x) { return std::cos(x); });
  else return sin(a + 1.57079632679f);
}
template <class S, int N> Packet<S, N> tan(Packet<S, N> a) { return sin(a) / cos(a); }
template <class S, int N> [[gnu::always_inline]] inline Packet<S, N> atan2(Packet<S, N> y, same<Packet<S, N>> x) {
  using P = Packet<S, N>;
  if constexpr (sizeof(S) == 8) return detail::each_lane(y, x, [](S b, S a) { return std::atan2(b, a); });
  else {
    const P ax = abs(x), ay = abs(y), low = min(ax, ay), high = max(ax, ay);
    const P t = low / max(high, std::numeric_limits<float>::min());
    const auto far = t > 0.414213562f;  // tan(pi/8): beyond it, atan t = pi/4 + atan((t - 1) / (t + 1))
    const P r = select(far, (t - 1.0f) / (t + 1.0f), t), z = r * r;
    const P p = detail::polynomial(z, 8.05374449538e-2f, -1.38776856032e-1f, 1.99777106478e-1f, -3.33329491539e-1f);
    P a = p * z * r + r + select(far, P(0.785398163f), P(0.0f));
    a = select(ay > ax, 1.57079633f - a, a);
    a = select(x < 0.0f, 3.14159265f - a, a);
    return select(y < 0.0f, -a, a);
  }
}
template <class S, int N> Packet<S, N> acos(Packet<S, N> a) {
  return atan2(sqrt(max((1.0f - a) * (1.0f + a), 0.0f)), a);
}
template <class S, int N> Packet<S, N> asin(Packet<S, N> a) {
  return atan2(a, sqrt(max((1.0f - a) * (1.0f + a), 0.0f)));
}
template <class S, int N> Packet<S, N> tanh(Packet<S, N> a) {
  using P = Packet<S, N>;
  if constexpr (sizeof(S) == 8) return detail::each_lane(a, [](S x) { return std::tanh(x); });
  else {
    const P z = a * a, p = detail::polynomial(z, -5.70498872745e-3f, 2.06390887954e-2f, -5.37397155531e-2f,
                                              1.33314422036e-1f, -3.33332819422e-1f);
    return select(abs(a) < 0.625f, p * z * a + a, 1.0f - 2.0f / (exp(2.0f * a) + 1.0f));
  }
}

}  // namespace burnish

#undef BURNISH_FUSE
