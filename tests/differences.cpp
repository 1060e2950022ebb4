// tests/differences.cpp -- the part of differences.h that knows numbers only; compiled once for all programs
// SPDX-License-Identifier: Apache-2.0
#include <differences.h>
#include <burnish/ad/replay.h>

namespace differences {
namespace {
using burnish::detail::digits;
using Numbers = Function::Numbers;

/// The recording played over places at once, in packets of floats; back come its values and slopes. The sweep back
/// multiplies zero adjoints, too, and so finds what a tape, which skips them, does not: an infinite slope on the side
/// of a select that is not taken.
struct Played {
  std::vector<float> values;
  std::vector<Numbers> slopes;
};
Played played(const Recording& recording, const std::vector<Numbers>& at) {
  const std::size_t inputs = at.front().size(), n = at.size(), padded = (n + tile - 1) / tile * tile;
  std::vector<std::vector<float>> x(inputs, std::vector<float>(padded)), d = x;
  for (std::size_t i = 0; i < padded; ++i)
    for (std::size_t k = 0; k < inputs; ++k) x[k][i] = float(at[i % n][k]);
  std::vector<const float*> pixels;
  std::vector<float*> d_pixels;
  for (std::size_t k = 0; k < inputs; ++k) pixels.push_back(x[k].data()), d_pixels.push_back(d[k].data());
  Environment e;
  e.pixels = pixels.data(), e.d_pixels = d_pixels.data();
  Played result;
  result.values.resize(padded);
  const std::vector<float> ones(padded, 1.0f);
  float* const image = result.values.data();
  const float* const d_image = ones.data();
  const Replay replay(recording, true, true);
  Replay::State state;
  replay.begin(state, e);
  for (std::size_t i = 0; i < padded; i += tile) replay.packet(state, e, int(i), &image, &d_image);
  replay.end(state, e);
  for (std::size_t i = 0; i < n; ++i) {
    Numbers& s = result.slopes.emplace_back();
    for (std::size_t k = 0; k < inputs; ++k) s.push_back(double(d[k][i]));
  }
  return result;
}
bool finite(const Numbers& x) {
  return std::all_of(x.begin(), x.end(), [](double a) { return std::isfinite(a); });
}
std::string text(const std::vector<std::string>& names, const Numbers& x) {
  std::string all;
  for (std::size_t i = 0; i < x.size(); ++i) all += (i ? ", " : "") + names[i] + " = " + digits(x[i], 17);
  return all;
}

/// The slope to one side of x, extrapolated to step zero, and how sure it is; not a number where f is none.
template <class F> burnish::detail::Difference one_sided(F f, double x, double side) {
  const double here = f(x);
  burnish::detail::Difference best{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()};
  double before[4] = {}, step = 1e-2 * std::max(std::fabs(x), 0.1);
  for (int depth = 0; step > 1e-12; step /= 4, ++depth) {
    const volatile double to = x + side * step;
    double row[4] = {(f(to) - here) / (to - x)};
    for (int j = 1; j < 4; ++j) row[j] = row[j - 1] + (row[j - 1] - before[j - 1]) / (std::pow(4, j) - 1);
    const double e = std::fabs(row[2] - before[2]) + std::fabs(row[3] - row[2]) + 1e-15 * std::fabs(here) / step;
    if (depth >= 3 && e < best.uncertainty) best = {row[3], e};
    std::copy(row, row + 4, before);
  }
  return best;
}
/// Whether d is the slope to the left, to the right or between them.
template <class F> bool one_sided_slope(F f, double x, double d) {
  const auto left = one_sided(f, x, -1), right = one_sided(f, x, 1);
  const double low = std::fmin(left.slope, right.slope), high = std::fmax(left.slope, right.slope);
  if (std::isnan(low)) return true;  // a place alone
  double slack = 1e-3 * std::max({std::fabs(low), std::fabs(high), std::fabs(d), 1e-3});
  for (const auto& side : {left, right})
    if (std::isfinite(side.uncertainty)) slack += 10 * side.uncertainty;
  return d >= low - slack && d <= high + slack;
}

/// The first that went wrong, in words, and how many did.
struct Wrong {
  int count = 0;
  std::string first;
  void add(const std::string& what) {
    if (count++ == 0) first = what;
  }
};
}  // namespace

void round_to_float(double& x) {
  const volatile float rounded = float(x);  // g++ 12 at -O2 leaves out a mere x = float(x) on neighbours
  x = rounded;
}

void check(const std::string& names, Function& f, const How& how, const std::string& hard) {
  Random first(20);
  f.draw(first);  // what is Fixed is as it is drawn
  const std::vector<std::string> inputs = f.names();
  Recording recording;
  const bool recorded = f.record(recording);
  Random random(20);
  Wrong odd, slope, value;
  double worst = 0;
  int decided = 0;
  std::vector<Numbers> places;
  std::vector<double> values;
  Numbers d, d_float, direction(inputs.size());
  for (std::size_t k = 0; k < direction.size(); ++k) direction[k] = 1 - 0.375 * double(k % 5);
  // Everything at one place but for the differences; false where something is no number.
  const auto one_value = [&](const Numbers& x, int lane, bool compare) {
    const double y = f.in_double(x), size = std::max(std::fabs(y), how.scale);
    double dual_slope = 0, by_tape = 0, by_tape_size = 0;
    const double in_float[] = {f.in_float(x), f.in_packet(x, lane % 16), recorded ? y : f.taped_in_float(x, d_float)};
    const double in_double[] = {f.in_double_packet(x, lane % 8), f.taped(x, d), f.dual(x, direction, dual_slope)};
    for (std::size_t k = 0; k < d.size(); ++k)
      by_tape += d[k] * direction[k], by_tape_size += std::fabs(d[k] * direction[k]);
    bool numbers = std::isfinite(y) && std::isfinite(dual_slope) && finite(d) && (recorded || finite(d_float));
    for (int k = 0; k < 3; ++k) numbers = numbers && std::isfinite(in_float[k]) && std::isfinite(in_double[k]);
    if (!numbers) odd.add("not a number at " + text(inputs, x));
    for (int k = 0; k < 3 && compare; ++k) {
      if (!(std::fabs(in_float[k] - y) <= how.rounding * size))
        value.add("float says " + digits(in_float[k], 9) + ", double " + digits(y, 9) + " at " + text(inputs, x));
      if (!(std::fabs(in_double[k] - y) <= how.exact * size))
        value.add("double says " + digits(in_double[k], 17) + " and " + digits(y, 17) + " at " + text(inputs, x));
    }
    if (compare && !(std::fabs(dual_slope - by_tape) <= 1e-9 * by_tape_size + 1e-12 * size))
      slope.add("Dual says " + digits(dual_slope, 17) + ", Var " + digits(by_tape, 17) + " at " + text(inputs, x));
    places.push_back(x);
    values.push_back(y);
  };
  const auto by_recording = [&](bool compare) {
    if (recorded && !places.empty()) {
      const Played p = played(recording, places);
      for (std::size_t i = 0; i < places.size(); ++i) {
        const double y = double(p.values[i]), size = std::max(std::fabs(values[i]), how.scale);
        if (!std::isfinite(y) || !finite(p.slopes[i])) odd.add("recorded, not a number at " + text(inputs, places[i]));
        if (compare && !(std::fabs(y - values[i]) <= how.rounding * size))
          value.add("recorded it says " + digits(y, 9) + ", in double " + digits(values[i], 9) + " at " +
                    text(inputs, places[i]));
      }
    }
    places.clear(), values.clear();
  };

  for (int i = 0; i < record::points(); ++i) {
    Numbers x = f.draw(random);
    for (double& a : x) round_to_float(a);
    one_value(x, i, true);
    const auto call = [](void* self, const Numbers& at) { return static_cast<Function*>(self)->in_double(at); };
    const GradientCheck c =
        burnish::detail::check_slopes(call, &f, inputs, x, d, Checking{.step = how.step});
    if (c.verdict != Verdict::right) slope.add(c.text());
    if (c.verdict == Verdict::undecided) continue;
    ++decided;
    worst = std::isfinite(c.error) ? std::max(worst, c.error) : c.error;
  }
  by_recording(true);
  INFO(names << "\n" << odd.first << "\n" << value.first << "\n" << slope.first);
  CHECK(odd.count == 0);
  CHECK(value.count == 0);
  CHECK(slope.count == 0);
  record::claim(names, "gradient", "Richardson differences in double", 1e-7, worst, decided);
  if (hard.empty()) return;
  odd = slope = {};
  int n = 0;
  for (bool one_sided = true;; one_sided = false) {
    int i = 0;
    for (Numbers x = f.hard(0, one_sided); !x.empty(); x = f.hard(std::size_t(++i), one_sided)) {
      for (double& a : x) round_to_float(a);
      one_value(x, i, false);
      for (std::size_t k = 0; k < x.size() && one_sided; ++k) {
        const auto moved = [&](double to) {
          Numbers at = x;
          at[k] = to;
          return f.in_double(at);
        };
        if (!one_sided_slope(moved, x[k], d[k]))
          slope.add("the slope " + digits(d[k], 6) + " by " + inputs[k] + " is neither side's at " + text(inputs, x));
      }
    }
    n += i;
    by_recording(false);
    if (!one_sided) break;
  }
  INFO(odd.first << "\n" << slope.first);
  record::claim(names, "hard places", hard, 0, odd.count + slope.count, n);
}

}  // namespace differences
