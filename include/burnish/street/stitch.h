// burnish/street/stitch.h -- pictures of fisheyes made one panorama: exposures matched, seams feathered
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>
#include <burnish/ad/parallel.h>
#include <burnish/light/environment.h>
#include <burnish/scene/error.h>
#include <burnish/street/lens.h>

namespace burnish {

/// What a lens saw: linear RGB. Pixels at `clipped` or above in any channel do not count when exposures are matched.
struct LensPicture {
  Lens lens;
  Image image;
  float clipped = 0.97f;
};
struct StitchOptions {
  int height = 512;         ///< of the panorama, which is twice as wide
  float feather = 0.12f;    ///< rad: over so much a picture fades out towards its rim
  bool match_exposure = true;
};
struct Stitched {
  Image panorama;                   ///< lat-long as light/environment.h has it; black where no lens sees
  Mask seen;                        ///< 1 where a lens sees
  std::vector<vec3<float>> gains;   ///< what each picture was multiplied by; their product is 1
  double seam = 0;                  ///< how far they still differ where they overlap: median of 2 |a - b| / (a + b)
};

namespace detail {
/// Between pixel centres; the rim's pixels go on outside.
inline vec3<float> sampled(const Image& image, const vec2<double>& at) {
  const double x = std::clamp(at.x - 0.5, 0.0, image.width - 1.0), y = std::clamp(at.y - 0.5, 0.0, image.height - 1.0);
  const int i = std::min(int(x), std::max(image.width - 2, 0)), j = std::min(int(y), std::max(image.height - 2, 0));
  const int i1 = std::min(i + 1, image.width - 1), j1 = std::min(j + 1, image.height - 1);
  const float u = float(x - i), v = float(y - j);
  return mix(mix(image.at(i, j), image.at(i1, j), u), mix(image.at(i, j1), image.at(i1, j1), u), v);
}
/// 1 well inside a lens's picture, 0 at its rim and beyond.
inline float lens_weight(const Lens& lens, const vec3<double>& d, float feather) {
  const vec3<double> c = lens.to_camera(d);
  const double theta = std::atan2(std::hypot(c.x, c.y), c.z);
  const double widest = std::visit([](const auto& m) { return double(m.widest); }, lens.model);
  if (theta >= widest || !lens.sees(d)) return 0;
  const vec2<double> p = lens.project(d);
  if (!(p.x >= 0 && p.y >= 0 && p.x <= lens.width && p.y <= lens.height)) return 0;
  const float t = std::clamp(float(widest - theta) / std::max(feather, 1e-6f), 0.0f, 1.0f);
  return std::max(t * t * (3 - 2 * t), 1e-4f);
}
inline double median(std::vector<double>& v) {
  if (v.empty()) return 0;
  std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
  return v[v.size() / 2];
}
/// visit(a, b, x, z): pictures a < b see one place as x and z, both believing it; at directions spread evenly (a
/// Fibonacci lattice).
template <class F> void each_overlap(const std::vector<LensPicture>& pictures, float feather, F visit) {
  constexpr int directions = 40000;
  const auto look = [&](const LensPicture& p, const vec3<double>& d, vec3<float>& color) {
    if (lens_weight(p.lens, d, feather) <= 0.01f) return false;
    color = sampled(p.image, p.lens.project(d));
    return std::max({color.x, color.y, color.z}) < p.clipped && std::min({color.x, color.y, color.z}) >= 0.004f;
  };
  for (int k = 0; k < directions; ++k) {
    const double y = 1 - (2 * k + 1.0) / directions, phi = 2.399963229728653 * k, s = std::sqrt(1 - y * y);
    const vec3<double> d(s * std::sin(phi), y, -s * std::cos(phi));
    vec3<float> x, z;
    for (std::size_t a = 0; a < pictures.size(); ++a) {
      if (!look(pictures[a], d, x)) continue;
      for (std::size_t b = a + 1; b < pictures.size(); ++b)
        if (look(pictures[b], d, z)) visit(a, b, x, z);
    }
  }
}
/// Minimises the sum over pairs of sqrt(places) (g_b - g_a - median of log(a / b))^2 in every channel; a few hundred
/// sweeps settle any ring of lenses. The product of all is 1.
inline std::vector<vec3<float>> matched_gains(const std::vector<LensPicture>& pictures, float feather) {
  const std::size_t n = pictures.size();
  std::vector<std::vector<double>> ratios(3 * n * n);
  each_overlap(pictures, feather, [&](std::size_t a, std::size_t b, const vec3<float>& x, const vec3<float>& z) {
    const float p[3] = {x.x, x.y, x.z}, q[3] = {z.x, z.y, z.z};
    for (std::size_t c = 0; c < 3; ++c) ratios[(c * n + a) * n + b].push_back(std::log(double(p[c]) / double(q[c])));
  });
  std::vector<vec3<float>> gains(n);
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<double> gain(n), weight(n * n), ratio(n * n);
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = a + 1; b < n; ++b) {
        auto& r = ratios[(c * n + a) * n + b];
        weight[a * n + b] = weight[b * n + a] = r.size() < 20 ? 0 : std::sqrt(double(r.size()));
        ratio[a * n + b] = median(r), ratio[b * n + a] = -ratio[a * n + b];
      }
    for (int sweep = 0; sweep < 300; ++sweep)
      for (std::size_t b = 0; b < n; ++b) {
        double sum = 0, all = 0;
        for (std::size_t a = 0; a < n; ++a) {
          sum += weight[a * n + b] * (gain[a] + ratio[a * n + b]);
          all += weight[a * n + b];
        }
        if (all > 0) gain[b] = sum / all;
      }
    double mean = 0;
    for (const double g : gain) mean += g / double(n);
    for (std::size_t a = 0; a < n; ++a) {
      vec3<float>& g = gains[a];
      (c == 0 ? g.x : c == 1 ? g.y : g.z) = float(std::exp(gain[a] - mean));
    }
  }
  return gains;
}
}  // namespace detail

