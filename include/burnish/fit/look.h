// burnish/fit/look.h -- a look, the data it reads, and its recording by the compiler or at run time
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <stdexcept>
#include <burnish/ad/plan.h>
#include <burnish/ad/repeat.h>

namespace burnish {

/// A look with the run-time data it reads.
template <class Look, class... Data> struct With {
  Look look;
  std::tuple<const Data&...> data;
};
template <class Look, class... Data> With<Look, Data...> with(const Look& look, const Data&... data) {
  return {look, {data...}};
}

namespace detail {

template <class T> struct as_with {
  using type = With<T>;
  static type of(const T& t) { return {t, {}}; }
};
template <class L, class... D> struct as_with<With<L, D...>> {
  using type = With<L, D...>;
  static const type& of(const type& t) { return t; }
};

inline constexpr int largest_compiled = 2048;  // nodes

/// Data in another number: a vector of items becomes a List.
template <class U, class D> rebind_t<D, U> lift_data(const D& d) {
  if constexpr (requires { rebind_t<D, U>{}.items; }) return {d};
  else return lift<U>(d);
}
template <class X> inline constexpr bool is_list = false;
template <template <class> class Item, class T> inline constexpr bool is_list<List<Item, T>> = true;

/// The recording of look(model, at, data...). M: the plain model of one pixel; Maps: it differs from pixel to pixel. What
/// is Fixed in model and data is taken from `plain` and `given`; where they are null, it is as a new struct has it.
template <class M, template <class> class At, bool Maps, class Look, class... Data>
constexpr Recording record(const Look& look, const M* plain = nullptr,
                           const std::tuple<const Data&...>* given = nullptr) {
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
    throw std::length_error(
        "burnish: this look has more than 2048 operations once its loops over arrays are unrolled; use repeat");
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

}  // namespace detail

}  // namespace burnish
