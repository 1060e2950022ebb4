// tests/ad/operation.cpp -- every operation of the table: its slopes against differences, one value in every number
// SPDX-License-Identifier: Apache-2.0
#include <burnish/ad/replay.h>
#include <differences.h>

using namespace differences;

namespace {
constexpr auto all = [](auto...) { return true; };
template <class Op> constexpr auto applied = [](const auto&... x) { return apply<Op>(x...); };
template <class Op, std::size_t... I>
auto tuple_of(std::index_sequence<I...>, const std::array<double, Op::inputs>& x) {
  return std::tuple{x[I]...};
}
template <class Op> using Inputs = decltype(tuple_of<Op>(std::make_index_sequence<Op::inputs>{}, {}));
/// One operation, its inputs within the given ranges (the last goes on) where away(inputs...) holds.
template <class Op, class Away = decltype(all)>
void right(const std::string& name, std::vector<Range> in, Away away = {}, const Hard<Inputs<Op>>& hard = {}) {
  holds(
      name, applied<Op>,
      [=](Random& r) {
        for (;;) {
          std::array<double, Op::inputs> x;
          for (std::size_t k = 0; k < x.size(); ++k) {
            const Range range = in[std::min(k, in.size() - 1)];
            x[k] = between(r, double(range.low), double(range.high));
          }
          const auto point = tuple_of<Op>(std::make_index_sequence<Op::inputs>{}, x);
          if (std::apply(away, point)) return point;
        }
      },
      {}, hard);
}
constexpr Range wide{-9, 9}, some{-2, 2};
}  // namespace

TEST_CASE("operations: the slopes of arithmetic are its differences", "[ad][gradient]") {
  const auto apart = [](double a, double b) { return std::fabs(a - b) > 0.1; };
  const auto off_zero = [](double a) { return std::fabs(a) > 0.1; };
  right<op::Add>("op::Add", {wide, some});
  right<op::Sub>("op::Sub", {wide, some});
  right<op::Mul>("op::Mul", {wide, some});
  right<op::Div>("op::Div", {wide, {0.2f, 5}});
  right<op::Reciprocal>("op::Reciprocal", {{0.2f, 9}});
  right<op::MulAdd>("op::MulAdd", {wide, some});
  right<op::MulSub>("op::MulSub", {wide, some});
  right<op::SubMul>("op::SubMul", {wide, some});
  right<op::Square>("op::Square", {wide});
  right<op::Dot3>("op::Dot3", {wide, some});
  right<op::Neg>("op::Neg", {wide});
  right<op::Abs>("op::Abs, abs", {wide}, off_zero, {"0", {{0.0}}});
  right<op::Max>("op::Max, max", {some}, apart, {"a tie", {{0.0, 0.0}, {-1.0, -1.0}}});
  right<op::Min>("op::Min, min", {some}, apart, {"a tie", {{0.0, 0.0}, {-1.0, -1.0}}});
  right<op::Less>("op::Less", {some}, apart, {"a tie", {}, {{0.5, 0.5}}});
  right<op::Floor>("op::Floor, floor", {wide}, [](double a) { return std::fabs(a - std::round(a)) > 0.1; },
                   {"whole numbers", {}, {{0.0}, {-1.0}, {3.0}}});
  right<op::Select>("op::Select, select", {some}, [](double c, double, double) { return std::fabs(c - 0.5) > 0.1; });
}
TEST_CASE("operations: the slopes of the elementary functions are their differences", "[ad][gradient]") {
  right<op::Sqrt>("op::Sqrt, sqrt", {{0.01f, 9}}, all, {"0", {}, {{0.0}}});
  right<op::Rsqrt>("op::Rsqrt, rsqrt", {{0.05f, 9}});
  right<op::Exp>("op::Exp, exp", {wide}, all, {"underflow", {{-200.0}}});
  right<op::Log>("op::Log, log", {{0.01f, 9}});
  right<op::Exp2>("op::Exp2, exp2", {wide}, all, {"underflow", {{-200.0}}});
  right<op::Log2>("op::Log2, log2", {{0.01f, 9}});
  right<op::Pow>("op::Pow, pow", {{0.05f, 4}, {-3, 3}}, all, {"0", {}, {{0.0, 0.5}, {0.0, 1.0}, {0.0, 2.5}}});
  right<op::Sin>("op::Sin, sin", {wide}, all, {"0", {{0.0}}});
  right<op::Cos>("op::Cos, cos", {wide}, all, {"0", {{0.0}}});
  right<op::Tan>("op::Tan, tan", {{-1.3f, 1.3f}}, all, {"0", {{0.0}}});
  right<op::Asin>("op::Asin, asin", {{-0.9f, 0.9f}}, all, {"0, the ends", {{0.0}}, {{1.0}, {-1.0}}});
  right<op::Acos>("op::Acos, acos", {{-0.9f, 0.9f}}, all, {"0, the ends", {{0.0}}, {{1.0}, {-1.0}}});
  right<op::Tanh>("op::Tanh, tanh", {{-4, 4}}, all, {"0, far out", {{0.0}, {50.0}, {-50.0}}});
  right<op::Atan2>("op::Atan2, atan2", {some},
                   [](double a, double b) { return a * a + b * b > 0.1 && std::fabs(a) > 0.05; },
                   {"the axes, 0 by 0", {{0.0, 1.0}, {1.0, 0.0}, {-1.0, 0.0}}, {{0.0, 0.0}}});
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
  const auto apart = [](double x, double y) {
    return std::fabs(x - y) > 0.05 && std::fabs(x) > 0.05 && std::fabs(y) > 0.05 && std::fabs(y + 1.5) > 0.05 &&
           std::fabs(y - 1.7) > 0.05 && std::fabs(y + 0.01 - std::round(y + 0.01)) > 0.05;
  };
  const std::string chain = "a chain of elementary functions";
  holds(
      chain,
      [](auto x, auto y) { return sin(x) * cos(y) + tan(0.3f * x) - exp(x * 0.5f) + log(y * y + 0.2f) / (2.5f + x); },
      within(all, 0.0, 0.0));
  holds(
      chain, [](auto x, auto y) { return pow(x * x + 0.1f, y) + exp2(x) * log2(y * y + 0.3f) + rsqrt(x * x + 1.0f); },
      within(all, 0.0, 0.0));
  holds(
      chain, [](auto x, auto y) { return asin(0.4f * x) + acos(0.3f * y) * atan2(y, x + 3.0f) + tanh(x - y); },
      within(all, 0.0, 0.0));
  holds("clamp, mix, smoothstep",
        [](auto x, auto y) {
          return max(x, y) * min(x, y) + abs(x) + clamp(y, -1.5f, 1.7f) + mix(x, y, 0.3f) - (-x) +
                 smoothstep(-3.0f, 3.0f, x) * floor(y + 0.01f);
        },
        within(apart, 0.0, 0.0), {}, {"the ends of clamp and smoothstep", {{3.0, -1.5}, {-3.0, 1.75}, {0.0, 0.0}}});
  holds(
      "a chain of selects",
      [](auto x, auto y) {
        return select(x < y, x * x, y * x) + select(!(x > y) || y <= 0.3f, y, x) +
               select(x >= 0.2f && y < 1.0f, x, y * y);
      },
      within(
          [](double x, double y) {
            return std::fabs(x - y) > 0.05 && std::fabs(x - 0.2) > 0.05 && std::fabs(y - 1) > 0.05 &&
                   std::fabs(y - 0.3) > 0.05;
          },
          0.0, 0.0));
}
