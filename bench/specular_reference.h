// bench/specular_reference.h -- a GGX lobe under a panorama, integrated in double until it stands: value and slope
// SPDX-License-Identifier: Apache-2.0
//
// Shares nothing with light/: its own lookup, lobe and quadrature. Two techniques, weighted by the balance heuristic
// (Veach 1995): directions drawn from the panorama's texels, and half vectors from the distribution of normals itself;
// both rank-1 lattices, shifted from set to set. The slope by roughness is that of the integrand at fixed directions.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>
#include <burnish/ad/packet.h>
#include <burnish/math/vec.h>
#include <burnish/scene/image.h>

namespace specular_reference {
using burnish::vec2, burnish::vec3;
constexpr double pi = 3.14159265358979323846;
constexpr double f0 = 0.04;

struct Pair {
  double value = 0, slope = 0;  // slope by perceptual roughness
};

/// Luminance of a lat-long picture, bilinear; +Y up, u = 0 looks to -Z, u = 1/4 to +X.
struct Panorama {
  int width, height;
  std::vector<double> luminance, density, cumulative;  // density: of a sample, per texel, not yet normalised

  explicit Panorama(const burnish::Image& p) : width(p.width), height(p.height) {
    const int n = width * height;
    double mean = 0, area = 0;
    for (int i = 0; i < n; ++i) {
      const double y = 0.2126 * p.plane(0)[i] + 0.7152 * p.plane(1)[i] + 0.0722 * p.plane(2)[i], s = sine(i / width);
      luminance.push_back(y > 0 ? y : 0);
      mean += luminance.back() * s, area += s;
    }
    cumulative.push_back(0);
    for (int i = 0; i < n; ++i) {
      density.push_back((luminance[i] + 0.05 * mean / area) * sine(i / width));
      cumulative.push_back(cumulative.back() + density.back());
    }
  }
  double sine(int row) const { return std::sin(pi * (row + 0.5) / height); }
  static vec2<double> place(const vec3<double>& d) {
    const double u = std::atan2(d.x, -d.z) / (2 * pi);
    return {u < 0 ? u + 1 : u, std::atan2(std::hypot(d.x, d.z), d.y) / pi};
  }
  static vec3<double> direction(const vec2<double>& at) {
    const double s = std::sin(pi * at.y);
    return {s * std::sin(2 * pi * at.x), std::cos(pi * at.y), -s * std::cos(2 * pi * at.x)};
  }
  double bilinear(const std::vector<double>& from, const vec2<double>& at) const {
    const double x = at.x * width - 0.5, y = at.y * height - 0.5;
    const int i = int(std::floor(x)), j = int(std::floor(y));
    const double fx = x - i, fy = y - j;
    const double* top = &from[std::size_t(std::max(j, 0)) * width];
    const double* low = &from[std::size_t(std::min(j + 1, height - 1)) * width];
    const int a = (i + width) % width, b = (i + 1) % width;
    return (1 - fy) * ((1 - fx) * top[a] + fx * top[b]) + fy * ((1 - fx) * low[a] + fx * low[b]);
  }
  /// Density of sample() at that place, per steradian.
  double probability(const vec2<double>& at) const {
    return bilinear(density, at) * width * height / (cumulative.back() * 2 * pi * pi * std::sin(pi * at.y) + 1e-300);
  }
  /// A place in a texel chosen by its light, tent-distributed around its middle.
  vec2<double> sample(double which, double x, double y) const {
    const auto at = std::upper_bound(cumulative.begin(), cumulative.end(), which * cumulative.back());
    const int k = std::clamp(int(at - cumulative.begin()) - 1, 0, width * height - 1);
    const auto tent = [](double q) { return q < 0.5 ? std::sqrt(2 * q) - 1 : 1 - std::sqrt(2 * (1 - q)); };
    double u = (k % width + 0.5 + tent(x)) / width, v = (k / width + 0.5 + tent(y)) / height;
    u -= std::floor(u), v = v < 0 ? -v : v > 1 ? 2 - v : v;
    return {u, std::clamp(v, 1e-9, 1 - 1e-9)};
  }
};

/// A view: surface normal and direction to the viewer, unit; in the frame x y n the view lies in the x-n plane.
struct View {
  vec3<double> n, v, x, y;
  double nv, sv;
  View(const vec3<double>& normal, const vec3<double>& view) : n(normalize(normal)), v(normalize(view)) {
    nv = dot(n, v);
    const vec3<double> side = v - n * nv;
    x = normalize(
        dot(side, side) > 1e-12 ? side : cross(n, std::abs(n.x) < 0.6 ? vec3<double>(1, 0, 0) : vec3<double>(0, 1, 0)));
    y = cross(n, x), sv = std::sqrt(std::max(0.0, 1 - nv * nv));
  }
  vec3<double> world(double a, double b, double c) const { return x * a + y * b + n * c; }
};
/// Normals over the whole sphere, cosines of the view even from .08 to 1.
inline std::vector<View> views(int count) {
  std::vector<View> all;
  const auto spread = [](int i, double by, double from) { return std::fmod(i * by + from, 1.0); };
  for (int i = 0; i < count; ++i) {
    const double z = 1 - 2 * (i + 0.5) / count, p = 2 * pi * spread(i, 0.6180339887498949, 0), s = std::sqrt(1 - z * z);
    const View at({s * std::cos(p), z, s * std::sin(p)}, {s * std::cos(p), z, s * std::sin(p)});
    const double nv = 0.08 + 0.92 * spread(i, 0.7548776662466927, 0.5), sv = std::sqrt(1 - nv * nv),
                 q = 2 * pi * spread(i, 0.5698402909980532, 0.25);
    all.emplace_back(at.n, at.world(sv * std::cos(q), sv * std::sin(q), nv));
  }
  return all;
}

/// D, V and F by double or packets: distribution of normals (GGX), height-correlated Smith visibility, Schlick's curve.
template <class T> struct Ggx {
  double r, a2, nv, sv, change_v;
  Ggx(double roughness, double cosine)
      : r(roughness),
        a2(r * r * r * r),
        nv(cosine),
        sv(std::sqrt(a2 + (1 - a2) * nv * nv)),
        change_v((1 - nv * nv) / (2 * sv)) {}
  /// value: D V F nl; slope: by roughness; t2: tan^2 of the half vector's angle, hz its cosine.
  void operator()(T nl, T vh, T hz, T t2, T* density, T* value, T* slope) const {
    const T q = 1 / (a2 + t2), z2 = hz * hz, d = a2 / pi * q * q / (z2 * z2);
    const T sl = sqrt(a2 + (1 - a2) * nl * nl), both = 1 / (nl * sv + nv * sl);
    const T m = 1 - vh, fresnel = f0 + (1 - f0) * (m * m * m * m * m);
    *density = d;
    *value = d * 0.5 * both * fresnel * nl;
    *slope = *value * (1 / a2 - 2 * q - both * (nl * change_v + nv * (1 - nl * nl) / (2 * sl))) * (4 * r * r * r);
  }
};
/// The lobe of the published grid renderer (bench/specular_grid.h), its clamps away.
template <class T> struct Published {
  double r, a2, nv, k, gv, log_slope_v;
  Published(double roughness, double cosine)
      : r(roughness),
        a2(r * r * r * r),
        nv(cosine),
        k((r + 1) * (r + 1) / 8),
        gv(1 / (nv * (1 - k) + k)),
        log_slope_v(-(1 - nv) * gv * (r + 1) / 4) {}
  void operator()(T nl, T vh, T hz, T t2, T* density, T* value, T* slope) const {
    const T q = 1 / (a2 + t2), z2 = hz * hz, d = a2 / pi * q * q / (z2 * z2), gl = 1 / (nl * (1 - k) + k);
    const T fresnel = f0 + (1 - f0) * exp(((-5.55472 * vh - 6.98316) * vh) * 0.6931471805599453);
    *density = d;
    *value = d * 0.25 * gv * gl * fresnel * nl;
    *slope = *value * ((1 / a2 - 2 * q) * (4 * r * r * r) + log_slope_v - (1 - nl) * gl * ((r + 1) / 4));
  }
};

/// The quadrature of a panorama: `samples` directions a technique.
class Quadrature {
public:
  Quadrature(const Panorama& p, int samples, int set) : light(p), count(samples) {
    shift = {0.13 + 0.37 * set, 0.71 + 0.21 * set};
    for (auto* v : {&x, &y, &z, &radiance, &probability}) v->resize(count);
    for (int i = 0; i < count; ++i) {
      const vec2<double> at =
          p.sample((i + std::fmod(shift.x, 1.0)) / count, std::fmod(i * 0.7548776662466927 + shift.y, 1.0),
                   std::fmod(i * 0.5698402909980532 + shift.x, 1.0));
      const vec3<double> d = Panorama::direction(at);
      x[i] = d.x, y[i] = d.y, z[i] = d.z, radiance[i] = p.bilinear(p.luminance, at), probability[i] = p.probability(at);
    }
  }
  template <template <class> class Lobe> Pair integral(const View& view, double roughness) const {
    using P = burnish::Packet<double, 8>;
    const Lobe<P> lobe(roughness, view.nv);
    P value = 0.0, slope = 0.0;
    for (int i = 0; i < count; i += 8) {
      const P lx = P::load(&x[i]), ly = P::load(&y[i]), lz = P::load(&z[i]), l = P::load(&radiance[i]),
              nl = lx * view.n.x + ly * view.n.y + lz * view.n.z, up = max(nl, 1e-9);
      const P hx = lx * view.x.x + ly * view.x.y + lz * view.x.z + view.sv,
              hy = lx * view.y.x + ly * view.y.y + lz * view.y.z, h = up + view.nv;
      const P flat = hx * hx + hy * hy, over = 1 / sqrt(flat + h * h), hz = h * over,
              vh = (hx * view.sv + h * view.nv) * over;
      P d, f, df;
      lobe(up, vh, hz, flat / (h * h), &d, &f, &df);
      const P weight = select(nl > 1e-9, l / (P::load(&probability[i]) + d * hz / (4 * vh)), P(0.0));
      value += f * weight, slope += df * weight;
    }
    Pair sum{value.sum(), slope.sum()};
    const Lobe<double> one(roughness, view.nv);
    const double a2 = roughness * roughness * roughness * roughness;
    for (int i = 0; i < count; ++i) {
      const double u = (i + 0.5) / count, angle = 2 * pi * std::fmod(i * 0.6180339887498949 + shift.x, 1.0),
                   t2 = a2 * u / (1 - u), hz = 1 / std::sqrt(1 + t2), s = std::sqrt(t2) * hz, hx = s * std::cos(angle),
                   vh = hx * view.sv + hz * view.nv, nl = 2 * vh * hz - view.nv;
      if (vh <= 0 || nl <= 1e-9) continue;
      const vec2<double> at = Panorama::place(view.world(2 * vh * hx - view.sv, 2 * vh * s * std::sin(angle), nl));
      double d, f, df;
      one(nl, vh, hz, t2, &d, &f, &df);
      const double weight = light.bilinear(light.luminance, at) / (light.probability(at) + d * hz / (4 * vh));
      sum.value += f * weight, sum.slope += df * weight;
    }
    return {sum.value / count, sum.slope / count};
  }

private:
  const Panorama& light;
  int count;
  vec2<double> shift;
  std::vector<double> x, y, z, radiance, probability;
};

}  // namespace specular_reference
