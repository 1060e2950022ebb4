// burnish/twin/match_pose.h -- the pose in which a mesh looks like a photo's vehicle: views all round, then slopes
// SPDX-License-Identifier: Apache-2.0
//
// Views all round are compared with the photo as a whole (the way of 360/A renderings), by what each covers of the mask
// and, where a photo is given, by its edges and dark parts; the best are refined, and what they are worth against each
// other is said.
#pragma once
#include <mutex>
#include <burnish/twin/refine_pose.h>

namespace burnish {

struct MatchOptions {
  float focal = 1.2f;       ///< in widths of the picture, to start with
  bool fit_focal = false;   ///< whether it is not known
  int azimuths = 24;        ///< views all round, at each of the elevations
  std::vector<float> elevations = {0.03f, 0.14f, 0.3f};  ///< rad
  int pixels = 192;         ///< the longer side of the vehicle's window that the last refinement works on
  float edge_weight = 5;    ///< of the photo's edges against the outline; 0: the outline alone is refined
  bool keep_shape = true;   ///< false: what is found goes with a mesh that is stretched
  bool hidden = true;       ///< whether something may stand before the vehicle
  float usual = 0.08f;      ///< see RefineOptions
  std::vector<float> tones = {};  ///< of the parts, see Tones; empty: as they are found
};

/// A pose and what speaks for it.
struct PoseCandidate : MatchedPose {
  Agreement agreement;  // with the photo; 0 without one
  double score = 0;     // of all evidence, a logarithm; comparable among poses and models for one photo
  double belief = 0;    // 0 .. 1, against the other headings that were found for the same model
  bool sure() const { return belief > 0.9; }
};

namespace detail {

/// The logarithm of how likely it is to see that of the right pose rather than of a wrong one: a logistic regression
/// over renderings of one model matched by another, with and without a bar before it. The tone counts more than there,
/// where most paints were dark, and the roll less, for photos are held less straight.
inline double score_of(double iou, const Agreement& a, const Pose<float>& p) {
  const double roll = double(p.roll) / 0.06;
  return -3.5 * std::log(1.02 - iou) + 13 * a.edges + 2 * a.tone - 0.5 * roll * roll;
}

/// Moves and sizes a pose so that the points' box is `want` (x0, y0, x1, y1), as seen in the window.
inline void fit_box(Pose<float>& p, const std::vector<vec3<float>>& points, const std::array<float, 4>& want,
                    const Window& window, float least) {
  for (int round = 0; round < 5; ++round) {
    std::array<float, 4> b{1e9f, 1e9f, -1e9f, -1e9f};
    for (const vec3<float>& x : points) {
      const vec3<float> s = window.project(p, x);
      b = {std::min(b[0], s.x), std::min(b[1], s.y), std::max(b[2], s.x), std::max(b[3], s.y)};
    }
    const float wide = (b[2] - b[0]) / (want[2] - want[0]), high = (b[3] - b[1]) / (want[3] - want[1]);
    const float f = p.focal * float(p.width), scale = std::sqrt(wide * high);
    p.distance = std::max(p.distance * scale, least);
    p.right += (0.5f * (want[0] + want[2]) - 0.5f * (b[0] + b[2])) / (f * window.across());
    p.down += (0.5f * (want[1] + want[3]) - 0.5f * (b[1] + b[3])) / (f * window.along());
  }
}
/// x0, y0, x1, y1 of what is covered by more than half.
inline std::array<float, 4> box_of(const Mask& m) {
  std::array<float, 4> b{1e9f, 1e9f, -1e9f, -1e9f};
  for (int y = 0; y < m.height; ++y)
    for (int x = 0; x < m.width; ++x)
      if (m.at(x, y) > 0.5f)
        b = {std::min(b[0], float(x)), std::min(b[1], float(y)), std::max(b[2], float(x + 1)),
             std::max(b[3], float(y + 1))};
  return b;
}

/// What is compared at one size.
struct MatchLevel {
  PoseTarget target;
  Appearance photo;
  float blur = 0;

  MatchLevel(const Mask& mask, const Image& image, const Window& window) : target{window, window.of(mask)} {
    blur = 0.016f * float(std::max(window.width, window.height));
    if (image.width) photo = appearance_of(window.of(image), target.mask, blur);
  }
  void judge(PoseCandidate& c, const Raycaster& scene, const Tones& tones) const {
    const GBuffer g = scene.trace(target.window.camera(c.pose), 1);
    c.iou = mask_iou(g.frame("coverage"), target.mask);
    if (photo.width) c.agreement = agreement(photo, appearance_of(g, tones, blur));
    c.score = score_of(c.iou, c.agreement, c.pose);
  }
};
}  // namespace detail

/// The poses in which the mesh looks most like the photo's vehicle, the best first: `keep` of them, no two within a
/// sixth of a turn. photo: of the mask's size; of no size: by the mask alone. Error where the mask is empty.
/// progress(done, of) is told.
template <class Progress>
std::vector<PoseCandidate> match_pose(const Raycaster& scene, const Mask& mask, const Image& photo,
                                      const MatchOptions& options, int keep, Progress progress) {
  using detail::MatchLevel;
  const Window fine_window = Window::around(mask, options.pixels);
  const MatchLevel coarse(mask, photo, fine_window.at_most(96)), fine(mask, photo, fine_window);
  const EdgeField coarse_edges(coarse.photo, coarse.target.window), fine_edges(fine.photo, fine.target.window);
  const Mesh& mesh = scene.mesh();
  const MeshEdges edges(mesh);
  const Tones tones(mesh, options.tones);
  const RefineOptions refining{.fit_focal = options.fit_focal,
                               .fit_shape = true,
                               .hidden = options.hidden,
                               .usual = options.usual,
                               .usual_focal = options.focal,
                               .tones = &tones};
  const Box box = bounds(mesh);
  const vec3<float> size = box.size();
  std::vector<vec3<float>> points;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 1 + mesh.triangles.size() / 4000)
    points.push_back(mesh.positions[std::size_t(mesh.triangles[i][0])]);

