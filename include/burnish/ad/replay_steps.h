// burnish/ad/replay_steps.h -- a recording written out as steps over strips, and where each value has its room
// SPDX-License-Identifier: Apache-2.0
//
// The room of a value is given to another once nothing reads it any more. An adjoint that is merely handed on changes
// its owner, not its place. What a loop's way back reads of a turn is kept in a frame of its own for every turn.
#pragma once
#include <burnish/ad/fuse.h>
#include <burnish/ad/replay_order.h>
#include <burnish/ad/strip.h>

namespace burnish::detail {

/// Where values and adjoints lie (operands of strip.h; -1: nowhere), and the steps of every block.
struct ReplaySteps {
  struct Move {
    int from, to, how;
  };
  struct Block {
    int loop = -1;
    std::vector<Step> steps;
    std::size_t steps_again = 0;             // of them a turn of the way back does these first
    std::vector<Move> sums;                  // values: term to sum; adjoints: sum to term
    std::vector<int> clear;                  // strips that a loop adds to from zero
    std::vector<std::pair<int, int>> items;  // where, which field
  };
  std::vector<int> value_at, adjoint_at, more, frame;
  std::vector<Block> blocks;
  std::size_t first_back = 0;
  std::vector<int> once, last;  // nodes done before all pixels and after them
  std::vector<Move> field_moves, plane_moves;
  std::vector<int> zeroed, outputs_at;  // adjoints of the outputs: those that begin here; all
  int memory = 0;                       // floats
};

/// Writes them. r must outlive it.
class ReplayWriter {
public:
  ReplayWriter(const Recording& recording, const std::vector<Duty>& duties, const ReplayOrder& replay_order,
               bool gradient)
      : r(recording), duty(duties), order(replay_order), with_gradient(gradient) {
    out.value_at.assign(r.nodes.size(), -1);
    out.adjoint_at.assign(r.nodes.size(), -1);
    out.blocks.resize(order.blocks.size());
    for (std::size_t b = 0; b < out.blocks.size(); ++b) out.blocks[b].loop = order.blocks[b].loop;
    out.first_back = order.first_back, out.once = order.once, out.last = order.last;
    place_uniforms();
    write_steps();
  }
  ReplaySteps steps() { return std::move(out); }

private:
  using Task = ReplayOrder::Task;
  const Recording& r;
  const std::vector<Duty>& duty;
  const ReplayOrder& order;
  bool with_gradient;
  ReplaySteps out;
  std::vector<int> free;  // strips

  static std::size_t at(int i) { return std::size_t(i); }
  int size() const { return int(r.nodes.size()); }
  const Node& node(int i) const { return r.nodes[at(i)]; }
  int packet_room() {
    out.memory += lanes;
    return out.memory - lanes;
  }
  int strip_room() {
    if (free.empty()) {
      out.memory += strip;
      return out.memory - strip;
    }
    const int room = free.back();
    free.pop_back();
    return room;
  }

  /// Room for what is the same for all pixels or all pixels of a turn, and in the frames.
  void place_uniforms() {
    out.frame.assign(r.loops.size(), 0);
    for (int i = 0; i < size(); ++i) {
      const Node& x = node(i);
      if (!x.varying || x.kind == Kind::item) {
        out.value_at[at(i)] = packet_room() | uniform;
        if (!x.varying && duty[at(i)].adjoint) out.adjoint_at[at(i)] = packet_room();
      } else if (duty[at(i)].kept) {
        out.value_at[at(i)] = out.frame[at(x.loop)] | framed;
        out.frame[at(x.loop)] += strip;
      }
    }
  }

  /// Has a strip that others may use before and after.
  bool roomed(int i) const { return node(i).varying && node(i).kind != Kind::item && !duty[at(i)].kept; }

