// burnish/twin/pose_squares.h -- how far a mesh in a pose is off a photo's mask and edges, as least squares
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/twin/align_edges.h>
#include <burnish/twin/silhouette.h>

namespace burnish {

/// What a pose is fitted to.
struct PoseTarget {
  Window window;
  Mask mask;                        // of the window
  Mask known = {};                  // of the window: 0 where nobody knows whether the vehicle is there; or empty
  const EdgeField* edges = nullptr; // of the same window
  float edge_weight = 1;            // of the photo's edges against the outline
};
namespace detail {
/// Solves a x = b in place by Cholesky's way; false where a is not positive definite.
template <std::size_t N> bool solve(std::array<std::array<double, N>, N> a, std::array<double, N>& b) {
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double s = a[i][j];
      for (std::size_t k = 0; k < j; ++k) s -= a[i][k] * a[j][k];
      if (i != j) a[i][j] = s / a[j][j];
      else if (s > 0) a[i][i] = std::sqrt(s);
      else return false;
    }
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
    b[i] /= a[i][i];
  }
  for (std::size_t i = N; i-- > 0;) {
    for (std::size_t k = i + 1; k < N; ++k) b[i] -= a[k][i] * b[k];
    b[i] /= a[i][i];
  }
  return true;
}

/// Least squares of a pose's misfit, with Gauss' and Newton's curvature.
struct PoseSquares {
  static constexpr std::size_t n = EdgeField::n;
  double loss = 0;
  std::array<double, n> slope{};
  std::array<std::array<double, n>, n> curvature{};

  /// Of mask - target on pixels and on blocks of 2, 4, ... of them, each level with one weight a pixel's area: the
  /// coarse ones see far, the fine ones see well.
  void add_mask(const Silhouette& seen, const PoseTarget& target, const StretchedPose<float>& pose,
                bool with_slopes) {
    const int w = target.window.width, h = target.window.height;
    const auto known = [&](int p) { return target.known.width ? double(target.known.values[std::size_t(p)]) : 1.0; };
    int levels = 1;
    while ((std::max(w, h) >> levels) > 6) ++levels;
    struct Row {
      int pixel;
      std::array<double, n> d;
    };
    std::vector<Row> rows;
    if (with_slopes) {
      const auto project = [&](const auto& m, const vec3<float>& p) { return target.window.project(m, p); };
      seen.each_slope(pose, project, [&](int pixel, const auto& d) {
        if (!(known(pixel) > 0)) return;
        rows.push_back({pixel, d});
        for (double& x : rows.back().d) x *= known(pixel);
      });
    }
    for (int l = 0; l < levels; ++l) {
      const int across = (w >> l) + 1;
      const auto block = [&](int pixel) { return std::size_t((pixel / w >> l) * across + (pixel % w >> l)); };
      std::vector<double> rest(std::size_t(across) * std::size_t((h >> l) + 1));
      for (int p = 0; p < w * h; ++p)
        rest[block(p)] +=
            known(p) * (double(seen.mask.values[std::size_t(p)]) - double(target.mask.values[std::size_t(p)]));
      const double weight = 1.0 / (double(1 << l) * double(1 << l));  // the squared sum over a block, by its area
      for (const double r : rest) loss += weight * r * r;
      if (!with_slopes) continue;
      std::vector<std::array<double, n>> jacobian(rest.size());
      for (const Row& row : rows)
        for (std::size_t i = 0; i < n; ++i) jacobian[block(row.pixel)][i] += row.d[i];
      for (std::size_t b = 0; b < rest.size(); ++b)
        for (std::size_t i = 0; i < n; ++i) {
          slope[i] += weight * jacobian[b][i] * rest[b];
          for (std::size_t j = 0; j < n; ++j) curvature[i][j] += weight * jacobian[b][i] * jacobian[b][j];
        }
    }
  }
  /// weight: of the mean misfit of all points.
  void add_edges(const EdgeField& field, const std::vector<EdgePoint>& points, const StretchedPose<float>& pose,
                 double weight, bool with_slopes) {
    const EdgeField::Sum sum = field.at(points, pose, with_slopes);
    loss += weight * sum.loss;
    for (std::size_t i = 0; i < n; ++i) {
      slope[i] += 0.5 * weight * sum.slope[i];  // as for the mask: half the loss's slope goes with J^T J
      for (std::size_t j = 0; j < n; ++j) curvature[i][j] += 0.5 * weight * sum.curvature[i][j];
    }
  }
  /// A number that is usually near 0, by 1 or so: place is it, d its slope by parameter i, e that by j.
  void add_usual(std::size_t i, double place, double d, double weight, std::size_t j = 0, double e = 0) {
    loss += weight * place * place;
    slope[i] += weight * place * d, curvature[i][i] += weight * d * d;
    if (e == 0) return;
    slope[j] += weight * place * e, curvature[j][j] += weight * e * e;
    curvature[i][j] += weight * d * e, curvature[j][i] += weight * d * e;
  }
  /// Parameters that are not free neither move nor count.
  template <class F> void hold(F free) {
    for (std::size_t i = 0; i < n; ++i) {
      if (free(i)) continue;
      for (std::size_t j = 0; j < n; ++j) curvature[i][j] = curvature[j][i] = 0;
      curvature[i][i] = 1, slope[i] = 0;
    }
  }
};
}  // namespace detail

}  // namespace burnish
