// burnish/ad/tape.h -- one point, through any control flow: each operation notes its slopes as it is done
// SPDX-License-Identifier: Apache-2.0
//
// The slowest player and the freest: `if` and `while` on a Var are allowed, because a Var has a value. differentiate()
// in ad/differentiate.h is the door; this file is for those who keep a tape themselves.
#pragma once
#include <burnish/ad/model.h>

namespace burnish {

/// What was done, as slopes: an entry of value i is (an earlier value, d value i / d that value).
template <class S> class Tape {
public:
  int input() { return add(); }
  void slope(int input, S by) { entries.push_back({input, by}); }
  /// Closes the value whose slopes were just given.
  int add() {
    ends.push_back(int(entries.size()));
    return int(ends.size()) - 1;
  }
  void clear() {
    entries.clear();
    ends.clear();
  }
  /// d y / d every value, by a sweep from y to the first.
  const std::vector<S>& backward(int y) {
    d.assign(ends.size(), S(0));
    if (y < 0) return d;
    d[std::size_t(y)] = 1;
    for (int i = y; i >= 0; --i) {
      const S s = d[std::size_t(i)];
      if (s == 0) continue;
      for (int e = i ? ends[std::size_t(i) - 1] : 0; e < ends[std::size_t(i)]; ++e)
        d[std::size_t(entries[std::size_t(e)].input)] += s * entries[std::size_t(e)].by;
    }
    return d;
  }

private:
  struct Entry {
    int input;
    S by;
  };
  std::vector<Entry> entries;
  std::vector<int> ends;
  std::vector<S> d;
};

/// A number on a tape; without one, a constant. S is float or double.
template <class S = double> struct Var : detail::Elementary<Var<S>> {
  Tape<S>* tape = nullptr;
  int id = -1;
  S value = 0;

  constexpr Var() = default;
  template <class A> requires std::is_arithmetic_v<A> constexpr Var(A x) : value(S(x)) {}
  Var(Tape<S>& t, S x) : tape(&t), id(t.input()), value(x) {}

  static bool less(const Var& a, const Var& b) { return a.value < b.value; }
  friend Var select(bool condition, const Var& a, const Var& b) { return condition ? a : b; }

  template <class Op, std::size_t N> static std::array<Var, Op::outputs> play(const std::array<Var, N>& x) {
    return taped<Op>(x, nullptr);
  }
  template <class Op, class D, std::size_t N>
  static std::array<Var, Op::outputs> read(const D& data, const std::array<Var, N>& x) {
    return taped<Op>(x, static_cast<const typename Op::Data*>(&data));
  }

private:
  template <class Op, std::size_t N>
  static std::array<Var, Op::outputs> taped(const std::array<Var, N>& x, const void* data) {
    S in[N], y[Op::outputs], d_x[N];
    Tape<S>* tape = nullptr;
    for (std::size_t k = 0; k < N; ++k) {
      in[k] = x[k].value;
      if (x[k].tape) tape = x[k].tape;
    }
    detail::forward<Op, S>(in, y, data);
    std::array<Var, Op::outputs> r;
    for (int j = 0; j < Op::outputs; ++j) {
      r[std::size_t(j)].value = y[j];
      if (!tape || !detail::has_slopes<Op>()) continue;
      S d_y[Op::outputs] = {};
      d_y[j] = 1;
      detail::backward<Op, S>(in, y, d_y, d_x, data, nullptr);
      for (std::size_t k = 0; k < N; ++k)
        if (x[k].tape) tape->slope(x[k].id, d_x[k]);
      r[std::size_t(j)].tape = tape;
      r[std::size_t(j)].id = tape->add();
    }
    return r;
  }
};

}  // namespace burnish
