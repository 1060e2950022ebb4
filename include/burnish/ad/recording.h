// burnish/ad/recording.h -- a function as a list of operations, made by running it once on Recorded numbers
// SPDX-License-Identifier: Apache-2.0
//
// The same code records in the compiler (constexpr) and at run time. What is written twice is recorded once, and what is
// made of constants is computed on the spot. The bodies of loops lie in the same list; a node belongs to a loop only if one
// of its inputs does, so what does not change from turn to turn is hoisted as it is written.
#pragma once
#include <bit>
#include <stdexcept>
#include <burnish/ad/model.h>
#include <burnish/ad/strip.h>

namespace burnish {

enum class Kind : unsigned char { constant, parameter, data, pixel, item, operation, output, sum };

struct Node {
  Kind kind = Kind::constant;
  bool active = false;    // has a derivative
  bool varying = false;   // differs from pixel to pixel, or from turn to turn
  bool scatters = false;  // a reading operation whose data is itself a parameter
  int loop = -1;          // the loop that owns it, -1: none; of a sum: the loop it sums over
  int index = 0;          // which parameter, plane, field, resource; of an output: its place
  float value = 0;        // of a constant
  const Info* op = nullptr;
  std::array<int, detail::max_inputs> in{};
};
/// A loop over a list: its body is nodes[begin, end), and its sums follow from first_sum.
struct Loop {
  int list = 0, begin = 0, end = 0, sums = 0, first_sum = 0;
};

struct Recording {
  std::vector<Node> nodes;
  std::vector<Loop> loops;
  std::vector<int> outputs;
  std::vector<char> fitted;  // a resource: is it a parameter? (vector<bool> is not constexpr with clang)
  int parameters = 0, data = 0, pixels = 0, lists = 0, open = -1;

  constexpr int add(const Node& n) {
    nodes.push_back(n);
    return int(nodes.size()) - 1;
  }
  constexpr int input(Kind kind, int index, bool active) {
    Node n;
    n.kind = kind;
    n.index = index;
    n.active = active;
    n.varying = kind == Kind::pixel || kind == Kind::item;
    if (kind == Kind::item) n.loop = open;
    return add(n);
  }
  constexpr int constant(float x) {
    Node n;
    n.value = x;
    return once(n, std::bit_cast<unsigned>(x) * 2654435761u);
  }
  constexpr int operation(const Info* op, const int* in, int resource = 0) {
    Node n;
    n.kind = Kind::operation;
    n.op = op;
    n.index = resource;
    n.scatters = op->reads && fitted[std::size_t(resource)];
    n.active = n.scatters;
    for (int k = 0; k < op->inputs; ++k) n.in[k] = in[k];
    if ((is<op::Add>(op) || is<op::Mul>(op)) && n.in[1] < n.in[0]) std::swap(n.in[0], n.in[1]);
    unsigned hash = op->hash + unsigned(resource) * 97u;
    for (int k = 0; k < op->inputs; ++k) {
      const Node& x = nodes[std::size_t(n.in[k])];
      n.active |= x.active;
      n.varying |= x.varying;
      if (x.kind != Kind::sum && x.loop >= 0) n.loop = x.loop;
      hash = (hash ^ unsigned(n.in[k])) * 2654435761u;
    }
    n.active &= op->active;
    const int before = int(nodes.size()), id = once(n, hash);
    if (id < before) return id;
    for (int k = 1; k < op->outputs; ++k) {
      Node o = n;
      o.kind = Kind::output;
      o.scatters = false;
      o.index = k;
      o.in = {id};
      add(o);
    }
    return id;
  }

private:
  std::vector<int> table;  // 1 + a node, or 0; open addressing
  int filled = 0;

  constexpr int once(const Node& n, unsigned hash) {
    if (std::size_t(filled) * 2 >= table.size()) grow();
    for (std::size_t at = hash ^ hash >> 15;; ++at) {
      int& slot = table[at & (table.size() - 1)];
      if (slot == 0) {
        slot = add(n) + 1;
        hashes.push_back({slot, hash});
        ++filled;
        return slot - 1;
      }
      const Node& x = nodes[std::size_t(slot - 1)];
      const bool same_op = n.kind != Kind::operation || (x.kind == n.kind && x.op->hash == n.op->hash);
      if (x.kind == n.kind && same_op && x.index == n.index && x.in == n.in &&
          std::bit_cast<unsigned>(x.value) == std::bit_cast<unsigned>(n.value))
        return slot - 1;
    }
  }
  struct Hashed {
    int slot;
    unsigned hash;
  };
  std::vector<Hashed> hashes;
  constexpr void grow() {
    table.assign(table.empty() ? 64 : table.size() * 2, 0);
    for (const Hashed& h : hashes)
      for (std::size_t at = h.hash ^ h.hash >> 15;; ++at)
        if (int& slot = table[at & (table.size() - 1)]; slot == 0) {
          slot = h.slot;
          break;
        }
  }
};

/// A number that writes down how it is made. Constants become nodes only where an operation needs them.
struct Recorded : detail::Elementary<Recorded> {
  Recording* recording = nullptr;
  int id = -1;
  float constant = 0;

