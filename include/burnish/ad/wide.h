// burnish/ad/wide.h -- vectors of more lanes than a register of the machine has
// SPDX-License-Identifier: Apache-2.0
//
// g++ takes a vector wider than its registers apart lane by lane, comparisons above all: functions of sixteen floats are
// then eight times slower than they need be. Wide is such a vector as two halves, each a register or again a Wide, with
// the operators of the compilers' own vectors: + - * / & | ^ << >> between vectors or with a number on either side,
// comparisons that set all bits of a lane, and [] for one lane. Where the compilers' vectors ask for `m ? a : b` and
// __builtin_convertvector, blend and convert serve both kinds and single numbers.
#pragma once
#include <cstdint>
#include <type_traits>

// g++ fuses a product into the sum that follows it wherever it may; clang only if asked here.
#if defined(__clang__)
#define BURNISH_FUSE _Pragma("clang fp contract(fast)")
#else
#define BURNISH_FUSE
#endif
#define BURNISH_INLINE [[gnu::always_inline]] inline

namespace burnish::detail {

/// Bytes of the widest register that has whole numbers and floats.
#if defined(__AVX512F__)
inline constexpr int register_bytes = 64;
#elif defined(__AVX2__)
inline constexpr int register_bytes = 32;
#else
inline constexpr int register_bytes = 16;
#endif

template <class E, int N> struct native;  // spelled out: g++ 12 forgets an attribute that depends on the template
#define BURNISH_NATIVE(E, N) \
  template <> struct native<E, N> { typedef E type __attribute__((vector_size(N * sizeof(E)))); };
#define BURNISH_NATIVES(E) BURNISH_NATIVE(E, 2) BURNISH_NATIVE(E, 4) BURNISH_NATIVE(E, 8)
BURNISH_NATIVES(float) BURNISH_NATIVES(std::int32_t) BURNISH_NATIVES(std::uint32_t)
BURNISH_NATIVES(double) BURNISH_NATIVES(std::int64_t) BURNISH_NATIVES(std::uint64_t)
BURNISH_NATIVE(float, 16) BURNISH_NATIVE(std::int32_t, 16) BURNISH_NATIVE(std::uint32_t, 16)
#undef BURNISH_NATIVES
#undef BURNISH_NATIVE

template <class E, int N> struct Wide;
template <class E, int N> struct wide {
  using type = Wide<E, N>;
};
/// N lanes of E, a power of two: the compiler's own vector where a register holds it.
template <class E, int N> using vector_t =
    typename std::conditional_t<(N * int(sizeof(E)) <= register_bytes), native<E, N>, wide<E, N>>::type;

/// Nothing, but not at compile time: g++ clears a constant struct of Wides byte by byte, in memory.
template <class V> struct Unset {
  BURNISH_INLINE Unset() {}
};
template <class E, int N> struct alignas(N * sizeof(E)) Wide : Unset<Wide<E, N>> {
  using Half = vector_t<E, N / 2>;
  using Mask = Wide<std::conditional_t<sizeof(E) == 4, std::int32_t, std::int64_t>, N>;
  Half low, high;

  Wide() = default;
  BURNISH_INLINE Wide(Half l, Half h) : low(l), high(h) {}
  /// The same bits.
  template <class F> BURNISH_INLINE explicit Wide(const Wide<F, N>& a) : low(Half(a.low)), high(Half(a.high)) {}

  BURNISH_INLINE E operator[](int lane) const { return lane < N / 2 ? low[lane] : high[lane - N / 2]; }
  BURNISH_INLINE E& operator[](int lane) { return reinterpret_cast<E*>(this)[lane]; }

#define BURNISH_WIDE(R, op)                                                                                \
  BURNISH_INLINE friend R operator op(const Wide& a, const Wide& b) {                                      \
    BURNISH_FUSE                                                                                           \
    return R(a.low op b.low, a.high op b.high);                                                            \
  }                                                                                                        \
  BURNISH_INLINE friend R operator op(const Wide& a, E b) { return R(a.low op b, a.high op b); }           \
  BURNISH_INLINE friend R operator op(E a, const Wide& b) { return R(a op b.low, a op b.high); }
#define BURNISH_WIDE_TOO(op) \
  BURNISH_WIDE(Wide, op)     \
  template <class B> BURNISH_INLINE friend Wide& operator op##=(Wide& a, const B& b) { return a = a op b; }
  BURNISH_WIDE_TOO(+) BURNISH_WIDE_TOO(-) BURNISH_WIDE_TOO(*) BURNISH_WIDE_TOO(/)
  BURNISH_WIDE_TOO(&) BURNISH_WIDE_TOO(|) BURNISH_WIDE_TOO(^) BURNISH_WIDE_TOO(<<) BURNISH_WIDE_TOO(>>)
  BURNISH_WIDE(Mask, <) BURNISH_WIDE(Mask, >) BURNISH_WIDE(Mask, <=) BURNISH_WIDE(Mask, >=)
  BURNISH_WIDE(Mask, ==) BURNISH_WIDE(Mask, !=)
#undef BURNISH_WIDE
#undef BURNISH_WIDE_TOO
  BURNISH_INLINE friend Wide operator-(const Wide& a) { return Wide(-a.low, -a.high); }
  BURNISH_INLINE friend Wide operator~(const Wide& a) { return Wide(~a.low, ~a.high); }
};
template <class V> inline constexpr bool is_wide = false;
template <class E, int N> inline constexpr bool is_wide<Wide<E, N>> = true;

template <class V> BURNISH_INLINE V load(const void* from) {
  if constexpr (is_wide<V>) {
    using H = typename V::Half;
    return V(load<H>(from), load<H>(static_cast<const char*>(from) + sizeof(H)));
  } else {
    V r;
    __builtin_memcpy(&r, from, sizeof r);
    return r;
  }
}
template <class V> BURNISH_INLINE void store(const V& a, void* to) {
  if constexpr (is_wide<V>) store(a.low, to), store(a.high, static_cast<char*>(to) + sizeof a.low);
  else __builtin_memcpy(to, &a, sizeof a);
}
/// The same bits as another type; of a packet those of its lanes.
template <class To, class From> BURNISH_INLINE To bits(const From& a) {
  static_assert(sizeof(To) == sizeof(From));
  if constexpr (requires { a.v; }) return bits<To>(a.v);
  else if constexpr (requires { typename To::V; }) return To(bits<typename To::V>(a));
  else if constexpr (is_wide<To> && is_wide<From>) return To(a);
  else return load<To>(&a);
}
/// a in the lanes where m is not 0, b in the others.
template <class M, class V> BURNISH_INLINE V blend(M m, V a, V b) {
  if constexpr (is_wide<V>) return V(blend(m.low, a.low, b.low), blend(m.high, a.high, b.high));
  else return V(m ? a : b);
}
/// Every lane as a number of the other kind, toward zero.
template <class To, class From> BURNISH_INLINE To convert(From a) {
  if constexpr (is_wide<From> && is_wide<To>) {
    return To(convert<typename To::Half>(a.low), convert<typename To::Half>(a.high));
  } else if constexpr (is_wide<To>) {
    using Lane = std::remove_cvref_t<decltype(a[0])>;
    return convert<To>(bits<Wide<Lane, int(sizeof a / sizeof(Lane))>>(a));
  } else if constexpr (is_wide<From>) {
    To r;
    using Lane = std::remove_cvref_t<decltype(r[0])>;
    return bits<To>(convert<Wide<Lane, int(sizeof r / sizeof(Lane))>>(a));
  } else {
    return __builtin_convertvector(a, To);
  }
}
/// from[i] in every lane; i is not checked.
template <class V, class I> BURNISH_INLINE V gathered(const float* from, I i) {
  if constexpr (is_wide<V>) {
    return V(gathered<typename V::Half>(from, i.low), gathered<typename V::Half>(from, i.high));
  } else {
    V r;
    using Lane = std::remove_cvref_t<decltype(r[0])>;
    for (int k = 0; k < int(sizeof r / sizeof(Lane)); ++k) r[k] = Lane(from[i[k]]);
    return r;
  }
}

// One instruction each, where one is. The compilers' own names: the header that gives others costs a quarter of a second
// to read. g++ does not see `a > b ? a : b` for what it is when b is a constant.
/// sqrt of floats.
template <class V> BURNISH_INLINE V root(V x) {
  if constexpr (is_wide<V>) return V(root(x.low), root(x.high));
#if defined(__has_builtin) && __has_builtin(__builtin_elementwise_sqrt)
  else return __builtin_elementwise_sqrt(x);
#else
#if defined(__AVX512F__) && defined(__clang__)
  else if constexpr (sizeof x == 64) return __builtin_ia32_sqrtps512(x, 4);
#elif defined(__AVX512F__)
  else if constexpr (sizeof x == 64) return __builtin_ia32_sqrtps512_mask(x, V{}, -1, 4);
#endif
#if defined(__AVX__)
  else if constexpr (sizeof x == 32) return __builtin_ia32_sqrtps256(x);
#endif
#if defined(__SSE2__)
  else if constexpr (sizeof x == 16) return __builtin_ia32_sqrtps(x);
#endif
  else {
    for (int i = 0; i < int(sizeof x / sizeof x[0]); ++i) x[i] = __builtin_sqrtf(x[i]);
    return x;
  }
#endif
}
/// a > b ? a : b and a < b ? a : b.
#if defined(__clang__)
#define BURNISH_EXTREME(name)
#elif defined(__AVX2__)
#define BURNISH_EXTREME(name)                                                                               \
  else if constexpr (std::is_same_v<V, native<float, 8>::type>) return __builtin_ia32_##name##ps256(a, b);
#elif defined(__SSE2__)
#define BURNISH_EXTREME(name)                                                                               \
  else if constexpr (std::is_same_v<V, native<float, 4>::type>) return __builtin_ia32_##name##ps(a, b);
#else
#define BURNISH_EXTREME(name)
#endif
template <class V> BURNISH_INLINE V higher(V a, V b) {
  if constexpr (is_wide<V>) return V(higher(a.low, b.low), higher(a.high, b.high));
  BURNISH_EXTREME(max)
  else return a > b ? a : b;
}
template <class V> BURNISH_INLINE V lower(V a, V b) {
  if constexpr (is_wide<V>) return V(lower(a.low, b.low), lower(a.high, b.high));
  BURNISH_EXTREME(min)
  else return a < b ? a : b;
}
#undef BURNISH_EXTREME

}  // namespace burnish::detail

#undef BURNISH_FUSE
#undef BURNISH_INLINE
