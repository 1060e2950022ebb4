// burnish/twin/match_pose.h -- the pose in which a mesh covers a photo's mask: views all round, then slopes
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/twin/pose.h>
#include <burnish/twin/silhouette.h>

namespace burnish {

/// The masks' intersection over their union; both of one size.
inline double mask_iou(const Mask& a, const Mask& b) {
  double both = 0, either = 0;
  for (std::size_t i = 0; i < std::size_t(a.width) * std::size_t(a.height); ++i)
    both += double(std::min(a.values[i], b.values[i])), either += double(std::max(a.values[i], b.values[i]));
  return either > 0 ? both / either : 0;
}

struct MatchOptions {
  float focal = 1.2f;       ///< in widths of the picture, to start with
  bool fit_focal = false;   ///< whether it is known
  int azimuths = 24;        ///< views all round, at each of the elevations
  std::vector<float> elevations = {0.03f, 0.14f, 0.3f};  ///< rad
  int pixels = 192;         ///< the longer side of the mask that the last refinement works on
};
/// A pose with how well it is known.
struct MatchedPose {
  Pose<float> pose;       // of the mask's own size
  double iou = 0;
  Pose<float> deviation;  // standard deviations, as far as the mask tells, were its misfit independent by pixel
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
inline constexpr auto project_by_pose = []<class P>(const P& pose, const vec3<float>& p) { return pose.project(p); };

/// A mask of at most that many pixels along its longer side, by areas.
inline Mask smaller(const Mask& m, int longest) {
  const int side = std::max(m.width, m.height);
  if (side <= longest) return m;
  const int w = std::max(1, m.width * longest / side), h = std::max(1, m.height * longest / side);
  Mask out(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const double x0 = double(x) * m.width / w, x1 = double(x + 1) * m.width / w, y0 = double(y) * m.height / h,
                   y1 = double(y + 1) * m.height / h;
      double sum = 0;
      for (int j = int(y0); j < std::min(m.height, int(std::ceil(y1))); ++j)
        for (int i = int(x0); i < std::min(m.width, int(std::ceil(x1))); ++i)
          sum += double(m.at(i, j)) * (std::min(x1, i + 1.0) - std::max(x0, double(i))) *
                 (std::min(y1, j + 1.0) - std::max(y0, double(j)));
      out.at(x, y) = float(sum / ((x1 - x0) * (y1 - y0)));
    }
  return out;
}

/// Least squares of mask - target on pixels and on blocks of 2, 4, ... of them, each level with one weight a pixel's
/// area: the coarse ones see far, the fine ones see well.
struct MaskSquares {
  static constexpr std::size_t n = 7;
  double loss = 0;
  std::array<double, n> slope{};
  std::array<std::array<double, n>, n> curvature{};

