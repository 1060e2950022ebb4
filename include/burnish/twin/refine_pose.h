// burnish/twin/refine_pose.h -- from a pose near by to one that covers a mask and has its edges on a photo's
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/twin/pose_squares.h>

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
  Pose<float> deviation;  // standard deviations, as far as the misfit tells: see pose_deviation
};

struct RefineOptions {
  bool fit_focal = false;
  bool fit_shape = false;    ///< whether the mesh may be longer and higher than it is
  bool only_place = false;   ///< keeps the camera's direction, its focal length and the shape
  bool hidden = true;        ///< whether something may stand before the vehicle: see hidden_by_others
  int steps = 30;
  float usual = 0.02f;       ///< how much it counts that photos are taken upright, from about a person's height
  float usual_focal = 1.2f;  ///< in widths of the picture: where the focal length goes when the photo does not tell
  bool deviation = true;     ///< whether it is said how sure the pose is, which takes as long as 16 steps
  const Tones* tones = nullptr;  ///< of the mesh; where the target has edges
};

namespace detail {
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

namespace detail {
/// A mesh, a target and what is usual: everything that a pose's misfit hangs on.
class PoseMisfit {
public:
  using P = StretchedPose<float>;
  static constexpr std::size_t n = PoseSquares::n;

  PoseMisfit(const Raycaster& s, const MeshEdges& e, PoseTarget t, const RefineOptions& o)
      : scene(s), edges(e), target(std::move(t)), options(o) {
    double area = 0;
    for (std::size_t i = 0; i < std::size_t(target.window.width) * std::size_t(target.window.height); ++i)
      area += double(target.mask.values[i]);
    outline = 4 * std::sqrt(std::max(area, 1.0));
  }
  bool has_edges() const { return target.edges != nullptr; }
  const Mask& mask() const { return target.mask; }
  bool free(std::size_t i) const {  // azimuth, elevation, roll, distance, right, down, focal, longer, higher
    if (options.only_place) return i >= 3 && i < 6;
    return i < 6 || (i == 6 ? options.fit_focal : options.fit_shape);
  }
  Silhouette look(const P& p) const {
    return Silhouette(scene, edges, StretchedCamera{target.window.camera(p.pose), p.factors()});
  }
  /// Which edges the mesh shows from there.
  void find_points(const P& p) {
    if (target.edges) points = edge_points(scene.trace(target.window.camera(p.pose), 1), *options.tones);
  }
  /// What something else may hide no longer counts.
  void leave_out_hidden(const Silhouette& seen) {
    const Mask hidden = hidden_by_others(seen.mask, target.mask);
    if (!target.known.width) target.known = Mask(hidden.width, hidden.height, 1);
    for (std::size_t i = 0; i < hidden.values.size(); ++i) target.known.values[i] *= 1 - hidden.values[i];
  }
  PoseSquares measure(const Silhouette& seen, const P& p, bool with_slopes) const {
    PoseSquares s;
    s.add_mask(seen, target, p, with_slopes);
    if (target.edges) s.add_edges(*target.edges, points, p, outline * double(target.edge_weight), with_slopes);
    return s;
  }
  /// What is usual counts as much as a few independent observations of the misfit: nothing where the mesh fits.
  PoseSquares with_usual(PoseSquares s, const P& p, double misfit) const {
    const double weight = double(options.usual) * misfit;
    s.add_usual(1, double(p.pose.view_elevation() - 0.1f) / 0.12, 1 / 0.12, weight, 5,
                1 / (0.12 * (1 + double(p.pose.down) * double(p.pose.down))));
    s.add_usual(2, double(p.pose.roll) / 0.04, 1 / 0.04, weight);
    if (options.fit_focal)
      s.add_usual(6, std::log(double(p.pose.focal / options.usual_focal)) / 0.4, 1 / (0.4 * double(p.pose.focal)),
                  weight);
    for (const std::size_t i : {7u, 8u}) s.add_usual(i, double(i == 7 ? p.longer : p.higher) / 0.07, 1 / 0.07, weight);
    s.hold([&](std::size_t i) { return free(i); });
    return s;
  }

