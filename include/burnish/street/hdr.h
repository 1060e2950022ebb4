// burnish/street/hdr.h -- from a panorama of eight bits to light: what was clipped of sky and sun is put back
// SPDX-License-Identifier: Apache-2.0
//
// Lat-long panoramas as in light/environment.h, linear RGB, the photo's white at 1, level, of any size. No network is
// asked, but what one predicts can be handed to compose_hdr.
#pragma once
#include <burnish/scene/error.h>
#include <burnish/street/refine_sun.h>
#include <burnish/street/sky_fit.h>

namespace burnish {

enum class SkyKind {
  sunny,   ///< the sun is seen
  cloudy,  ///< a sky without a sun that is seen: clouds, dusk, or the sun is hidden
  none     ///< indoors, or no sky was found: the panorama is given back as it is
};

struct HdrPanorama {
  Image panorama;  ///< linear, the input's size and white
  SkyKind kind = SkyKind::none;
  vec3<float> sun_direction;  ///< unit, towards the sun; not sunny: the best guess
  double sun_sigma = 3;       ///< its standard deviation, rad; 3 for nothing known
  /// Of a surface that faces the sun, by its disc alone, radiance x sr; 0 where none is seen.
  vec3<float> sun_irradiance;
  double sun_factor = 1;  ///< e^(standard deviation of ln sun_irradiance)
  FittedSky sky;          ///< sky.residual says how well the model holds
  SkyMask mask;           ///< at mask_height rows
  SunSpot spot;