/// All pictures as seen from one place, infinitely far away: what is near a rig of several lenses shows twice at the
/// seams. Exposures: one gain a picture and channel, by least squares over the medians of log ratios of all pairs that
/// overlap. Error where a picture's size is not its lens's.
inline Stitched stitch(const std::vector<LensPicture>& pictures, const StitchOptions& options = {}) {
  using namespace detail;
  if (pictures.empty()) throw Error("no picture to stitch, expected at least one");
  for (const LensPicture& p : pictures)
    if (p.image.width != p.lens.width || p.image.height != p.lens.height)
      throw Error("picture " + std::to_string(p.image.width) + " x " + std::to_string(p.image.height) +
                  ", its lens \"" + p.lens.name + "\" " + std::to_string(p.lens.width) + " x " +
                  std::to_string(p.lens.height) + ": they must agree");
  const std::size_t n = pictures.size();
  Stitched out;
  out.gains.assign(n, {1, 1, 1});
  if (options.match_exposure && n > 1) out.gains = matched_gains(pictures, options.feather);
  std::vector<double> apart;
  each_overlap(pictures, options.feather, [&](std::size_t a, std::size_t b, const auto& x, const auto& z) {
    const double p = double(x.y * out.gains[a].y), q = double(z.y * out.gains[b].y);
    apart.push_back(2 * std::abs(p - q) / (p + q));
  });
  out.seam = median(apart);

  const int h = std::max(options.height, 2), w = 2 * h;
  out.panorama = Image(w, h), out.seen = Mask(w, h);
  parallel_for(h, [&](int y) {
    for (int x = 0; x < w; ++x) {
      const vec3<double> d = latlong_direction((x + 0.5) / w, (y + 0.5) / h);
      vec3<float> sum;
      float all = 0;
      for (std::size_t a = 0; a < n; ++a) {
        const float weight = lens_weight(pictures[a].lens, d, options.feather);
        if (weight <= 0) continue;
        sum += sampled(pictures[a].image, pictures[a].lens.project(d)) * out.gains[a] * weight;
        all += weight;
      }
      if (all <= 0) continue;
      out.panorama.set(x, y, sum / all);
      out.seen.at(x, y) = 1;
    }
  });
  return out;
}

}  // namespace burnish