  /// Standard deviations of a pose that was found. A mesh that is not quite the photo's is off along whole stretches of
  /// its outline, not pixel by pixel; so the misfit of each of 16 sectors about the mask's middle is one observation,
  /// and what these pull the pose apart is how uncertain it is (Liang and Zeger 1986: covariance of clustered data).
  Pose<float> deviation(const Silhouette& seen, const P& p) const {
    constexpr int sectors = 16;
    const int w = target.window.width, h = target.window.height;
    double mx = 0, my = 0, area = 1e-9;
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const double m = double(target.mask.at(x, y));
        mx += x * m, my += y * m, area += m;
      }
    const auto sector = [&](double x, double y) {
      const double turn = std::atan2(y - my / area, x - mx / area) / 6.283185307179586 + 1;
      return int(turn * sectors) % sectors;
    };
    const PoseSquares all = measure(seen, p, true);
    const auto curvature = with_usual(all, p, all.loss).curvature;
    std::array<std::array<double, n>, sectors> pull{};
    std::array<double, n> mean{};
    for (int s = 0; s < sectors; ++s) {
      PoseMisfit part = *this;
      part.target.known = Mask(w, h);
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x)
          if (sector(x, y) == s) part.target.known.at(x, y) = target.known.width ? target.known.at(x, y) : 1.0f;
      part.points.clear();
      double weight = 0, mine = 0;
      for (const EdgePoint& e : points) {
        const vec3<float> at = target.window.project(p.pose, e.place);
        double strength = 0;
        for (const float x : e.strength) strength += double(x);
        weight += strength;
        if (sector(double(at.x), double(at.y)) == s) part.points.push_back(e), mine += strength;
      }
      if (weight > 0) part.target.edge_weight *= float(mine / weight);  // the mean of all is made of theirs
      PoseSquares squares = part.measure(seen, p, true);
      squares.hold([&](std::size_t i) { return free(i); });
      pull[std::size_t(s)] = squares.slope;
      for (std::size_t i = 0; i < n; ++i) mean[i] += squares.slope[i] / sectors;
    }
    std::array<double, n> variance{};
    for (auto& step : pull) {
      for (std::size_t i = 0; i < n; ++i) step[i] -= mean[i];
      auto a = curvature;
      for (std::size_t i = 0; i < n; ++i) a[i][i] += 1e-12;
      const bool known = solve(a, step);
      for (std::size_t i = 0; i < n; ++i)
        variance[i] += known ? step[i] * step[i] * sectors / (sectors - 1) : std::numeric_limits<double>::infinity();
    }
    Pose<float> out{};
    std::size_t k = 0;
    each([&](float& x) { x = free(k) ? float(std::sqrt(variance[k])) : 0.0f, ++k; }, out);
    return out;
  }

private:
  const Raycaster& scene;
  const MeshEdges& edges;
  PoseTarget target;
  RefineOptions options;
  double outline;  // of the mask, pixels, about
  std::vector<EdgePoint> points;
};
}  // namespace detail

/// Levenberg's and Marquardt's way (Marquardt 1963) from a pose near by. Where the target has edges, those of the mesh
/// are found at the start and again half-way.
inline MatchedPose refine_pose(const Raycaster& scene, const MeshEdges& edges, PoseTarget target,
                               const MatchedPose& start, const RefineOptions& options) {
  using detail::PoseSquares;
  constexpr std::size_t n = PoseSquares::n;
  using P = StretchedPose<float>;
  detail::PoseMisfit misfit_of(scene, edges, std::move(target), options);
  P at{start.pose, std::log(start.stretch.x), std::log(start.stretch.y)};
  Silhouette seen = misfit_of.look(at);
  PoseSquares here;
  for (const int round : {0, 1}) {
    if (round && !misfit_of.has_edges() && !options.hidden) break;
    if (round && options.hidden) misfit_of.leave_out_hidden(seen);
    misfit_of.find_points(at);
    here = misfit_of.measure(seen, at, true);
    double damping = 1e-2;
    const int steps = misfit_of.has_edges() || options.hidden ? (options.steps + 1) / 2 : options.steps;
    for (int step = 0; step < steps && damping < 1e6;) {
      const double misfit = here.loss;
      const PoseSquares whole = misfit_of.with_usual(here, at, misfit);
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
      Silhouette there = misfit_of.look(next);
      const double loss = misfit_of.with_usual(misfit_of.measure(there, next, false), next, misfit).loss;
      if (!(loss < whole.loss)) {
        damping *= 4;
        continue;
      }
      const bool little = whole.loss - loss < 1e-5 * whole.loss;
      at = next, seen = std::move(there);
      here = misfit_of.measure(seen, at, true);
      damping = std::max(damping / 5, 1e-9);
      if (little) break;
    }
  }
  MatchedPose out{at.pose, at.factors(), mask_iou(seen.mask, misfit_of.mask()), {}};
  if (options.deviation) out.deviation = misfit_of.deviation(seen, at);
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
