// burnish/ad/differentiate.h -- the value of a function at a point and its derivative by every argument
// SPDX-License-Identifier: Apache-2.0
//
//   auto [z, dz_dx, dz_dy] = differentiate([](auto x, auto y) { return sin(x) * exp(x * y); }, 1.0, 2.0);
//   auto [y, d] = differentiate([&](const auto& s) { return luminance(shade(s, hit)); }, plastic);  // d is a Surface<float>
#pragma once
#include <deque>
#include <burnish/ad/tape.h>

namespace burnish {

namespace detail {
template <class A> struct scalar_in {
  using type = A;
};
template <template <class> class P, class S> struct scalar_in<P<S>> {
  using type = S;
};
template <class A> using scalar_in_t = typename scalar_in<A>::type;

/// One tape a depth of nesting and thread, kept warm.
template <class S> class TapeLease {
public:
  TapeLease() {
    if (std::size_t(depth()) == kept().size()) kept().emplace_back();
    tape = &kept()[std::size_t(depth()++)];
    tape->clear();
  }
  ~TapeLease() { --depth(); }
  TapeLease(const TapeLease&) = delete;
  TapeLease& operator=(const TapeLease&) = delete;
  Tape<S>& operator*() const { return *tape; }

private:
  Tape<S>* tape;
  static std::deque<Tape<S>>& kept() {  // which never moves what it holds
    static thread_local std::deque<Tape<S>> tapes;
    return tapes;
  }
  static int& depth() {
    static thread_local int d = 0;
    return d;
  }
};
}  // namespace detail

/// {f(args...), d f / d args...}: f gives a number; an argument is a float or double, or a struct with parameters(),
/// and its derivative has its type. Any control flow. All arguments of one call hold the same plain number type.
template <class F, class First, class... Rest>
std::tuple<detail::scalar_in_t<First>, First, Rest...> differentiate(F&& f, const First& first, const Rest&... rest) {
  using S = detail::scalar_in_t<First>;
  static_assert(Plain<S> && (std::is_same_v<S, detail::scalar_in_t<Rest>> && ...),
                "burnish: differentiate takes arguments of one plain number type: all float or all double");
  const detail::TapeLease<S> lease;
  std::tuple<rebind_t<First, Var<S>>, rebind_t<Rest, Var<S>>...> lifted{lift<Var<S>>(first), lift<Var<S>>(rest)...};
  const auto every = [](auto visit, auto& t) { std::apply([&](auto&... a) { (each(visit, a), ...); }, t); };
  every([&]<class X>(X& x) { if constexpr (Number<X>) x = Var<S>(*lease, x.value); }, lifted);
  const Var<S> y = std::apply([&](const auto&... a) { return Var<S>(f(a...)); }, lifted);
  const std::vector<S>& d = (*lease).backward(y.id);
  std::tuple<First, Rest...> slopes{first, rest...};
  std::size_t i = 0;
  every([&]<class X>(X& x) { if constexpr (Number<X>) x = d[i++]; }, slopes);
  return std::tuple_cat(std::tuple<S>(y.value), slopes);
}

}  // namespace burnish
