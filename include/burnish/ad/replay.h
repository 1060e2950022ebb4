// burnish/ad/replay.h -- the player for recordings made at run time: one operation after another over a strip of pixels
// SPDX-License-Identifier: Apache-2.0
//
// A value is a strip of floats, or one packet where it is the same for all pixels. Strips are short, so that a
// recording's values stay in the fast caches; the room of a value is given to another once nothing reads it any more.
// Multiplications that feed one sum are fused into it, and an adjoint that is merely handed on changes its owner, not
// its place. What a loop's way back reads of a turn is kept in a frame of its own for every turn.
#pragma once
#include <burnish/ad/plan.h>
#include <burnish/ad/strip.h>

namespace burnish {

/// Pixels that are played at a time; planes are padded to a multiple of it.
inline constexpr int tile = 256;

namespace detail {

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

}  // namespace detail

class Replay {
public:
  /// One a thread; kept between tiles and calls.
  struct State {
    std::vector<Lanes> memory;
    float* m = nullptr;
    std::vector<float*> frames;  // of each loop's first turn
  };

  /// image: the outputs are wanted; gradient: their adjoints go back.
  Replay(Recording recording, bool image, bool gradient)
      : r(std::move(recording)), with_image(image), with_gradient(gradient) {
    detail::fuse(r);
    duty.resize(r.nodes.size());
    const bool kept = gradient && best_turns(r, duty, image) == Turns::kept;
    std::fill(duty.begin(), duty.end(), Duty{});
    make_plan(r, duty, gradient, kept ? Turns::all : Turns::again, image);
    value_at.assign(r.nodes.size(), -1);
    adjoint_at.assign(r.nodes.size(), -1);
    place_uniforms();
    schedule();
    write_steps();
  }
  const Recording& recording() const { return r; }
  /// Is there a step that writes the adjoint of this plane?
  bool writes(int plane) const {
    for (const Move& f : plane_moves)
      if (f.to == plane) return true;
    return false;
  }
  int bytes_a_pixel() const { return memory / detail::strip * 4; }

