// burnish/fit/render.h -- numbers of the model -> image, and d image -> d numbers of the model
// SPDX-License-Identifier: Apache-2.0
//
// A look is any function look(model, at) or look(model, at, data...) of templated numbers that gives a colour (or for
// sum_and_gradient a number). `at` is the surfel of a GBuffer, or whatever struct Planes hold. A look without captures is
// recorded by the compiler; one that captures is recorded when it is called, and replayed. What a look reads beside model
// and pixel is handed over with with(look, data...): structs of numbers, Resources, std::vectors of items for repeat.
#pragma once
#include <burnish/fit/play.h>

namespace burnish {

namespace detail {
/// Sixteen pixels' worth of whatever planes hold.
template <template <class> class P, class Pointers> P<Lanes> load(const Pointers& planes, int pixel) {
  P<Lanes> p;
  std::size_t k = 0;
  each([&](Lanes& x) { x = Lanes::load(planes[k++] + pixel); }, p);
  return p;
}
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
        shade(
            [&](int p) {
              return [&]<template <class> class P>(const Planes<P>&) { return detail::load<P>(planes, p); }(model);
            },
            begin, end);
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
