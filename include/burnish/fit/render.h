// burnish/fit/render.h -- numbers of the model -> image, and d image -> d numbers of the model
// SPDX-License-Identifier: Apache-2.0
//
// A look is any function look(model, at) or look(model, at, data...) of templated numbers that gives a colour (or for
// sum_and_gradient a number). `at` is the surfel of a GBuffer, or whatever struct Planes hold. A look without captures is
// recorded by the compiler; one that captures is recorded when it is called, and replayed. What a look reads beside model
// and pixel is handed over with with(look, data...): structs of numbers, Resources, std::vectors of items for repeat.
#pragma once
#include <burnish/ad/compiled.h>
#include <burnish/ad/parallel.h>
#include <burnish/ad/repeat.h>
#include <burnish/fit/planes.h>

namespace burnish {

/// A look with the run-time data it reads.
template <class Look, class... Data> struct With {
  Look look;
  std::tuple<const Data&...> data;
};
template <class Look, class... Data> With<Look, Data...> with(const Look& look, const Data&... data) { return {look, {data...}}; }

/// Which player does the gradient.
enum class Player { automatic, compiled, replayed };

namespace detail {

template <class T> struct as_with {
  using type = With<T>;
  static type of(const T& t) { return {t, {}}; }
};
template <class L, class... D> struct as_with<With<L, D...>> {
  using type = With<L, D...>;
  static const type& of(const type& t) { return t; }
};

inline constexpr int bands = 32;  // of the image, however many threads: what makes sums the same for every count
inline constexpr int largest_compiled = 2048;  // nodes

/// Data in another number: a vector of items becomes a List.
template <class U, class D> rebind_t<D, U> lift_data(const D& d) {
  if constexpr (requires { rebind_t<D, U>{}.items; }) return {d};
  else return lift<U>(d);
}
template <class X> inline constexpr bool is_list = false;
template <template <class> class Item, class T> inline constexpr bool is_list<List<Item, T>> = true;

template <class Output, class F> constexpr void each_output(Output& y, F f) { each(f, y); }

/// The recording of look(model, at, data...). M: the plain model of one pixel; Maps: it differs from pixel to pixel. What
/// is Fixed in model and data is taken from `plain` and `given`; where they are null, it is as a new struct has it.
template <class M, template <class> class At, bool Maps, class Look, class... Data>
constexpr Recording record(const Look& look, const M* plain = nullptr, const std::tuple<const Data&...>* given = nullptr) {
  Recording r;
  const auto name = [&](Kind kind, int& count, bool active) {
    return [&r, &count, kind, active]<class X>(X& x) {
      if constexpr (std::is_same_v<X, Recorded>) x = Recorded(&r, r.input(kind, count++, active));
      else {
        x.recording = &r;
        if constexpr (is_list<X>) x.index = r.lists++;
        else {
          x.index = int(r.fitted.size());
          r.fitted.push_back(active);
        }
      }
    };
  };
  rebind_t<M, Recorded> model{};
  if (plain) copy_fixed(model, *plain);
  each(name(Maps ? Kind::pixel : Kind::parameter, Maps ? r.pixels : r.parameters, true), model);
  At<Recorded> at{};
  each(name(Kind::pixel, r.pixels, false), at);
  std::tuple<rebind_t<Data, Recorded>...> data{};
  if (given)
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (copy_fixed(std::get<I>(data), std::get<I>(*given)), ...);
    }(std::index_sequence_for<Data...>{});
  std::apply([&](auto&... d) { (each(name(Kind::data, r.data, false), d), ...); }, data);
  auto y = std::apply([&](const auto&... d) { return look(std::as_const(model), std::as_const(at), d...); }, data);
  each([&](Recorded& x) { r.outputs.push_back(x.node(&r)); }, y);
  return r;
}

/// A recording that the compiler keeps.
struct Held {
  std::array<Node, largest_compiled> nodes{};
  std::array<Loop, 16> loops{};
  std::array<int, 16> outputs{};
  int size = 0, loop_count = 0, output_count = 0;
};
template <class M, template <class> class At, bool Maps, class Look, class... Data> constexpr Held hold() {
  const Recording r = record<M, At, Maps, Look, Data...>(Look{});
  Held h;
  if (r.nodes.size() > h.nodes.size() || r.loops.size() > 16 || r.outputs.size() > 16)
    throw std::length_error("burnish: this look has more than 2048 operations once its loops over arrays are unrolled; use repeat");
  for (const Node& n : r.nodes) h.nodes[std::size_t(h.size++)] = n;
  for (const Loop& l : r.loops) h.loops[std::size_t(h.loop_count++)] = l;
  for (const int o : r.outputs) h.outputs[std::size_t(h.output_count++)] = o;
  return h;
}
template <class M, template <class> class At, bool Maps, class Look, class... Data> struct Source {
  static constexpr Held held = hold<M, At, Maps, Look, Data...>();
  static constexpr auto recording = [] {
    Frozen<held.size, held.loop_count, held.output_count> f;
    for (std::size_t i = 0; i < f.nodes.size(); ++i) f.nodes[i] = held.nodes[i];
    for (std::size_t i = 0; i < f.loops.size(); ++i) f.loops[i] = held.loops[i];
    for (std::size_t i = 0; i < f.outputs.size(); ++i) f.outputs[i] = held.outputs[i];
    return f;
  }();
};
template <class Look> concept Captureless = std::is_empty_v<Look> && std::is_default_constructible_v<Look>;
template <class M, template <class> class At, bool Maps, class Look, class... Data> concept CompilerRecords =
    Captureless<Look> && requires { typename std::bool_constant<(hold<M, At, Maps, Look, Data...>().size > 0)>; };

inline std::pair<int, int> band(int padded_pixels, int b) {
  const int tiles = padded_pixels / tile;
  return {tiles * b / bands * tile, tiles * (b + 1) / bands * tile};
}

/// A buffer that stays when its user is done; one a thread and use.
template <class Tag, class T> T& kept_buffer() {
  static thread_local T buffer;
  return buffer;
}

/// What the players read, gathered once a call, and where their results are gathered; kept from call to call.
struct Inputs {
  std::vector<float> parameters, data, list_values;
  std::vector<FlatList> lists;
  std::vector<const float*> pixels;
  std::vector<float*> d_pixels;
  std::vector<const void*> resources;
  std::vector<float> part;                     // bands x parameters
  std::vector<std::vector<Scatter>> scatters;  // bands x resources

private:  // before gather: their types are deduced
  auto into(std::vector<float>& v) {
    return [this, &v]<class X>(const X& x) {
      if constexpr (Plain<X>) v.push_back(x);
      else resources.push_back(&*x);
    };
  }
  template <class D> void add(const D& d) {
    if constexpr (requires { rebind_t<D, Recorded>{}.recording; d.begin(); }) {
      const std::size_t before = list_values.size();
      for (const auto& item : d) each(into(list_values), item);
      const int n = int(d.size());
      lists.push_back({nullptr, n ? int(list_values.size() - before) / n : 0, n});
    } else each(into(data), d);
  }

public:
  template <class G, class M, class... Data> void gather(const G& g, const M& model, const std::tuple<const Data&...>& d, M& d_model) {
    parameters.clear(), data.clear(), list_values.clear(), lists.clear(), pixels.clear(), d_pixels.clear(), resources.clear();
    if constexpr (is_planes<M>) {
      for (const float* p : model.pointers()) pixels.push_back(p);
      for (auto& p : d_model.plane) d_pixels.push_back(p.data());
    } else each(into(parameters), model);
    for (const float* p : g.pointers()) pixels.push_back(p);
    d_pixels.resize(pixels.size());
    std::apply([&](const auto&... x) { (add(x), ...); }, d);
    const float* values = list_values.data();
    for (FlatList& l : lists) l.values = values, values += l.fields * l.count;
    part.assign(parameters.size() * bands, 0.0f);
    scatters.resize(bands);
    for (auto& band_scatters : scatters) {
      band_scatters.resize(std::max(band_scatters.size(), resources.size()));
      for (Scatter& s : band_scatters) s.entries.clear();
    }
  }
  Environment environment(int band) {
    Environment e;
    e.parameters = parameters.data(), e.data = data.data(), e.pixels = pixels.data(), e.lists = lists.data();
    e.resources = resources.data(), e.d_pixels = d_pixels.data(), e.scatters = scatters[std::size_t(band)].data();
    return e;
  }
};

/// Scattered adjoints of one resource: all entries, band after band, each thread its own share of the texels.
template <class X> void gather_scatter(X& to, const std::vector<std::vector<Scatter>>& parts, std::size_t resource) {
  float* const out = to.texels.data();
  const std::size_t n = to.texels.size();
  constexpr int shares = 16;
  parallel_for(shares, [&](int share) {
    const int begin = int(n * std::size_t(share) / shares), end = int(n * (std::size_t(share) + 1) / shares);
    for (const auto& band_scatter : parts)
      for (const auto& e : band_scatter[resource].entries)
        for (int k = 0; k < lanes; ++k)
          if (e.index[k] >= begin && e.index[k] < end) out[e.index[k]] += e.value[k];
  });
}

template <bool Image, bool Gradient, class S, class G, class M, class... Data>
struct CompiledRun {
  using P = Compiled<S, Image, Gradient>;
  template <class I> explicit CompiledRun(const I&) {}
  struct State {
    typename P::Uniform uniform;
    std::vector<Lanes> kept;
  };
  static State& state() {
    static thread_local const std::unique_ptr<State> s(new State);
    return *s;
  }
  /// Is there a step that writes the adjoint of this plane?
  static bool writes(int plane) {
    for (int k = 0; k < P::plan.planes.size; ++k)
      if (S::recording.nodes[std::size_t(P::plan.planes.node[k])].index == plane) return true;
    return false;
  }
  void band(Environment& e, int begin, int end, float* const* image, const float* const* d_image, float* d_parameters, int n) const {
    State& s = state();
    std::size_t turns = 1;
    for (const Loop& l : S::recording.loops) turns = std::max(turns, std::size_t(e.lists[l.list].count));
    if (s.kept.size() < std::size_t(P::plan.kept) * turns) s.kept.resize(std::size_t(P::plan.kept) * turns);
    e.kept = s.kept.data();
    P::begin(s.uniform, e);
    for (int p = begin; p < end; p += lanes) P::packet(s.uniform, e, p, image, d_image);
    if constexpr (Gradient) {
      P::end(s.uniform, e);
      for (int i = 0; i < n; ++i) d_parameters[i] = s.uniform.d_u[i].sum();
    }
  }
};
struct ReplayRun {
  const Replay& player;
  bool writes(int plane) const { return player.writes(plane); }
  void band(Environment& e, int begin, int end, float* const* image, const float* const* d_image, float* d_parameters, int n) const {
    static thread_local Replay::State s;
    player.begin(s, e);
    for (int p = begin; p < end; p += tile) player.packet(s, e, p, image, d_image);
    player.end(s, e);
    for (int i = 0; i < n; ++i) d_parameters[i] = player.d_parameter(s, i);
  }
};

/// Ready to take the derivative by `model`: like it in shape; planes keep their room from call to call.
template <class M> void shape_like(M& d, const M& model) {
  if constexpr (is_planes<M>) {
    if (d.size() != model.size()) d = model;
  } else d = model;
}

/// Plays all bands. fill(begin, end, image planes, d_image planes) readies a band's adjoints; sums of the model's
/// adjoints are added in the order of the bands.
template <class Run, class G, class M, class... Data, class Fill, class Done>
void play(const Run& run, const G& g, const M& model, const std::tuple<const Data&...>& data, int outputs, bool image, Fill fill, Done done, M& d) {
  Inputs& in = kept_buffer<Run, Inputs>();
  shape_like(d, model);
  in.gather(g, model, data, d);
  const int padded_size = int(padded(std::size_t(g.size()), tile)), n = int(in.parameters.size());
  parallel_for(bands, [&](int b) {
    const auto [begin, end] = band(padded_size, b);
    if (begin == end) return;
    Environment e = in.environment(b);
    auto& buffer = kept_buffer<Run, Floats>();
    const std::size_t length = std::size_t(end - begin);
    if (buffer.size() < length * std::size_t(outputs) * 2) buffer.resize(length * std::size_t(outputs) * 2);
    std::array<float*, 16> y{};
    std::array<const float*, 16> d_y{};
    for (std::size_t c = 0; c < std::size_t(outputs); ++c) {
      y[c] = buffer.data() + c * length;
      float* const to = buffer.data() + (std::size_t(outputs) + c) * length;
      fill(int(c), begin, end, to);
      y[c] -= begin;
      d_y[c] = to - begin;
    }
    if constexpr (is_planes<M>)  // a plane that the look does not read has no step that would write its adjoint
      for (std::size_t k = 0; k < d.plane.size(); ++k)
        if (!run.writes(int(k))) std::fill(d.plane[k].begin() + begin, d.plane[k].begin() + end, 0.0f);
    run.band(e, begin, end, y.data(), d_y.data(), in.part.data() + std::size_t(b) * std::size_t(n), n);
    if (image) done(b, begin, end, y.data());
  });
  std::size_t i = 0, resource = 0;
  if constexpr (!is_planes<M>)
    each([&]<class X>(X& x) {
      if constexpr (Plain<X>) {
        x = 0;
        for (std::size_t b = 0; b < bands; ++b) x += in.part[b * std::size_t(n) + i];
        ++i;
      } else {
        std::fill(x.texels.begin(), x.texels.end(), 0.0f);
        gather_scatter(x, in.scatters, resource++);
      }
    }, d);
}

/// Chooses the player and plays.
template <Player Which, bool Image, class G, class M, class Look, class... Data, class Fill, class Done>
void gradient(const G& g, const With<Look, Data...>& w, const M& model, int outputs, Fill fill, Done done, M& d) {
  using One = typename model_at<M>::type;
  using Pixels = pixels_of<G>;
  constexpr bool maps = is_planes<M>;
  constexpr bool fixed = has_fixed_members<One>() || (... || has_fixed_members<Data>());
  constexpr bool compile = Which == Player::compiled || (Which == Player::automatic && !fixed &&
                           CompilerRecords<One, Pixels::template type, maps, Look, Data...>);
  if constexpr (compile) {
    static_assert(!fixed, "burnish: the compiler cannot know what is Fixed in this model or data; leave the choice to "
                          "Player::automatic, or make it a parameter");
    static_assert(Captureless<Look>, "burnish: this look captures; the compiler cannot record it. Hand run-time data over "
                                     "with with(look, data...), or leave the choice to Player::automatic");
    static_assert(!Captureless<Look> || CompilerRecords<One, Pixels::template type, maps, Look, Data...>,
                  "burnish: the compiler cannot record this look; make every function that it calls constexpr, or leave the "
                  "choice to Player::automatic. What stopped it is named below.");
    using S = Source<One, Pixels::template type, maps, Look, Data...>;
    play(CompiledRun<Image, true, S, G, M, Data...>(0), g, model, w.data, outputs, Image, fill, done, d);
  } else {
    const One* plain = nullptr;
    if constexpr (!maps) plain = &model;
    const Replay replay(record<One, Pixels::template type, maps, Look, Data...>(w.look, plain, &w.data), Image, true);
    play(ReplayRun{replay}, g, model, w.data, outputs, Image, fill, done, d);
  }
}
/// Sixteen pixels' worth of whatever planes hold.
template <template <class> class P, class Pointers> P<Lanes> load(const Pointers& planes, int pixel) {
  P<Lanes> p;
  std::size_t k = 0;
  each([&](Lanes& x) { x = Lanes::load(planes[k++] + pixel); }, p);
  return p;
}
/// The image's place of surfel i.
inline int place(const GBuffer& g, int i) { return g.pixel[std::size_t(i)]; }

}  // namespace detail

