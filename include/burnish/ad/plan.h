// burnish/ad/plan.h -- what of a recording a player must do: passes that all players share
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/ad/recording.h>

namespace burnish {

/// A recording of exact size, as the compiler keeps it.
template <int N, int L, int O> struct Frozen {
  std::array<Node, N> nodes{};
  std::array<Loop, L> loops{};
  std::array<int, O> outputs{};
};

/// On the way back a loop either runs its body again, or reads the costly values (quotients, roots, noise) that the way
/// forth has kept, and does the cheap ones again, or reads all that it needs.
enum class Turns { again, kept, all };

/// What to do with one node.
struct Duty {
  bool forward = false;  // compute it on the way forth
  bool turn = false;     // a body node: compute it (again) in a turn of the way back
  bool adjoint = false;  // its value has an adjoint
  bool back = false;     // an operation: one of its values has
  int kept = 0;          // a body node: 1 + where its value is kept for the way back; 0: not kept
  int clear = 0;         // 1 + the loop before whose way back its adjoint must be zero; 0: none
  std::array<signed char, detail::max_inputs> mode{};  // adjoint of input k: 0 none, 1 assign, 2 add
};

/// A node that is done anew in each turn of a loop.
template <class R> constexpr bool in_body(const R& r, int i) {
  const Node& x = r.nodes[std::size_t(i)];
  return x.loop >= 0 && x.kind != Kind::sum;
}
/// Cheaper to compute than to keep.
constexpr bool cheap(const Node& x) {
  return is<op::Add>(x.op) || is<op::Sub>(x.op) || is<op::Mul>(x.op) || is<op::MulAdd>(x.op) ||
         is<op::Neg>(x.op) || is<op::Max>(x.op) || is<op::Min>(x.op) || is<op::Abs>(x.op) ||
         is<op::Less>(x.op) || is<op::Select>(x.op);
}
/// So many cheap operations are worth keeping their result.
inline constexpr int dear = 6;
constexpr int inputs_of(const Node& x) {
  return x.kind == Kind::operation ? x.op->inputs : x.kind == Kind::output || x.kind == Kind::sum ? 1 : 0;
}

/// Fills p, one Duty a node. Gives how many values a turn keeps. `image`: the outputs are wanted beside the gradient.
template <class R, class A>
constexpr int make_plan(const R& r, A& p, bool gradient, Turns turns = Turns::again, bool image = false) {
  const int n = int(r.nodes.size());
  const auto node = [&](int i) -> const Node& { return r.nodes[std::size_t(i)]; };
  const auto duty = [&](int i) -> Duty& { return p[std::size_t(i)]; };
  const auto mark = [&](int t, int from) {
    if (!node(t).active) return 0;
    const bool seen = duty(t).adjoint;
    duty(t).adjoint = true;
    if (!node(t).varying) return 2;  // accumulates over the whole band
    if (from >= 0 && !in_body(r, t)) {
      if (!seen) duty(t).clear = from + 1;
      return 2;
    }
    return seen ? 2 : 1;
  };
  const auto need = [&](int i) { (in_body(r, i) ? duty(i).turn : duty(i).forward) = true; };
  const auto back = [&](int i) {
    const Node& x = node(i);
    if (x.kind != Kind::operation || !x.active) return;
    bool any = false;
    for (int k = 0; k < x.op->outputs; ++k) any |= duty(i + k).adjoint;
    if (!any) return;
    duty(i).back = true;
    unsigned bits = x.scatters ? (1u << x.op->inputs) - 1 : 0;
    for (int k = 0; k < x.op->inputs; ++k) {
      duty(i).mode[std::size_t(k)] = static_cast<signed char>(mark(x.in[std::size_t(k)], in_body(r, i) ? x.loop : -1));
      if (duty(i).mode[std::size_t(k)]) bits |= x.op->needs[std::size_t(k)];
    }
    for (int k = 0; k < x.op->inputs; ++k)
      if (bits >> k & 1) need(x.in[std::size_t(k)]);
    for (int k = 0; k < x.op->outputs; ++k)
      if (bits >> (x.op->inputs + k) & 1) need(i + k);
  };
  if (!gradient || image)
    for (const int o : r.outputs) duty(o).forward = true;
  if (gradient) {
    for (const int o : r.outputs) duty(o).adjoint = true;
    for (int i = n - 1; i >= 0; --i) {
      if (in_body(r, i)) continue;
      if (node(i).kind != Kind::sum) {
        back(i);
        continue;
      }
      const int l = node(i).loop;
      const Loop& loop = r.loops[std::size_t(l)];
      if (i != loop.first_sum) continue;
      for (int s = i; s < i + loop.sums; ++s)
        if (duty(s).adjoint && node(s).active) duty(s).mode[0] = static_cast<signed char>(mark(node(s).in[0], l));
      for (int j = loop.end - 1; j >= loop.begin; --j)
        if (in_body(r, j) && node(j).loop == l) back(j);
    }
  }
  // What a turn reads from the way forth: the costly values, and those that many cheap ones lead to.
  const auto closure = [&](auto stop) {
    for (int i = n - 1; i >= 0; --i) {
      if (stop(i)) {
        duty(i).turn = false;
        duty(i).forward = true;
      }
      for (int k = 0; k < inputs_of(node(i)); ++k) {
        if (duty(i).forward) duty(node(i).in[std::size_t(k)]).forward = true;
        if (duty(i).turn) need(node(i).in[std::size_t(k)]);
      }
    }
  };
  if (turns == Turns::again) {
    closure([](int) { return false; });
    return 0;
  }
  std::vector<char> wanted(r.nodes.size(), char(0)),
      keep(r.nodes.size(), char(0));  // not bool: its vector is no constant expression in every library
  for (int i = 0; i < n; ++i) wanted[std::size_t(i)] = duty(i).turn;
  std::vector<char> reached = wanted;
  for (int i = n - 1; i >= 0; --i)
    if (reached[std::size_t(i)] && node(i).kind == Kind::operation && cheap(node(i)))
      for (int k = 0; k < inputs_of(node(i)); ++k)
        if (in_body(r, node(i).in[std::size_t(k)])) reached[std::size_t(node(i).in[std::size_t(k)])] = true;
  std::vector<int> cost(std::size_t(n), 0);
  for (int i = 0; i < n; ++i) {
    if (!(turns == Turns::all ? wanted : reached)[std::size_t(i)] || node(i).kind == Kind::item) continue;
    if (turns == Turns::all || !(node(i).kind == Kind::operation && cheap(node(i)))) {
      keep[std::size_t(i)] = true;
      continue;
    }
    int c = 1;
    for (int k = 0; k < inputs_of(node(i)); ++k) c += cost[std::size_t(node(i).in[std::size_t(k)])];
    if (c >= dear && wanted[std::size_t(i)]) keep[std::size_t(i)] = true;
    else cost[std::size_t(i)] = c;
  }
  int kept = 0;
  closure([&](int i) {
    if (!keep[std::size_t(i)] || !duty(i).turn) return false;
    duty(i).kept = ++kept;
    return true;
  });
  return kept;
}

/// Where the way back needs the sum over a loop, the loop runs forth anyway and keeps what its way back wants; where it
/// does not, the loop runs on the way back alone.
template <class R, class A> constexpr Turns best_turns(const R& r, A& duty, bool image) {
  make_plan(r, duty, true, Turns::again, image);
  for (std::size_t i = 0; i < r.nodes.size(); ++i)
    if (r.nodes[i].kind == Kind::sum && duty[i].forward) return Turns::kept;
  return Turns::again;
}

}  // namespace burnish
