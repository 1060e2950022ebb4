// burnish/fit/adam.h -- Adam (Kingma and Ba 2015), in units of every parameter's range
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <string>
#include <vector>
#include <burnish/ad/model.h>
#include <burnish/scene/error.h>

namespace burnish {

/// A parameter with a range steps by about rate times the range's width and stays inside; one without, by rate. Texels
/// of a fitted image count as numbers of the image's range. epsilon stands beside the root of the corrected second
/// moment.
struct Adam {
  float rate = 0.02f, beta1 = 0.9f, beta2 = 0.999f, epsilon = 1e-8f;
  // What a later step needs: a fit goes on to the same bits from a copy of these.
  int steps = 0;
  std::vector<float> first{}, second{};

  /// One step down d, the derivative of the loss by model. A derivative that is no number is refused: Error names it.
  template <class M> void step(M& model, const M& d) {
    check(d);
    ++steps;
    const float c1 = 1 - std::pow(beta1, float(steps)), c2 = 1 - std::pow(beta2, float(steps));
    std::vector<Range> ranges;
    for_each_parameter(model, [&](const std::string&, auto&, Range r) { ranges.push_back(r); });
    std::size_t i = 0, leaf = 0;
    const auto one = [&](float& x, float g, Range r) {
      if (first.size() <= i) first.resize(i + 1), second.resize(i + 1);
      float &m = first[i], &v = second[i++];
      m = beta1 * m + (1 - beta1) * g;
      v = beta2 * v + (1 - beta2) * g * g;
      const bool open = r.low <= anything.low || r.high >= anything.high;
      // In units of the range the slope is g times the width; Adam's quotient does not change by it, epsilon's weight
      // does.
      const float width = open ? 1 : r.high - r.low;
      x -= rate * width * (m / c1) / (std::sqrt(v / c2) + epsilon / std::max(width, 1e-6f));
      x = std::min(std::max(x, r.low), r.high);
    };
    each(
        [&]<class X>(X& x, const X& g) {
          const Range r = ranges[leaf++];
          if constexpr (Plain<X>) one(x, g, r);
          else
            for (std::size_t k = 0; k < x.texels.size(); ++k) one(x.texels[k], g.texels[k], r);
        },
        model, d);
  }

  /// Throws Error where a derivative is no number: "d flakes.amount is nan at step 12".
  template <class M> void check(const M& d) const {
    for_each_parameter(d, [&]<class X>(const std::string& name, const X& g, Range) {
      const auto one = [&](float x) {
        if (!std::isfinite(x))
          throw Error("d " + name + " is " + (std::isnan(x) ? "nan" : "infinite") + " at step " +
                      std::to_string(steps + 1));
      };
      if constexpr (Plain<X>) one(g);
      else
        for (const float x : g.texels) one(x);
    });
  }
};

}  // namespace burnish
