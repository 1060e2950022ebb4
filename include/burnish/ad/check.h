// burnish/ad/check.h -- is this gradient right? Richardson differences in double say, or say that they cannot
// SPDX-License-Identifier: Apache-2.0
//
// A difference with a fixed step misjudges a right slope near an edge and a wrong one where rounding rules. Here the central
// difference is taken at eight steps, each half the last, and extrapolated (Richardson 1911; Ridders 1982); how well
// the extrapolations agree is the judge's own error. Where that error is not small, or where the slopes to the left and to
// the right do not meet, the verdict is `undecided`: an edge (max, floor, a lattice line) lies at the point or within the
// steps, or the function is too rough for its rounding.
#pragma once
#include <algorithm>
#include <cstdio>
#include <burnish/ad/differentiate.h>

namespace burnish {

enum class Verdict { right, wrong, undecided };

namespace detail {
inline std::string digits(double x, int count) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", count, x);
  return text;
}
}  // namespace detail

/// The worst parameter found.
struct GradientCheck {
  Verdict verdict = Verdict::right;
  double error = 0;  ///< |slope - difference| / scale; scale is the larger of the two, or 1 % of the largest slope
  std::string parameter;     ///< its name; arguments are numbered: "0.base_color.x"
  double slope = 0, difference = 0, uncertainty = 0;  ///< uncertainty of the difference, in units of scale
  std::string point;         ///< all parameters at the point, "name = value"
  int checked = 0, undecided = 0;

  explicit operator bool() const { return verdict != Verdict::wrong; }
  std::string text() const {
    const char* const words = verdict == Verdict::right ? "right" : verdict == Verdict::wrong ? "wrong" : "undecided";
    return std::string(words) + ": d/d " + parameter + " = " + detail::digits(slope, 9) + ", differences say " +
           detail::digits(difference, 9) + " +- " + detail::digits(uncertainty, 3) + " of scale, error " +
           detail::digits(error, 3) + " at " + point;
  }
};

namespace detail {
struct Difference {
  double slope, uncertainty;
};
/// d f / d x at x by central differences, extrapolated to step zero.
template <class F> Difference difference(F f, double x, double step) {
  constexpr int levels = 8;
  double table[levels][levels], best = 0, spread = std::numeric_limits<double>::infinity(), bend[levels];
  const double here = f(x);
  for (int i = 0; i < levels; ++i, step /= 2) {
    const volatile double up = x + step, down = x - step;
    const double above = f(up), below = f(down);
    table[i][0] = (above - below) / (up - down);
    bend[i] = std::fabs((above - here) / (up - x) - (here - below) / (x - down));
    // A value of many operations is off by a few units in its last place.
    const double rounding =
        4 * std::numeric_limits<double>::epsilon() * std::max(std::fabs(above), std::fabs(below)) / step;
    double power = 4;
    for (int j = 1; j <= i; ++j, power *= 4) {
      table[i][j] = table[i][j - 1] + (table[i][j - 1] - table[i - 1][j - 1]) / (power - 1);
      // Two neighbours in the table can agree by chance; three hardly do.
      double e = std::max(std::fabs(table[i][j] - table[i][j - 1]), std::fabs(table[i][j] - table[i - 1][j - 1]));
      if (j < i) e = std::max(e, std::fabs(table[i][j] - table[i - 1][j]));
      e = std::max(e, rounding);
      if (e < spread) {
        spread = e;
        best = table[i][j];
      }
    }
  }
  // Left and right slopes of a smooth function approach each other as the step does zero; at a kink they keep their distance.
  if (bend[levels - 1] > 0.5 * bend[0] && bend[levels - 1] > 1e-6 * std::fabs(best))
    spread = std::max(spread, bend[levels - 1]);
  return {best, spread};
}
}  // namespace detail

