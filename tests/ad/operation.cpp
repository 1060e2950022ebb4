// tests/ad/operation.cpp -- every operation of the table: its slopes against differences, one value in every number
// SPDX-License-Identifier: Apache-2.0
#include <burnish/ad/replay.h>
#include <math/laws.h>

using namespace burnish;

namespace {

/// Two or three numbers within the given ranges.
struct Inside {
  Range a, b = {-2, 2}, c = {-2, 2};
};
/// The slopes that Op::back gives in double at 1,000 points where away(a, b, c) holds, against Richardson differences
/// of Op::value: 1e-7 of the larger of slope and value.
template <class Op, class Away> void slopes_are_right(Inside in, Away away, double step = 1e-2) {
  std::mt19937_64 random(7);
  const auto pick = [&](Range r) {
    return std::uniform_real_distribution<double>(double(r.low), double(r.high))(random);
  };
  const auto value = [](const std::array<double, 3>& x) {
    return detail::value_of<Op>(std::make_index_sequence<Op::inputs>{}, x.data());
  };
  for (int i = 0; i < 1000; ++i) {
    std::array<double, 3> x;
    do x = {pick(in.a), pick(in.b), pick(in.c)};
    while (!away(x[0], x[1], x[2]));
    const double y = value(x), d = 0.75;  // back is linear in the adjoint
    const auto back = detail::back_of<Op>(std::make_index_sequence<Op::inputs>{}, d, y, x.data());
    for (std::size_t k = 0; k < std::size_t(Op::inputs); ++k) {
      const double here = x[k];
      const auto numeric = detail::difference([&](double t) {
        auto moved = x;
        moved[k] = t;
        return value(moved);
      }, here, step * std::max(std::fabs(here), 0.1));
      const double scale = std::max({std::fabs(numeric.slope), std::fabs(y), 1e-3});
      if (!(std::fabs(back[k] / d - numeric.slope) <= 1e-7 * scale)) {
        CAPTURE(k, x[0], x[1], x[2], back[k] / d, numeric.slope, numeric.uncertainty);
        FAIL("a slope differs from the difference");
      }
    }
  }
  SUCCEED();
}
template <class Op> void slopes_are_right(Inside in) {
  slopes_are_right<Op>(in, [](double, double, double) { return true; });
}

}  // namespace