/// The image of a model, written over those pixels of `image` that g holds. M: a model, or Planes of models (one a surfel).
template <class Look, class M> void render(const GBuffer& g, const Look& l, const M& model, Image& image) {
  const auto& w = detail::as_with<Look>::of(l);
  std::apply([&](const auto&... d) {
    const std::tuple lifted{detail::lift_data<Lanes>(d)...};
    const auto pointers = g.pointers();
    const int size = g.size(), packets = (size + lanes - 1) / lanes;
    const auto shade = [&](const auto& m, int begin, int end) {
      for (int p = begin; p < end; p += lanes) {
        const auto at = detail::load<Surfel>(pointers, p);
        const vec3<Lanes> c = std::apply([&](const auto&... x) {
          if constexpr (detail::is_planes<M>) return vec3<Lanes>(w.look(m(p), at, x...));
          else return vec3<Lanes>(w.look(m, at, x...));
        }, lifted);
        for (int k = 0; k < lanes && p + k < size; ++k) {
          const std::size_t to = std::size_t(g.pixel[std::size_t(p + k)]);
          image.plane(0)[to] = c.x[k], image.plane(1)[to] = c.y[k], image.plane(2)[to] = c.z[k];
        }
      }
    };
    parallel_for(detail::bands, [&](int b) {
      const int begin = packets * b / detail::bands * lanes, end = packets * (b + 1) / detail::bands * lanes;
      if constexpr (detail::is_planes<M>) {
        const auto planes = model.pointers();
        shade([&](int p) { return [&]<template <class> class P>(const Planes<P>&) { return detail::load<P>(planes, p); }(model); }, begin, end);
      } else shade(lift<Lanes>(model), begin, end);
    });
  }, w.data);
}
/// The same on a black image of g's size.
template <class Look, class M> Image render(const GBuffer& g, const Look& look, const M& model) {
  Image image(g.width, g.height);
  render(g, look, model, image);
  return image;
}

