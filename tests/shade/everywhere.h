// tests/shade/everywhere.h -- one line for a differentiable function: all numbers agree, and the slopes are right
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <random>
#include <burnish/ad/check.h>
#include <burnish_test.h>

namespace everywhere {
using namespace burnish;
using Random = std::mt19937;

inline double between(Random& r, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(r);
}
/// Uniform over the part of the unit sphere with z >= low.
inline vec3<double> upward(Random& r, double low) {
  const double z = between(r, low, 1), phi = between(r, -3.14, 3.14), s = std::sqrt(1 - z * z);
  return {s * std::cos(phi), s * std::sin(phi), z};
}
/// In the range that its parameters() give it, off the ends.
template <class P> P inside(Random& r) {
  P p{};
  randomize(p, r);
  return p;
}

/// f(numbers and structs of numbers) -> number, at 1,000 points that draw(random) gives as a tuple of them in double:
/// float, both packets and Var give one value (float within `rounding` of the value or of `scale`), and the gradient
/// agrees with differences to 1e-7 of itself. draw keeps off the edges of f; `step`: the first of the differences.
template <class F, class Draw>
void holds(F f, Draw draw, double rounding = 1e-5, double scale = 1e-3, double step = 1e-2) {
  Random random(7);
  int wrong = 0, undecided = 0;
  double worst_float = 0, worst_packet = 0, worst_double = 0;
  std::string text, rounded;
  for (int i = 0; i < 1000; ++i)
    std::apply(
        [&](const auto&... a) {
          const double y = f(a...), size = std::max(std::fabs(y), scale);
          const auto off = [&](double x) { return std::isfinite(x) ? std::fabs(x - y) / size : 1e30; };
          worst_float = std::max(worst_float, off(f(lift<float>(a)...)));
          worst_packet = std::max(worst_packet, off(f(lift<Packet<float, 16>>(a)...)[i % 16]));
          worst_double = std::max(worst_double, off(f(lift<Packet<double, 8>>(a)...)[i % 8]));
          worst_double = std::max(worst_double, off(std::get<0>(differentiate(f, a...))));
          const GradientCheck c = check_gradient(f, Checking{.step = step}, a...);
          if (std::max(worst_float, worst_packet) >= rounding && rounded.empty())
            rounded = "float " + std::to_string(double(f(lift<float>(a)...))) + " for " + std::to_string(y) + " at " +
                      c.point;
          wrong += c.verdict == Verdict::wrong;
          undecided += c.verdict == Verdict::undecided;
          if (c.verdict != Verdict::right && text.empty()) text = c.text();
        },
        draw(random));
  INFO(text);
  INFO(rounded);
  CHECK(wrong == 0);
  CHECK(undecided == 0);
  CHECK(worst_float < rounding);
  CHECK(worst_packet < rounding);
  CHECK(worst_double < 1e-10);
}
}  // namespace everywhere