TEST_CASE("operations: the slopes of arithmetic are its differences", "[ad][gradient]") {
  const auto apart = [](double a, double b, double) { return std::fabs(a - b) > 0.1; };
  const auto off_zero = [](double a, double, double) { return std::fabs(a) > 0.1; };
  slopes_are_right<op::Add>({{-9, 9}});
  slopes_are_right<op::Sub>({{-9, 9}});
  slopes_are_right<op::Mul>({{-9, 9}});
  slopes_are_right<op::Div>({{-9, 9}, {0.2f, 5}});
  slopes_are_right<op::Reciprocal>({{0.2f, 9}});
  slopes_are_right<op::MulAdd>({{-9, 9}});
  slopes_are_right<op::MulSub>({{-9, 9}});
  slopes_are_right<op::SubMul>({{-9, 9}});
  slopes_are_right<op::Neg>({{-9, 9}});
  slopes_are_right<op::Abs>({{-9, 9}}, off_zero);
  slopes_are_right<op::Max>({{-2, 2}}, apart);
  slopes_are_right<op::Min>({{-2, 2}}, apart);
  slopes_are_right<op::Less>({{-2, 2}}, apart);
  slopes_are_right<op::Floor>({{-9, 9}}, [](double a, double, double) { return std::fabs(a - std::round(a)) > 0.1; });
  slopes_are_right<op::Select>({{-2, 2}}, [](double a, double, double) { return std::fabs(a - 0.5) > 0.1; });
}
TEST_CASE("operations: the slopes of the elementary functions are their differences", "[ad][gradient]") {
  slopes_are_right<op::Sqrt>({{0.01f, 9}});
  slopes_are_right<op::Rsqrt>({{0.05f, 9}});
  slopes_are_right<op::Exp>({{-9, 9}});
  slopes_are_right<op::Log>({{0.01f, 9}});
  slopes_are_right<op::Exp2>({{-9, 9}});
  slopes_are_right<op::Log2>({{0.01f, 9}});
  slopes_are_right<op::Pow>({{0.05f, 4}, {-3, 3}});
  slopes_are_right<op::Sin>({{-9, 9}});
  slopes_are_right<op::Cos>({{-9, 9}});
  slopes_are_right<op::Tan>({{-1.3f, 1.3f}});
  slopes_are_right<op::Asin>({{-0.9f, 0.9f}});
  slopes_are_right<op::Acos>({{-0.9f, 0.9f}});
  slopes_are_right<op::Tanh>({{-4, 4}});
  slopes_are_right<op::Atan2>({{-2, 2}},
                              [](double a, double b, double) { return a * a + b * b > 0.1 && std::fabs(a) > 0.05; });
}
TEST_CASE("operations: where no slope exists the stated one is given", "[ad][limit]") {
  const auto slope = [](auto f, double x) { return std::get<1>(differentiate(f, x)); };
  CHECK(slope([](auto x) { return sqrt(x); }, 0.0) == 0);
  CHECK(slope([](auto x) { return pow(x, 0.5); }, 0.0) == 0);
  CHECK(slope([](auto x) { return pow(x, x); }, 0.0) == 0);
  CHECK(slope([](auto x) { return abs(x); }, 0.0) == 1);
  CHECK(slope([](auto x) { return max(x, 0); }, 0.0) == 0);  // a tie goes to the second
  CHECK(slope([](auto x) { return min(x, 0); }, 0.0) == 0);
  CHECK(slope([](auto x) { return floor(x); }, 1.0) == 0);
  CHECK(slope([](auto x) { return acos(x); }, 1.0) == Approx(-3162.3).epsilon(1e-4));
  CHECK(slope([](auto x) { return asin(x); }, -1.0) == Approx(3162.3).epsilon(1e-4));
  const auto [y, d_y, d_x] = differentiate([](auto a, auto b) { return atan2(a, b); }, 0.0, 0.0);
  CHECK((y == 0 && d_y == 0 && d_x == 0));
}
TEST_CASE("operations: the side of a select that is not taken makes no NaN when guarded", "[ad][limit]") {
  const auto guarded = [](auto x) { return select(x > 0.0f, sqrt(max(x, 1e-12f)), x * x); };
  const auto [y, d] = differentiate(guarded, -3.0);
  CHECK((y == 9 && d == -6));
}
TEST_CASE("operations: what the way back keeps is found", "[ad][value]") {
  CHECK(info<op::Mul>.needs[0] == 0b010u);    // the adjoint of a needs b
  CHECK(info<op::Mul>.needs[1] == 0b001u);
  CHECK(info<op::Add>.needs[0] == 0u);
  CHECK(info<op::Exp>.needs[0] == 0b10u);     // y alone
  CHECK(info<op::Sqrt>.needs[0] == 0b10u);
  CHECK(info<op::Select>.needs[1] == 0b0001u);
  CHECK(info<op::Div>.needs[0] == 0b010u);
  CHECK(info<op::Div>.needs[1] == 0b110u);
}
TEST_CASE("functions: one value in every number, slopes of a long chain right", "[ad][agreement]") {
  const laws::Anywhere anywhere;
  const auto off = [](double x, double y) {
    return std::fabs(x - y) > 0.05 && std::fabs(x) > 0.05 && std::fabs(y) > 0.05 && std::fabs(y + 1.5) > 0.05 &&
           std::fabs(y - 1.7) > 0.05;
  };
  laws::hold(
      [](auto x, auto y) { return sin(x) * cos(y) + tan(0.3f * x) - exp(x * 0.5f) + log(y * y + 0.2f) / (1.5f + x); },
      anywhere, {}, 0.0, 0.0);
  laws::hold([](auto x, auto y) { return pow(x * x + 0.1f, y) + exp2(x) * log2(y * y + 0.3f) + rsqrt(x * x + 1.0f); },
             anywhere, {}, 0.0, 0.0);
  laws::hold([](auto x, auto y) { return asin(0.4f * x) + acos(0.3f * y) * atan2(y, x + 3.0f) + tanh(x - y); },
             anywhere, {}, 0.0, 0.0);
  laws::hold(
      [](auto x, auto y) { return max(x, y) * min(x, y) + abs(x) + clamp(y, -1.5f, 1.7f) + mix(x, y, 0.3f) - (-x); },
      off, {}, 0.0, 0.0);
  laws::hold(
      [](auto x, auto y) {
        return select(x < y, x * x, y * x) + select(!(x > y) || y <= 0.3f, y, x) +
               select(x >= 0.2f && y < 1.0f, x, y * y);
      },
      [](double x, double y) {
        return std::fabs(x - y) > 0.05 && std::fabs(x - 0.2) > 0.05 && std::fabs(y - 1) > 0.05 &&
               std::fabs(y - 0.3) > 0.05;
      },
      {}, 0.0, 0.0);
  laws::hold([](auto x, auto y) { return smoothstep(-3.0f, 3.0f, x) * floor(y + 0.01f); },
             [](double, double y) { return std::fabs(y + 0.01 - std::round(y + 0.01)) > 0.05; }, {}, 0.0, 0.0);
}
