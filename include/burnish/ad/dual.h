// burnish/ad/dual.h -- a number with its slopes in a few directions, carried forward
// SPDX-License-Identifier: Apache-2.0
//
// The better way up to about eight directions, and for small Jacobians; T is any number but a Recorded one.
#pragma once
#include <burnish/ad/model.h>

namespace burnish {

template <class T, int N> struct Dual : detail::Elementary<Dual<T, N>> {
  T value{};
  std::array<T, N> slope{};

  constexpr Dual() { slope.fill(T(0.0f)); }
  template <class A> requires std::is_arithmetic_v<A> constexpr Dual(A x) : value(x) { slope.fill(T(0.0f)); }
  constexpr Dual(const T& x) requires(!std::is_arithmetic_v<T>) : value(x) { slope.fill(T(0.0f)); }
  /// The variable of one direction.
  constexpr Dual(const T& x, int direction) : Dual(x) { slope[std::size_t(direction)] = T(1.0f); }

  static constexpr auto less(const Dual& a, const Dual& b) { return a.value < b.value; }
  template <class M> friend constexpr Dual select(const M& condition, const Dual& a, const Dual& b) {
    Dual r(select(condition, a.value, b.value));
    for (std::size_t i = 0; i < N; ++i) r.slope[i] = select(condition, a.slope[i], b.slope[i]);
    return r;
  }
  template <class Op, std::size_t K> static constexpr std::array<Dual, Op::outputs> play(const std::array<Dual, K>& x) {
    return carried<Op>(x, nullptr);
  }
  template <class Op, class D, std::size_t K>
  static constexpr std::array<Dual, Op::outputs> read(const D& data, const std::array<Dual, K>& x) {
    return carried<Op>(x, static_cast<const typename Op::Data*>(&data));
  }

private:
  template <class Op, std::size_t K>
  static constexpr std::array<Dual, Op::outputs> carried(const std::array<Dual, K>& x, const void* data) {
    T in[K], y[Op::outputs], d_x[K];
    for (std::size_t k = 0; k < K; ++k) in[k] = x[k].value;
    detail::forward<Op, T>(in, y, data);
    std::array<Dual, Op::outputs> r;
    for (int j = 0; j < Op::outputs; ++j) {
      Dual& out = r[std::size_t(j)];
      out.value = y[j];
      if constexpr (detail::has_slopes<Op>()) {
        T d_y[Op::outputs];
        for (int i = 0; i < Op::outputs; ++i) d_y[i] = T(i == j ? 1.0f : 0.0f);
        detail::backward<Op, T>(in, y, d_y, d_x, data, nullptr);
        for (std::size_t i = 0; i < N; ++i)
          for (std::size_t k = 0; k < K; ++k) out.slope[i] += d_x[k] * x[k].slope[i];
      }
    }
    return r;
  }
};

}  // namespace burnish
