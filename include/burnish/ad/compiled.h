// burnish/ad/compiled.h -- the player for recordings made by the compiler: straight-line packet code, forth and back
// SPDX-License-Identifier: Apache-2.0
//
// Every node becomes a few instructions on registers; there is no tape. What a phase has to do is listed by the compiler
// first (Steps), so that each phase unrolls over its own nodes alone: that halves the time this takes to compile.
#pragma once
#include <burnish/ad/environment.h>
#include <burnish/ad/plan.h>

namespace burnish {

namespace detail {
/// Nodes, in the order they are done.
template <int N> struct Steps {
  int node[N + 1] = {};
  int size = 0;
  constexpr void add(int i) { node[size++] = i; }
};
}  // namespace detail

/// Source::recording is a static constexpr Frozen. Image: the outputs are wanted; Gradient: their adjoints go back.
template <class Source, bool Image, bool Gradient> struct Compiled {
  static constexpr const auto& R = Source::recording;
  static constexpr int N = int(R.nodes.size()), outputs = int(R.outputs.size()), loops = int(R.loops.size());
  using Duties = std::array<Duty, N>;
  static constexpr Turns turns = [] {
    Duties d{};
    return Gradient ? best_turns(R, d, Image) : Turns::again;
  }();
  struct Plan {
    Duties duty{};
    int kept = 0;
    detail::Steps<N> once, last, fields, forth, back, accumulate, planes;
    std::array<detail::Steps<N>, loops> body{}, keep{}, restore{}, turn{}, body_back{}, clear{};
  };
  static constexpr Plan make() {
    Plan p;
    p.kept = make_plan(R, p.duty, Gradient, turns, Image);
    for (int i = 0; i < N; ++i) {
      const Node& x = R.nodes[std::size_t(i)];
      const Duty& d = p.duty[std::size_t(i)];
      const bool operation = x.kind == Kind::operation, body = in_body(R, i);
      bool forward = false;  // of any output
      for (int k = 0; operation && k < x.op->outputs; ++k) forward |= p.duty[std::size_t(i + k)].forward;
      if (!x.varying) {
        if (operation && forward) p.once.add(i);
        if (d.adjoint) p.accumulate.add(i);
      } else if (body) {
        auto& l = p.body[std::size_t(x.loop)];
        if ((operation && forward) || (x.kind == Kind::item && d.forward)) l.add(i);
        if (d.kept) p.keep[std::size_t(x.loop)].add(i), p.restore[std::size_t(x.loop)].add(i);
        bool turn = false;
        for (int k = 0; operation && k < x.op->outputs; ++k) turn |= p.duty[std::size_t(i + k)].turn;
        if (turn || (x.kind == Kind::item && d.turn)) p.turn[std::size_t(x.loop)].add(i);
      } else if (x.kind == Kind::pixel) {
        if (d.forward) p.fields.add(i);
        if (Gradient && x.active && d.adjoint) p.planes.add(i);
      } else if ((operation && forward) || (x.kind == Kind::sum && R.loops[std::size_t(x.loop)].first_sum == i))
        p.forth.add(i);
      if (d.clear) p.clear[std::size_t(d.clear - 1)].add(i);
    }
    for (int i = N - 1; Gradient && i >= 0; --i) {
      const Node& x = R.nodes[std::size_t(i)];
      if (x.kind == Kind::sum && R.loops[std::size_t(x.loop)].first_sum == i) p.back.add(i);
      if (!p.duty[std::size_t(i)].back) continue;
      if (!x.varying) p.last.add(i);
      else if (in_body(R, i)) p.body_back[std::size_t(x.loop)].add(i);
      else p.back.add(i);
    }
    return p;
  }
  static constexpr Plan plan = make();

  /// u: values that are the same for all pixels; d_u: their adjoints, a sum a lane.
  struct Uniform {
    Lanes u[N], d_u[N];
  };
  static void begin(Uniform& s, const Environment& e) {
    for (int i = 0; i < N; ++i) {
      const Node& x = R.nodes[std::size_t(i)];
      if (x.kind == Kind::parameter) s.u[i] = e.parameters[x.index];
      if (x.kind == Kind::data) s.u[i] = e.data[x.index];
      if (x.kind == Kind::constant) s.u[i] = x.value;
      s.d_u[i] = 0.0f;
    }
    const State t{s.u, s.d_u, s.u, e, 0};
    run<Forth, &Plan::once>(t);
  }
  /// The adjoints of what is the same for all pixels, once at the end of a band.
  static void end(Uniform& s, const Environment& e) {
    const State t{s.u, s.d_u, s.u, e, 0};
    run<BackUniform, &Plan::last>(t);
  }
  /// Sixteen pixels. image: where the outputs go (unless Image is false); d_image: their adjoints (with Gradient).
  [[gnu::noinline]] static void packet(Uniform& s, const Environment& e, int pixel,
                                       [[maybe_unused]] float* const* image,
                                       [[maybe_unused]] const float* const* d_image) {
    Lanes v[N], d[N];
    const State t{v, d, s.u, e, pixel};
    run<Load, &Plan::fields>(t);
    run<Forth, &Plan::forth>(t);
    if constexpr (Image) store_outputs(t, image, std::make_integer_sequence<int, outputs>{});
    if constexpr (Gradient) {
      run<Zero, &Plan::accumulate>(t);
      load_outputs(t, d_image, std::make_integer_sequence<int, outputs>{});
      run<Back, &Plan::back>(t);
      run<Store, &Plan::planes>(t);
      accumulate(t, s, std::make_integer_sequence<int, plan.accumulate.size>{});
    }
  }

private:
  struct State {
    Lanes *v, *d;
    const Lanes* u;
    const Environment& e;
    int pixel;
  };
  // In blocks, because clang folds at most 256 operands and g++ grows slow on long ones.
  template <class Do, auto Member, int L, int From, int... I>
  [[gnu::always_inline]] static inline void block(const State& s, [[maybe_unused]] int turn,
                                                  std::integer_sequence<int, I...>) {
    if constexpr (L < 0) (Do::template run<(plan.*Member).node[From + I]>(s), ...);
    else (Do::template run<(plan.*Member)[std::size_t(L)].node[From + I]>(s, turn), ...);
  }
  template <class Do, auto Member, int L = -1, int From = 0>
  [[gnu::always_inline]] static inline void run(const State& s, int turn = 0) {
    constexpr int size = [] {
      if constexpr (L < 0) return (plan.*Member).size;
      else return (plan.*Member)[std::size_t(L)].size;
    }();
    if constexpr (From < size) {
      constexpr int n = size - From < 64 ? size - From : 64;
      block<Do, Member, L, From>(s, turn, std::make_integer_sequence<int, n>{});
      run<Do, Member, L, From + n>(s, turn);
    }
  }
  template <int I> [[gnu::always_inline]] static inline Lanes get(const State& s) {
    if constexpr (R.nodes[I].kind == Kind::constant) return Lanes(R.nodes[I].value);
    else if constexpr (R.nodes[I].varying) return s.v[I];
    else return s.u[I];
  }
  template <int I, int... K>
  [[gnu::always_inline]] static inline void inputs(const State& s, Lanes* in, std::integer_sequence<int, K...>) {
    ((in[K] = get<R.nodes[I].in[K]>(s)), ...);
  }
  template <auto F, class... A> [[gnu::always_inline]] static inline void call(A... a) { F(a...); }

  struct Load {
    template <int I> [[gnu::always_inline]] static inline void run(const State& s) {
      s.v[I] = Lanes::load(s.e.pixels[R.nodes[I].index] + s.pixel);
    }
  };
  struct Store {
    template <int I> [[gnu::always_inline]] static inline void run(const State& s) {
      s.d[I].store(s.e.d_pixels[R.nodes[I].index] + s.pixel);
    }
  };
  struct Zero {
    template <int I> [[gnu::always_inline]] static inline void run(const State& s, int = 0) { s.d[I] = 0.0f; }
  };
  struct Forth {
    template <int I> [[gnu::always_inline]] static inline void run(const State& s, [[maybe_unused]] int turn = 0) {
      constexpr const Info* op = R.nodes[I].op;
      if constexpr (R.nodes[I].kind == Kind::sum) Compiled::template loop_forth<R.nodes[I].loop>(s);
      else if constexpr (R.nodes[I].kind == Kind::item) item<I>(s, turn);
      else {
        Lanes in[op->inputs], out[op->outputs];
        Compiled::template inputs<I>(s, in, std::make_integer_sequence<int, op->inputs>{});
        call<op->forward>(static_cast<const Lanes*>(in), static_cast<Lanes*>(out),
                          op->reads ? s.e.resources[R.nodes[I].index] : nullptr);
        for (int k = 0; k < op->outputs; ++k) s.v[I + k] = out[k];
      }
    }
  };
  template <int I> [[gnu::always_inline]] static inline void item(const State& s, int turn) {
    const FlatList& list = s.e.lists[R.loops[std::size_t(R.nodes[I].loop)].list];
    s.v[I] = Lanes(list.values[turn * list.fields + R.nodes[I].index]);
  }
  struct Keep {
    template <int I> [[gnu::always_inline]] static inline void run(const State& s, int turn) {
      s.e.kept[turn * plan.kept + plan.duty[I].kept - 1] = s.v[I];
    }
  };
  struct Restore {
    template <int I> [[gnu::always_inline]] static inline void run(const State& s, int turn) {
      s.v[I] = s.e.kept[turn * plan.kept + plan.duty[I].kept - 1];
    }
  };
  template <int M> [[gnu::always_inline]] static inline void give(Lanes& d, Lanes x) {
    if constexpr (M == 1) d = x;
    else if constexpr (M == 2) d += x;
  }
  template <int I, int... K> [[gnu::always_inline]] static inline void give_all(const State& s, const Lanes* d_in,
                                                                                std::integer_sequence<int, K...>) {
    (give<plan.duty[I].mode[K]>(s.d[R.nodes[I].in[K]], d_in[K]), ...);
  }
  template <int I, int... K> [[gnu::always_inline]] static inline void outgoing(const State& s, Lanes* out,
                                                                                Lanes* d_out,
                                                                                std::integer_sequence<int, K...>) {
    ((out[K] = (R.nodes[I].varying ? s.v : s.u)[I + K]), ...);
    ((d_out[K] = plan.duty[I + K].adjoint ? s.d[I + K] : Lanes(0.0f)), ...);
  }
  struct Back {
    template <int I> [[gnu::always_inline]] static inline void run(const State& s, int = 0) {
      constexpr const Info* op = R.nodes[I].op;
      if constexpr (R.nodes[I].kind == Kind::sum) Compiled::template loop_back<R.nodes[I].loop>(s);
      else {
        Lanes in[op->inputs], out[op->outputs], d_in[op->inputs], d_out[op->outputs];
        Compiled::template inputs<I>(s, in, std::make_integer_sequence<int, op->inputs>{});
        Compiled::template outgoing<I>(s, out, d_out, std::make_integer_sequence<int, op->outputs>{});
        call<op->backward>(static_cast<const Lanes*>(in), static_cast<const Lanes*>(out),
                           static_cast<const Lanes*>(d_out), static_cast<Lanes*>(d_in),
                           op->reads ? s.e.resources[R.nodes[I].index] : nullptr,
                           R.nodes[I].scatters ? s.e.scatters + R.nodes[I].index : nullptr);
        Compiled::template give_all<I>(s, d_in, std::make_integer_sequence<int, op->inputs>{});
      }
    }
  };
  using BackUniform = Back;

  template <int L> static constexpr bool loop_runs_forth() {
    return plan.body[std::size_t(L)].size > 0 || plan.keep[std::size_t(L)].size > 0 || [] {
      for (int k = 0; k < R.loops[L].sums; ++k)
        if (plan.duty[std::size_t(R.loops[L].first_sum + k)].forward) return true;
      return false;
    }();
  }
  template <int L, int... K>
  [[gnu::always_inline]] static inline void clear_sums(const State& s, std::integer_sequence<int, K...>) {
    ((s.v[R.loops[L].first_sum + K] = Lanes(0.0f)), ...);
  }
  template <int I> [[gnu::always_inline]] static inline void add_term(const State& s) {
    if constexpr (plan.duty[I].forward) s.v[I] += get<R.nodes[I].in[0]>(s);
  }
  template <int L, int... K>
  [[gnu::always_inline]] static inline void add_terms(const State& s, std::integer_sequence<int, K...>) {
    (add_term<R.loops[L].first_sum + K>(s), ...);
  }
  template <int L> [[gnu::always_inline]] static inline void loop_forth(const State& s) {
    if constexpr (loop_runs_forth<L>()) {
      using Sums = std::make_integer_sequence<int, R.loops[L].sums>;
      clear_sums<L>(s, Sums{});
      const int turns_to_do = s.e.lists[R.loops[L].list].count;
#pragma GCC unroll 1
      for (int t = 0; t < turns_to_do; ++t) {
        run<Forth, &Plan::body, L>(s, t);
        run<Keep, &Plan::keep, L>(s, t);
        add_terms<L>(s, Sums{});
      }
    }
  }
  template <int L, int... K>
  [[gnu::always_inline]] static inline void give_terms(const State& s, std::integer_sequence<int, K...>) {
    (give<plan.duty[R.loops[L].first_sum + K].mode[0]>(s.d[R.nodes[R.loops[L].first_sum + K].in[0]],
                                                       s.d[R.loops[L].first_sum + K]),
     ...);
  }
  template <int L> [[gnu::always_inline]] static inline void loop_back(const State& s) {
    run<Zero, &Plan::clear, L>(s, 0);
    const int turns_to_do = s.e.lists[R.loops[L].list].count;
#pragma GCC unroll 1
    for (int t = 0; t < turns_to_do; ++t) {
      run<Restore, &Plan::restore, L>(s, t);
      run<Forth, &Plan::turn, L>(s, t);
      give_terms<L>(s, std::make_integer_sequence<int, R.loops[L].sums>{});
      run<Back, &Plan::body_back, L>(s, t);
    }
  }
  template <int... C> [[gnu::always_inline]] static inline void store_outputs(const State& s, float* const* image,
                                                                              std::integer_sequence<int, C...>) {
    (get<R.outputs[C]>(s).store(image[C] + s.pixel), ...);
  }
  /// A node may be several outputs; what is the same for all pixels was set to zero before.
  template <int C> [[gnu::always_inline]] static inline void load_output(const State& s, const float* from) {
    constexpr bool first = R.nodes[R.outputs[C]].varying && [] {
      for (int b = 0; b < C; ++b)
        if (R.outputs[b] == R.outputs[C]) return false;
      return true;
    }();
    give<first ? 1 : 2>(s.d[R.outputs[C]], Lanes::load(from));
  }
  template <int... C> [[gnu::always_inline]] static inline void load_outputs(const State& s,
                                                                             const float* const* d_image,
                                                                             std::integer_sequence<int, C...>) {
    (load_output<C>(s, d_image[C] + s.pixel), ...);
  }
  template <int... K> [[gnu::always_inline]] static inline void accumulate(const State& s, Uniform& uniform,
                                                                           std::integer_sequence<int, K...>) {
    ((uniform.d_u[plan.accumulate.node[K]] += s.d[plan.accumulate.node[K]]), ...);
  }
};

}  // namespace burnish
