// tests/reference/errors.h -- how far burnish is from another renderer's numbers
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <burnish/ad/differentiate.h>
#include <record.h>
#include "npy.h"

namespace reference {

/// The worst |ours - theirs| / max(|theirs|, scale) of many; what is not a number counts as 1e30.
class Errors {
public:
  /// allowed: how far theirs may be off by its own rounding alone; it is taken from the difference.
  void add(double ours, double theirs, double scale = 0, double allowed = 0) {
    const double size = std::max({std::fabs(theirs), scale, 1e-30}), off = std::fabs(ours - theirs);
    const double error = std::max(off - allowed, 0.0) / size, plain = off / std::max(std::fabs(theirs), 1e-30);
    worst_ = std::max(worst_, std::isfinite(off) ? error : 1e30);
    unforgiven_ = std::max(unforgiven_, std::isfinite(off) ? off / size : 1e30);
    beyond_ += !(plain <= 1e-5);
    ++points_;
  }
  double worst() const { return worst_; }
  long points() const { return points_; }
  void claim(const std::string& what, const std::string& kind, const std::string& against, double tolerance) const {
    record::claim(what, kind, against, tolerance, worst_, points_);
  }
  /// The same with nothing allowed.
  void claim_unforgiven(const std::string& what, const std::string& kind, const std::string& against,
                        double tolerance) const {
    record::claim(what, kind, against, tolerance, unforgiven_, points_);
  }
  /// The share of the points that are off by more than 1e-5 of theirs alone, whatever the scale.
  void claim_share(const std::string& what, const std::string& kind, const std::string& against, double most) const {
    record::claim(what, kind, against + "; share of points off by more than 1e-5 of it alone", most,
                  double(beyond_) / double(points_), points_);
  }

private:
  double worst_ = 0, unforgiven_ = 0;
  long beyond_ = 0, points_ = 0;
};

/// f(i, numbers...) -> number at all points of the arrays <name>_value and <name>_by_<parameter>, in double and in
/// float; draw(i) gives its numbers as a tuple. A slope may be off in units of itself or of value / parameter, the
/// greater: near a slope's zero no renderer in single precision has digits of it.
template <class F, class Draw>
void agrees(const std::string& what, const std::string& theirs, const std::string& name,
            const std::vector<std::string>& parameters, F f, Draw draw, double value_tolerance,
            double slope_tolerance) {
  const Array value = load(name + "_value");
  std::vector<Array> slopes;
  for (const std::string& p : parameters) slopes.push_back(load(name + "_by_" + p));
  const auto in = [&]<class T>(T) {
    Errors of_value;
    std::vector<Errors> of_slopes(parameters.size());
    for (std::size_t i = 0; i < value.size(); ++i)
      std::apply(
          [&](auto... a) {
            const double at[] = {double(a)...};
            const auto all = burnish::differentiate([&](auto... x) { return f(i, x...); }, T(a)...);
            of_value.add(double(std::get<0>(all)), value(i));
            const auto slope = [&](std::size_t k, T ours) {
              of_slopes[k].add(double(ours), slopes[k](i), std::fabs(value(i) / at[k]));
            };
            [&]<std::size_t... K>(std::index_sequence<K...>) {
              (slope(K, std::get<K + 1>(all)), ...);
            }(std::index_sequence_for<decltype(a)...>{});
          },
          draw(i));
    of_value.claim(what, "value", theirs + ", relative", value_tolerance);
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      of_slopes[k].claim(what, "gradient",
                         theirs + " by " + parameters[k] + ", relative to max(slope, value / parameter)",
                         slope_tolerance);
      of_slopes[k].claim_share(what, "gradient", theirs + " by " + parameters[k], 0.1);
    }
  };
  in(double());
  in(float());
}

}  // namespace reference
