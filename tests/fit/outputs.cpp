// tests/fit/outputs.cpp -- outputs that repeat, are parameters, or depend on nothing; a model for every pixel; sums
// SPDX-License-Identifier: Apache-2.0
#include "players.h"

using namespace burnish;
using namespace players;

namespace {

template <class T> struct Pair {
  T a = 0.7f, b = 0.3f, c = 0.9f;
  static constexpr auto parameters() {
    return std::tuple{Param{"a", &Pair::a}, Param{"b", &Pair::b}, Param{"c", &Pair::c}};
  }
};
template <class T> struct Spot {
  vec2<T> x;
  T target;
  static constexpr auto parameters() { return std::tuple{Param{"x", &Spot::x}, Param{"target", &Spot::target}}; }
};
constexpr auto grey = [](const auto& p, const auto& at) {
  const auto y = p.a * p.a * at.uv.x + p.b * at.uv.y;
  return vec3<std::remove_cvref_t<decltype(y)>>{y, y, y};
};
/// A parameter, a product of parameters alone, a constant.
constexpr auto plain = [](const auto& p, const auto&) {
  return vec3<std::remove_cvref_t<decltype(p.a)>>{p.a, p.a * p.b * p.b, 0.25f};
};
/// A parameter twice, and once more inside.
constexpr auto twice = [](const auto& p, const auto& at) {
  return vec3<std::remove_cvref_t<decltype(p.a)>>{p.b, p.b, p.b * at.uv.x};
};
constexpr auto error = [](const auto& p, const auto& spot) {
  const auto e = p.a * sin(spot.x.x * p.b) - spot.target;
  return e * e;
};

}  // namespace

TEST_CASE("outputs: one number given out three times collects three adjoints", "[fit][agreement]") {
  agree(patch(50), 2e-5, grey, Pair<float>{});
}
TEST_CASE("outputs: parameters and constants may be outputs", "[fit][agreement]") {
  agree(patch(50), 2e-5, plain, Pair<float>{});
  agree(patch(50), 2e-5, twice, Pair<float>{});
}
TEST_CASE("outputs: the picture of every player is the look's, pixel by pixel", "[fit][value]") {
  const GBuffer g = patch(50);
  const Image image = render(g, twice, Pair<float>{});
  for (int i = 0; i < g.size(); ++i) {
    const auto c = twice(Pair<float>{}, g.at(i));
    CHECK(image.plane(2)[g.pixel[std::size_t(i)]] == Approx(c.z));
  }
  CHECK(image.plane(0)[1] == 0);  // pixel 1 is not in g
}
TEST_CASE("sums: the sum and a model for every pixel", "[fit][agreement]") {
  for (const int n : {0, 1, 17, 300}) {
    CAPTURE(n);
    Planes<Pair> model(n);
    Planes<Spot> spots(n);
    std::mt19937 random(5);
    double sum = 0;
    std::vector<Pair<double>> slopes;
    for (int i = 0; i < n; ++i) {
      Pair<float> p;
      Spot<float> s;
      randomize(p, random), randomize(s, random);
      model.set(i, p), spots.set(i, s);
      const auto [y, d] = differentiate([&]<class M>(const M& m) { return error(m, lift<detail::scalar_in_t<M>>(s)); },
                                        lift<double>(p));
      sum += y, slopes.push_back(d);
    }
    const auto same = [&](const std::pair<double, Planes<Pair>>& r) {
      CHECK(r.first == Approx(sum).epsilon(1e-5));
      for (int i = 0; i < n; ++i) {
        const Pair<float> d = r.second.at(i);
        const Pair<double>& t = slopes[std::size_t(i)];
        CHECK(double(d.a) == Approx(t.a).epsilon(1e-4).margin(1e-5));
        CHECK(double(d.b) == Approx(t.b).epsilon(1e-4).margin(1e-5));
        CHECK(d.c == 0);  // read by nobody
      }
    };
    same(sum_and_gradient<Player::compiled>(spots, error, model));
    same(sum_and_gradient<Player::replayed>(spots, error, model));
  }
}
TEST_CASE("sums: the value without its gradient's player is the same sum", "[fit][value]") {
  Planes<Spot> spots(40, Spot<float>{{0.4f, 0.1f}, 0.2f});
  const Pair<float> p;
  const double one = double(error(p, Spot<float>{{0.4f, 0.1f}, 0.2f}));
  CHECK(sum_and_gradient<Player::compiled>(spots, error, p).first == Approx(40 * one).epsilon(1e-6));
  CHECK(sum_and_gradient<Player::replayed>(spots, error, p).first == Approx(40 * one).epsilon(1e-6));
}
