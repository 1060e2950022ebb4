// burnish/twin/cut.h -- a minimum cut of a small graph in two
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <limits>
#include <vector>

namespace burnish {

/// Which nodes are in: the labelling with the least sum of what each node costs in or out and of the edges between an
/// inner and an outer node. By Dinic's maximum flow (1970), exact; meant for some thousand nodes.
class MinimumCut {
public:
  explicit MinimumCut(int nodes) : first_(std::size_t(nodes) + 2, -1), source_(nodes), sink_(nodes + 1) {}
  /// Adds to the costs of node i, one of which may be negative.
  void node(int i, float cost_in, float cost_out) {
    if (cost_out > cost_in) arcs(source_, i, cost_out - cost_in, 0);
    else arcs(i, sink_, cost_in - cost_out, 0);
  }
  /// The cost of a and b on different sides, not negative.
  void edge(int a, int b, float cost) { arcs(a, b, cost, cost); }
  /// If a is in, so is b.
  void follow(int a, int b) { arcs(a, b, 1e9f, 0); }

  std::vector<bool> solve() {
    while (layered()) {
      at_ = first_;
      while (push(source_, std::numeric_limits<float>::max()) > 0) {}
    }
    std::vector<bool> in;
    for (int i = 0; i < source_; ++i) in.push_back(level_[std::size_t(i)] >= 0);
    return in;
  }

private:
  struct Arc {
    int to, next;
    float left;
  };
  std::vector<Arc> arc_;  // k and k ^ 1 are one arc's two directions
  std::vector<int> first_, at_, level_;
  int source_, sink_;

  void arcs(int a, int b, float there, float back) {
    arc_.push_back({b, first_[std::size_t(a)], there});
    first_[std::size_t(a)] = int(arc_.size()) - 1;
    arc_.push_back({a, first_[std::size_t(b)], back});
    first_[std::size_t(b)] = int(arc_.size()) - 1;
  }
  /// What is left after rounding is no flow.
  static bool open(float left) { return left > 1e-4f; }
  bool layered() {
    level_.assign(first_.size(), -1);
    std::vector<int> line{source_};
    level_[std::size_t(source_)] = 0;
    for (std::size_t i = 0; i < line.size(); ++i)
      for (int k = first_[std::size_t(line[i])]; k >= 0; k = arc_[std::size_t(k)].next) {
        const Arc& a = arc_[std::size_t(k)];
        if (!open(a.left) || level_[std::size_t(a.to)] >= 0) continue;
        level_[std::size_t(a.to)] = level_[std::size_t(line[i])] + 1;
        line.push_back(a.to);
      }
    return level_[std::size_t(sink_)] >= 0;
  }
  /// One path to the sink; what went through. Paths are as long as the graph is wide, so recursion is shallow enough.
  float push(int i, float most) {
    if (i == sink_) return most;
    for (int& k = at_[std::size_t(i)]; k >= 0; k = arc_[std::size_t(k)].next) {
      const Arc a = arc_[std::size_t(k)];
      if (!open(a.left) || level_[std::size_t(a.to)] != level_[std::size_t(i)] + 1) continue;
      const float through = push(a.to, std::min(most, a.left));
      if (through <= 0) continue;
      arc_[std::size_t(k)].left -= through;
      arc_[std::size_t(k ^ 1)].left += through;
      return through;
    }
    return 0;
  }
};

}  // namespace burnish