  constexpr Recorded() = default;
  constexpr Recorded(float c) : constant(c) {}
  constexpr Recorded(Recording* r, int node) : recording(r), id(node) {}
  constexpr bool is(float c) const { return id < 0 && constant == c; }
  constexpr int node(Recording* r) const { return id >= 0 ? id : r->constant(constant); }

  struct Mask;
  static constexpr Mask less(const Recorded& a, const Recorded& b);

  /// Gives y and true where no node is needed. R is Recorded: a dependent name, so that clang may use play in here.
  template <class Op, class R, std::size_t N> static constexpr bool folded(const std::array<R, N>& x, R& y) {
    bool constants = true;
    for (const R& a : x) constants &= a.id < 0;
    if (constants) {
      float in[N] = {};
      for (std::size_t k = 0; k < N; ++k) in[k] = x[k].constant;
      y = R(detail::value_of<Op>(std::make_index_sequence<N>{}, in));
      return true;
    }
    const R &a = x[0], &b = x[N - 1];
    if constexpr (std::is_same_v<Op, op::Add>) return a.is(0) ? (y = b, true) : b.is(0) ? (y = a, true) : false;
    if constexpr (std::is_same_v<Op, op::Sub>) return b.is(0) ? (y = a, true) : a.is(0) ? (y = -b, true) : false;
    if constexpr (std::is_same_v<Op, op::Mul>)
      return a.is(1) ? (y = b, true) : b.is(1) ? (y = a, true) : a.is(0) || b.is(0) ? (y = R(0.0f), true) : false;
    if constexpr (std::is_same_v<Op, op::Div>)
      return y = b.id < 0  ? a * R(1 / b.constant)
                 : a.is(0) ? R(0.0f)
                           : a * R::template play<op::Reciprocal>(std::array<R, 1>{b})[0],
             true;
    return false;
  }
  template <class Op, std::size_t N>
  static constexpr std::array<Recorded, Op::outputs> play(const std::array<Recorded, N>& x) {
    if constexpr (detail::Arithmetic<Op>)
      if (Recorded y; folded<Op>(x, y)) return {y};
    Recording* r = nullptr;
    for (const Recorded& a : x)
      if (a.id >= 0) r = a.recording;
    return written<Op>(r, x, 0);
  }
  template <class Op, std::size_t N>
  static constexpr std::array<Recorded, Op::outputs> written(Recording* r, const std::array<Recorded, N>& x,
                                                             int resource) {
    if (!r) throw std::logic_error("burnish: an operation of its own on constants only; compute it with floats");
    std::array<int, N> in{};
    for (std::size_t k = 0; k < N; ++k) in[k] = x[k].node(r);
    const int id = r->operation(&info<Op>, in.data(), resource);
    std::array<Recorded, Op::outputs> y;
    for (int k = 0; k < Op::outputs; ++k) y[std::size_t(k)] = Recorded(r, id + k);
    return y;
  }
};

/// A condition: 1 or 0.
struct Recorded::Mask {
  Recorded is;
  friend constexpr Mask operator&&(const Mask& a, const Mask& b) { return {a.is * b.is}; }
  friend constexpr Mask operator||(const Mask& a, const Mask& b) { return !(!a && !b); }
  friend constexpr Mask operator!(const Mask& a) { return {Recorded(1.0f) - a.is}; }
  template <class B> requires std::is_same_v<B, bool> explicit constexpr operator B() const {
    static_assert(
        !std::is_same_v<B, bool>,
        "burnish: `if`, `?:` or a loop depends on a number; write select(condition, a, b), min, max or clamp");
    return false;
  }
};
constexpr Recorded::Mask Recorded::less(const Recorded& a, const Recorded& b) {
  return {play<op::Less>(std::array{a, b})[0]};
}
constexpr Recorded select(const Recorded::Mask& m, const Recorded& a, const Recorded& b) {
  if (m.is.id < 0) return m.is.constant > 0.5f ? a : b;
  return Recorded::play<op::Select>(std::array{m.is, a, b})[0];
}

/// Recorded: a name.
template <class D> struct Resource<Recorded, D> {
  Recording* recording = nullptr;
  int index = 0;
};

/// An operation that reads data: an image, a table. y[0], y[1], ... are its outputs.
template <class Op, Number T, class D, std::size_t N>
constexpr std::array<T, Op::outputs> apply(const Resource<T, D>& from, const std::array<T, N>& x)
  requires(N == Op::inputs && detail::Reads<Op>)
{
  if constexpr (std::is_same_v<T, Recorded>) return Recorded::written<Op>(from.recording, x, from.index);
  else if constexpr (requires { T::template read<Op>(*from, x); }) return T::template read<Op>(*from, x);
  else {
    std::array<T, Op::outputs> y{};
    detail::forward<Op, T>(x.data(), y.data(), &static_cast<const typename Op::Data&>(*from));
    return y;
  }
}
/// The same with its inputs as arguments; an operation with one output gives it as it is.
template <class Op, Number T, class D, class... Rest>
constexpr auto apply(const Resource<T, D>& from, const same<T>& x, const Rest&... rest) requires(detail::Reads<Op>) {
  const auto y = apply<Op>(from, std::array<T, Op::inputs>{x, T(rest)...});
  if constexpr (Op::outputs == 1) return y[0];
  else return y;
}

}  // namespace burnish
