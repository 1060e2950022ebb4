// burnish/fit/play.h -- a recording played over all pixels on all threads, the derivatives gathered in a fixed order
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/ad/compiled.h>
#include <burnish/ad/parallel.h>
#include <burnish/fit/look.h>
#include <burnish/fit/planes.h>

namespace burnish {

/// Which player does the gradient.
enum class Player { automatic, compiled, replayed };

namespace detail {

inline constexpr int bands = 32;  // of the image, however many threads: what makes sums the same for every count

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
  template <class G, class M, class... Data>
  void gather(const G& g, const M& model, const std::tuple<const Data&...>& d, M& d_model) {
    parameters.clear(), data.clear(), list_values.clear(), lists.clear(), pixels.clear(), d_pixels.clear(),
        resources.clear();
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
    static thread_local std::vector<State> s(1);  // not in the thread's own memory, of which a plugin has little
    return s[0];
  }
  /// Is there a step that writes the adjoint of this plane?
  static bool writes(int plane) {
    for (int k = 0; k < P::plan.planes.size; ++k)
      if (S::recording.nodes[std::size_t(P::plan.planes.node[k])].index == plane) return true;
    return false;
  }
  void band(Environment& e, int begin, int end, float* const* image, const float* const* d_image, float* d_parameters,
            int n) const {
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
  void band(Environment& e, int begin, int end, float* const* image, const float* const* d_image, float* d_parameters,
            int n) const {
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
void play(const Run& run, const G& g, const M& model, const std::tuple<const Data&...>& data, int outputs, bool image,
          Fill fill, Done done, M& d) {
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
  using PixelsOf = pixels_of<G>;
  constexpr bool maps = is_planes<M>;
  constexpr bool fixed = has_fixed_members<One>() || (... || has_fixed_members<Data>());
  constexpr bool compile = Which == Player::compiled || (Which == Player::automatic && !fixed &&
                           CompilerRecords<One, PixelsOf::template type, maps, Look, Data...>);
  if constexpr (compile) {
    static_assert(!fixed, "burnish: the compiler cannot know what is Fixed in this model or data; leave the choice to "
                          "Player::automatic, or make it a parameter");
    static_assert(Captureless<Look>,
                  "burnish: this look captures; the compiler cannot record it. Hand run-time data over "
                  "with with(look, data...), or leave the choice to Player::automatic");
    static_assert(
        !Captureless<Look> || CompilerRecords<One, PixelsOf::template type, maps, Look, Data...>,
        "burnish: the compiler cannot record this look; make every function that it calls constexpr, or leave the "
        "choice to Player::automatic. What stopped it is named below.");
    using S = Source<One, PixelsOf::template type, maps, Look, Data...>;
    play(CompiledRun<Image, true, S, G, M, Data...>(0), g, model, w.data, outputs, Image, fill, done, d);
  } else {
    const One* plain = nullptr;
    if constexpr (!maps) plain = &model;
    const Replay replay(record<One, PixelsOf::template type, maps, Look, Data...>(w.look, plain, &w.data), Image, true);
    play(ReplayRun{replay}, g, model, w.data, outputs, Image, fill, done, d);
  }
}

}  // namespace detail

}  // namespace burnish
