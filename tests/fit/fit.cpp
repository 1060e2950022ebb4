// tests/fit/fit.cpp -- the loop: a paint found again from its own picture, ends, refusals, going on
// SPDX-License-Identifier: Apache-2.0
#include <burnish/fit/fit.h>
#include <burnish/fit/loss.h>
#include <burnish/nodes/car_paint.h>
#include <burnish/nodes/image.h>
#include <burnish/shade/brdf.h>
#include <burnish_test.h>
#include <cstring>
#include "sphere.h"

using namespace burnish;

namespace {

/// Three lamps far away; captured, so that the look is recorded when it is called and this file compiles quickly.
struct Lamp {
  vec3<float> direction, radiance;
};
auto lit() {
  const std::array<Lamp, 3> lamps{{{normalize(vec3<float>(0.5f, 0.6f, 0.8f)), {2.4f, 2.2f, 2.0f}},
                                   {normalize(vec3<float>(-0.8f, 0.1f, 0.5f)), {0.8f, 1.0f, 1.3f}},
                                   {normalize(vec3<float>(0.1f, -0.7f, 0.6f)), {0.5f, 0.5f, 0.4f}}}};
  return [lamps](const auto& paint, const auto& at) {
    using T = std::remove_cvref_t<decltype(at.uv.x)>;
    const auto surface = paint(at);
    vec3<T> sum;
    for (const Lamp& lamp : lamps)
      sum += brdf_cos(surface, at.normal, at.tangent, at.view, vec3<T>(lamp.direction)) * vec3<T>(lamp.radiance);
    return sum;
  };
}
using Paint = CarPaint<float>;

/// Masked L1 and the part's statistics, as a fit to a photo has them; only `fitted` numbers keep a derivative.
struct ToPicture {
  GBuffer g = sphere::seen(48);
  Image photo;
  Mask cover = g.frame("coverage");
  std::vector<std::string> fitted = {"base_color", "base_metalness", "specular_roughness", "coat_weight"};