/// How strictly to check.
struct Checking {
  double tolerance = 1e-7;  ///< the largest error called right, and the largest uncertainty called decided
  double step = 1e-2;       ///< the first, relative to max(|x|, 0.1)
};
namespace detail {
/// check_gradient with its types taken off: a function of numbers (called with `self`), the names of these, the point
/// and the slopes there.
inline GradientCheck check_slopes(double (*call)(void* self, const std::vector<double>&), void* self,
                                  const std::vector<std::string>& names, std::vector<double> at,
                                  const std::vector<double>& slopes, const Checking& how) {
  const auto f = [&](const std::vector<double>& x) { return call(self, x); };
  const double f0 = std::fabs(f(at));
  double largest = 0;
  for (const double s : slopes) largest = std::max(largest, std::fabs(s));
  GradientCheck worst;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const double x0 = at[i], first = how.step * std::max(std::fabs(x0), 0.1);
    const auto numeric = difference([&](double x) { at[i] = x; return f(at); }, x0, first);
    at[i] = x0;
    const double scale = std::max({std::fabs(slopes[i]), std::fabs(numeric.slope), 0.01 * largest, 1e-9 * f0, 1e-30});
    // Where f is level, slope and difference are both nothing but rounding.
    const double nothing = 1e-9 * std::max(f0, 1e-3);
    const bool level = std::fabs(slopes[i]) <= nothing && std::fabs(numeric.slope) <= nothing;
    const double error = level ? 0 : std::fabs(slopes[i] - numeric.slope) / scale, doubt = numeric.uncertainty / scale;
    Verdict v = error <= how.tolerance ? Verdict::right
                : doubt <= how.tolerance ? Verdict::wrong
                                         : Verdict::undecided;
    if (!std::isfinite(slopes[i])) v = Verdict::wrong;
    ++worst.checked;
    worst.undecided += v == Verdict::undecided;
    const auto badness = [](Verdict w) { return w == Verdict::wrong ? 2 : w == Verdict::undecided ? 1 : 0; };
    if (worst.parameter.empty() || badness(v) > badness(worst.verdict) ||
        (v == worst.verdict && !(error <= worst.error))) {
      worst.verdict = v;
      worst.error = error;
      worst.parameter = names[i];
      worst.slope = slopes[i];
      worst.difference = numeric.slope;
      worst.uncertainty = doubt;
    }
  }
  for (std::size_t i = 0; i < at.size(); ++i)
    worst.point += (i ? ", " : "") + names[i] + " = " + digits(at[i], 17);
  return worst;
}
}  // namespace detail

/// Checks d f / d args at one point. f takes what differentiate takes; args are double, or structs of double.
template <class F, class... Args> GradientCheck check_gradient(F&& f, const Checking& how, const Args&... args) {
  const auto all = differentiate(f, args...);
  std::vector<std::string> names;
  std::vector<double> at, slopes;
  std::tuple<Args...> point{args...};
  std::apply([&](auto&... a) {
    int k = 0;
    ((for_each_parameter(a, [&]<class X>(const std::string& n, X& x, Range) {
       if constexpr (Plain<X>) names.push_back(std::to_string(k) + (n.empty() ? "" : "." + n)), at.push_back(x);
     }), ++k), ...);
  }, point);
  const auto each_number = [](auto& t, auto visit) {
    std::apply([&](auto&... a) { (each([&]<class X>(X& x) { if constexpr (Plain<X>) visit(x); }, a), ...); }, t);
  };
  auto d = [&]<std::size_t... I>(std::index_sequence<I...>) {
    return std::tuple<Args...>{std::get<I + 1>(all)...};
  }(std::index_sequence_for<Args...>{});
  each_number(d, [&](double& x) { slopes.push_back(x); });
  auto value = [&](const std::vector<double>& x) {
    std::size_t i = 0;
    each_number(point, [&](double& to) { to = x[i++]; });
    return double(std::apply([&](const auto&... a) { return f(a...); }, point));
  };
  const auto call = [](void* self, const std::vector<double>& x) { return (*static_cast<decltype(value)*>(self))(x); };
  return detail::check_slopes(call, &value, names, at, slopes, how);
}
template <class F, class First, class... Rest>
GradientCheck check_gradient(F&& f, const First& first,
                             const Rest&... rest) requires(!std::is_same_v<First, Checking>) {
  return check_gradient(f, Checking{}, first, rest...);
}

/// Every number of p somewhere inside its range, open ranges taken as -2 to 2. margin keeps off both ends, as a part of the
/// width. Random is any generator of the standard's kind, the numbers the same in every library.
template <class P, class Random> void randomize(P& p, Random& random, double margin = 0.01) {
  for_each_parameter(p, [&]<class X>(const std::string&, X& x, Range range) {
    if constexpr (Plain<X>) {
      const double low = range.low <= anything.low ? -2 : range.low,
                   high = range.high >= anything.high ? 2 : range.high;
      const double pad = margin * (high - low);
      const double part = double(random() - Random::min()) / double(Random::max() - Random::min());
      x = X(low + pad + (high - low - 2 * pad) * part);
    }
  });
}

}  // namespace burnish
