// burnish/ad/replay.h -- the player for recordings made at run time: one operation after another over a tile of pixels
// SPDX-License-Identifier: Apache-2.0
//
// A value is a tile of 256 floats, or one packet where it is the same for all pixels. Multiplications that feed one sum are
// fused into it; a value's room is given to another once nothing reads it any more, so that the tiles in use stay in cache.
#pragma once
#include <cstring>
#include <burnish/ad/environment.h>
#include <burnish/ad/plan.h>

namespace burnish {

/// Pixels that the replay does at a time; planes are padded to a multiple of it.
inline constexpr int tile = 256;

namespace detail {

/// One operation over a tile. Offsets are in floats.
struct Step {
  const Info* op = nullptr;
  int packets = 0, resource = -1;
  bool scatters = false;
  std::array<int, max_inputs> x{}, x_stride{}, d_x{};
  std::array<int, max_outputs> y{}, d_y{};
  std::array<signed char, max_inputs> mode{};
  const void* data = nullptr;
  Scatter* scatter = nullptr;
};
// Pointers and strides are copied out first: a store of packets might change the step, as far as the compiler knows.
template <class Op> void tile_forward(const Step& s, float* values) {
  const float* x_at[Op::inputs];
  int stride[Op::inputs];
  float* y_at[Op::outputs];
  for (int k = 0; k < Op::inputs; ++k) x_at[k] = values + s.x[k], stride[k] = s.x_stride[k];
  for (int k = 0; k < Op::outputs; ++k) y_at[k] = values + s.y[k];
  const void* const data = s.data;
  for (int p = 0, n = s.packets; p < n; ++p) {
    Lanes x[Op::inputs], y[Op::outputs];
    for (int k = 0; k < Op::inputs; ++k) {
      x[k] = Lanes::load(x_at[k]);
      x_at[k] += stride[k];
    }
    forward<Op, Lanes>(x, y, data);
    for (int k = 0; k < Op::outputs; ++k) {
      y[k].store(y_at[k]);
      y_at[k] += lanes;
    }
  }
}
/// M: the modes, where they are few enough to be compiled one by one.
template <class Op, int... M> void tile_backward_as(const Step& s, float* values, float* adjoints) {
  constexpr int fixed[] = {M..., -1};
  const float *x_at[Op::inputs], *y_at[Op::outputs], *d_y_at[Op::outputs];
  int stride[Op::inputs], mode[Op::inputs];
  float* d_x_at[Op::inputs];
  for (int k = 0; k < Op::inputs; ++k) {
    x_at[k] = values + s.x[k], stride[k] = s.x_stride[k];
    d_x_at[k] = adjoints + s.d_x[k], mode[k] = s.mode[k];
  }
  for (int k = 0; k < Op::outputs; ++k) {
    y_at[k] = values + s.y[k];
    d_y_at[k] = s.d_y[k] >= 0 ? adjoints + s.d_y[k] : nullptr;
  }
  const void* const data = s.data;
  Scatter* const scatter = s.scatter;
  for (int p = 0, n = s.packets; p < n; ++p) {
    Lanes x[Op::inputs], y[Op::outputs], d_x[Op::inputs], d_y[Op::outputs];
    for (int k = 0; k < Op::inputs; ++k) {
      x[k] = Lanes::load(x_at[k]);
      x_at[k] += stride[k];
    }
    for (int k = 0; k < Op::outputs; ++k) {
      y[k] = Lanes::load(y_at[k] + p * lanes);
      d_y[k] = Op::outputs == 1 || d_y_at[k] ? Lanes::load(d_y_at[k] + p * lanes) : Lanes(0.0f);
    }
    backward<Op, Lanes>(x, y, d_y, d_x, data, scatter);
    for (int k = 0; k < Op::inputs; ++k) {
      const int m = sizeof...(M) ? fixed[k < int(sizeof...(M)) ? k : 0] : mode[k];
      float* const to = d_x_at[k] + p * stride[k];
      if (m == 1) d_x[k].store(to);
      else if (m == 2) (Lanes::load(to) + d_x[k]).store(to);
    }
  }
}
template <class Op> void tile_backward(const Step& s, float* values, float* adjoints) {
  if constexpr (Op::inputs == 1 && Arithmetic<Op>) {
    if (s.mode[0] == 1) tile_backward_as<Op, 1>(s, values, adjoints);
    else tile_backward_as<Op, 2>(s, values, adjoints);
  } else if constexpr (Op::inputs == 2 && Arithmetic<Op>) {
    switch (s.mode[0] * 3 + s.mode[1]) {
      case 1: return tile_backward_as<Op, 0, 1>(s, values, adjoints);
      case 2: return tile_backward_as<Op, 0, 2>(s, values, adjoints);
      case 3: return tile_backward_as<Op, 1, 0>(s, values, adjoints);
      case 4: return tile_backward_as<Op, 1, 1>(s, values, adjoints);
      case 5: return tile_backward_as<Op, 1, 2>(s, values, adjoints);
      case 6: return tile_backward_as<Op, 2, 0>(s, values, adjoints);
      case 7: return tile_backward_as<Op, 2, 1>(s, values, adjoints);
      case 8: return tile_backward_as<Op, 2, 2>(s, values, adjoints);
    }
  } else tile_backward_as<Op>(s, values, adjoints);
}

/// A product that only one sum or difference reads becomes one operation with it.
inline void fuse(Recording& r) {
  std::vector<int> uses(r.nodes.size());
  for (const Node& x : r.nodes)
    for (int k = 0; k < inputs_of(x); ++k) ++uses[std::size_t(x.in[std::size_t(k)])];
  for (const int o : r.outputs) ++uses[std::size_t(o)];
  for (Node& x : r.nodes) {
    if (x.kind != Kind::operation || (x.op != &info<op::Add> && x.op != &info<op::Sub>)) continue;
    for (const int k : {0, 1}) {
      const Node& m = r.nodes[std::size_t(x.in[std::size_t(k)])];
      if (m.kind != Kind::operation || m.op != &info<op::Mul> || uses[std::size_t(x.in[std::size_t(k)])] != 1) continue;
      if (m.loop != x.loop || m.varying != x.varying || m.in[0] == m.in[1]) continue;
      const int other = x.in[std::size_t(1 - k)];
      x.op = x.op == &info<op::Add> ? &info<op::MulAdd> : k == 0 ? &info<op::MulSub> : &info<op::SubMul>;
      x.in = {m.in[0], m.in[1], other};
      break;
    }
  }
}

}  // namespace detail

class Replay {
public:
  /// One a thread; kept between tiles and calls.
  struct State {
    std::vector<Lanes, std::allocator<Lanes>> memory;
    float *v = nullptr, *d = nullptr;
  };

