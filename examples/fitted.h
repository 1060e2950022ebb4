// examples/fitted.h -- the numbers of a fit: held back where the photo tells nothing, found, and how sure
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <functional>
#include <vector>
#include <burnish/fit/fit.h>
#include "settings.h"

namespace fitted {
using namespace burnish;
using fitting::Settings;

/// The diagonal of the inverse of a symmetric positive matrix, n x n row by row, by its Cholesky factor.
inline std::vector<double> inverse_diagonal(std::vector<double> a, int n) {
  const auto at = [&](int i, int j) -> double& { return a[std::size_t(i * n + j)]; };
  for (int j = 0; j < n; ++j) {
    for (int k = 0; k < j; ++k) at(j, j) -= at(j, k) * at(j, k);
    at(j, j) = std::sqrt(at(j, j));
    for (int i = j + 1; i < n; ++i) {
      for (int k = 0; k < j; ++k) at(i, j) -= at(i, k) * at(j, k);
      at(i, j) /= at(j, j);
    }
  }
  const std::size_t size = std::size_t(n);
  std::vector<double> diagonal(size), x(size);
  for (int c = 0; c < n; ++c) {  // column c of the factor's inverse; the sum of its squares is the entry
    for (int i = c; i < n; ++i) {
      double sum = i == c;
      for (int k = c; k < i; ++k) sum -= at(i, k) * x[std::size_t(k)];
      x[std::size_t(i)] = sum / at(i, i);
      diagonal[std::size_t(c)] += x[std::size_t(i)] * x[std::size_t(i)];
    }
  }
  return diagonal;
}

/// The standard deviation of every number of a fitted model, in the order of for_each_parameter; 0 for those that were
/// not free. Gauss-Newton: the covariance is (J^T J / s^2 + P)^-1, J the slopes of the rendered pixels by the numbers
/// (by differences of a hundredth of their ranges), s^2 the variance of what is left, P the prior that a number is
/// anywhere in its range. What is left is alike in neighbours: s^2 is raised by the number of pixels that count as one,
/// found from the sums over squares of 16 x 16 pixels. It tells of the photo's noise and of what the model cannot draw,
/// given the light; the light's own strength is not in it.
template <class M> std::vector<double> deviations(const M& fitted, const std::function<Image(const M&)>& render,
                                                  const Image& photo, const Mask& mask,
                                                  const std::function<bool(const std::string&)>& free) {
  struct Number {
    bool free;
    Range range;
  };
  std::vector<Number> numbers;
  for_each_parameter(fitted, [&](const std::string& name, auto&, Range r) { numbers.push_back({free(name), r}); });
  std::vector<std::size_t> pixels;
  for (std::size_t i = 0; i < std::size_t(mask.width) * std::size_t(mask.height); ++i)
    if (mask.values[i] > 0.5f) pixels.push_back(i);
  const Image middle = render(fitted);
  std::vector<std::vector<float>> slopes;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    if (!numbers[k].free) continue;
    const float width = numbers[k].range.high - numbers[k].range.low;
    M moved = fitted;
    float step = 0;
    std::size_t i = 0;
    each(
        [&](float& x) {
          if (i++ != k) return;
          step = x + 0.01f * width > numbers[k].range.high ? -0.01f : 0.01f;
          x += step * width;
        },
        moved);
    const Image image = render(moved);
    auto& column = slopes.emplace_back();
    for (int c = 0; c < 3; ++c)
      for (const std::size_t p : pixels)
        column.push_back((image.plane(c)[p] - middle.plane(c)[p]) / step);  // by the range
  }
  const int blocks = mask.width / 16 + 1;
  double squares = 0, sums = 0;
  for (int c = 0; c < 3; ++c) {
    std::vector<double> block(std::size_t(blocks) * std::size_t(mask.height / 16 + 1));
    for (const std::size_t p : pixels) {
      const double r = double(middle.plane(c)[p] - photo.plane(c)[p]);
      squares += r * r;
      block[p / std::size_t(mask.width) / 16 * std::size_t(blocks) + p % std::size_t(mask.width) / 16] += r;
    }
    for (const double b : block) sums += b * b;
  }
  const double variance = std::max(squares / std::max<double>(1, 3 * double(pixels.size())), 1e-6);
  const double alike = 3 * std::max(1.0, sums / std::max(squares, 1e-12));  // the three channels err together, too
  const int n = int(slopes.size());
  std::vector<double> matrix(std::size_t(n * n));
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      double sum = 0;
      for (std::size_t p = 0; p < slopes[std::size_t(i)].size(); ++p)
        sum += double(slopes[std::size_t(i)][p]) * double(slopes[std::size_t(j)][p]);
      matrix[std::size_t(i * n + j)] =
          sum / (variance * alike) + (i == j ? 12.0 : 0.0);  // evenly in [0, 1]: variance 1/12
    }
  const std::vector<double> diagonal = inverse_diagonal(matrix, n);
  std::vector<double> out;
  std::size_t k = 0;
  for (const Number& x : numbers)
    out.push_back(x.free ? std::sqrt(diagonal[k++]) * double(x.range.high - x.range.low) : 0);
  return out;
}

/// What the photo does not tell stays near where it began: a parabola over every parameter's range but a colour's, of
/// that strength, added to the loss and to d. Frozen parameters lose their derivative.
template <class M> double hold_back(const M& model, const M& start, M& d, const Settings& settings, float strength) {
  double loss = 0;
  std::vector<std::pair<std::string, Range>> names;
  for_each_parameter(d, [&](const std::string& name, auto&, Range r) { names.push_back({name, r}); });
  std::size_t i = 0;
  each(
      [&](float& slope, const float& x, const float& x0) {
        const auto& [name, range] = names[i++];
        if (settings.frozen(name)) slope = 0;
        else if (name.find("color") == std::string::npos && name.find("behind") == std::string::npos &&
                 name != "mirrored") {
          const float width = range.high - range.low, off = (x - x0) / width;
          loss += double(strength * off * off);
          slope += 2 * strength * off / width;
        }
      },
      d, model, start);
  return loss;
}

/// A part's fit: its state, and what is said about it.
template <class M> struct Fitted {
  FitState<M> state;
  std::vector<double> deviation;  // of every number
  int pixels = 0;                 // that lie on the photo's part
  double seconds = 0;
};
/// A row a number: before, fitted, how sure, range, remarks.
template <class M> void add_rows(std::vector<std::vector<std::string>>& rows, const std::string& of, const M& before,
                                 const Fitted<M>& fitted, const Settings& settings) {
  const auto text = [](const char* format, double a, double b = 0) {
    char t[48];
    std::snprintf(t, sizeof t, format, a, b);
    return std::string(t);
  };
  std::vector<float> old;
  each([&](const float& x) { old.push_back(x); }, before);
  std::size_t i = 0;
  for_each_parameter(fitted.state.best, [&](const std::string& name, const float& x, Range r) {
    const double sure = fitted.deviation.empty() ? 0 : fitted.deviation[i];
    const bool open = sure > 0.2 * double(r.high - r.low);
    rows.push_back({of + " " + name, text("%.3g", old[i++]), text("%.3g", x),
                    sure > 0 ? "+- " + text("%.2g", sure) : "", text("%g to %g", r.low, r.high),
                    settings.frozen(name)       ? "held"
                    : x <= r.low || x >= r.high ? "at its bound"
                    : open                      ? "the photo does not tell"
                                                : ""});
  });
}

}  // namespace fitted