  explicit ToPicture(const Paint& truth) : photo(render(g, lit(), truth)) {}
  double operator()(const Paint& paint, Paint& d) const {
    const Image image = render(g, lit(), paint);
    Image d_image(g.width, g.height);
    const double loss = masked_l1(image, photo, cover, 1, d_image) +
                        part_statistics(image, cover, Statistics(photo, cover), 0.1, d_image);
    backward(g, lit(), paint, d_image, d);
    for_each_parameter(d, [&](const std::string& name, float& x, Range) {
      bool keep = false;
      for (const std::string& f : fitted) keep |= name.rfind(f, 0) == 0;
      if (!keep) x = 0;
    });
    return loss;
  }
};
Paint target() {
  Paint p;
  p.base_color = {0.15f, 0.32f, 0.62f}, p.base_metalness = 0.2f, p.specular_roughness = 0.42f, p.coat_weight = 0.8f;
  return p;
}
template <class M> bool same_bits(const M& a, const M& b) {
  bool same = true;
  each([&](float x, float y) { same = same && std::memcmp(&x, &y, sizeof x) == 0; }, a, b);
  return same;
}
template <class M> bool same_bits(const FitState<M>& a, const FitState<M>& b) {
  return same_bits(a.model, b.model) && same_bits(a.best, b.best) && a.losses == b.losses &&
         a.best_loss == b.best_loss && a.adam.first == b.adam.first && a.adam.second == b.adam.second;
}
template <class F> std::string refusal(F f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

/// One number; what it is compared with is prescribed.
template <class T> struct Single {
  T x = 0.5f;
  static constexpr auto parameters() { return std::tuple{Param{"x", &Single::x, unit}}; }
};
/// The losses of a list, one after the other, the last for ever.
auto prescribed(std::vector<double> losses) {
  return [losses, i = std::size_t(0)](const Single<float>&, Single<float>& d) mutable {
    d.x = 0.1f;
    return losses[std::min(i++, losses.size() - 1)];
  };
}
FitState<Single<float>> after(const std::vector<double>& losses, const Patience& patience) {
  FitState<Single<float>> state{Single<float>()};
  fit(state, prescribed(losses), patience);
  return state;
}

}  // namespace

TEST_CASE("fit: a paint is found again from its own picture", "[fit][limit]") {
  const Paint truth = target();
  FitState<Paint> state(Paint{}, Adam{.rate = 0.02f});
  fit(state, ToPicture(truth), {.steps = 300, .window = 0});
  CHECK(state.step() == 300);
  CHECK(state.best_loss < 0.03 * state.losses.front());
  CHECK(state.best.base_color.x == Approx(truth.base_color.x).margin(1e-2));
  CHECK(state.best.base_color.y == Approx(truth.base_color.y).margin(1e-2));
  CHECK(state.best.base_color.z == Approx(truth.base_color.z).margin(1e-2));
  CHECK(state.best.base_metalness == Approx(truth.base_metalness).margin(0.03));
  CHECK(state.best.specular_roughness == Approx(truth.specular_roughness).margin(0.03));
  CHECK(state.best.coat_weight == Approx(truth.coat_weight).margin(0.05));
  CHECK(state.best.coat_ior == Paint{}.coat_ior);
}
TEST_CASE("fit: the same bits for 1, 2 and 3 threads", "[fit][agreement]") {
  const int before = threads();
  std::vector<FitState<Paint>> states;
  for (const int n : {1, 2, 3}) {
    set_threads(n);
    FitState<Paint> state{Paint{}};
    fit(state, ToPicture(target()), {.steps = 20});
    states.push_back(state);
  }
  set_threads(before);
  CHECK(states[0].step() == 20);
  CHECK(same_bits(states[0], states[1]));
  CHECK(same_bits(states[0], states[2]));
}
TEST_CASE("fit: ended by its caller and gone on with, from a copy, it comes to the same bits", "[fit][agreement]") {
  const ToPicture objective(target());
  FitState<Paint> whole{Paint{}}, half{Paint{}};
  fit(whole, objective, {.steps = 20});
  int calls = 0;
  fit(half, objective, {.steps = 20}, [&](const FitState<Paint>& s) { return ++calls, s.step() < 7; });
  CHECK(half.step() == 7);
  CHECK(calls == 7);
  CHECK_FALSE(same_bits(half, whole));
  FitState<Paint> rest = half;
  fit(rest, objective, {.steps = 20});
  CHECK(same_bits(rest, whole));
  fit(rest, objective, {.steps = 20});  // at its end already
  CHECK(same_bits(rest, whole));
}

TEST_CASE("fit: the best model seen is kept with its loss", "[fit][value]") {
  FitState<Single<float>> state{Single<float>()};
  std::vector<float> models;
  fit(state, prescribed({5, 3, 4, 3, 6}), {.steps = 5}, [&, before = 0.5f](const auto& s) mutable {
    models.push_back(before);
    before = s.model.x;
    return true;
  });
  CHECK(state.losses == std::vector<double>{5, 3, 4, 3, 6});
  CHECK(state.best_loss == 3);
  CHECK(state.best.x == models[1]);
  CHECK(models[1] != models[3]);
}
TEST_CASE("Patience: a fit ends where a window gains less than asked over the one before", "[fit][limit]") {
  const Patience patience{.steps = 100, .window = 10, .gain = 0.01};
  CHECK(after({1}, patience).step() == 20);
  std::vector<double> falling;
  for (int i = 0; i < 100; ++i) falling.push_back(std::pow(0.99, i));  // 10 % a window
  CHECK(after(falling, patience).step() == 100);
  falling.resize(50);  // level from there: the window to 60 still gains on the one to 50, that to 70 does not
  CHECK(after(falling, patience).step() == 70);
  CHECK(after({1}, {.steps = 100, .window = 0}).step() == 100);
  CHECK(after({1}, {.steps = 15, .window = 10}).step() == 15);
  CHECK(after({1}, {.steps = 0}).step() == 0);
  // 1 % less in the second window is just enough, a little less is not.
  std::vector<double> step(10, 1.0);
  step.resize(20, 0.9899);
  step.resize(30, 0.98);
  CHECK(after(step, patience).step() == 40);
  std::fill(step.begin() + 10, step.begin() + 20, 0.9901);
  CHECK(after(step, patience).step() == 20);
}

TEST_CASE("fit: a loss that is no number is refused at its step, and nothing is changed", "[fit][limit]") {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  for (const auto& [odd, what] : {std::pair{nan, "nan"}, std::pair{-nan, "nan"}, std::pair{infinite, "infinite"},
                                  std::pair{-infinite, "infinite"}}) {
    FitState<Single<float>> state{Single<float>()};
    fit(state, prescribed({2}), {.steps = 2});
    const FitState<Single<float>> before = state;
    CHECK(refusal([&] { fit(state, prescribed({odd})); }) == std::string("the loss is ") + what + " at step 3");
    CHECK(same_bits(state, before));
  }
}
TEST_CASE("surfel_to_blame: it finds the surfel, and the refusal names parameter and step", "[fit][value]") {
  const ToPicture clean(target());
  const int size = clean.g.size();
  REQUIRE(size > 600);
  for (const int planted : {0, 255, 256, 411, size - 1}) {
    CAPTURE(planted);
    ToPicture objective = clean;
    FitState<Paint> state{Paint{}};
    std::optional<int> found;
    const std::string message = refusal([&] {
      fit(state, [&](const Paint& paint, Paint& d) {
        if (state.step() == 2) objective.g.plane[1][std::size_t(planted)] = std::nanf("");  // position.y
        const double loss = objective(paint, d);
        try {
          state.adam.check(d);
        } catch (const Error&) {
          Image d_image(objective.g.width, objective.g.height);
          const Image image = render(objective.g, lit(), paint);
          masked_l1(image, objective.photo, objective.cover, 1, d_image);
          part_statistics(image, objective.cover, Statistics(objective.photo, objective.cover), 0.1, d_image);
          found = surfel_to_blame(objective.g, lit(), paint, d_image);
          throw;
        }
        return loss;
      });
    });
    CHECK(message == "d base_color.x is nan at step 3");
    CHECK(state.step() == 2);
    REQUIRE(found.has_value());
    CHECK(*found == planted);
  }
}
TEST_CASE("surfel_to_blame: the first of several; none where none is, or none is seen", "[fit][limit]") {
  const Image ones(48, 48, {1, 1, 1});
  GBuffer g = sphere::seen(48);
  CHECK_FALSE(surfel_to_blame(g, lit(), Paint{}, ones).has_value());
  CHECK_FALSE(surfel_to_blame(GBuffer{}, lit(), Paint{}, Image()).has_value());
  Image odd = ones;  // the fault lies in the loss
  odd.plane(1)[0] = odd.plane(1)[g.pixel[700]] = std::nanf("");  // the corner is not in g
  CHECK(surfel_to_blame(g, lit(), Paint{}, odd) == 700);
  for (const int planted : {900, 301, 300}) {
    g.plane[3][std::size_t(planted)] = std::numeric_limits<float>::infinity();
    CHECK(surfel_to_blame(g, lit(), Paint{}, ones) == planted);
  }
}
TEST_CASE("surfel_to_blame: a look that knows surfels by their place; one whose texels alone are hit", "[fit][limit]") {
  const GBuffer g = sphere::seen(48);
  const auto by_place = [place = 517.0f](const auto& p, const auto& at) {
    return vec3{p.x, p.x, p.x / abs(at.index - place)};
  };
  CHECK(surfel_to_blame(g, by_place, Single<float>{}, Image(48, 48, {1, 1, 1})) == 517);
  ImageNode<float> print;
  static_cast<TextureData&>(print.file) = TextureData(4, 4, 3, 0.5f);
  const auto printed = [place = 345.0f](const auto& p, const auto& at) { return p(at.uv) / abs(at.index - place); };
  CHECK(surfel_to_blame(g, printed, print, Image(48, 48, {1, 1, 1})) == 345);
}