  /// Writes all steps; room is taken at the first write and given back after the last read.
  void write_steps() {
    const std::vector<Task> todo = order.tasks();
    std::vector<std::vector<int>> dies(todo.size());
    std::vector<char> alive(r.nodes.size());
    for (std::size_t t = todo.size(); t-- > 0;) {
      const auto seen = [&](int i) {
        if (roomed(i) && !alive[at(i)]) alive[at(i)] = true, dies[t].push_back(i);
      };
      order.reads(todo[t], seen);
      order.writes(todo[t], seen);
      order.writes(todo[t], [&](int i) { alive[at(i)] = false; });
    }
    for (std::size_t t = 0; t < todo.size(); ++t) {
      order.writes(todo[t], [&](int i) {
        if (roomed(i)) out.value_at[at(i)] = strip_room();
      });
      write(todo[t]);
      for (const int i : dies[t]) free.push_back(out.value_at[at(i)]);
    }
    for (int i = 0; i < size(); ++i)
      if (node(i).kind == Kind::pixel && node(i).active && duty[at(i)].adjoint)
        out.plane_moves.push_back({out.adjoint_at[at(i)], node(i).index, 0});
  }
  void write(const Task& t) {
    if (t.what == Task::start)
      for (const int i : order.fields) out.field_moves.push_back({node(i).index, out.value_at[at(i)], 0});
    if (t.what == Task::turn && with_gradient)
      for (const int o : r.outputs) {
        if (node(o).active && out.adjoint_at[at(o)] < 0) out.zeroed.push_back(adjoint(o));
        out.outputs_at.push_back(node(o).active ? out.adjoint_at[at(o)] : -1);
      }
    if (t.block < 0) return;
    ReplaySteps::Block& b = out.blocks[at(t.block)];
    const bool is_back = order.blocks[at(t.block)].back;
    if (t.what == Task::open && b.loop >= 0) {
      for (int i = r.loops[at(b.loop)].begin; i < r.loops[at(b.loop)].end; ++i)
        if (node(i).kind == Kind::item) b.items.push_back({offset(out.value_at[at(i)]), node(i).index});
      if (is_back) open_back(b);
    }
    if (t.what == Task::forth) {
      b.steps.push_back(forth(t.node));
      if (is_back) b.steps_again = b.steps.size();
    }
    if (t.what == Task::back) back(b, t.node);
    if (t.what == Task::close && b.loop >= 0) {
      if (is_back)
        order.each_sum(b.loop, [&](int s) {
          if (out.adjoint_at[at(s)] >= 0) free.push_back(out.adjoint_at[at(s)]);
        });
      else
        order.each_sum(b.loop, [&](int s) {
          if (duty[at(s)].forward) b.sums.push_back({out.value_at[at(node(s).in[0])], out.value_at[at(s)], 0});
        });
    }
  }
  int adjoint(int i) {
    if (out.adjoint_at[at(i)] < 0) out.adjoint_at[at(i)] = strip_room();
    return out.adjoint_at[at(i)];
  }
  void open_back(ReplaySteps::Block& b) {
    for (int i = 0; i < size(); ++i)
      if (duty[at(i)].clear == b.loop + 1) b.clear.push_back(adjoint(i));
    order.each_sum(b.loop, [&](int s) {
      const int term = node(s).in[0], mode = duty[at(s)].mode[0];
      if (mode) b.sums.push_back({out.adjoint_at[at(s)], adjoint(term), node(term).varying ? mode : summed});
    });
  }
  Step step(const std::vector<int>& operands) {
    Step s;
    if (operands.size() <= Step::inlined) std::copy(operands.begin(), operands.end(), s.at);
    else {
      s.at[0] = int(out.more.size());
      out.more.insert(out.more.end(), operands.begin(), operands.end());
    }
    return s;
  }
  /// A value that a step names but does not read may have no room.
  int operand(int i) const { return std::max(0, out.value_at[at(i)]); }
  Step forth(int i) {
    const Node& x = node(i);
    std::vector<int> o;
    for (int k = 0; k < x.op->inputs; ++k) o.push_back(operand(x.in[at(k)]));
    for (int k = 0; k < x.op->outputs; ++k) o.push_back(operand(i + k));
    if (x.op->reads) o.push_back(x.index);
    Step s = step(o);
    s.run = x.op->strip_forward;
    return s;
  }
  void back(ReplaySteps::Block& b, int i) {
    const Node& x = node(i);
    std::vector<int> d_y, d_x;
    for (int k = 0; k < x.op->outputs; ++k) d_y.push_back(duty[at(i + k)].adjoint ? adjoint(i + k) : absent);
    bool handed = false;
    for (int k = 0; k < x.op->inputs; ++k) {
      const int mode = duty[at(i)].mode[at(k)], from = x.in[at(k)];
      if (!mode) d_x.push_back(none);
      else if (!node(from).varying) d_x.push_back(out.adjoint_at[at(from)] | summed);
      else if (mode == assigned && !handed && out.adjoint_at[at(from)] < 0 && hands_on(x.op, k)) {
        out.adjoint_at[at(from)] = out.adjoint_at[at(i)];
        handed = true;
        d_x.push_back(none);
      } else d_x.push_back(adjoint(from) | mode);
    }
    // Products go back one by one, and what is added to them as a sum.
    const int products = is<op::Mul>(x.op) || is<op::MulAdd>(x.op) ? 1 : is<op::Dot3>(x.op) ? 3 : 0;
    for (std::size_t k = 0; k < 2 * at(products); k += 2) {
      const int p = x.in[k], q = x.in[k + 1];
      if (p == q) back_step(b, &info<op::Square>, {operand(p), operand(i)}, d_y, {d_x[k]});
      else back_step(b, &info<op::Mul>, {operand(p), operand(q), operand(i)}, d_y, {d_x[k], d_x[k + 1]});
    }
    if (is<op::MulAdd>(x.op))
      back_step(b, &info<op::Add>, {operand(x.in[2]), 0, operand(i)}, d_y, {d_x[2], none});
    if (!products) {
      std::vector<int> o;
      for (int k = 0; k < x.op->inputs; ++k) o.push_back(operand(x.in[at(k)]));
      for (int k = 0; k < x.op->outputs; ++k) o.push_back(operand(i + k));
      back_step(b, x.op, o, d_y, d_x, x.index, x.scatters);
    }
    for (int k = 0; k < x.op->outputs; ++k)
      if (out.adjoint_at[at(i + k)] >= 0) {
        if (!handed) free.push_back(out.adjoint_at[at(i + k)]);
        out.adjoint_at[at(i + k)] = -1;
      }
  }
  void back_step(ReplaySteps::Block& b, const Info* op, std::vector<int> o, const std::vector<int>& d_y,
                 const std::vector<int>& d_x, int resource = 0, bool scatters = false) {
    bool work = scatters;
    int modes[max_inputs] = {};
    for (std::size_t k = 0; k < d_x.size(); ++k) modes[k] = d_x[k] & 3, work |= modes[k] != none;
    if (!work) return;
    o.insert(o.end(), d_y.begin(), d_y.end());
    o.insert(o.end(), d_x.begin(), d_x.end());
    if (op->reads) o.push_back(resource), o.push_back(scatters);
    b.steps.push_back(step(o));
    b.steps.back().run = op->strip_backward(modes);
  }
};

}  // namespace burnish::detail
