// burnish/ad/replay_order.h -- in which order a replayed recording is done: forth, and back
// SPDX-License-Identifier: Apache-2.0
//
// Straight stretches and loops are blocks. What is the same for all pixels is done once, before or after them.
#pragma once
#include <burnish/ad/plan.h>

namespace burnish::detail {

/// The nodes of a recording in the order in which they are done. r and duty, of make_plan, must outlive it.
class ReplayOrder {
public:
  /// A stretch of nodes without a loop, or one loop.
  struct Block {
    int loop = -1;
    bool back = false;
    std::vector<int> again, nodes;  // what a turn of the way back does again; what is done
  };
  std::vector<Block> blocks;
  std::size_t first_back = 0;           // the first block of the way back
  std::vector<int> fields, once, last;  // read from the pixels; done before all pixels and after them

  ReplayOrder(const Recording& recording, const std::vector<Duty>& duties, bool image, bool gradient)
      : r(recording), duty(duties), with_image(image), with_gradient(gradient) {
    schedule();
  }

  /// What is done one after another: nodes forth or back, a block's begin and end; the start and the turning point.
  struct Task {
    enum { start, open, forth, back, close, turn } what;
    int block = -1, node = -1;
  };
  std::vector<Task> tasks() const {
    std::vector<Task> t{{Task::start}};
    for (std::size_t b = 0; b <= blocks.size(); ++b) {
      if (b == first_back) t.push_back({Task::turn});
      if (b == blocks.size()) break;
      t.push_back({Task::open, int(b)});
      for (const int i : blocks[b].again) t.push_back({Task::forth, int(b), i});
      for (const int i : blocks[b].nodes) t.push_back({blocks[b].back ? Task::back : Task::forth, int(b), i});
      t.push_back({Task::close, int(b)});
    }
    return t;
  }
  /// The sums of a loop.
  template <class F> void each_sum(int l, F f) const {
    const Loop& loop = r.loops[at(l)];
    for (int s = loop.first_sum; s < loop.first_sum + loop.sums; ++s) f(s);
  }
  /// Values that a task reads.
  template <class F> void reads(const Task& t, F f) const {
    if (t.what == Task::forth)
      for (int k = 0; k < node(t.node).op->inputs; ++k) f(node(t.node).in[at(k)]);
    if (t.what == Task::back) read_back(t.node, f);
    if (t.what == Task::turn && with_image)
      for (const int o : r.outputs) f(o);
    if (t.what != Task::close || blocks[at(t.block)].loop < 0) return;
    const Block& b = blocks[at(t.block)];
    if (!b.back) each_sum(b.loop, [&](int s) {
      if (duty[at(s)].forward) f(s), f(node(s).in[0]);
    });
    // What the turns read from outside must last until the last of them.
    for (const int i : b.again)
      for (int k = 0; k < node(i).op->inputs; ++k)
        if (!in_body(r, node(i).in[at(k)])) f(node(i).in[at(k)]);
    for (const int i : b.nodes) {
      const auto outside = [&](int j) {
        if (!in_body(r, j)) f(j);
      };
      if (b.back) read_back(i, outside);
      else
        for (int k = 0; k < node(i).op->inputs; ++k) outside(node(i).in[at(k)]);
    }
  }
  /// Values that a task writes.
  template <class F> void writes(const Task& t, F f) const {
    if (t.what == Task::start)
      for (const int i : fields) f(i);
    if (t.what == Task::forth)
      for (int k = 0; k < node(t.node).op->outputs; ++k) f(t.node + k);
    if (t.what == Task::open && blocks[at(t.block)].loop >= 0 && !blocks[at(t.block)].back)
      each_sum(blocks[at(t.block)].loop, [&](int s) {
        if (duty[at(s)].forward) f(s);
      });
  }
private:
  const Recording& r;
  const std::vector<Duty>& duty;
  bool with_image, with_gradient;

  static std::size_t at(int i) { return std::size_t(i); }
  int size() const { return int(r.nodes.size()); }
  const Node& node(int i) const { return r.nodes[at(i)]; }
  bool any(int i, bool Duty::*flag) const {
    for (int k = 0; k < node(i).op->outputs; ++k)
      if (duty[at(i + k)].*flag) return true;
    return false;
  }
  /// Which nodes are done in which block, in order.
  void schedule() {
    const int n = size();
    const auto straight = [&](bool back) -> Block& {
      if (blocks.size() == (back ? first_back : 0) || blocks.back().loop >= 0) blocks.emplace_back().back = back;
      return blocks.back();
    };
    for (int i = 0; i < n; ++i) {
      const Node& x = node(i);
      if (x.kind == Kind::pixel && duty[at(i)].forward) fields.push_back(i);
      if (x.kind == Kind::sum && r.loops[at(x.loop)].first_sum == i) {
        Block b;
        b.loop = x.loop;
        const Loop& loop = r.loops[at(x.loop)];
        bool wanted = false;
        for (int k = 0; k < loop.sums; ++k) wanted |= duty[at(i + k)].forward;
        for (int j = loop.begin; j < loop.end; ++j)
          if (in_body(r, j) && node(j).kind == Kind::operation && any(j, &Duty::forward)) b.nodes.push_back(j);
        if (wanted || !b.nodes.empty()) blocks.push_back(std::move(b));
      } else if (x.kind == Kind::operation && !in_body(r, i) && any(i, &Duty::forward))
        (x.varying ? straight(false).nodes : once).push_back(i);
    }
    first_back = blocks.size();
    for (int i = n - 1; with_gradient && i >= 0; --i) {
      const Node& x = node(i);
      if (in_body(r, i)) continue;
      if (x.kind == Kind::sum && r.loops[at(x.loop)].first_sum == i) {
        Block b;
        b.loop = x.loop;
        b.back = true;
        const Loop& loop = r.loops[at(x.loop)];
        for (int j = loop.begin; j < loop.end; ++j)
          if (in_body(r, j) && node(j).kind == Kind::operation && any(j, &Duty::turn)) b.again.push_back(j);
        for (int j = loop.end - 1; j >= loop.begin; --j)
          if (in_body(r, j) && duty[at(j)].back) b.nodes.push_back(j);
        blocks.push_back(std::move(b));
      } else if (duty[at(i)].back) (x.varying ? straight(true).nodes : last).push_back(i);
    }
  }

  /// Values a node's way back reads.
  template <class F> void read_back(int i, F f) const {
    const Node& x = node(i);
    unsigned bits = x.scatters ? (1u << x.op->inputs) - 1 : 0;
    for (int k = 0; k < x.op->inputs; ++k)
      if (duty[at(i)].mode[at(k)]) bits |= x.op->needs[at(k)];
    for (int k = 0; k < x.op->inputs; ++k)
      if (bits >> k & 1) f(x.in[at(k)]);
    for (int k = 0; k < x.op->outputs; ++k)
      if (bits >> (x.op->inputs + k) & 1) f(i + k);
  }
};

}  // namespace burnish::detail
