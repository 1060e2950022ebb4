// burnish/street/sky_fit.h -- Hosek and Wilkie's sky fitted to what is not clipped of a panorama's
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/ad/dual.h>
#include <burnish/street/find_sun.h>
#include <burnish/street/sky_model.h>

namespace burnish {

/// A clear sky in the units of a panorama, and how well it is known.
struct FittedSky {
  HosekWilkieSky<double> sky;
  vec3<double> scale{1};       ///< panorama / model, a factor for each channel: exposure and white balance
  vec3<double> sun;            ///< unit
  double sun_sigma = 3;        ///< rad, of the larger of its two angles
  double turbidity_sigma = 0;  ///< of ln turbidity
  double residual = 1e9;       ///< robust rms of ln radiance: 0.1 a clear sky, above 0.4 clouds
  int texels = 0;

  HosekWilkieLobes<double> lobes() const { return hosek_wilkie_lobes(sky); }
};

namespace detail {
struct SkySample {
  vec3<double> direction, ln_radiance;
};
/// At most `count` texels of open sky, evenly over the sphere, the same every time.
inline std::vector<SkySample> sky_samples(const Image& p, const SkyMask& m, int count) {
  std::vector<SkySample> all;
  for (int y = 0; y < p.height; ++y) {
    for (int x = (y * 7) % row_step(p.height, y); x < p.width; x += row_step(p.height, y)) {
      const vec3<float> c = p.at(x, y);
      const vec3<double> d = latlong_direction((x + 0.5) / p.width, (y + 0.5) / p.height);
      if (m.sky.at(x, y) < 0.5f || m.clipped.at(x, y) > 0.5f || d.y < 0.035) continue;
      all.push_back({d,
                     {std::log(std::max(double(c.x), 2e-3)), std::log(std::max(double(c.y), 2e-3)),
                      std::log(std::max(double(c.z), 2e-3))}});
    }
  }
  std::vector<SkySample> some;
  const std::size_t n = all.size(), step = std::max<std::size_t>(1, n / std::size_t(count));
  for (std::size_t i = step / 2; i < n; i += step) some.push_back(all[i]);
  return some;
}
}  // namespace detail

/// Levenberg and Marquardt's way (1944, 1963) on ln radiance, texels that fit badly (clouds) counted less (Cauchy at
/// 0.2). Free are turbidity, the channels' factors and the sun, which is held near `sun` with `sun_sigma` (rad).
/// Slopes are those of Dual.
inline FittedSky fit_sky(const std::vector<detail::SkySample>& samples, const vec3<double>& sun, double sun_sigma,
                         double albedo = 0.2, int steps = 25) {
  constexpr int n = 6;  // ln turbidity, the sun's two angles, ln of three factors
  using D = Dual<double, n>;
  using Numbers = std::array<double, n>;
  FittedSky out;
  out.sky.albedo = albedo, out.sun = sun, out.texels = int(samples.size());
  if (samples.size() < 60) return out;
  // The sun's angles are about axes across its first direction.
  const vec3<double> side =
                         normalize(cross(std::fabs(sun.y) < 0.95 ? vec3<double>(0, 1, 0) : vec3<double>(1, 0, 0), sun)),
                     over = cross(sun, side);
  const auto place = [&](const auto& a, const auto& b) {
    using T = std::remove_cvref_t<decltype(a)>;
    const vec3<T> d = vec3<T>(sun) + vec3<T>(side) * a + vec3<T>(over) * b;
    return d * (T(1.0f) / sqrt(dot(d, d)));
  };
  const Numbers prior = {std::log(3.0), 0, 0, 0, 0, 0}, tight = {2, 1 / sun_sigma, 1 / sun_sigma, 0, 0, 0};
  Numbers x = prior;
  double a[n][n], b[n], left = 0;
  const auto evaluate = [&](const Numbers& at, bool slopes) {
    std::array<D, n> v;
    for (int i = 0; i < n; ++i) v[std::size_t(i)] = D(at[std::size_t(i)], i);
    HosekWilkieSky<D> s;
    s.turbidity = clamp(exp(v[0]), 1.0f, 10.0f), s.albedo = D(albedo), s.sun = place(v[1], v[2]);
    const HosekWilkieLobes<D> lobes = hosek_wilkie_lobes(s);
    double cost = 0;
    if (slopes) {
      for (int i = 0; i < n; ++i) std::fill(a[i], a[i] + n, 0.0), b[i] = 0;
    }
    for (const auto& sample : samples) {
      const vec3<D> l = clear_sky_radiance(lobes, vec3<D>(sample.direction));
      const D r[3] = {log(max(l.x, 1e-4f)) + v[3] - sample.ln_radiance.x,
                      log(max(l.y, 1e-4f)) + v[4] - sample.ln_radiance.y,
                      log(max(l.z, 1e-4f)) + v[5] - sample.ln_radiance.z};
      for (const D& e : r) {
        const double q = e.value * e.value / 0.04, w = 1 / (1 + q);
        cost += std::log1p(q);
        if (!slopes) continue;
        for (int i = 0; i < n; ++i) {
          b[i] -= w * e.slope[std::size_t(i)] * e.value;
          for (int k = 0; k < n; ++k) a[i][k] += w * e.slope[std::size_t(i)] * e.slope[std::size_t(k)];
        }
      }
    }
    // As if a fiftieth of the texels were independent, against what is believed beforehand.
    const double each_counts = 0.02;
    cost *= each_counts;
    for (int i = 0; i < n; ++i) {
      const double off = (at[std::size_t(i)] - prior[std::size_t(i)]) * tight[std::size_t(i)];
      cost += off * off;
      if (!slopes) continue;
      for (int k = 0; k < n; ++k) a[i][k] *= each_counts / 0.04;
      b[i] *= each_counts / 0.04;
      a[i][i] += tight[std::size_t(i)] * tight[std::size_t(i)];
      b[i] -= off * tight[std::size_t(i)];
    }
    return cost;
  };
  // (a + damping diag(a)) move = b; also the inverse's diagonal, for the deviations.
  const auto solve = [&](double damping, Numbers& move, Numbers& inverse) {
    double m[n][2 * n + 1] = {};
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < n; ++k) m[i][k] = a[i][k];
      m[i][i] = a[i][i] * (1 + damping) + 1e-12, m[i][n] = b[i], m[i][n + 1 + i] = 1;
    }
    for (int i = 0; i < n; ++i) {
      int p = i;
      for (int k = i + 1; k < n; ++k) p = std::fabs(m[k][i]) > std::fabs(m[p][i]) ? k : p;
      std::swap(m[i], m[p]);
      for (int k = 0; k < n; ++k) {
        const double f = m[k][i] / m[i][i];
        for (int j = i; k != i && j < 2 * n + 1; ++j) m[k][j] -= f * m[i][j];
      }
    }
    for (int i = 0; i < n; ++i)
      move[std::size_t(i)] = m[i][n] / m[i][i], inverse[std::size_t(i)] = m[i][n + 1 + i] / m[i][i];
  };
  // The factors' start: the medians, so that the rest is shape.
  {
    HosekWilkieSky<double> s;
    s.albedo = albedo, s.sun = sun;
    const auto lobes = hosek_wilkie_lobes(s);
    std::vector<double> off[3];
    for (const auto& sample : samples) {
      const vec3<double> l = clear_sky_radiance(lobes, sample.direction);
      off[0].push_back(sample.ln_radiance.x - std::log(std::max(l.x, 1e-4)));
      off[1].push_back(sample.ln_radiance.y - std::log(std::max(l.y, 1e-4)));
      off[2].push_back(sample.ln_radiance.z - std::log(std::max(l.z, 1e-4)));
    }
    for (std::size_t c = 0; c < 3; ++c) x[3 + c] = detail::median_of(off[c]);
  }
  double damping = 1e-2, cost = evaluate(x, true);
  Numbers move{}, inverse{};
  for (int step = 0; step < steps; ++step) {
    solve(damping, move, inverse);
    Numbers next = x;
    for (std::size_t i = 0; i < n; ++i) next[i] += move[i];
    next[0] = std::clamp(next[0], 0.1, 2.29), next[1] = std::clamp(next[1], -1.0, 1.0);
    next[2] = std::clamp(next[2], -1.0, 1.0);
    const double now = evaluate(next, false);
    if (now < cost) {
      const bool done = cost - now < 1e-7 * cost;
      x = next, cost = evaluate(x, true), damping = std::max(damping * 0.3, 1e-9);
      if (done) break;
    } else if ((damping *= 5) > 1e6) break;
  }
  solve(0, move, inverse);
  out.sun = place(x[1], x[2]);
  out.sky.turbidity = std::exp(x[0]), out.sky.sun = out.sun;
  out.scale = {std::exp(x[3]), std::exp(x[4]), std::exp(x[5])};
  out.sun_sigma = std::sqrt(std::max({inverse[1], inverse[2], 0.0})),
  out.turbidity_sigma = std::sqrt(std::max(inverse[0], 0.0));
  std::vector<double> off;
  const auto lobes = out.lobes();
  for (const auto& sample : samples) {
    const vec3<double> l = clear_sky_radiance(lobes, sample.direction) * out.scale;
    off.push_back(std::fabs(std::log(std::max(l.y, 1e-4)) - sample.ln_radiance.y));
  }
  left = detail::median_of(off) * 1.4826;
  out.residual = left;
  return out;
}

}  // namespace burnish
