// tests/light/reference.h -- light against GGX integrated by brute force in double: the independent path of these tests
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <random>
#include <burnish/light/environment.h>

namespace reference {
using burnish::vec3;
constexpr double pi = 3.14159265358979323846;

struct Frame {
  vec3<double> x, y, z;
  explicit Frame(const vec3<double>& n) : z(n) {
    x = normalize(cross(std::abs(n.x) < 0.6 ? vec3<double>(1, 0, 0) : vec3<double>(0, 1, 0), n));
    y = cross(n, x);
  }
  vec3<double> world(double a, double b, double c) const { return x * a + y * b + z * c; }
};
inline double power5(double x) { return x * x * x * x * x; }
inline double smith(double a2, double nl, double nv) {
  return 0.5 / (nl * std::sqrt(a2 + (1 - a2) * nv * nv) + nv * std::sqrt(a2 + (1 - a2) * nl * nl));
}

/// int L D V nl {1 - x(vh), x(vh), x(nl) (1 - x(vh)), x(nl) x(vh)} over directions l, for a scalar L: half vectors
/// drawn from the distribution of normals itself, stratified in the polar angle, a golden spiral in azimuth.
template <class L> std::array<double, 4> specular(L radiance, const vec3<double>& n, const vec3<double>& v,
                                                  double roughness, int samples) {
  const Frame f(n);
  const double a2 = std::pow(roughness, 4), nv = dot(n, v);
  std::array<double, 4> sum{};
  for (int i = 0; i < samples; ++i) {
    const double u = (i + 0.5) / samples, t2 = a2 * u / (1 - u), hz = 1 / std::sqrt(1 + t2),
                 angle = 2.399963229728653 * i;
    const vec3<double> h = f.world(std::sqrt(t2) * hz * std::cos(angle), std::sqrt(t2) * hz * std::sin(angle), hz);
    const double vh = dot(v, h);
    if (vh <= 0) continue;
    const vec3<double> l = h * (2 * vh) - v;
    const double nl = dot(n, l);
    if (nl <= 0) continue;
    const double g = radiance(l) * smith(a2, nl, nv) * nl * 4 * vh / (hz * samples), fv = power5(1 - vh),
                 fl = power5(1 - nl);
    sum[0] += g * (1 - fv), sum[1] += g * fv, sum[2] += g * fl * (1 - fv), sum[3] += g * fl * fv;
  }
  return sum;
}
/// int L nl x(nl)^k over the hemisphere, k = 0, 1, 2: midpoint rule.
template <class L> std::array<double, 3> irradiance(L radiance, const vec3<double>& n, int steps) {
  const Frame f(n);
  std::array<double, 3> sum{};
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < 4 * steps; ++j) {
      const double c = (i + 0.5) / steps, s = std::sqrt(1 - c * c), a = 2 * pi * (j + 0.5) / (4 * steps);
      const double e = radiance(f.world(s * std::cos(a), s * std::sin(a), c)) * c * 2 * pi / (steps * 4.0 * steps),
                   x = power5(1 - c);
      sum[0] += e, sum[1] += e * x, sum[2] += e * x * x;
    }
  }
  return sum;
}
/// A panorama of a scalar function of direction, the mean over 2 x 2 places a texel.
template <class L> burnish::Image panorama(L radiance, int height) {
  burnish::Image p(2 * height, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < 2 * height; ++x) {
      double s = 0;
      for (int k = 0; k < 4; ++k)
        s += radiance(burnish::latlong_direction((x + 0.25 + 0.5 * (k & 1)) / (2 * height),
                                                 (y + 0.25 + 0.5 * (k >> 1)) / height)) /
             4;
      p.set(x, y, vec3<float>(float(s)));
    }
  }
  return p;
}
/// Random surfels: unit normal and view with dot(normal, view) > least.
struct Surfels {
  struct Surfel {
    vec3<float> normal, view;
  };
  std::vector<Surfel> all;
  Surfels(int n, double least, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const auto any = [&] {
      const double x = normal(random), y = normal(random), z = normal(random);  // in this order for every compiler
      return normalize(vec3<double>(x, y, z));
    };
    while (int(all.size()) < n) {
      const vec3<double> a = any(), b = any();
      if (dot(a, b) > least) all.push_back({vec3<float>(a), vec3<float>(b)});
    }
  }
  int size() const { return int(all.size()); }
  Surfel at(int i) const { return all[i]; }
};
inline vec3<double> unit_of(const vec3<float>& d) { return normalize(vec3<double>(d)); }
}  // namespace reference
