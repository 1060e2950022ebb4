// tests/nodes/patterns.h -- places and colours to try nodes at, and the players they must agree in
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/fit/render.h>
#include <differences.h>

/// Where a node of uv or position is tried.
template <class T> struct Spot {
  burnish::vec2<T> uv;
  burnish::vec3<T> position;
  static constexpr auto parameters() {
    return std::tuple{burnish::Param{"uv", &Spot::uv, burnish::Range{-2, 2}},
                      burnish::Param{"position", &Spot::position, burnish::Range{-2, 2}}};
  }
};
/// What a blend or tint node is tried on.
template <class T> struct Colors {
  burnish::vec3<T> a = {0.2f, 0.5f, 0.7f}, b = {0.6f, 0.3f, 0.9f};
  static constexpr auto parameters() {
    return std::tuple{burnish::Param{"a", &Colors::a, burnish::unit}, burnish::Param{"b", &Colors::b, burnish::unit}};
  }
};

/// Look: a captureless type; look(node, at) gives a number. Its sum over `count` random places and the derivative by
/// the node are the same when recorded by the compiler, when recorded at run time and when taped in double place by
/// place.
template <template <class> class At, class Look, template <class> class Node>
void players_agree(Look look, const Node<float>& node, int count = 300, double within = 3e-5) {
  using namespace burnish;
  Planes<At> places(count);
  std::mt19937 random(9);
  double sum = 0, magnitude = 0;
  std::vector<double> slopes(std::size_t(burnish::count<Node<float>>())), sizes(slopes.size());
  for (int i = 0; i < count; ++i) {
    At<float> at;
    randomize(at, random);
    places.set(i, at);
    const auto at64 = lift<double>(at);
    const auto [y, d] = differentiate([&]<class N>(const N& n) { return look(n, lift<detail::scalar_in_t<N>>(at64)); },
                                      lift<double>(node));
    sum += y, magnitude += std::fabs(y);
    std::size_t k = 0;
    each([&](double x) { slopes[k] += x, sizes[k++] += std::fabs(x); }, d);
  }
  const auto same = [&](const auto& result) {
    CHECK(result.first == Approx(sum).epsilon(0).margin(within * magnitude));
    std::size_t k = 0;
    each(
        [&](float x) {
          CAPTURE(k);
          CHECK(double(x) == Approx(slopes[k]).epsilon(0).margin(within * sizes[k] + 1e-6));
          ++k;
        },
        result.second);
  };
  same(sum_and_gradient<Player::compiled>(places, look, node));
  same(sum_and_gradient<Player::replayed>(places, look, node));
}