  static constexpr int mask_height = 256;
};

namespace detail {
/// Irradiance of an upward surface, luminance.
inline double irradiance_up(const Image& p) {
  double sum = 0;
  for (int y = 0; y < p.height / 2; ++y) {
    const double up = std::cos((y + 0.5) * 3.141592653589793 / p.height) * texel_area(p.width, p.height, y);
    for (int x = 0; x < p.width; ++x) sum += up * double(luminance(p.at(x, y)));
  }
  return sum;
}
}  // namespace detail

/// Puts back what was clipped. Error for a panorama that is none (not twice as wide as high, to 2 %).
inline HdrPanorama estimate_hdr(const Image& ldr);

/// The paper's composition: the sky from a prediction in HDR (any size, any exposure), all else from the panorama; the
/// prediction's range is aligned by what is not clipped in the panorama.
inline Image compose_hdr(const Image& ldr, const Image& hdr_prediction);

namespace detail {
inline void check_panorama(const Image& p, const char* what) {
  if (p.width < 16 || p.height < 8 || std::fabs(double(p.width) / p.height - 2) > 0.04)
    throw Error(std::string(what) + ": " + std::to_string(p.width) + " x " + std::to_string(p.height) +
                ", expected a lat-long panorama twice as wide as high");
}
/// Luminance of the sky against the angle from the sun, where it is not clipped: ln L = a - p ln(angle).
struct Glow {
  double a = 0, p = 0;
  double operator()(double angle) const { return std::exp(a - p * std::log(std::max(angle, 0.02))); }
};
inline Glow fit_glow(const std::vector<SkySample>& samples, const vec3<double>& sun, double inner) {
  double n = 0, x1 = 0, y1 = 0, xx = 0, xy = 0;
  for (const auto& s : samples) {
    const double g = std::acos(std::clamp(dot(s.direction, sun), -1.0, 1.0));
    if (g > inner + 0.5) continue;
    const vec3<double> c(std::exp(s.ln_radiance.x), std::exp(s.ln_radiance.y), std::exp(s.ln_radiance.z));
    const double x = std::log(std::max(g, 0.02)), y = std::log(luminance(c));
    n += 1, x1 += x, y1 += y, xx += x * x, xy += x * y;
  }
  if (n < 20) return {0, 0};
  const double slope = (xy - x1 * y1 / n) / std::max(xx - x1 * x1 / n, 1e-6);
  const double p = std::clamp(-slope, 0.0, 1.8);
  // Through the rim of what is clipped, where radiance is 1.
  return {p * std::log(std::max(inner, 0.02)), p};
}

/// Of a sky whose luminance is log-normal with a deviation of 0.5 and clipped in that part that the mask says: the
/// mean of what is clipped. Between 1.2 (a few white clouds) and about 3 (all of it is white).
inline double mean_above_white(const Image& p, const SkyMask& m) {
  double clipped = 0, all = 1e-9;
  for (int y = 0; y < p.height; ++y) {
    const double area = texel_area(p.width, p.height, y);
    for (int x = 0; x < p.width; ++x) {
      if (m.sky.at(x, y) > 0.5f) all += area, clipped += area * double(m.clipped.at(x, y));
    }
  }
  const double q = std::clamp(clipped / all, 0.01, 0.97), sigma = 0.5;
  const auto below = [](double x) { return 0.5 * std::erfc(-x * 0.7071067811865475); };
  double low = -3, high = 3;  // the normal's quantile q
  for (int step = 0; step < 40; ++step) (below(0.5 * (low + high)) < q ? low : high) = 0.5 * (low + high);
  return std::exp(sigma * low + sigma * sigma / 2) * below(low + sigma) / q;
}
/// Of the ground: the mean over the outdoor panoramas that were looked at; half and twice as much are met.
inline constexpr double believed_albedo = 0.12;

struct SunStrength {
  double irradiance = 0, sigma = 1;  // luminance, of a surface that faces the sun; of its logarithm
};
/// Three guesses, each as sure as it was found to be on real panoramas, put together as logarithms.
inline SunStrength sun_strength(const Image& small, const HdrPanorama& found, const Glow& glow, double sky_up) {
  const vec3<double> sun = vec3<double>(found.sun_direction);
  const double up = std::max(sun.y, 0.03), degrees = found.spot.radius * 57.29578;
  double sum = 0, weights = 0;
  const auto guess = [&](double value, double sigma) {
    sum += std::log(std::max(value, 1e-6)) / sigma / sigma, weights += 1 / sigma / sigma;
  };
  // The glare's size, as far as the air lets the sun through.
  const double through = luminance(sun_irradiance(3.5, sun)) / 126;
  guess(0.7 * std::pow(degrees, 0.6) * through, 0.9);
  // The fitted sky's own sun.
  const vec3<double> model =
      sun_irradiance(std::min(found.sky.sky.turbidity, 5.0), sun) * found.sky.scale * (1 / 0.683);
  guess(luminance(model), std::hypot(0.1, 5 * found.sky.residual));
  // The ground's radiance, by its believed albedo.
  std::vector<double> ground;
  const int h = small.height;
  for (int y = h * 7 / 12; y < h; ++y) {
    for (int x = 0; x < small.width; x += row_step(h, y)) ground.push_back(double(luminance(small.at(x, y))));
  }
  const double lit = 3.14159 * median_of(ground) / believed_albedo - sky_up;
  if (up > 0.2) guess(std::max(lit, 0.1 * sky_up) / up, 1.3);
  // A sun behind a cloud makes a white spot without a slope around; under a sky that is as clear as the model it is
  // seen.
  const double t = std::clamp(std::max((glow.p - 0.2) / 0.3, (0.1 - found.sky.residual) / 0.06), 0.0, 1.0);
  const double seen = t * t * (3 - 2 * t);
  return {std::exp(sum / weights) * seen, std::sqrt(1 / weights)};
}
}  // namespace detail

inline HdrPanorama estimate_hdr(const Image& ldr) {
  detail::check_panorama(ldr, "panorama");
  HdrPanorama out;
  out.panorama = ldr;
  const int h = HdrPanorama::mask_height;
  const Image small = detail::resampled_panorama(ldr, h);
  out.mask = find_sky(small);
  if (out.mask.evidence <= 0) return out;
  out.kind = SkyKind::cloudy;
  // Of the spots the one about which the sky is most like a sky.
  const auto few = detail::sky_samples(small, out.mask, 300);
  double best = 0;
  const auto spots = find_suns(small, out.mask);
  for (std::size_t i = 0; i < spots.size() && i < 4; ++i) {
    const double misfit = fit_sky(few, spots[i].direction, 0.05, detail::believed_albedo, 8).residual;
    const double score = spots[i].plausible * std::pow(0.05 / (0.05 + misfit), 2);
    if (score > best) best = score, out.spot = spots[i];
  }
  const auto samples = detail::sky_samples(small, out.mask, 1000);
  const bool spotted = best > 1e-3;
  if (spotted) {
    const RefinedSun refined = refine_sun(small, out.mask, out.spot);
    out.spot.direction = refined.direction, out.spot.sigma = refined.sigma;
  }
  out.sky = fit_sky(samples, spotted ? out.spot.direction : vec3<double>(0, 0.7071, -0.7071), spotted ? 0.02 : 2.0,
                    detail::believed_albedo);
  const vec3<double> sun = spotted ? out.spot.direction : out.sky.sun;
  out.sun_direction = vec3<float>(sun);
  out.sun_sigma = spotted ? out.spot.sigma : std::max(out.sky.sun_sigma, 0.3);

  // The clipped sky: about the sun by the fall of the glow, elsewhere what is likely above white.
  const double white = detail::mean_above_white(small, out.mask);
  const detail::Glow glow = spotted ? detail::fit_glow(samples, sun, out.spot.radius) : detail::Glow{};
  const Mask sky = resized(out.mask.sky, ldr.width, ldr.height);
  for (int y = 0; y < ldr.height; ++y) {
    for (int x = 0; x < ldr.width; ++x) {
      const vec3<float> c = ldr.at(x, y);
      if (sky.at(x, y) < 0.3f || std::max({c.x, c.y, c.z}) < clipped_from) continue;
      const vec3<double> d = latlong_direction((x + 0.5) / ldr.width, (y + 0.5) / ldr.height);
      const double angle = std::acos(std::clamp(dot(d, sun), -1.0, 1.0));
      const double l = spotted && angle < 1.3 * out.spot.radius ? std::clamp(glow(angle), 1.0, 50.0) : white;
      const auto back = [&](float v) { return v >= clipped_from ? std::max(v, float(l)) : v; };
      out.panorama.set(x, y, {back(c.x), back(c.y), back(c.z)});
    }
  }
  if (!spotted) return out;
  const double sky_up = detail::irradiance_up(detail::resampled_panorama(out.panorama, h)), up = std::max(sun.y, 0.03);
  const detail::SunStrength strength = detail::sun_strength(small, out, glow, sky_up);
  const double e = strength.irradiance;
  if (e * up < 0.01 * sky_up && e < 0.03 * sky_up) return out;
  out.kind = SkyKind::sunny;
  // Its colour: the fitted sky's as far as that holds, else that of a sun of this height, white at 45 degrees.
  const vec3<double> model = sun_irradiance(std::min(out.sky.sky.turbidity, 4.0), sun) * out.sky.scale;
  const vec3<double> usual = sun_irradiance(3.0, sun) / sun_irradiance(3.0, vec3<double>(0, 0.7071, 0.7071));
  const double clear = std::clamp((0.2 - out.sky.residual) / 0.1, 0.0, 1.0);
  const auto unit_light = [](const vec3<double>& c) {
    const vec3<double> some = max(c, vec3<double>(1e-9));
    return some / luminance(some);
  };
  out.sun_irradiance = vec3<float>(mix(unit_light(usual), unit_light(model), clear) * e);
  out.sun_factor = std::exp(strength.sigma);
  // The disc, 0.53 degrees wide or at least three texels.
  const double radius = std::max(0.0047, 1.5 * 3.141592653589793 / ldr.height);
  double area = 0;
  const auto over_disc = [&](auto f) {
    for (int y = 0; y < ldr.height; ++y) {
      for (int x = 0; x < ldr.width; ++x) {
        const vec3<double> d = latlong_direction((x + 0.5) / ldr.width, (y + 0.5) / ldr.height);
        if (dot(d, sun) > std::cos(radius)) f(x, y);
      }
    }
  };
  over_disc([&](int, int y) { area += detail::texel_area(ldr.width, ldr.height, y); });
  over_disc(
      [&](int x, int y) { out.panorama.set(x, y, out.panorama.at(x, y) + out.sun_irradiance * float(1 / area)); });
  return out;
}

inline Image compose_hdr(const Image& ldr, const Image& hdr_prediction) {
  detail::check_panorama(ldr, "panorama");
  detail::check_panorama(hdr_prediction, "HDR prediction");
  const SkyMask m = find_sky(detail::resampled_panorama(ldr, HdrPanorama::mask_height));
  const Mask sky = resized(m.sky, ldr.width, ldr.height);
  const Image predicted = resized(hdr_prediction, ldr.width, ldr.height);
  std::vector<double> ratio;
  for (int y = 0; y < ldr.height; ++y) {
    for (int x = 0; x < ldr.width; x += detail::row_step(ldr.height, y)) {
      const vec3<float> c = ldr.at(x, y), p = predicted.at(x, y);
      if (sky.at(x, y) > 0.99f && std::max({c.x, c.y, c.z}) < clipped_from && luminance(p) > 1e-6f)
        ratio.push_back(double(luminance(c) / luminance(p)));
    }
  }
  const float align = ratio.empty() ? 1 : float(detail::median_of(ratio));
  Image out = ldr;
  for (int y = 0; y < ldr.height; ++y) {
    for (int x = 0; x < ldr.width; ++x) out.set(x, y, mix(ldr.at(x, y), predicted.at(x, y) * align, sky.at(x, y)));
  }
  return out;
}

}  // namespace burnish
