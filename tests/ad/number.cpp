// tests/ad/number.cpp -- what the compiler computes of constants is what the C library computes
// SPDX-License-Identifier: Apache-2.0
#include <burnish/ad/number.h>
#include <burnish_test.h>
#include <array>

// Named in full: unqualified, a plain number outside of namespace burnish finds the C library's function first.
namespace {
constexpr int n = 21;
/// f at 21 numbers from low to high, by the compiler.
template <class T, class F> constexpr std::array<T, n> table(F f, T low, T high) {
  std::array<T, n> y{};
  for (int i = 0; i < n; ++i) y[std::size_t(i)] = f(low + (high - low) * T(i) / T(n - 1));
  return y;
}
template <class T, class F> void agree(F f, const std::array<T, n>& by_compiler, T low, T high, double within) {
  for (int i = 0; i < n; ++i) {
    volatile T x = low + (high - low) * T(i) / T(n - 1);
    const T at_run_time = f(x);
    CAPTURE(i, double(x), double(by_compiler[std::size_t(i)]), double(at_run_time));
    CHECK(std::fabs(double(by_compiler[std::size_t(i)]) - double(at_run_time)) <=
          within * std::max(1.0, std::fabs(double(at_run_time))));
  }
}
}  // namespace

#define BURNISH_SAME(name, low, high)                                                    \
  {                                                                                      \
    INFO(#name);                                                                         \
    constexpr auto f = [](auto x) { return burnish::name(x); };                                   \
    constexpr auto by_compiler = table<double>(f, low, high);                            \
    agree<double>(f, by_compiler, low, high, 4e-15);                                      \
    constexpr auto in_float = table<float>(f, low, high);                                \
    agree<float>(f, in_float, low, high, 1.2e-7);                                         \
  }

TEST_CASE("numbers: functions of constants are the C library's", "[ad][agreement]") {
  BURNISH_SAME(sqrt, 0, 100)
  BURNISH_SAME(rsqrt, 0.01, 100)
  BURNISH_SAME(exp, -30, 8)
  BURNISH_SAME(log, 1e-6, 1e4)
  BURNISH_SAME(exp2, -10, 10)
  BURNISH_SAME(log2, 1e-6, 1e4)
  BURNISH_SAME(sin, -20, 20)
  BURNISH_SAME(cos, -20, 20)
  BURNISH_SAME(tan, -1.4, 1.4)
  BURNISH_SAME(asin, -1, 1)
  BURNISH_SAME(acos, -1, 1)
  BURNISH_SAME(tanh, -12, 12)
  BURNISH_SAME(floor, -3, 3.2)
  BURNISH_SAME(abs, -3, 3.2)
}
TEST_CASE("numbers: functions of two constants are the C library's", "[ad][agreement]") {
  constexpr auto power = [](auto x) { return burnish::pow(x, 2.2f); };
  constexpr auto p = table<double>(power, 0.01, 5);
  agree<double>(power, p, 0.01, 5, 1e-14);
  constexpr auto angle = [](auto x) { return burnish::atan2(x, -0.3f) + burnish::atan2(0.2f * x, x); };
  constexpr auto a = table<double>(angle, -2, 2.1);
  agree<double>(angle, a, -2, 2.1, 1e-14);
}
TEST_CASE("numbers: edges in constant expressions", "[ad][limit]") {
  static_assert(burnish::sqrt(0.0) == 0 && burnish::sqrt(4.0) == 2);
  static_assert(burnish::exp(-1000.0) == 0 && burnish::exp(0.0) == 1);
  static_assert(burnish::floor(-0.5) == -1 && burnish::floor(2.0) == 2 && burnish::floor(1e300) == 1e300);
  static_assert(burnish::log(0.0) == -std::numeric_limits<double>::infinity());
  static_assert(burnish::max(3.0f, 0) == 3 && burnish::min(3.0, 5) == 3 && burnish::select(true, 1.0f, 2) == 1);
  constexpr double root_of_negative = burnish::sqrt(-1.0), log_of_negative = burnish::log(-1.0);
  CHECK((std::isnan(root_of_negative) && std::isnan(log_of_negative)));
  CHECK(burnish::atan2(0.0, 0.0) == 0);
}
