// tests/fit/looks.cpp -- one look of everything a recording can hold, in every player
// SPDX-License-Identifier: Apache-2.0
#include <burnish/nodes/image.h>
#include "players.h"

using namespace burnish;
using namespace players;

namespace {

/// An operation of the user's own.
struct Softplus : Operation<1> {
  template <class T> static constexpr T value(T x) { return log(1.0f + exp(x)); }
  template <class T> static constexpr Back<T, 1> back(T d, T, T x) { return {d / (1.0f + exp(-x))}; }
};
template <class T> struct Layer {
  T weight = 0.4f;
  vec2<T> stretch = {1.3f, 0.7f};
  static constexpr auto parameters() {
    return std::tuple{Param{"weight", &Layer::weight, unit}, Param{"stretch", &Layer::stretch}};
  }
};
template <class T> struct Decal {
  vec3<T> base = {0.5f, 0.2f, 0.1f};
  T rough = 0.4f, unread = 0.5f;
  Layer<T> layer;
  std::array<Layer<T>, 2> more = {{{0.3f, {0.9f, 1.1f}}, {0.2f, {0.4f, 2.1f}}}};
  ImageNode<T> print;
  static constexpr auto parameters() {
    return std::tuple{Param{"base", &Decal::base, unit}, Param{"rough", &Decal::rough, unit},
                      Param{"unread", &Decal::unread},   Param{"layer", &Decal::layer},
                      Param{"more", &Decal::more},       Param{"print", &Decal::print}};
  }
};
template <class T> struct Film {
  T exposure = 1.3f, gamma = 0.6f;
  static constexpr auto parameters() {
    return std::tuple{Param{"exposure", &Film::exposure}, Param{"gamma", &Film::gamma}};
  }
};
/// Nested structs, an array, an operation of one's own, a wide one, an image whose texels are fitted, select, data.
constexpr auto decal_look = [](const auto& p, const auto& at, const auto& film) {
  auto sum = p.base * apply<Softplus>(p.layer.weight);
  for (const auto& layer : p.more) {
    const auto height = noise2d(vec2{at.uv.x * layer.stretch.x * 3.0f, at.uv.y * layer.stretch.y * 3.0f});
    sum = sum + p.base * (layer.weight * height.value * height.slope.x);
  }
  const auto rough = select(at.uv.x < 0.1f && at.normal.z > 0.2f, p.rough, pow(p.rough, 1.2f + p.layer.weight));
  sum = sum * rough + p.print({at.uv.x * p.layer.stretch.x, at.uv.y * p.layer.stretch.y});
  return decltype(sum){sum.x * film.exposure, atan2(sum.y, film.gamma), sqrt(max(sum.z, 0) + 0.1f)};
};
Decal<float> decal() {
  Decal<float> d;
  static_cast<TextureData&>(d.print.file) = TextureData(3, 2, 3);
  for (std::size_t i = 0; i < d.print.file.texels.size(); ++i) d.print.file.texels[i] = 0.3f + 0.1f * float(i * 5 % 7);
  return d;
}

}  // namespace

TEST_CASE("players: a look of every kind of node has the slopes of a tape in double", "[fit][agreement]") {
  agree(patch(300), 2e-5, decal_look, decal(), Film<float>{});
}
TEST_CASE("players: pictures of 0, 1, 17 and 300 pixels", "[fit][limit]") {
  for (const int n : {0, 1, 17}) {
    CAPTURE(n);
    agree(patch(n), 2e-5, decal_look, decal(), Film<float>{});
  }
}
TEST_CASE("players: duals carry the slopes of the tape", "[fit][agreement]") {
  using D = Dual<double, 3>;
  const GBuffer g = patch(40);
  const Decal<float> plain = decal();
  const Decal<double> model = lift<double>(plain);
  for (int i = 0; i < g.size(); ++i) {
    const auto look = [&]<class M>(const M& m) {
      using S = detail::scalar_in_t<M>;
      const auto c = decal_look(m, lift<S>(g.at(i)), lift<S>(Film<float>{}));
      return c.x - c.y * c.z;
    };
    const auto [y, d] = differentiate(look, model);
    Decal<D> m = lift<D>(plain);
    m.base.y = D(model.base.y, 0), m.rough = D(model.rough, 1), m.more[1].stretch.x = D(model.more[1].stretch.x, 2);
    const D z = look(m);
    CHECK(z.value == Approx(y).epsilon(1e-12));
    CHECK(z.slope[0] == Approx(d.base.y).epsilon(1e-12).margin(1e-14));
    CHECK(z.slope[1] == Approx(d.rough).epsilon(1e-12).margin(1e-14));
    CHECK(z.slope[2] == Approx(d.more[1].stretch.x).epsilon(1e-12).margin(1e-14));
  }
}
TEST_CASE("players: a captured number makes a recording of its own at run time", "[fit][agreement]") {
  const float exposure = 1.7f;
  const auto look = [exposure](const auto& p, const auto& at) {
    return p.base * (at.normal.z * exposure) * exp(-p.rough * at.uv.x);
  };
  agree<false>(patch(60), 2e-5, look, decal());
}
