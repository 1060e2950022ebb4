// burnish/twin/refine_pose.h -- from a pose near by to one that covers a mask and has its edges on a photo's
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/twin/align_edges.h>
#include <burnish/twin/silhouette.h>

namespace burnish {

/// The masks' intersection over their union; both of one size.
inline double mask_iou(const Mask& a, const Mask& b) {
  double both = 0, either = 0;
  for (std::size_t i = 0; i < std::size_t(a.width) * std::size_t(a.height); ++i)
    both += double(std::min(a.values[i], b.values[i])), either += double(std::max(a.values[i], b.values[i]));
  return either > 0 ? both / either : 0;
}

/// A pose with how well it is known.
struct MatchedPose {
  Pose<float> pose;       // of the whole photo's size
  vec3<float> stretch{1, 1, 1};  // by which the mesh is longer, higher and wider than it is; see stretched()
  double iou = 0;
  Pose<float> deviation;  // standard deviations, as far as the misfit tells, were it independent by pixel
};

/// What a pose is fitted to.
struct PoseTarget {
  Window window;
  Mask mask;                        // of the window
  Mask known = {};                  // of the window: 0 where nobody knows whether the vehicle is there; or empty
  const EdgeField* edges = nullptr; // of the same window
  float edge_weight = 1;            // of the photo's edges against the outline
};
struct RefineOptions {
  bool fit_focal = false;
  bool fit_shape = false;    ///< whether the mesh may be longer and higher than it is
  bool only_place = false;   ///< keeps the camera's direction, its focal length and the shape
  bool hidden = true;        ///< whether something may stand before the vehicle: see hidden_by_others
  int steps = 30;
  float usual = 0.02f;       ///< how much it counts that photos are taken upright, from about a person's height
  float usual_focal = 1.2f;  ///< in widths of the picture: where the focal length goes when the photo does not tell
  const Tones* tones = nullptr;  ///< of the mesh; where the target has edges
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

/// What of the mesh's mask something else may hide: where the photo's mask lacks more than a seam, as wide as a share
/// of the vehicle. 1 there, else 0.
inline Mask hidden_by_others(const Mask& mesh, const Mask& photo) {
  double area = 0;
  Mask lacking(mesh.width, mesh.height);
  for (std::size_t i = 0; i < std::size_t(mesh.width) * std::size_t(mesh.height); ++i)
    lacking.values[i] = std::max(mesh.values[i] - photo.values[i], 0.0f), area += double(photo.values[i]);
  const float seam = 0.03f * float(std::sqrt(area));
  Mask wide = blurred(lacking, seam);
  for (float& x : wide.values) x = x > 0.85f ? 1.0f : 0.0f;
  wide = blurred(wide, 1.5f * seam);
  for (std::size_t i = 0; i < std::size_t(mesh.width) * std::size_t(mesh.height); ++i)
    wide.values[i] = lacking.values[i] > 0 && wide.values[i] > 0.02f ? 1.0f : 0.0f;
  return wide;
}
}  // namespace detail

/// Levenberg's and Marquardt's way (Marquardt 1963) from a pose near by. Where the target has edges, those of the mesh
/// are found at the start and again half-way.
inline MatchedPose refine_pose(const Raycaster& scene, const MeshEdges& edges, PoseTarget target,
                               const MatchedPose& start, const RefineOptions& options) {
  using detail::PoseSquares;
  constexpr std::size_t n = PoseSquares::n;
  using P = StretchedPose<float>;
  const auto free = [&](std::size_t i) {  // azimuth, elevation, roll, distance, right, down, focal, longer, higher
    if (options.only_place) return i >= 3 && i < 6;
    return i < 6 || (i == 6 ? options.fit_focal : options.fit_shape);
  };
  const auto look = [&](const P& p) {
    return Silhouette(scene, edges, StretchedCamera{target.window.camera(p.pose), p.factors()});
  };
  double area = 0;
  for (std::size_t i = 0; i < std::size_t(target.window.width) * std::size_t(target.window.height); ++i)
    area += double(target.mask.values[i]);
  const double outline = 4 * std::sqrt(std::max(area, 1.0));  // pixels, about
  std::vector<EdgePoint> points;
  const auto measure = [&](const Silhouette& seen, const P& p, bool with_slopes) {
    PoseSquares s;
    s.add_mask(seen, target, p, with_slopes);
    if (target.edges) s.add_edges(*target.edges, points, p, outline * double(target.edge_weight), with_slopes);
    return s;
  };
  // What is usual counts as much as a few independent observations of the misfit: nothing where the mesh fits.
  const auto with_usual = [&](PoseSquares s, const P& p, double misfit) {
    const double weight = double(options.usual) * misfit;
    s.add_usual(1, double(p.pose.view_elevation() - 0.1f) / 0.12, 1 / 0.12, weight, 5,
                1 / (0.12 * (1 + double(p.pose.down) * double(p.pose.down))));
    s.add_usual(2, double(p.pose.roll) / 0.04, 1 / 0.04, weight);
    if (options.fit_focal)
      s.add_usual(6, std::log(double(p.pose.focal / options.usual_focal)) / 0.4, 1 / (0.4 * double(p.pose.focal)),
                  weight);
    for (const std::size_t i : {7u, 8u}) s.add_usual(i, double(i == 7 ? p.longer : p.higher) / 0.07, 1 / 0.07, weight);
    s.hold(free);
    return s;
  };
  const auto find_points = [&](const P& p) {
    if (target.edges) points = edge_points(scene.trace(target.window.camera(p.pose), 1), *options.tones);
  };
  P at{start.pose, std::log(start.stretch.x), std::log(start.stretch.y)};
  Silhouette seen = look(at);
  PoseSquares here;
  for (const int round : {0, 1}) {
    if (round && !target.edges && !options.hidden) break;
    if (round && options.hidden) {
      const Mask hidden = detail::hidden_by_others(seen.mask, target.mask);
      if (!target.known.width) target.known = Mask(hidden.width, hidden.height, 1);
      for (std::size_t i = 0; i < hidden.values.size(); ++i) target.known.values[i] *= 1 - hidden.values[i];
    }
    find_points(at);
    here = measure(seen, at, true);
    double damping = 1e-2;
    const int steps = target.edges || options.hidden ? (options.steps + 1) / 2 : options.steps;
    for (int step = 0; step < steps && damping < 1e6;) {
      const double misfit = here.loss;
      const PoseSquares whole = with_usual(here, at, misfit);
      auto a = whole.curvature;
      std::array<double, n> move{};
      for (std::size_t i = 0; i < n; ++i) move[i] = -whole.slope[i], a[i][i] += damping * a[i][i] + 1e-12;
      ++step;
      P next = at;
      bool usable = detail::solve(a, move);
      std::size_t k = 0;
      for_each_parameter(next, [&](const std::string&, float& x, Range r) {
        x += float(move[k++]);
        usable = usable && x > r.low && x < r.high;
      });
      if (!usable) {
        damping *= 8;
        continue;
      }
      Silhouette there = look(next);
      const double loss = with_usual(measure(there, next, false), next, misfit).loss;
      if (!(loss < whole.loss)) {
        damping *= 4;
        continue;
      }
      const bool little = whole.loss - loss < 1e-5 * whole.loss;
      at = next, seen = std::move(there);
      here = measure(seen, at, true);
      damping = std::max(damping / 5, 1e-9);
      if (little) break;
    }
  }
  MatchedPose out{at.pose, at.factors(), mask_iou(seen.mask, target.mask), at.pose};
  // Misfit by degree of freedom times the inverse of the curvature.
  auto a = with_usual(here, at, here.loss).curvature;
  for (std::size_t i = 0; i < n; ++i) a[i][i] += 1e-12;
  const double misfit = here.loss / std::max(seen.size(), 8);
  std::size_t k = 0;
  each(
      [&](float& x) {
        std::array<double, n> unit_of{};
        unit_of[k] = 1;
        x = !free(k) ? 0.0f
            : detail::solve(a, unit_of) ? float(std::sqrt(std::max(0.0, unit_of[k] * misfit)))
                                        : std::numeric_limits<float>::infinity();
        ++k;
      },
      out.deviation);
  return out;
}
/// By the mask alone, which is the whole picture's.
inline MatchedPose refine_pose(const Raycaster& scene, const MeshEdges& edges, const Mask& mask, Pose<float> start,
                               bool fit_focal, int steps = 30) {
  const PoseTarget target{Window::whole(mask.width, mask.height), mask};
  return refine_pose(scene, edges, target, {.pose = start.resized(mask.width, mask.height), .deviation = {}},
                     {.fit_focal = fit_focal, .hidden = false, .steps = steps, .usual = 0, .usual_focal = start.focal});
}

}  // namespace burnish