  void begin(State& s, const Environment& e) const {
    std::size_t need = at(memory);
    s.frames.resize(r.loops.size());
    for (std::size_t l = 0; l < r.loops.size(); ++l) need += at(frame[l]) * at(e.lists[r.loops[l].list].count);
    if (s.memory.size() < need / lanes + 1) s.memory.resize(need / lanes + 1);
    s.m = reinterpret_cast<float*>(s.memory.data());
    std::fill(s.m, s.m + memory, 0.0f);
    float* to = s.m + memory;
    for (std::size_t l = 0; l < r.loops.size(); ++l) {
      s.frames[l] = to;
      to += frame[l] * e.lists[r.loops[l].list].count;
    }
    for (int i = 0; i < size(); ++i) {
      const Node& x = node(i);
      if (x.varying || x.kind == Kind::operation || x.kind == Kind::output || value_at[at(i)] < 0) continue;
      const float value = x.kind == Kind::parameter ? e.parameters[x.index]
                          : x.kind == Kind::data    ? e.data[x.index]
                                                    : x.value;
      Lanes(value).store(place(s, i));
    }
    for (const int i : once) {
      const Node& x = node(i);
      Lanes in[detail::max_inputs], out[detail::max_outputs];
      for (int k = 0; k < x.op->inputs; ++k) in[k] = Lanes::load(place(s, x.in[at(k)]));
      x.op->forward(in, out, x.op->reads ? e.resources[x.index] : nullptr);
      for (int k = 0; k < x.op->outputs; ++k) out[k].store(place(s, i + k));
    }
  }
  /// One tile from `pixel`. image: where the outputs go; d_image: their adjoints.
  void packet(State& s, const Environment& e, int pixel, float* const* image, const float* const* d_image) const {
    for (int p = pixel; p < pixel + tile; p += detail::strip) play(s, e, p, image, d_image);
  }
  void end(State& s, const Environment& e) const {
    for (const int i : last) {
      const Node& x = node(i);
      Lanes in[detail::max_inputs], out[detail::max_outputs], d_in[detail::max_inputs], d_out[detail::max_outputs];
      for (int k = 0; k < x.op->inputs; ++k) in[k] = Lanes::load(place(s, x.in[at(k)]));
      for (int k = 0; k < x.op->outputs; ++k) {
        out[k] = Lanes::load(place(s, i + k));
        d_out[k] = adjoint_at[at(i + k)] >= 0 ? Lanes::load(s.m + adjoint_at[at(i + k)]) : Lanes(0.0f);
      }
      x.op->backward(in, out, d_out, d_in, x.op->reads ? e.resources[x.index] : nullptr,
                     x.scatters ? e.scatters + x.index : nullptr);
      for (int k = 0; k < x.op->inputs; ++k) {
        if (!duty[at(i)].mode[at(k)]) continue;
        float* const to = s.m + adjoint_at[at(x.in[at(k)])];
        (Lanes::load(to) + d_in[k]).store(to);
      }
    }
  }
  /// The adjoint of parameter node `id`, after end().
  float d_parameter(const State& s, int id) const {
    const int a = adjoint_at[at(id)];
    return a < 0 ? 0 : Lanes::load(s.m + a).sum();
  }

private:
  using Steps = std::vector<detail::Step>;
  struct Move {
    int from, to, how;
  };
  /// A stretch of steps without a loop, or one loop.
  struct Block {
    int loop = -1;
    bool back = false;
    std::vector<int> again, nodes;           // what a turn of the way back does again; what is done
    Steps steps;
    std::vector<Move> sums;                  // values: term to sum; adjoints: sum to term
    std::vector<int> clear;                  // strips that a loop adds to from zero
    std::vector<std::pair<int, int>> items;  // where, which field
    std::size_t steps_again = 0;
  };
  Recording r;
  bool with_image, with_gradient;
  std::vector<Duty> duty;
  std::vector<int> value_at, adjoint_at;  // operands
  std::vector<int> fields, once, last, more, frame;
  std::vector<Block> blocks;
  std::size_t first_back = 0;
  std::vector<Move> field_moves, plane_moves;
  std::vector<int> zeroed, outputs_at;  // adjoints of the outputs: those that begin here; all
  int memory = 0;
  std::vector<int> free;

  static std::size_t at(int i) { return std::size_t(i); }
  int size() const { return int(r.nodes.size()); }
  const Node& node(int i) const { return r.nodes[at(i)]; }
  bool any(int i, bool Duty::*flag) const {
    for (int k = 0; k < node(i).op->outputs; ++k)
      if (duty[at(i + k)].*flag) return true;
    return false;
  }
  float* place(State& s, int i) const { return s.m + detail::offset(value_at[at(i)]); }
  int packet_room() {
    memory += lanes;
    return memory - lanes;
  }
  int strip_room() {
    if (free.empty()) {
      memory += detail::strip;
      return memory - detail::strip;
    }
    const int room = free.back();
    free.pop_back();
    return room;
  }

