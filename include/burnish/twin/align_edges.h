// burnish/twin/align_edges.h -- how far the edges that a mesh shows lie on a photo's edges, and its slope by the pose
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/ad/dual.h>
#include <burnish/twin/edges.h>
#include <burnish/twin/stretch.h>
#include <burnish/twin/window.h>

namespace burnish {

/// Points of a mesh at which it shows an edge from where it was seen.
struct EdgePoint {
  vec3<float> place;                                      // metres, the vehicle's frame
  std::array<float, Appearance::orientations> strength;   // by the gradient's orientation; sums to the point's weight
};
/// At most `most` of them, spread evenly. The part behind a jump of depth shows no edge: what lies before it does.
inline std::vector<EdgePoint> edge_points(const GBuffer& g, const Tones& tones, int most = 1500) {
  const Appearance sharp = appearance_of(g, tones, 0);
  const Mask depth = g.frame("depth");
  std::vector<EdgePoint> all;
  for (int i = 0; i < g.size(); ++i) {
    const int pixel = g.pixel[std::size_t(i)], x = pixel % g.width, y = pixel / g.width;
    EdgePoint e{g.at(i).position, {}};
    float sum = 0;
    for (std::size_t k = 0; k < e.strength.size(); ++k) sum += e.strength[k] = sharp.edges[k].at(x, y);
    if (!(sum > 0.25f)) continue;
    bool behind = false;
    for (const auto& [u, v] : {std::pair{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}})
      behind = behind || depth.at(u, v) < depth.at(x, y) - 0.12f;  // edges are never at the border
    if (!behind) all.push_back(e);
  }
  std::vector<EdgePoint> out;
  const std::size_t step = 1 + all.size() / std::size_t(most);
  for (std::size_t i = 0; i < all.size(); i += step) out.push_back(all[i]);
  return out;
}

/// A photo's oriented edges as a field that is smooth in the place where it is read.
class EdgeField {
public:
  /// Window is what the appearance was made of; its blur is how far an edge is felt.
  EdgeField(const Appearance& photo, const Window& w) : window(w), edges(photo.edges) {
    std::vector<float> values;
    for (const Mask& m : edges)
      for (std::size_t i = 0; i < std::size_t(m.width) * std::size_t(m.height); ++i)
        if (m.values[i] > 0.02f) values.push_back(m.values[i]);
    if (values.empty()) return;
    auto high = values.begin() + std::ptrdiff_t(values.size() * 95 / 100);
    std::nth_element(values.begin(), high, values.end());
    scale = 1 / *high;
  }

  static constexpr std::size_t n = std::size_t(count<StretchedPose<float>>());
  /// Mean of weight (1 - field)^2 over the points, 0 where all lie on strong edges; with its slopes by the pose, and
  /// Gauss' and Newton's curvature.
  struct Sum {
    double loss = 0;
    std::array<double, n> slope{};
    std::array<std::array<double, n>, n> curvature{};
  };
  Sum at(const std::vector<EdgePoint>& points, const StretchedPose<float>& pose, bool with_slopes) const {
    using D = Dual<double, int(n)>;
    auto lifted = lift<D>(pose);
    int k = 0;
    each([&](D& x) { x = D(x.value, k++); }, lifted);
    const auto plain = lift<double>(pose);
    Sum sum;
    double all = 0;
    for (const EdgePoint& p : points) {
      double weight = 0;
      for (const float s : p.strength) weight += double(s);
      std::array<double, 3> v{};
      if (with_slopes) {
        const vec3<D> seen = window.project(lifted, p.place);
        v = read(p, weight, seen.x.value, seen.y.value);
        for (std::size_t i = 0; i < n; ++i) {
          const double di = v[1] * seen.x.slope[i] + v[2] * seen.y.slope[i];
          sum.slope[i] -= weight * (1 - v[0]) * di;
          for (std::size_t j = 0; j <= i; ++j)
            sum.curvature[i][j] += weight * di * (v[1] * seen.x.slope[j] + v[2] * seen.y.slope[j]);
        }
      } else {
        const vec3<double> seen = window.project(plain, p.place);
        v = read(p, weight, seen.x, seen.y);
      }
      sum.loss += weight * (1 - v[0]) * (1 - v[0]);
      all += weight;
    }
    if (!(all > 0)) return sum;
    sum.loss /= all;
    for (std::size_t i = 0; i < n; ++i) {
      sum.slope[i] *= 2 / all;
      for (std::size_t j = 0; j <= i; ++j) sum.curvature[j][i] = sum.curvature[i][j] *= 2 / all;
    }
    return sum;
  }

private:
  Window window;
  std::array<Mask, Appearance::orientations> edges;
  float scale = 0;

  /// The field at a place for edges that run as the point's, and its slopes by x and y: quadratic B-splines.
  std::array<double, 3> read(const EdgePoint& p, double weight, double x, double y) const {
    const int i = int(std::floor(x)), j = int(std::floor(y));
    if (!(i >= 1 && j >= 1 && i + 1 < window.width && j + 1 < window.height)) return {};
    const auto spline = [](double t) {  // of the pixels before, here and after; t: 0 .. 1 from this pixel's left border
      return std::array<double, 3>{0.5 * (1 - t) * (1 - t), 0.5 + t * (1 - t), 0.5 * t * t};
    };
    const double tx = x - i, ty = y - j;
    const auto bx = spline(tx), by = spline(ty);
    const std::array<double, 3> dx{tx - 1, 1 - 2 * tx, tx}, dy{ty - 1, 1 - 2 * ty, ty};
    std::array<double, 3> out{};
    for (std::size_t k = 0; k < edges.size(); ++k) {
      const double share = double(p.strength[k]) / weight * double(scale);
      if (!(share > 0)) continue;
      for (int v = 0; v < 3; ++v)
        for (int u = 0; u < 3; ++u) {
          const double e = share * double(edges[k].at(i + u - 1, j + v - 1));
          out[0] += e * bx[std::size_t(u)] * by[std::size_t(v)];
          out[1] += e * dx[std::size_t(u)] * by[std::size_t(v)];
          out[2] += e * bx[std::size_t(u)] * dy[std::size_t(v)];
        }
    }
    return out;
  }
};

}  // namespace burnish
