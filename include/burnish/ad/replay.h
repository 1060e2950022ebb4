// burnish/ad/replay.h -- the player for recordings made at run time: one operation after another over a strip of pixels
// SPDX-License-Identifier: Apache-2.0
//
// A value is a strip of floats, or one packet where it is the same for all pixels. Strips are short, so that a
// recording's values stay in the fast caches.
#pragma once
#include <burnish/ad/replay_steps.h>

namespace burnish {

/// Pixels that are played at a time; planes are padded to a multiple of it.
inline constexpr int tile = 256;

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
    const detail::ReplayOrder order(r, duty, image, gradient);
    written = detail::ReplayWriter(r, duty, order, gradient).steps();
  }
  const Recording& recording() const { return r; }
  /// Is there a step that writes the adjoint of this plane?
  bool writes(int plane) const {
    for (const auto& f : written.plane_moves)
      if (f.to == plane) return true;
    return false;
  }
  int bytes_a_pixel() const { return written.memory / detail::strip * 4; }

  void begin(State& s, const Environment& e) const {
    std::size_t need = at(written.memory);
    s.frames.resize(r.loops.size());
    for (std::size_t l = 0; l < r.loops.size(); ++l) need += at(written.frame[l]) * at(e.lists[r.loops[l].list].count);
    if (s.memory.size() < need / lanes + 1) s.memory.resize(need / lanes + 1);
    s.m = reinterpret_cast<float*>(s.memory.data());
    std::fill(s.m, s.m + written.memory, 0.0f);
    float* to = s.m + written.memory;
    for (std::size_t l = 0; l < r.loops.size(); ++l) {
      s.frames[l] = to;
      to += written.frame[l] * e.lists[r.loops[l].list].count;
    }
    for (int i = 0; i < size(); ++i) {
      const Node& x = node(i);
      if (x.varying || x.kind == Kind::operation || x.kind == Kind::output || written.value_at[at(i)] < 0) continue;
      const float value = x.kind == Kind::parameter ? e.parameters[x.index]
                          : x.kind == Kind::data    ? e.data[x.index]
                                                    : x.value;
      Lanes(value).store(place(s, i));
    }
    for (const int i : written.once) {
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
    for (const int i : written.last) {
      const Node& x = node(i);
      Lanes in[detail::max_inputs], out[detail::max_outputs], d_in[detail::max_inputs], d_out[detail::max_outputs];
      for (int k = 0; k < x.op->inputs; ++k) in[k] = Lanes::load(place(s, x.in[at(k)]));
      for (int k = 0; k < x.op->outputs; ++k) {
        out[k] = Lanes::load(place(s, i + k));
        d_out[k] = written.adjoint_at[at(i + k)] >= 0 ? Lanes::load(s.m + written.adjoint_at[at(i + k)]) : Lanes(0.0f);
      }
      x.op->backward(in, out, d_out, d_in, x.op->reads ? e.resources[x.index] : nullptr,
                     x.scatters ? e.scatters + x.index : nullptr);
      for (int k = 0; k < x.op->inputs; ++k) {
        if (!duty[at(i)].mode[at(k)]) continue;
        float* const to = s.m + written.adjoint_at[at(x.in[at(k)])];
        (Lanes::load(to) + d_in[k]).store(to);
      }
    }
  }
  /// The adjoint of parameter node `id`, after end().
  float d_parameter(const State& s, int id) const {
    const int a = written.adjoint_at[at(id)];
    return a < 0 ? 0 : Lanes::load(s.m + a).sum();
  }

private:
  using Block = detail::ReplaySteps::Block;
  Recording r;
  bool with_image, with_gradient;
  std::vector<Duty> duty;
  detail::ReplaySteps written;

  static std::size_t at(int i) { return std::size_t(i); }
  int size() const { return int(r.nodes.size()); }
  const Node& node(int i) const { return r.nodes[at(i)]; }
  float* place(State& s, int i) const { return s.m + detail::offset(written.value_at[at(i)]); }

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
    for (const int* const rest = written.more.data(); first != end; ++first) first->run(*first, m, turn, rest, e);
  }
  void play(State& s, const Environment& e, int pixel, float* const* image, const float* const* d_image) const {
    float* const m = s.m;
    for (const auto& f : written.field_moves) copy(m + f.to, e.pixels[f.from] + pixel);
    for (std::size_t i = 0; i < written.first_back; ++i) {
      const Block& b = written.blocks[i];
      if (b.loop < 0) {
        run(b.steps.data(), b.steps.data() + b.steps.size(), m, nullptr, e);
        continue;
      }
      for (const auto& f : b.sums) zero(m + f.to);
      float* turn = s.frames[at(b.loop)];
      const int room = written.frame[at(b.loop)];
      for (int t = 0, count = e.lists[r.loops[at(b.loop)].list].count; t < count; ++t, turn += room) {
        take_items(b, m, e, t);
        run(b.steps.data(), b.steps.data() + b.steps.size(), m, turn, e);
        for (const auto& f : b.sums)
          add(m + f.to, (f.from & detail::framed ? turn : m) + detail::offset(f.from), stride(f.from));
      }
    }
    if (with_image)
      for (std::size_t c = 0; c < r.outputs.size(); ++c) {
        const int from = written.value_at[at(r.outputs[c])];
        copy(image[c] + pixel, m + detail::offset(from), stride(from));
      }
    if (!with_gradient) return;
    for (const int a : written.zeroed) zero(m + a);
    for (std::size_t c = 0; c < written.outputs_at.size(); ++c) {
      if (written.outputs_at[c] < 0) continue;
      if (node(r.outputs[c]).varying) add(m + written.outputs_at[c], d_image[c] + pixel);
      else add_up(m + written.outputs_at[c], d_image[c] + pixel);
    }
    for (std::size_t i = written.first_back; i < written.blocks.size(); ++i) {
      const Block& b = written.blocks[i];
      const detail::Step* const steps = b.steps.data();
      if (b.loop < 0) {
        run(steps, steps + b.steps.size(), m, nullptr, e);
        continue;
      }
      for (const int a : b.clear) zero(m + a);
      float* turn = s.frames[at(b.loop)];
      const int room = written.frame[at(b.loop)];
      for (int t = 0, count = e.lists[r.loops[at(b.loop)].list].count; t < count; ++t, turn += room) {
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
    for (const auto& f : written.plane_moves) copy(e.d_pixels[f.to] + pixel, m + f.from);
  }
  void take_items(const Block& b, float* m, const Environment& e, int turn) const {
    const FlatList& list = e.lists[r.loops[at(b.loop)].list];
    for (const auto& [to, field] : b.items) Lanes(list.values[turn * list.fields + field]).store(m + to);
  }
};

}  // namespace burnish