  /// image: the outputs are wanted; gradient: their adjoints go back.
  Replay(Recording recording, bool image, bool gradient) : r(std::move(recording)), with_image(image), with_gradient(gradient) {
    detail::fuse(r);
    duty.resize(r.nodes.size());
    make_plan(r, duty, gradient, Turns::again, image);
    schedule();
    place_values();
    for (int i = 0; i < size(); ++i)
      if (!node(i).varying && duty[at(i)].adjoint) adjoint_at[at(i)] = adjoints, adjoints += lanes;
    place_adjoints();
  }
  const Recording& recording() const { return r; }
  int bytes_a_pixel() const { return (values + adjoints) / tile * 4; }

  void begin(State& s, const Environment& e) const {
    const std::size_t need = std::size_t(values + adjoints) / lanes + 1;
    if (s.memory.size() < need) s.memory.resize(need);
    std::fill(s.memory.begin(), s.memory.begin() + std::ptrdiff_t(need), Lanes(0.0f));
    s.v = reinterpret_cast<float*>(s.memory.data());
    s.d = s.v + values;
    for (int i = 0; i < size(); ++i) {
      const Node& x = node(i);
      if (x.varying || x.kind == Kind::operation || x.kind == Kind::output || value_at[at(i)] < 0) continue;
      const float value = x.kind == Kind::parameter ? e.parameters[x.index] : x.kind == Kind::data ? e.data[x.index] : x.value;
      Lanes(value).store(s.v + value_at[at(i)]);
    }
    run(once, s, e, false);
  }
  /// One tile from `pixel`. image: where the outputs go; d_image: their adjoints.
  void packet(State& s, const Environment& e, int pixel, float* const* image, const float* const* d_image) const {
    for (const int i : fields) std::memcpy(s.v + value_at[at(i)], e.pixels[node(i).index] + pixel, tile * 4);
    for (const Block& b : forth) {
      if (b.loop < 0) {
        run(b.steps, s, e, false);
        continue;
      }
      const Loop& loop = r.loops[at(b.loop)];
      for (const auto& [sum, term, stride] : b.sums) std::memset(s.v + sum, 0, tile * 4);
      for (int t = 0; t < e.lists[loop.list].count; ++t) {
        items(b, s, e, t);
        run(b.steps, s, e, false);
        for (const auto& [sum, term, stride] : b.sums) add_tile(s.v + sum, s.v + term, stride);
      }
    }
    if (with_image)
      for (std::size_t c = 0; c < r.outputs.size(); ++c)
        for (int k = 0; k < tile; k += lanes)
          Lanes::load(s.v + value_at[at(r.outputs[c])] + (node(r.outputs[c]).varying ? k : 0)).store(image[c] + pixel + k);
    if (!with_gradient) return;
    for (const int a : zeroed) std::memset(s.d + a, 0, tile * 4);
    for (std::size_t c = 0; c < r.outputs.size(); ++c) {
      const int a = adjoint_at[at(r.outputs[c])];
      if (a < 0) continue;
      const bool varying = node(r.outputs[c]).varying;
      for (int k = 0; k < tile; k += lanes) {
        float* const to = s.d + a + (varying ? k : 0);
        (Lanes::load(to) + Lanes::load(d_image[c] + pixel + k)).store(to);
      }
    }
    for (const Block& b : back) {
      if (b.loop < 0) {
        run(b.steps, s, e, true);
        continue;
      }
      for (const int a : b.clear) std::memset(s.d + a, 0, tile * 4);
      for (int t = 0; t < e.lists[r.loops[at(b.loop)].list].count; ++t) {
        items(b, s, e, t);
        run(b.turn, s, e, false);
        for (const auto& [term, sum, mode] : b.sums)
          if (mode == 1) std::memcpy(s.d + term, s.d + sum, tile * 4);
          else add_tile(s.d + term, s.d + sum, lanes);
        run(b.steps, s, e, true);
      }
    }
    for (const int i : planes) std::memcpy(e.d_pixels[node(i).index] + pixel, s.d + adjoint_at[at(i)], tile * 4);
  }
  void end(State& s, const Environment& e) const { run(last, s, e, true); }
  /// The adjoint of parameter node `id`, after end().
  float d_parameter(const State& s, int id) const {
    const int a = adjoint_at[at(id)];
    return a < 0 ? 0 : Lanes::load(s.d + a).sum();
  }

private:
  using Steps = std::vector<detail::Step>;
  struct Block {
    int loop = -1;
    std::vector<int> nodes, turn_nodes, item_nodes;
    Steps steps, turn;
    std::vector<std::array<int, 3>> sums;  // forth: sum, term, stride of the term; back: d term, d sum, mode
    std::vector<int> clear;                // adjoints that a loop adds to from zero
    std::vector<std::pair<int, int>> fields;  // of the items: where, which
  };
  Recording r;
  bool with_image, with_gradient;
  std::vector<Duty> duty;
  std::vector<int> value_at, adjoint_at, fields, planes, once_nodes, last_nodes, zeroed;
  std::vector<Block> forth, back;
  Steps once, last;
  int values = 0, adjoints = 0;

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
    const auto straight = [](std::vector<Block>& v) -> Block& {
      if (v.empty() || v.back().loop >= 0) v.emplace_back();
      return v.back();
    };
    for (int i = 0; i < n; ++i) {
      const Node& x = node(i);
      if (x.kind == Kind::pixel && duty[at(i)].forward) fields.push_back(i);
      if (x.kind == Kind::pixel && duty[at(i)].adjoint && x.active) planes.push_back(i);
      if (x.kind == Kind::sum && r.loops[at(x.loop)].first_sum == i) {
        Block b;
        b.loop = x.loop;
        const Loop& loop = r.loops[at(x.loop)];
        bool wanted = false;
        for (int k = 0; k < loop.sums; ++k) wanted |= duty[at(i + k)].forward;
        if (!wanted) continue;
        for (int j = loop.begin; j < loop.end; ++j) {
          if (!in_body(r, j)) continue;
          if (node(j).kind == Kind::operation && any(j, &Duty::forward)) b.nodes.push_back(j);
          if (node(j).kind == Kind::item && duty[at(j)].forward) b.item_nodes.push_back(j);
        }
        forth.push_back(b);
      }
      if (x.kind != Kind::operation || in_body(r, i) || !any(i, &Duty::forward)) continue;
      if (x.varying) straight(forth).nodes.push_back(i);
      else once_nodes.push_back(i);
    }
    for (int i = n - 1; with_gradient && i >= 0; --i) {
      const Node& x = node(i);
      if (in_body(r, i)) continue;
      if (x.kind == Kind::sum && r.loops[at(x.loop)].first_sum == i) {
        Block b;
        b.loop = x.loop;
        const Loop& loop = r.loops[at(x.loop)];
        for (int j = loop.begin; j < loop.end; ++j) {
          if (!in_body(r, j)) continue;
          if (node(j).kind == Kind::operation && any(j, &Duty::turn)) b.turn_nodes.push_back(j);
          if (node(j).kind == Kind::item && duty[at(j)].turn) b.item_nodes.push_back(j);
        }
        for (int j = loop.end - 1; j >= loop.begin; --j)
          if (in_body(r, j) && duty[at(j)].back) b.nodes.push_back(j);
        back.push_back(b);
      } else if (duty[at(i)].back) {
        if (x.varying) straight(back).nodes.push_back(i);
        else last_nodes.push_back(i);
      }
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
  /// Gives every value its room, and the steps their offsets; room is used again once its value is read no more.
  void place_values() {
    value_at.assign(r.nodes.size(), -1);
    adjoint_at.assign(r.nodes.size(), -1);
    std::vector<int> last_use(r.nodes.size(), -1), free;
    // A time for every step; what a loop reads from outside is read until its end.
    int time = 0;
    const auto blocks = [&](auto&& field, auto&& forward_step, auto&& backward_step, auto&& block_end) {
      time = 0;
      field();
      for (Block& b : forth) {
        for (const int i : b.nodes) forward_step(i, b, false), ++time;
        block_end(b, false), ++time;
      }
      ++time;  // the outputs are read
      for (Block& b : back) {
        for (const int i : b.turn_nodes) forward_step(i, b, true), ++time;
        for (const int i : b.nodes) backward_step(i, b), ++time;
        block_end(b, true), ++time;
      }
    };
    std::vector<int> outside;  // read by the open loop, defined before it
    const auto use = [&](int i, const Block& b) {
      last_use[at(i)] = std::max(last_use[at(i)], time);
      if (b.loop >= 0 && !in_body(r, i)) outside.push_back(i);
    };
    // Body values live in one block at a time: those of the way forth and those of a turn are told apart by block.
    std::vector<std::vector<int>> body_last;  // per block in order: last use of each body node
    const auto each_block_use = [&] {
      blocks([] {},
             [&](int i, const Block& b, bool) {
               for (int k = 0; k < node(i).op->inputs; ++k) use(node(i).in[at(k)], b);
               for (int k = 0; k < node(i).op->outputs; ++k) use(i + k, b);
             },
             [&](int i, const Block& b) { read_back(i, [&](int j) { use(j, b); }); },
             [&](const Block& b, bool gradient) {
               if (b.loop < 0) return;
               const Loop& loop = r.loops[at(b.loop)];
               if (!gradient)
                 for (int s = loop.first_sum; s < loop.first_sum + loop.sums; ++s)
                   if (duty[at(s)].forward) {
                     last_use[at(node(s).in[0])] = time;
                     last_use[at(s)] = std::max(last_use[at(s)], time);
                   }
               for (const int i : outside) last_use[at(i)] = std::max(last_use[at(i)], time);
               outside.clear();
               std::vector<int> body(last_use.begin() + loop.begin, last_use.begin() + loop.end);
               body_last.push_back(std::move(body));
               for (int j = loop.begin; j < loop.end; ++j)
                 if (in_body(r, j)) last_use[at(j)] = -1;
             });
    };
    each_block_use();
    int end_of_forth = 0;
    for (const Block& b : forth) end_of_forth += int(b.nodes.size()) + 1;
    if (with_image)
      for (const int o : r.outputs) last_use[at(o)] = std::max(last_use[at(o)], end_of_forth);

    const auto uniform = [&](int i) {
      if (value_at[at(i)] < 0) value_at[at(i)] = values, values += lanes;
    };
    for (int i = 0; i < size(); ++i)
      if (!node(i).varying && (duty[at(i)].forward || duty[at(i)].turn || duty[at(i)].adjoint || node(i).kind == Kind::constant)) uniform(i);
    std::vector<std::pair<int, int>> ends;  // last use, node: room in use
    const auto room = [&](int i, int until) {
      if (!node(i).varying) return uniform(i);
      if (node(i).kind == Kind::item) {
        value_at[at(i)] = values, values += lanes;
        return;
      }
      if (free.empty()) {
        free.push_back(values);
        values += tile;
      }
      value_at[at(i)] = free.back();
      free.pop_back();
      ends.push_back({until, value_at[at(i)]});
    };
    const auto release = [&] {
      for (std::size_t k = 0; k < ends.size();)
        if (ends[k].first <= time) {
          free.push_back(ends[k].second);
          ends[k] = ends.back();
          ends.pop_back();
        } else ++k;
    };
    std::size_t block = 0;
    const auto open = [&](Block& b, bool gradient) {
      if (b.loop < 0) return;
      const Loop& loop = r.loops[at(b.loop)];
      for (int j = loop.begin; j < loop.end; ++j)
        if (in_body(r, j)) {
          last_use[at(j)] = body_last[block][at(j - loop.begin)];
          value_at[at(j)] = -1;
        }
      ++block;
      for (const int i : b.item_nodes) room(i, -1), b.fields.push_back({value_at[at(i)], node(i).index});
      if (!gradient)
        for (int s = loop.first_sum; s < loop.first_sum + loop.sums; ++s)
          if (duty[at(s)].forward) room(s, last_use[at(s)]);
    };
    const auto forward_step = [&](int i, Steps& to) {
      for (int k = 0; k < node(i).op->outputs; ++k) room(i + k, last_use[at(i + k)]);
      to.push_back(step(i));
      release();
    };
    // The same walk again, now with room. Blocks are opened at their first step.
    time = 0;
    for (const int i : fields) room(i, last_use[at(i)]);
    for (const int i : once_nodes) {
      for (int k = 0; k < node(i).op->outputs; ++k) uniform(i + k);
      once.push_back(step(i));
    }
    for (Block& b : forth) {
      open(b, false);
      for (const int i : b.nodes) forward_step(i, b.steps), ++time;
      if (b.loop >= 0) {
        const Loop& loop = r.loops[at(b.loop)];
        for (int s = loop.first_sum; s < loop.first_sum + loop.sums; ++s)
          if (duty[at(s)].forward) {
            const int term = node(s).in[0];
            b.sums.push_back({value_at[at(s)], value_at[at(term)], stride(term)});
          }
      }
      release(), ++time;
    }
    release(), ++time;
    for (Block& b : back) {
      open(b, true);
      for (const int i : b.turn_nodes) forward_step(i, b.turn), ++time;
      for (const int i : b.nodes) {
        b.steps.push_back(step(i));
        release(), ++time;
      }
      release(), ++time;
    }
    for (const int i : last_nodes) last.push_back(step(i));
  }
  int stride(int i) const { return node(i).varying && node(i).kind != Kind::item ? lanes : 0; }
  detail::Step step(int i) const {
    const Node& x = node(i);
    detail::Step s;
    s.op = x.op;
    s.packets = (x.varying ? tile : lanes) / lanes;
    if (x.op->reads) s.resource = x.index;
    s.scatters = x.scatters;
    for (int k = 0; k < x.op->outputs; ++k) s.y[at(k)] = std::max(0, value_at[at(i + k)]);
    for (int k = 0; k < x.op->inputs; ++k) {
      s.x[at(k)] = std::max(0, value_at[at(x.in[at(k)])]);
      s.x_stride[at(k)] = stride(x.in[at(k)]);
      s.mode[at(k)] = duty[at(i)].mode[at(k)];
    }
    return s;
  }

  /// Adjoints get their room at the first write and lose it after their node's own step.
  void place_adjoints() {
    if (!with_gradient) return;
    std::vector<int> free;
    const auto room = [&](int i) {
      if (adjoint_at[at(i)] < 0) {
        if (free.empty()) free.push_back(adjoints), adjoints += tile;
        adjoint_at[at(i)] = free.back();
        free.pop_back();
      }
      return adjoint_at[at(i)];
    };
    for (const int o : r.outputs)
      if (node(o).active) {
        const bool fresh = adjoint_at[at(o)] < 0;
        const int a = room(o);
        if (fresh) zeroed.push_back(a);
      }
    const auto bind = [&](detail::Step& s, int i) {
      const Node& x = node(i);
      for (int k = 0; k < x.op->outputs; ++k) s.d_y[at(k)] = duty[at(i + k)].adjoint ? room(i + k) : -1;
      for (int k = 0; k < x.op->inputs; ++k)
        if (s.mode[at(k)]) s.d_x[at(k)] = room(x.in[at(k)]);
      if (x.varying)
        for (int k = 0; k < x.op->outputs; ++k)
          if (adjoint_at[at(i + k)] >= 0) free.push_back(adjoint_at[at(i + k)]);
    };
    for (Block& b : back) {
      if (b.loop >= 0) {
        const Loop& loop = r.loops[at(b.loop)];
        for (int j = 0; j < size(); ++j)
          if (duty[at(j)].clear == b.loop + 1) b.clear.push_back(room(j));
        for (int s = loop.first_sum; s < loop.first_sum + loop.sums; ++s)
          if (const int mode = duty[at(s)].mode[0]) b.sums.push_back({room(node(s).in[0]), adjoint_at[at(s)], mode});
      }
      for (std::size_t k = 0; k < b.nodes.size(); ++k) bind(b.steps[k], b.nodes[k]);
    }
    for (std::size_t k = 0; k < last_nodes.size(); ++k) bind(last[k], last_nodes[k]);
  }

  void run(const Steps& steps, State& t, const Environment& e, bool backward) const {
    for (const detail::Step& s : steps) {
      const detail::Step* p = &s;
      detail::Step with_data;
      if (s.resource >= 0) {
        with_data = s;
        with_data.data = e.resources[s.resource];
        with_data.scatter = s.scatters ? e.scatters + s.resource : nullptr;
        p = &with_data;
      }
      if (backward) s.op->tile_backward(*p, t.v, t.d);
      else s.op->tile_forward(*p, t.v);
    }
  }
  void items(const Block& b, State& s, const Environment& e, int turn) const {
    const FlatList& list = e.lists[r.loops[at(b.loop)].list];
    for (const auto& [to, field] : b.fields) Lanes(list.values[turn * list.fields + field]).store(s.v + to);
  }
  static void add_tile(float* to, const float* from, int from_stride) {
    for (int k = 0; k < tile; k += lanes, from += from_stride) (Lanes::load(to + k) + Lanes::load(from)).store(to + k);
  }
};

}  // namespace burnish
