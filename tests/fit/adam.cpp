// tests/fit/adam.cpp -- Adam against the paper's algorithm in double; ranges, units, refusals, going on
// SPDX-License-Identifier: Apache-2.0
#include <burnish/fit/adam.h>
#include <burnish/math/vec.h>
#include <burnish/nodes/image.h>
#include <burnish_test.h>
#include <cstring>

using namespace burnish;

namespace {

template <class T> struct Sticker {
  vec3<T> color = {0.5f, 0.2f, 0.9f};
  T size = 0.001f, angle = -1.0f, shift = 3.0f;
  ImageNode<T> print;
  int rows = 3;
  static constexpr auto parameters() {
    return std::tuple{Param{"color", &Sticker::color, unit},
                      Param{"size", &Sticker::size, Range{0.0002f, 0.01f}},
                      Param{"angle", &Sticker::angle, Range{-2, -0.5f}},
                      Param{"shift", &Sticker::shift},
                      Param{"print", &Sticker::print},
                      Fixed{&Sticker::rows}};
  }
};
Sticker<float> sticker() {
  Sticker<float> s;
  static_cast<TextureData&>(s.print.file) = TextureData(2, 2, 3, 0.5f);
  for (std::size_t i = 0; i < 12; ++i) s.print.file.texels[i] = 0.1f + 0.07f * float(i);
  return s;
}
/// f on all numbers, texels among them, with their ranges.
template <class M, class F> void numbers(M& m, F f) {
  for_each_parameter(m, [&]<class X>(const std::string&, X& x, Range r) {
    if constexpr (Plain<std::remove_cv_t<X>>) f(x, r);
    else
      for (auto& t : x.texels) f(t, r);
  });
}
template <class M> std::vector<float> flat(const M& m) {
  std::vector<float> v;
  numbers(m, [&](float x, Range) { v.push_back(x); });
  return v;
}
/// An arbitrary derivative for a step: large, small and changing in sign.
Sticker<float> slope(int step, float size = 1) {
  Sticker<float> d = sticker();
  int i = 0;
  numbers(d, [&](float& x, Range) {
    x = size * std::pow(10.0f, float(i % 5 - 2)) * std::sin(0.7f * float(step) + float(i)), ++i;
  });
  return d;
}
/// Kingma and Ba 2015, algorithm 1, in double and in units of the range, u = (x - low) / (high - low), kept to 0..1.
struct Paper {
  double rate, beta1, beta2, epsilon;
  std::vector<double> m{}, v{};
  void step(std::vector<double>& x, const std::vector<float>& d, const std::vector<Range>& ranges, int t) {
    m.resize(x.size()), v.resize(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      const bool open = ranges[i].low < -1e29f;
      const double low = open ? 0 : double(ranges[i].low), width = open ? 1 : double(ranges[i].high) - low;
      const double g = double(d[i]) * width;
      m[i] = beta1 * m[i] + (1 - beta1) * g;
      v[i] = beta2 * v[i] + (1 - beta2) * g * g;
      double u = (x[i] - low) / width;
      u -= rate * m[i] / (1 - std::pow(beta1, t)) / (std::sqrt(v[i] / (1 - std::pow(beta2, t))) + epsilon);
      if (!open) u = std::clamp(u, 0.0, 1.0);
      x[i] = low + u * width;
    }
  }
};
template <class M> std::string refusal(Adam& adam, M& model, const M& d) {
  try {
    adam.step(model, d);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE("Adam: twenty steps are those of the paper in units of the ranges, of numbers and of texels",
          "[fit][agreement]") {
  const Adam choices[] = {Adam{}, Adam{.rate = 0.1f, .beta1 = 0.8f, .beta2 = 0.95f, .epsilon = 0.05f}};
  for (Adam adam : choices) {
    CAPTURE(adam.epsilon);
    Sticker<float> model = sticker();
    std::vector<Range> ranges;
    numbers(model, [&](float, Range r) { ranges.push_back(r); });
    const std::vector<float> start = flat(model);
    REQUIRE(start.size() == 18);
    std::vector<double> x(start.begin(), start.end());
    Paper paper{double(adam.rate), double(adam.beta1), double(adam.beta2), double(adam.epsilon)};
    for (int t = 1; t <= 20; ++t) {
      adam.step(model, slope(t));
      paper.step(x, flat(slope(t)), ranges, t);
      const std::vector<float> now = flat(model);
      for (std::size_t i = 0; i < x.size(); ++i) {
        CAPTURE(t, i);
        const double width = ranges[i].low < -1e29f ? 1 : double(ranges[i].high - ranges[i].low);
        CHECK((double(now[i]) - x[i]) / width == Approx(0).margin(1e-5));
      }
    }
    CHECK(adam.steps == 20);
    CHECK(model.rows == 3);
  }
}
TEST_CASE("Adam: the first step is the rate, in units of the range, however steep the loss", "[fit][value]") {
  for (const float size : {1e-3f, 1.0f, 1e3f}) {
    CAPTURE(size);
    Sticker<float> model = sticker();
    Sticker<float> d = slope(1);
    numbers(d, [&](float& x, Range) { x = size; });
    d.angle = -size, d.color.y = 0;
    Adam{.rate = 0.02f}.step(model, d);
    CHECK(model.color.x == Approx(0.5 - 0.02));
    CHECK(model.color.y == 0.2f);
    CHECK(model.size == Approx(0.001 - 0.02 * 0.0098).epsilon(1e-3));  // epsilon is felt where a slope is 1e-5 a width
    CHECK(model.angle == Approx(-1 + 0.02 * 1.5));
    CHECK(model.shift == Approx(3 - 0.02));
    CHECK(model.print.file.texels[5] == Approx(0.1 + 0.35 - 0.02));
  }
}
TEST_CASE("Adam: ranges are kept to, and reached", "[fit][limit]") {
  Sticker<float> model = sticker();
  Adam adam{.rate = 0.3f};
  const auto inside = [&] {
    bool yes = true;
    numbers(model, [&](float x, Range r) { yes = yes && x >= r.low && x <= r.high; });
    return yes;
  };
  for (int t = 0; t < 30; ++t) {
    adam.step(model, slope(t, 1e6f));
    CHECK(inside());
  }
  for (const float way : {1.0f, -1.0f}) {
    Sticker<float> d = slope(0);
    numbers(d, [&](float& x, Range) { x = way; });
    adam = Adam{.rate = 0.3f};
    for (int t = 0; t < 20; ++t) adam.step(model, d);
    numbers(model, [&](float x, Range r) {
      if (r.low > -1e29f) CHECK(x == (way > 0 ? r.low : r.high));
    });
  }
}
TEST_CASE("Adam: a number without a slope stays where it is, to the bit", "[fit][limit]") {
  Sticker<float> model = sticker(), d = slope(0, 0);
  const std::vector<float> start = flat(model);
  Adam adam;
  for (int t = 0; t < 5; ++t) adam.step(model, d);
  CHECK(flat(model) == start);
}
TEST_CASE("Adam: a derivative that is no number is refused by its name and step, and nothing is changed",
          "[fit][limit]") {
  Sticker<float> model = sticker();
  Adam adam;
  for (int t = 1; t <= 11; ++t) adam.step(model, slope(t));
  const std::vector<float> before = flat(model), first = adam.first, second = adam.second;
  const float nan = std::nanf(""), infinite = std::numeric_limits<float>::infinity();
  Sticker<float> d = slope(12);
  d.color.y = nan;
  CHECK(refusal(adam, model, d) == "d color.y is nan at step 12");
  d = slope(12), d.angle = -infinite;
  CHECK(refusal(adam, model, d) == "d angle is infinite at step 12");
  d = slope(12), d.print.file.texels[11] = nan;
  CHECK(refusal(adam, model, d) == "d print.file is nan at step 12");
  CHECK(flat(model) == before);
  CHECK(adam.first == first);
  CHECK(adam.second == second);
  CHECK(adam.steps == 11);
  CHECK(refusal(adam, model, slope(12)) == "");
  CHECK(adam.steps == 12);
}
TEST_CASE("Adam: a copy goes on to the same bits", "[fit][agreement]") {
  Sticker<float> model = sticker();
  Adam adam{.rate = 0.05f};
  for (int t = 1; t <= 7; ++t) adam.step(model, slope(t));
  Sticker<float> other_model = model;
  Adam other = adam;
  for (int t = 8; t <= 20; ++t) adam.step(model, slope(t));
  for (int t = 8; t <= 20; ++t) other.step(other_model, slope(t));
  const std::vector<float> a = flat(model), b = flat(other_model);
  CHECK(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0);
}
