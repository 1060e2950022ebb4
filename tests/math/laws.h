// tests/math/laws.h -- what holds for every differentiable function: one value in every number, and right slopes
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/ad/check.h>
#include <burnish/ad/dual.h>
#include <burnish/math/vec.h>
#include <burnish_test.h>

namespace laws {

/// A point inside the ranges of p..., rounded to float, so that every number type stands on the same one.
template <class Random, class... P> void move(Random& random, P&... p) {
  (burnish::randomize(p, random), ...);
  (burnish::each(
       [](auto& x) {
         if constexpr (burnish::Plain<std::remove_reference_t<decltype(x)>>) {
           const volatile float rounded = float(x);  // g++ 12 at -O2 leaves out a mere x = float(x) on neighbours
           x = rounded;
         }
       },
       p),
   ...);
}
/// One number out of a result: a fixed mixture of its components.
template <class T> constexpr T mixture(const T& y) requires burnish::Number<T> { return y; }
template <class T> constexpr T mixture(const burnish::vec2<T>& y) { return y.x * 0.75f - y.y * 1.25f; }
template <class T> constexpr T mixture(const burnish::vec3<T>& y) { return y.x * 0.75f - y.y * 1.25f + y.z * 0.875f; }

struct Anywhere {
  template <class... P> bool operator()(const P&...) const { return true; }
};

struct How {
  double rounding = 2e-5;  ///< of float against double, a part of the larger of the value and 1
  double step = 1e-2;      ///< first step of the differences, relative
  int points = 1000;
};

/// f(p...) is a number or vector; p are numbers or structs of double and tell the ranges only. At random places where
/// away(p...) holds, f gives one value in float, double, both packets, Var and Dual, and its slopes agree with
/// Richardson differences in double to 1e-7 relative.
template <class F, class Away, class... P> void hold(F f, Away away, How how, P... p) {
  using namespace burnish;
  std::mt19937_64 random(20);
  const auto number = [&](const auto&... a) { return mixture(f(a...)); };
  for (int i = 0; i < how.points; ++i) {
    do move(random, p...);
    while (!away(p...));
    const GradientCheck check = check_gradient(number, Checking{.step = how.step}, p...);
    // Where f is level the difference is rounding alone, and nothing to measure the slope 0 by.
    const bool level = std::fabs(check.slope) < 1e-12 && std::fabs(check.difference) < 1e-9;
    if (check.verdict != Verdict::right && !level) {
      CAPTURE(check.text());
      REQUIRE(check.verdict == Verdict::right);
    }
    if (i >= 100) continue;
    const double y = number(p...), unit_of = std::max(std::fabs(y), 1.0);
    const auto differs = [&](double other) { return std::isfinite(other) ? std::fabs(other - y) / unit_of : 1e30; };
    const double in_float =
        std::max(differs(number(lift<float>(p)...)), differs(number(lift<Packet<float, 16>>(p)...)[i % 16]));
    const double in_double =
        std::max({differs(number(lift<Packet<double, 8>>(p)...)[i % 8]), differs(number(lift<Var<double>>(p)...).value),
                  differs(number(lift<Dual<double, 2>>(p)...).value)});
    if (in_float > how.rounding || in_double > 1e-12) {
      CAPTURE(check.point, y, in_float, in_double);
      REQUIRE(in_float <= how.rounding);
      REQUIRE(in_double <= 1e-12);
    }
  }
  SUCCEED();
}
template <class F, class... P> void hold(F f, const P&... p) { hold(f, Anywhere{}, How{}, p...); }

}  // namespace laws