  MaskSquares(const Silhouette& seen, const Mask& target, const Pose<float>& pose, bool with_slopes) {
    const int w = target.width, h = target.height;
    int levels = 1;
    while ((std::max(w, h) >> levels) > 6) ++levels;
    struct Row {
      int pixel;
      std::array<double, n> d;
    };
    std::vector<Row> rows;
    if (with_slopes)
      seen.each_slope(pose, project_by_pose, [&](int pixel, const auto& d) { rows.push_back({pixel, d}); });
    for (int l = 0; l < levels; ++l) {
      const int across = (w >> l) + 1;
      const auto block = [&](int pixel) { return std::size_t((pixel / w >> l) * across + (pixel % w >> l)); };
      std::vector<double> rest(std::size_t(across) * std::size_t((h >> l) + 1));
      for (int p = 0; p < w * h; ++p)
        rest[block(p)] += double(seen.mask.values[std::size_t(p)]) - double(target.values[std::size_t(p)]);
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
};

}  // namespace detail

/// Levenberg's and Marquardt's way (Marquardt 1963) from a pose near by to one whose silhouette covers the mask. The
/// target's size is the picture's.
inline MatchedPose refine_pose(const Raycaster& scene, const MeshEdges& edges, const Mask& target, Pose<float> start,
                               bool fit_focal, int steps = 30) {
  using detail::MaskSquares;
  constexpr std::size_t n = MaskSquares::n;
  static_assert(count<Pose<float>>() == int(n));
  start = start.resized(target.width, target.height);
  const auto free = [&](std::size_t i) { return fit_focal || i + 1 < n; };
  const auto look = [&](const Pose<float>& p) { return Silhouette(scene, edges, p.camera()); };
  Pose<float> at = start;
  Silhouette seen = look(at);
  MaskSquares here(seen, target, at, true);
  double damping = 1e-2;
  for (int step = 0; step < steps && damping < 1e6;) {
    auto a = here.curvature;
    std::array<double, n> move{};
    for (std::size_t i = 0; i < n; ++i) {
      move[i] = -here.slope[i];
      a[i][i] += damping * a[i][i] + 1e-12;
      if (free(i)) continue;
      for (std::size_t j = 0; j < n; ++j) a[i][j] = a[j][i] = 0;
      a[i][i] = 1, move[i] = 0;
    }
    ++step;
    Pose<float> next = at;
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
    const double loss = MaskSquares(there, target, next, false).loss;
    if (!(loss < here.loss)) {
      damping *= 4;
      continue;
    }
    const bool little = here.loss - loss < 1e-5 * here.loss;
    at = next, seen = std::move(there);
    here = MaskSquares(seen, target, at, true);
    damping = std::max(damping / 5, 1e-9);
    if (little) break;
  }
  MatchedPose out{at, mask_iou(seen.mask, target), at};
  // Misfit by degree of freedom times the inverse of the curvature.
  auto a = here.curvature;
  for (std::size_t i = 0; i < n; ++i) {
    a[i][i] += 1e-12;
    if (free(i)) continue;
    for (std::size_t j = 0; j < n; ++j) a[i][j] = a[j][i] = 0;
    a[i][i] = 1;
  }
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

/// The poses in which the mesh covers the mask best, the best first: views all round, moved and sized so that their
/// boxes are the mask's; the best of them refined on a small mask, the best of those on a larger one. keep: how many
/// are given, no two within a sixth of a turn. Error where the mask is empty. progress(done, of) is told.
template <class Progress>
std::vector<MatchedPose> match_pose(const Raycaster& scene, const Mask& mask, const MatchOptions& options, int keep,
                                    Progress progress) {
  const Mask coarse = detail::smaller(mask, 64), middle = detail::smaller(mask, 96),
             fine = detail::smaller(mask, options.pixels);
  const auto box_of = [](const Mask& m) {
    std::array<float, 4> b{1e9f, 1e9f, -1e9f, -1e9f};
    for (int y = 0; y < m.height; ++y)
      for (int x = 0; x < m.width; ++x)
        if (m.at(x, y) > 0.5f)
          b = {std::min(b[0], float(x)), std::min(b[1], float(y)), std::max(b[2], float(x + 1)),
               std::max(b[3], float(y + 1))};
    return b;
  };
  const auto want = box_of(coarse);
  if (want[2] <= want[0]) throw Error("the mask is empty, expected a vehicle on it");
  const Mesh& mesh = scene.mesh();
  const MeshEdges edges(mesh);
  const Box box = bounds(mesh);
  const vec3<float> size = box.size();
  std::vector<vec3<float>> points;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 1 + mesh.triangles.size() / 4000)
    points.push_back(mesh.positions[std::size_t(mesh.triangles[i][0])]);

  std::vector<MatchedPose> views;
  for (const float elevation : options.elevations)
    for (int k = 0; k < options.azimuths; ++k) {
      Pose<float> p;
      p.azimuth = 2 * pi * float(k) / float(options.azimuths), p.elevation = elevation, p.focal = options.focal;
      p.center = box.center(), p.width = coarse.width, p.height = coarse.height;
      p.distance = 2 * length(size) * std::max(1.0f, options.focal);
      for (int round = 0; round < 5; ++round) {
        std::array<float, 4> b{1e9f, 1e9f, -1e9f, -1e9f};
        for (const vec3<float>& x : points) {
          const vec3<float> s = p.project(x);
          b = {std::min(b[0], s.x), std::min(b[1], s.y), std::max(b[2], s.x), std::max(b[3], s.y)};
        }
        const float wide = (b[2] - b[0]) / (want[2] - want[0]), high = (b[3] - b[1]) / (want[3] - want[1]);
        const float f = p.focal * float(p.width), scale = std::sqrt(wide * high);
        p.distance = std::max(p.distance * scale, 0.6f * length(size));
        p.right += (0.5f * (want[0] + want[2]) - 0.5f * (b[0] + b[2])) / f;
        p.down += (0.5f * (want[1] + want[3]) - 0.5f * (b[1] + b[3])) / f;
      }
      views.push_back({p, 0, p});
    }
  const int all = int(views.size()), first = 10, second = std::max(3, keep), total = all + 10 * first + 60 * second;
  int done = 0;
  const auto better = [](const MatchedPose& x, const MatchedPose& y) { return x.iou > y.iou; };
  for (MatchedPose& v : views) {
    v.iou = mask_iou(scene.trace(v.pose.camera(), 1).frame("coverage"), coarse);
    progress(++done, total);
  }
  const auto refine = [&](const Mask& target, int count, int steps, int cost) {
    std::stable_sort(views.begin(), views.end(), better);
    views.resize(std::size_t(std::min(count, int(views.size()))));
    for (MatchedPose& v : views) {
      v = refine_pose(scene, edges, target, v.pose, options.fit_focal, steps);
      progress(done += cost, total);
    }
    std::stable_sort(views.begin(), views.end(), better);
    // What came to the same place counts once.
    std::vector<MatchedPose> apart;
    for (const MatchedPose& v : views)
      if (std::none_of(apart.begin(), apart.end(), [&](const MatchedPose& o) {
            return std::cos(v.pose.azimuth - o.pose.azimuth) > 0.5f;
          }))
        apart.push_back(v);
    views = apart;
  };
  refine(middle, first, 15, 10);
  refine(fine, second, 30, 60);
  progress(total, total);
  views.resize(std::size_t(std::min(keep, int(views.size()))));
  for (MatchedPose& v : views) v.pose = v.pose.resized(mask.width, mask.height);
  return views;
}
inline std::vector<MatchedPose> match_pose(const Raycaster& scene, const Mask& mask, const MatchOptions& options = {},
                                           int keep = 1) {
  return match_pose(scene, mask, options, keep, [](int, int) {});
}

}  // namespace burnish