  /// Room for what is the same for all pixels or all pixels of a turn, and in the frames.
  void place_uniforms() {
    frame.assign(r.loops.size(), 0);
    for (int i = 0; i < size(); ++i) {
      const Node& x = node(i);
      if (!x.varying || x.kind == Kind::item) {
        value_at[at(i)] = packet_room() | detail::uniform;
        if (!x.varying && duty[at(i)].adjoint) adjoint_at[at(i)] = packet_room();
      } else if (duty[at(i)].kept) {
        value_at[at(i)] = frame[at(x.loop)] | detail::framed;
        frame[at(x.loop)] += detail::strip;
      }
    }
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
  template <class F> void each_sum(const Block& b, F f) const {
    const Loop& loop = r.loops[at(b.loop)];
    for (int s = loop.first_sum; s < loop.first_sum + loop.sums; ++s) f(s);
  }
  template <class F> void reads(const Task& t, F f) const {
    if (t.what == Task::forth)
      for (int k = 0; k < node(t.node).op->inputs; ++k) f(node(t.node).in[at(k)]);
    if (t.what == Task::back) read_back(t.node, f);
    if (t.what == Task::turn && with_image)
      for (const int o : r.outputs) f(o);
    if (t.what != Task::close || blocks[at(t.block)].loop < 0) return;
    const Block& b = blocks[at(t.block)];
    if (!b.back) each_sum(b, [&](int s) {
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
  template <class F> void writes(const Task& t, F f) const {
    if (t.what == Task::start)
      for (const int i : fields) f(i);
    if (t.what == Task::forth)
      for (int k = 0; k < node(t.node).op->outputs; ++k) f(t.node + k);
    if (t.what == Task::open && blocks[at(t.block)].loop >= 0 && !blocks[at(t.block)].back)
      each_sum(blocks[at(t.block)], [&](int s) {
        if (duty[at(s)].forward) f(s);
      });
  }
  /// Has a strip that others may use before and after.
  bool roomed(int i) const { return node(i).varying && node(i).kind != Kind::item && !duty[at(i)].kept; }

  /// Writes all steps; room is taken at the first write and given back after the last read.
  void write_steps() {
    const std::vector<Task> todo = tasks();
    std::vector<std::vector<int>> dies(todo.size());
    std::vector<char> alive(r.nodes.size());
    for (std::size_t t = todo.size(); t-- > 0;) {
      const auto seen = [&](int i) {
        if (roomed(i) && !alive[at(i)]) alive[at(i)] = true, dies[t].push_back(i);
      };
      reads(todo[t], seen);
      writes(todo[t], seen);
      writes(todo[t], [&](int i) { alive[at(i)] = false; });
    }
    for (std::size_t t = 0; t < todo.size(); ++t) {
      writes(todo[t], [&](int i) {
        if (roomed(i)) value_at[at(i)] = strip_room();
      });
      write(todo[t]);
      for (const int i : dies[t]) free.push_back(value_at[at(i)]);
    }
    for (int i = 0; i < size(); ++i)
      if (node(i).kind == Kind::pixel && node(i).active && duty[at(i)].adjoint)
        plane_moves.push_back({adjoint_at[at(i)], node(i).index, 0});
  }
  void write(const Task& t) {
    if (t.what == Task::start)
      for (const int i : fields) field_moves.push_back({node(i).index, value_at[at(i)], 0});
    if (t.what == Task::turn && with_gradient)
      for (const int o : r.outputs)
        {
          if (node(o).active && adjoint_at[at(o)] < 0) zeroed.push_back(adjoint(o));
          outputs_at.push_back(node(o).active ? adjoint_at[at(o)] : -1);
        }
    if (t.block < 0) return;
    Block& b = blocks[at(t.block)];
    if (t.what == Task::open && b.loop >= 0) {
      for (int i = r.loops[at(b.loop)].begin; i < r.loops[at(b.loop)].end; ++i)
        if (node(i).kind == Kind::item) b.items.push_back({detail::offset(value_at[at(i)]), node(i).index});
      if (b.back) open_back(b);
    }
    if (t.what == Task::forth) {
      b.steps.push_back(forth(t.node));
      if (b.back) b.steps_again = b.steps.size();
    }
    if (t.what == Task::back) back(b, t.node);
    if (t.what == Task::close && b.loop >= 0) {
      if (b.back)
        each_sum(b, [&](int s) {
          if (adjoint_at[at(s)] >= 0) free.push_back(adjoint_at[at(s)]);
        });
      else
        each_sum(b, [&](int s) {
          if (duty[at(s)].forward) b.sums.push_back({value_at[at(node(s).in[0])], value_at[at(s)], 0});
        });
    }
  }
  int adjoint(int i) {
    if (adjoint_at[at(i)] < 0) adjoint_at[at(i)] = strip_room();
    return adjoint_at[at(i)];
  }
  void open_back(Block& b) {
    for (int i = 0; i < size(); ++i)
      if (duty[at(i)].clear == b.loop + 1) b.clear.push_back(adjoint(i));
    each_sum(b, [&](int s) {
      const int term = node(s).in[0], mode = duty[at(s)].mode[0];
      if (mode) b.sums.push_back({adjoint_at[at(s)], adjoint(term), node(term).varying ? mode : detail::summed});
    });
  }
  detail::Step step(const std::vector<int>& operands) {
    detail::Step s;
    if (operands.size() <= detail::Step::inlined) std::copy(operands.begin(), operands.end(), s.at);
    else {
      s.at[0] = int(more.size());
      more.insert(more.end(), operands.begin(), operands.end());
    }
    return s;
  }
  /// A value that a step names but does not read may have no room.
  int operand(int i) const { return std::max(0, value_at[at(i)]); }
  detail::Step forth(int i) {
    const Node& x = node(i);
    std::vector<int> o;
    for (int k = 0; k < x.op->inputs; ++k) o.push_back(operand(x.in[at(k)]));
    for (int k = 0; k < x.op->outputs; ++k) o.push_back(operand(i + k));
    if (x.op->reads) o.push_back(x.index);
    detail::Step s = step(o);
    s.run = x.op->strip_forward;
    return s;
  }
  void back(Block& b, int i) {
    const Node& x = node(i);
    std::vector<int> d_y, d_x;
    for (int k = 0; k < x.op->outputs; ++k) d_y.push_back(duty[at(i + k)].adjoint ? adjoint(i + k) : detail::absent);
    bool handed = false;
    for (int k = 0; k < x.op->inputs; ++k) {
      const int mode = duty[at(i)].mode[at(k)], from = x.in[at(k)];
      if (!mode) d_x.push_back(detail::none);
      else if (!node(from).varying) d_x.push_back(adjoint_at[at(from)] | detail::summed);
      else if (mode == detail::assigned && !handed && adjoint_at[at(from)] < 0 && detail::hands_on(x.op, k)) {
        adjoint_at[at(from)] = adjoint_at[at(i)];
        handed = true;
        d_x.push_back(detail::none);
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
      back_step(b, &info<op::Add>, {operand(x.in[2]), 0, operand(i)}, d_y, {d_x[2], detail::none});
    if (!products) {
      std::vector<int> o;
      for (int k = 0; k < x.op->inputs; ++k) o.push_back(operand(x.in[at(k)]));
      for (int k = 0; k < x.op->outputs; ++k) o.push_back(operand(i + k));
      back_step(b, x.op, o, d_y, d_x, x.index, x.scatters);
    }
    for (int k = 0; k < x.op->outputs; ++k)
      if (adjoint_at[at(i + k)] >= 0) {
        if (!handed) free.push_back(adjoint_at[at(i + k)]);
        adjoint_at[at(i + k)] = -1;
      }
  }
  void back_step(Block& b, const Info* op, std::vector<int> o, const std::vector<int>& d_y, const std::vector<int>& d_x,
                 int resource = 0, bool scatters = false) {
    bool work = scatters;
    int modes[detail::max_inputs] = {};
    for (std::size_t k = 0; k < d_x.size(); ++k) modes[k] = d_x[k] & 3, work |= modes[k] != detail::none;
    if (!work) return;
    o.insert(o.end(), d_y.begin(), d_y.end());
    o.insert(o.end(), d_x.begin(), d_x.end());
    if (op->reads) o.push_back(resource), o.push_back(scatters);
    b.steps.push_back(step(o));
    b.steps.back().run = op->strip_backward(modes);
  }

  static void copy(float* to, const float* from, int stride = lanes) {
    for (int k = 0; k < detail::strip; k += lanes, from += stride) Lanes::load(from).store(to + k);
  }
  static void add(float* to, const float* from, int stride = lanes) {
    for (int k = 0; k < detail::strip; k += lanes, from += stride)
      (Lanes::load(to + k) + Lanes::load(from)).store(to + k);
  }
  static void zero(float* to) {
    for (int k = 0; k < detail::strip; k += lanes) Lanes(0.0f).store(to + k);
  }
  static void add_up(float* to, const float* from) {
    Lanes sum = Lanes::load(to);
    for (int k = 0; k < detail::strip; k += lanes) sum += Lanes::load(from + k);
    sum.store(to);
  }
  static int stride(int operand) { return operand & detail::uniform ? 0 : lanes; }
  void run(const detail::Step* first, const detail::Step* end, float* m, float* turn, const Environment& e) const {
    for (const int* const rest = more.data(); first != end; ++first) first->run(*first, m, turn, rest, e);
  }
  void play(State& s, const Environment& e, int pixel, float* const* image, const float* const* d_image) const {
    float* const m = s.m;
    for (const auto& f : field_moves) copy(m + f.to, e.pixels[f.from] + pixel);
    for (std::size_t i = 0; i < first_back; ++i) {
      const Block& b = blocks[i];
      if (b.loop < 0) {
        run(b.steps.data(), b.steps.data() + b.steps.size(), m, nullptr, e);
        continue;
      }
      for (const auto& f : b.sums) zero(m + f.to);
      float* turn = s.frames[at(b.loop)];
      for (int t = 0, count = e.lists[r.loops[at(b.loop)].list].count; t < count; ++t, turn += frame[at(b.loop)]) {
        take_items(b, m, e, t);
        run(b.steps.data(), b.steps.data() + b.steps.size(), m, turn, e);
        for (const auto& f : b.sums)
          add(m + f.to, (f.from & detail::framed ? turn : m) + detail::offset(f.from), stride(f.from));
      }
    }
    if (with_image)
      for (std::size_t c = 0; c < r.outputs.size(); ++c) {
        const int from = value_at[at(r.outputs[c])];
        copy(image[c] + pixel, m + detail::offset(from), stride(from));
      }
    if (!with_gradient) return;
    for (const int a : zeroed) zero(m + a);
    for (std::size_t c = 0; c < outputs_at.size(); ++c) {
      if (outputs_at[c] < 0) continue;
      if (node(r.outputs[c]).varying) add(m + outputs_at[c], d_image[c] + pixel);
      else add_up(m + outputs_at[c], d_image[c] + pixel);
    }
    for (std::size_t i = first_back; i < blocks.size(); ++i) {
      const Block& b = blocks[i];
      const detail::Step* const steps = b.steps.data();
      if (b.loop < 0) {
        run(steps, steps + b.steps.size(), m, nullptr, e);
        continue;
      }
      for (const int a : b.clear) zero(m + a);
      float* turn = s.frames[at(b.loop)];
      for (int t = 0, count = e.lists[r.loops[at(b.loop)].list].count; t < count; ++t, turn += frame[at(b.loop)]) {
        take_items(b, m, e, t);
        run(steps, steps + b.steps_again, m, turn, e);
        for (const auto& f : b.sums) {
          if (f.how == detail::assigned) copy(m + f.to, m + f.from);
          else if (f.how == detail::added) add(m + f.to, m + f.from);
          else add_up(m + f.to, m + f.from);
        }
        run(steps + b.steps_again, steps + b.steps.size(), m, turn, e);
      }
    }
    for (const auto& f : plane_moves) copy(e.d_pixels[f.to] + pixel, m + f.from);
  }
  void take_items(const Block& b, float* m, const Environment& e, int turn) const {
    const FlatList& list = e.lists[r.loops[at(b.loop)].list];
    for (const auto& [to, field] : b.items) Lanes(list.values[turn * list.fields + field]).store(m + to);
  }
};

}  // namespace burnish
