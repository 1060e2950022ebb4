// tests/ad/model.cpp -- parameters(): names, ranges, order, nesting, arrays, what is fixed, and what is lifted
// SPDX-License-Identifier: Apache-2.0
#include <burnish/ad/check.h>
#include <burnish/math/vec.h>
#include <burnish_test.h>

using namespace burnish;

namespace {
template <class T> struct Flakes {
  T scale = 40, amount = 0.1f;
  int seed = 7;
  static constexpr auto parameters() {
    return std::tuple{Param{"scale", &Flakes::scale, Range{5, 200}}, Param{"amount", &Flakes::amount},
                      Fixed{&Flakes::seed}};
  }
};
template <class T> struct Coat {
  vec3<T> color = {0.1f, 0.2f, 0.3f};
  Flakes<T> flakes;
  std::array<Flakes<T>, 2> more;
  std::array<T, 2> weights = {0.25f, 0.75f};
  bool metallic = true;
  static constexpr auto parameters() {
    return std::tuple{Param{"color", &Coat::color, unit}, Param{"flakes", &Coat::flakes, Range{0, 2}},
                      Param{"more", &Coat::more}, Param{"weights", &Coat::weights, unit}, Fixed{&Coat::metallic}};
  }
};
}  // namespace

TEST_CASE("models: names are joined by dots, in the order of parameters()", "[ad][value]") {
  Coat<float> coat;
  std::vector<std::string> names;
  for_each_parameter(coat, [&](const std::string& name, float&, Range) { names.push_back(name); });
  CHECK(names == std::vector<std::string>{"color.x", "color.y", "color.z", "flakes.scale", "flakes.amount",
                                          "more.0.scale", "more.0.amount", "more.1.scale", "more.1.amount", "weights.0",
                                          "weights.1"});
  CHECK(count<Coat<float>>() == 11);
}
TEST_CASE("models: a member's own range goes before that of its struct", "[ad][value]") {
  Coat<float> coat;
  for_each_parameter(coat, [&](const std::string& name, float&, Range r) {
    CAPTURE(name, r.low, r.high);
    if (name == "color.y" || name == "weights.1") CHECK((r.low == 0 && r.high == 1));
    if (name == "flakes.scale" || name == "more.1.scale") CHECK((r.low == 5 && r.high == 200));
    if (name == "flakes.amount") CHECK((r.low == 0 && r.high == 2));
    if (name == "more.0.amount") CHECK((r.low == anything.low && r.high == anything.high));
  });
}
TEST_CASE("models: lift carries every number over, and what is fixed", "[ad][value]") {
  Coat<float> coat;
  coat.color.z = 0.5f, coat.more[1].amount = 0.75f, coat.weights[0] = 2, coat.metallic = false, coat.more[0].seed = 3;
  const Coat<double> d = lift<double>(coat);
  CHECK((d.color.z == 0.5 && d.more[1].amount == 0.75 && d.weights[0] == 2 && !d.metallic && d.more[0].seed == 3));
  const Coat<Packet<float, 16>> p = lift<Packet<float, 16>>(coat);
  CHECK((p.color.z[9] == 0.5f && p.more[1].amount[0] == 0.75f && p.more[0].seed == 3));
  const Coat<float> back = lift<float>(d);
  CHECK((back.weights[0] == 2 && !back.metallic));
}
TEST_CASE("models: each walks several structs in step", "[ad][value]") {
  Coat<float> a;
  Coat<double> b;
  a.color.x = 3;
  each([](float x, double& y) { y += double(x); }, a, b);
  CHECK(b.color.x == Approx(3.1));
  CHECK(b.flakes.scale == Approx(80));
}
TEST_CASE("models: a derivative is a model, and what is fixed in it is the model's", "[ad][gradient]") {
  Coat<double> coat;
  coat.metallic = false;
  const auto [y, d] =
      differentiate([](const auto& c) { return c.color.x * c.color.y + c.more[1].scale * c.weights[0] * 3.0f; }, coat);
  CHECK(d.color.x == Approx(0.2));
  CHECK(d.color.y == Approx(0.1));
  CHECK(d.color.z == 0);
  CHECK(d.more[1].scale == Approx(0.75));
  CHECK(d.weights[0] == Approx(120));
  CHECK(d.more[1].amount == 0);
  CHECK(!d.metallic);
}
TEST_CASE("models: a forgotten member is seen, a listed one is not", "[ad][value]") {
  struct Forgot {
    float a, b;
    static constexpr auto parameters() { return std::tuple{Param<Forgot, float>{"a", &Forgot::a}}; }
  };
  static_assert(!detail::complete<Forgot>());
  static_assert(detail::complete<Flakes<float>>() && detail::complete<Coat<float>>() &&
                detail::complete<vec3<float>>());
  SUCCEED();
}
TEST_CASE("models: randomize stays inside the ranges and reaches most of them", "[ad][value]") {
  std::mt19937 random(4);
  double low = 1e9, high = -1e9;
  for (int i = 0; i < 500; ++i) {
    Coat<double> coat;
    randomize(coat, random);
    for_each_parameter(coat, [&](const std::string& name, double& x, Range r) {
      if (r.low <= anything.low) r = {-2, 2};
      if (!(x > double(r.low) && x < double(r.high))) FAIL(name);
    });
    low = std::min(low, coat.flakes.scale), high = std::max(high, coat.flakes.scale);
  }
  CHECK((low < 12 && high > 190));
}