  std::vector<PoseCandidate> views;
  for (int k = 0; k < options.azimuths; ++k)
    for (const float elevation : options.elevations) {
      PoseCandidate c;
      Pose<float>& p = c.pose;
      p.azimuth = 2 * pi * float(k) / float(options.azimuths), p.elevation = elevation, p.focal = options.focal;
      p.center = box.center(), p.width = mask.width, p.height = mask.height;
      p.distance = 2 * length(size) * std::max(1.0f, options.focal);
      views.push_back(c);
    }
  constexpr int first = 12;
  const int second = std::max(4, keep), total = int(views.size()) + 8 * first + 50 * second;
  int done = 0;
  std::mutex telling;
  const auto tell = [&](int more) {
    const std::lock_guard lock(telling);
    progress(done += more, total);
  };
  const auto want = detail::box_of(coarse.target.mask);
  parallel_for(int(views.size()), [&](int i) {
    PoseCandidate& c = views[std::size_t(i)];
    const float elevation = c.pose.elevation;
    for (int round = 0; round < 3; ++round) {  // elevations are the camera's, wherever the vehicle lies in the picture
      detail::fit_box(c.pose, points, want, coarse.target.window, 0.6f * length(size));
      c.pose.elevation += elevation - c.pose.view_elevation();
    }
    coarse.judge(c, scene, tones);
    tell(1);
  });
  const auto better = [](const PoseCandidate& x, const PoseCandidate& y) { return x.score > y.score; };
  // No two whose headings are closer than that; what came to the same place counts once.
  const auto choose = [&](float apart, int count) {
    std::stable_sort(views.begin(), views.end(), better);
    std::vector<PoseCandidate> chosen;
    for (const PoseCandidate& v : views)
      if (int(chosen.size()) < count && std::none_of(chosen.begin(), chosen.end(), [&](const PoseCandidate& o) {
            return std::cos(v.pose.azimuth - o.pose.azimuth) > std::cos(apart);
          }))
        chosen.push_back(v);
    views = chosen;
  };
  const bool by_edges = photo.width && options.edge_weight > 0;
  const auto refine = [&](const MatchLevel& level, const EdgeField& field, int steps, int cost, bool deviation,
                          bool only_place = false) {
    PoseTarget target = level.target;
    target.edges = by_edges ? &field : nullptr, target.edge_weight = options.edge_weight;
    RefineOptions how = refining;
    how.steps = steps;
    how.deviation = deviation;
    how.only_place = only_place;
    parallel_for(int(views.size()), [&](int i) {
      PoseCandidate& c = views[std::size_t(i)];
      const Pose<float> known = c.deviation;
      static_cast<MatchedPose&>(c) = refine_pose(scene, edges, target, c, how);
      if (!deviation) c.deviation = known;
      level.judge(c, scene, tones);
      tell(cost);
    });
  };
  choose(0.1f, first);
  refine(coarse, coarse_edges, 14, 8, false);
  choose(1.04f, second);
  refine(fine, fine_edges, 24, 40, true);
  if (options.keep_shape) {
    for (PoseCandidate& v : views) v.stretch = {1, 1, 1};
    refine(fine, fine_edges, 8, 10, false, true);
  } else {
    parallel_for(int(views.size()), [&](int i) {
      PoseCandidate& c = views[std::size_t(i)];
      const Raycaster changed(stretched(mesh, c.stretch));
      fine.judge(c, changed, Tones(changed.mesh(), options.tones));
    });
  }
  choose(1.04f, second);
  double sum = 0;
  for (PoseCandidate& v : views) sum += v.belief = std::exp(v.score - views[0].score);
  for (PoseCandidate& v : views) v.belief /= sum;
  progress(total, total);
  views.resize(std::size_t(std::min(keep, int(views.size()))));
  return views;
}
inline std::vector<PoseCandidate> match_pose(const Raycaster& scene, const Mask& mask, const Image& photo,
                                             const MatchOptions& options = {}, int keep = 1) {
  return match_pose(scene, mask, photo, options, keep, [](int, int) {});
}
/// One of several models with its poses, the best first.
struct MatchedModel {
  int model = 0;
  std::vector<PoseCandidate> poses;
};
/// Matches all models and gives the one first whose best pose has the highest score. scene_of(k) gives model k's
/// Raycaster, by value or not. progress(done, of) is told over all.
template <class SceneOf, class Progress>
std::vector<MatchedModel> match_models(int models, SceneOf scene_of, const Mask& mask, const Image& photo,
                                       const MatchOptions& options, int keep, Progress progress) {
  std::vector<MatchedModel> out;
  for (int k = 0; k < models; ++k) {
    const auto& scene = scene_of(k);
    out.push_back({k, match_pose(scene, mask, photo, options, keep,
                                 [&](int done, int of) { progress(k * of + done, models * of); })});
  }
  std::stable_sort(out.begin(), out.end(), [](const MatchedModel& a, const MatchedModel& b) {
    return a.poses[0].score > b.poses[0].score;
  });
  return out;
}

/// By the mask alone.
inline std::vector<PoseCandidate> match_pose(const Raycaster& scene, const Mask& mask, const MatchOptions& options = {},
                                             int keep = 1) {
  return match_pose(scene, mask, Image(), options, keep, [](int, int) {});
}

}  // namespace burnish