/// d loss / d model from d loss / d image, into d; pixels that g does not hold are not read. The same bits for any number
/// of threads.
template <Player Which = Player::automatic, class Look, class M>
void backward(const GBuffer& g, const Look& look, const M& model, const Image& d_image, M& d) {
  const auto fill = [&](int c, int begin, int end, float* to) {
    const float* const from = d_image.plane(c);
    const int n = std::min(end, g.size());
    for (int i = begin; i < n; ++i) to[i - begin] = from[g.pixel[std::size_t(i)]];
    std::fill(to + std::max(0, n - begin), to + (end - begin), 0.0f);
  };
  detail::gradient<Which, false>(g, detail::as_with<Look>::of(look), model, 3, fill, [](auto...) {}, d);
}
template <Player Which = Player::automatic, class Look, class M>
M backward(const GBuffer& g, const Look& look, const M& model, const Image& d_image) {
  M d = model;
  backward<Which>(g, look, model, d_image, d);
  return d;
}

/// The sum over the pixels of f(model, at, data...), which gives a number; its derivative by the model into d. One pass.
template <Player Which = Player::automatic, class G, class F, class M>
double sum_and_gradient(const G& g, const F& f, const M& model, M& d) {
  std::array<double, detail::bands> sums{};
  const auto fill = [&](int, int begin, int end, float* to) {
    const int n = std::max(0, std::min(end, g.size()) - begin);
    std::fill(to, to + n, 1.0f);
    std::fill(to + n, to + (end - begin), 0.0f);
  };
  const auto done = [&](int b, int begin, int end, float* const* y) {
    double s = 0;
    for (int i = begin; i < std::min(end, g.size()); ++i) s += double(y[0][i]);
    sums[std::size_t(b)] = s;
  };
  detail::gradient<Which, true>(g, detail::as_with<F>::of(f), model, 1, fill, done, d);
  double sum = 0;
  for (const double s : sums) sum += s;
  return sum;
}
/// {the sum, its derivative by the model}.
template <Player Which = Player::automatic, class G, class F, class M>
std::pair<double, M> sum_and_gradient(const G& g, const F& f, const M& model) {
  M d = model;
  const double sum = sum_and_gradient<Which>(g, f, model, d);
  return {sum, std::move(d)};
}

}  // namespace burnish
