// tests/ad/check.cpp -- the gradient checker: right, wrong and undecided, and where
// SPDX-License-Identifier: Apache-2.0
#include <burnish/ad/check.h>
#include <burnish/math/vec.h>
#include <burnish_test.h>

using namespace burnish;

namespace {
/// Its slope is wrong by a thousandth, as a mistake in a formula would have it.
struct Wrong : Operation<1> {
  template <class T> static constexpr T value(T x) { return x * x * x; }
  template <class T> static constexpr Back<T, 1> back(T d, T, T x) { return {d * (3.003f * x * x)}; }
};
struct NotANumber : Operation<1> {
  template <class T> static constexpr T value(T x) { return x; }
  template <class T> static constexpr Back<T, 1> back(T d, T, T x) { return {d / (x - x)}; }
};
template <class T> struct Gloss {
  vec3<T> tint = {0.4f, 0.3f, 0.2f};
  T rough = 0.3f;
  static constexpr auto parameters() {
    return std::tuple{Param{"tint", &Gloss::tint, unit}, Param{"rough", &Gloss::rough, unit}};
  }
};
}  // namespace

TEST_CASE("check: a right slope is called right", "[ad][gradient]") {
  const auto c = check_gradient([](auto x, auto y) { return sin(x * y) * exp(x - y); }, 0.7, 1.3);
  CHECK((c.verdict == Verdict::right && c.checked == 2 && c.undecided == 0));
  CHECK(c.error < 1e-9);
  CHECK(bool(c));
}
TEST_CASE("check: a slope that is wrong by a thousandth is called wrong, by name and place", "[ad][gradient]") {
  const auto f = [](const auto& g, const auto& x) { return g.tint.x * x + apply<Wrong>(g.tint.y) + g.rough; };
  const auto c = check_gradient(f, Gloss<double>{}, 0.25);
  CHECK(c.verdict == Verdict::wrong);
  CHECK(!c);
  CHECK(c.parameter == "0.tint.y");
  CHECK(c.slope == Approx(3.003 * 0.09).epsilon(1e-6));
  CHECK(c.difference == Approx(3 * 0.09).epsilon(1e-6));
  CHECK(c.point.find("0.tint.x = 0.4") != std::string::npos);
  CHECK(c.point.find("1 = 0.25") != std::string::npos);
  CHECK(c.text().find("wrong: d/d 0.tint.y") == 0);
}
TEST_CASE("check: a slope that is no number is wrong", "[ad][limit]") {
  CHECK(check_gradient([](auto x) { return apply<NotANumber>(x); }, 0.5).verdict == Verdict::wrong);
}
TEST_CASE("check: an edge within the steps is undecided, one beyond them is not seen", "[ad][limit]") {
  const auto edge = [](auto x) { return max(x, 0.5f) * x; };
  const auto near = check_gradient(edge, 0.5 + 1e-5);
  CHECK(near.verdict == Verdict::undecided);
  CHECK(near.undecided == 1);
  CHECK(bool(near));
  CHECK(check_gradient(edge, Checking{.tolerance = 1e-9}, 0.52).verdict == Verdict::right);
  CHECK(check_gradient([](auto x) { return floor(x * 10.0f) + x; }, 0.30001).verdict == Verdict::undecided);
}
TEST_CASE("check: a model without slope at all is right", "[ad][limit]") {
  CHECK(check_gradient([](auto x) { return floor(x) * 3.0f; }, 0.5).verdict == Verdict::right);
}
TEST_CASE("check: the extrapolated difference is exact to ten digits", "[ad][value]") {
  const auto d = detail::difference([](double x) { return std::exp(x); }, 0.8, 0.01);
  CHECK(d.slope == Approx(std::exp(0.8)).epsilon(1e-10));
  CHECK(d.uncertainty < 1e-9);
}
