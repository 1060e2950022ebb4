// burnish/ad/fuse.h -- products and the sums that they feed, made one operation
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/ad/plan.h>

namespace burnish::detail {

/// Products that only one sum or difference reads become one operation with it; three in a sum, a dot product.
inline void fuse(Recording& r) {
  std::vector<int> uses(r.nodes.size());
  for (const Node& x : r.nodes)
    for (int k = 0; k < inputs_of(x); ++k) ++uses[std::size_t(x.in[std::size_t(k)])];
  for (const int o : r.outputs) ++uses[std::size_t(o)];
  // Input k of x, if it is such an operation and can be done where x is.
  const auto part = [&](const Node& x, std::size_t k, const Info* op) -> const Node* {
    const Node& m = r.nodes[std::size_t(x.in[k])];
    const bool fits = m.kind == Kind::operation && m.op == op && m.loop == x.loop && m.varying == x.varying;
    return fits && uses[std::size_t(x.in[k])] == 1 ? &m : nullptr;
  };
  for (Node& x : r.nodes) {
    if (x.kind != Kind::operation || (!is<op::Add>(x.op) && !is<op::Sub>(x.op))) continue;
    for (const std::size_t k : {0u, 1u}) {
      const Node* const m = part(x, k, &info<op::Mul>);
      if (!m) continue;
      x.op = is<op::Add>(x.op) ? &info<op::MulAdd> : k == 0 ? &info<op::MulSub> : &info<op::SubMul>;
      x.in = {m->in[0], m->in[1], x.in[1 - k]};
      break;
    }
  }
  for (Node& x : r.nodes) {
    if (x.kind != Kind::operation || !is<op::MulAdd>(x.op)) continue;
    const Node* const m = part(x, 2, &info<op::MulAdd>);
    const Node* const n = m ? part(*m, 2, &info<op::Mul>) : nullptr;
    if (!n) continue;
    x.op = &info<op::Dot3>;
    x.in = {x.in[0], x.in[1], m->in[0], m->in[1], n->in[0], n->in[1]};
  }
}
/// The adjoint of input k is that of the output as it is.
inline bool hands_on(const Info* op, int k) {
  return is<op::Add>(op) || (is<op::Sub>(op) && k == 0) || (is<op::MulAdd>(op) && k == 2) ||
         (is<op::SubMul>(op) && k == 2);
}

}  // namespace burnish::detail
