// tests/shade/laws.cpp -- the physics of the layered reflection: normalised, reciprocal, never more than it gets
// SPDX-License-Identifier: Apache-2.0
//
// The independent path is a second writing of the model, from the papers and in their form (angles by their tangents,
// Smith by Lambda: Walter et al. 2007, Heitz 2014; the layers by the head of shade/brdf.h), and rules of quadrature of
// its own: Gauss and Legendre's over directions of light, the trapezoid's in ln tan theta.
#include <burnish/ad/check.h>
#include <burnish/shade/brdf.h>
#include <record.h>
#include "quadrature.h"
#include <burnish_test.h>

namespace {
using namespace burnish;
using quadrature::direction, quadrature::tau, quadrature::Vec;

/// Nodes and weights on [0, 1] (Newton's method on the Legendre polynomial).
struct Gauss {
  std::vector<double> x, w;
  explicit Gauss(int n) : x(std::size_t(n)), w(std::size_t(n)) {
    for (int i = 0; i < n; ++i) {
      double t = std::cos(tau / 2 * (i + 0.75) / (n + 0.5)), slope = 1;
      for (int round = 0; round < 50; ++round) {
        double before = 1, p = t;
        for (int k = 2; k <= n; ++k) before = std::exchange(p, ((2 * k - 1) * t * p - (k - 1) * before) / k);
        slope = n * (t * p - before) / (t * t - 1);
        t -= p / slope;
      }
      x[std::size_t(i)] = (1 + t) / 2, w[std::size_t(i)] = 1 / ((1 - t * t) * slope * slope);
    }
  }
};

// ---- the model, written a second time -------------------------------------------------------------------------------

double d_of(double alpha, double c) {
  const double tan2 = (1 - c * c) / (c * c), k = 1 + tan2 / (alpha * alpha);
  return 2 / (tau * alpha * alpha * c * c * c * c * k * k);
}
double lambda_of(double alpha, double c) { return (std::sqrt(1 + alpha * alpha * (1 - c * c) / (c * c)) - 1) / 2; }
double schlick(double f0, double f90, double c) { return f0 + (f90 - f0) * std::pow(1 - c, 5); }
/// D F G2 / (4 nl nv).
double microfacets(double roughness, double f0, double f90, double nl, double nv, double nh, double vh) {
  const double alpha = roughness * roughness;
  return d_of(alpha, nh) * schlick(f0, f90, vh) / (1 + lambda_of(alpha, nl) + lambda_of(alpha, nv)) / (4 * nl * nv);
}
/// A grey surface: metal (1) or dielectric (0) of an albedo, under a coat of weight 1 or 0, no darkening.
struct Grey {
  double albedo, metal, roughness, coat, coat_roughness;
  double f(double nl, double nv, double nh, double vh) const {
    const double base_f0 = metal > 0 ? albedo : 0.04;
    const double wider = std::pow(roughness, 4) + 2 * std::pow(coat_roughness, 4);
    const double rough = coat > 0 ? std::pow(std::min(1.0, wider), 0.25) : roughness;
    const auto coat_of = [&](double c) { return coat * schlick(0.04, 1, c); };
    const auto through = [&](double c) { return 1 - schlick(0.04, 1, c); };
    const double diffuse = metal > 0 ? 0 : albedo * 2 / tau * through(nl) * through(nv);
    return coat * microfacets(coat_roughness, 0.04, 1, nl, nv, nh, vh) +
           (1 - coat_of(nl)) * (1 - coat_of(nv)) * (microfacets(rough, base_f0, 1, nl, nv, nh, vh) + diffuse);
  }
  Surface<double> surface() const {
    Surface<double> s;
    s.base_color = {albedo, albedo, albedo}, s.base_metalness = metal, s.specular_roughness = roughness;
    s.coat_weight = coat, s.coat_roughness = coat_roughness, s.coat_ior = 1.5, s.coat_darkening = 0;
    return s;
  }
};
/// The integral of f_cos(l, h) over directions l of the hemisphere.
template <class F> double over_light(double nv, const Gauss& rule, F f_cos) {
  double sum = 0;
  const Vec v = direction(nv, 0);
  for (std::size_t i = 0; i < rule.x.size(); ++i) {
    const double a = tau / 4 * rule.x[i], measure = std::sin(a) * tau / 4 * rule.w[i];
    for (std::size_t j = 0; j < rule.x.size(); ++j) {
      const Vec l = direction(std::cos(a), tau / 2 * rule.x[j]);
      sum += f_cos(l, normalize(v + l)) * measure * tau * rule.w[j];
    }
  }
  return sum;
}
const Vec up(0, 0, 1);
double average(const Vec& c) { return (c.x + c.y + c.z) / 3; }
Surface<double> any_surface(std::mt19937& random) {
  Surface<double> s;
  randomize(s, random);
  return s;
}
Vec any_above(std::mt19937& random, double least) {
  const auto part = [&] { return double(random()) / 4294967296.0; };
  const double c = least + (1 - least) * part();
  return direction(c, tau * part());
}
}  // namespace

TEST_CASE("Laws: D times the cosine integrates to 1, its visible part to the view's cosine", "[shade][energy]") {
  // In ln tan theta both ends fall off exponentially, and the trapezoid rule converges as fast.
  record::Worst worst, seen;
  int points = 0;
  for (const double r : {0.02, 0.05, 0.1, 0.3, 0.5, 0.7, 1.0}) {
    const double step = 0.05, middle = std::log(r * r);
    double sum = 0;
    for (int i = -700; i <= 700; ++i) {
      const double t = std::exp(middle + step * i), c = 1 / std::sqrt(1 + t * t);
      sum += ggx_d(r, c, t * t * c * c) * c * (c * c * c * t) * t * tau * step;  // sin dtheta = c^3 t^2 d(ln t)
    }
    worst(std::fabs(sum - 1));
    for (const double nv : {0.1, 0.5, 0.9}) {
      // int D max(v.h, 0) G1 dh = nv, over azimuth in closed parts: Gauss on either side of v.h = 0.
      const Vec v = direction(nv, 0);
      const Gauss side(40);
      double visible = 0;
      for (int i = -300; i <= 300; ++i) {
        const double t = std::exp(middle + 2 * step * i), c = 1 / std::sqrt(1 + t * t), s = t * c;
        const double edge = v.x * s > 0 ? std::acos(std::clamp(-nv * c / (v.x * s), -1.0, 1.0)) : tau / 2;
        double ring = 0;
        for (std::size_t k = 0; k < side.x.size(); ++k)
          ring += 2 * edge * side.w[k] * (nv * c + v.x * s * std::cos(edge * side.x[k]));
        visible += ggx_d(r, c, s * s) * ring * c * c * c * t * t * 2 * step;
      }
      seen(std::fabs(visible * ggx_g1(r, nv) / nv - 1));
    }
    ++points;
  }
  record::claim("ggx_d: normalisation", "law", "trapezoid rule in ln tan theta", 1e-6, worst.value, points);
  record::claim("ggx_g1: visible area is the view's cosine", "law", "trapezoid and Gauss-Legendre rules", 2e-5,
                seen.value, 3 * points);
}

TEST_CASE("Laws: the white furnace and the mean reflectance are those of the model written a second time",
          "[shade][energy]") {
  const Gauss rule(160);
  record::Worst metals, layered;
  int points = 0;
  for (const double nv : {0.15, 0.4, 0.8, 1.0})
    for (const double r : {0.3, 0.5, 0.8, 1.0}) {
      const auto apart = [&](const Grey& g) {
        const Surface<double> s = g.surface();
        const Vec v = direction(nv, 0);
        const double first = over_light(nv, rule, [&](const Vec& l, const Vec&) { return brdf_cos(s, up, v, l).x; });
        return std::fabs(first - over_light(nv, rule, [&](const Vec& l, const Vec& h) {
                           return g.f(l.z, nv, h.z, dot(v, h)) * l.z;
                         }));
      };
      metals(apart({1, 1, r, 0, 0.5}));
      layered(apart({1, 0, r, 0, 0.5})), layered(apart({0.5, 0, r, 1, 0.35})), layered(apart({0.9, 1, r, 1, 0.5}));
      ++points;
    }
  record::claim("brdf_cos: white furnace of a metal", "law", "Walter 2007 and Heitz 2014 by Gauss-Legendre",
                1e-6, metals.value, points);
  record::claim("brdf_cos: white furnace of coat, metal and dielectric", "law",
                "Walter 2007 and Heitz 2014 by Gauss-Legendre", 1e-6, layered.value, 3 * points);
}

TEST_CASE("Laws: no surface reflects more than it gets", "[shade][energy]") {
  std::mt19937 random(41);
  const int n = std::max(100, record::points() / 10);
  record::Worst most;
  for (int i = 0; i < n; ++i) {
    Surface<double> s = any_surface(random);
    // The brightest of its kind: what is colour is white.
    s.base_weight = s.specular_weight = 1;
    s.base_color = s.specular_color = s.coat_color = {1, 1, 1};
    if (i % 4 == 1) s.base_metalness = 1;
    if (i % 4 == 2) s.coat_weight = 1;
    if (i % 4 == 3) s.transmission_weight = 0, s.base_metalness = 0;
    const double nv = any_above(random, 0.02).z;
    most(quadrature::albedo(s, nv, 64).x + transmittance(s, nv).x);
  }
  // .0008 of it is the error of the fit in oren_nayar.
  record::claim("brdf_cos + transmittance: the most that leaves of 1", "law", "midpoints over half vectors and light",
                1.001, most.value, n);
  CHECK(most.value > 0.95);
}

TEST_CASE("Laws: light and view may change places", "[shade][symmetry]") {
  std::mt19937 random(3);
  record::Worst layered, lobes;
  for (int i = 0; i < record::points(); ++i) {
    const Surface<double> s = any_surface(random);
    const Vec v = any_above(random, 0.02), l = any_above(random, 0.02), h = normalize(v + l);
    layered(std::fabs(average(brdf_cos(s, up, v, l)) / l.z / (average(brdf_cos(s, up, l, v)) / v.z) - 1));
    const double r = s.specular_roughness, vl = dot(v, l), vh = dot(v, h);
    const auto ratio = [](double a, double b) { return std::fabs(a / b - 1); };
    lobes(ratio(ggx_v_smith_correlated(r, l.z, v.z), ggx_v_smith_correlated(r, v.z, l.z)));
    lobes(ratio(ggx_v_smith_separable(r, l.z, v.z), ggx_v_smith_separable(r, v.z, l.z)));
    lobes(ratio(average(oren_nayar(s.base_color, r, l.z, v.z, vl)),
                average(oren_nayar(s.base_color, r, v.z, l.z, vl))));
    lobes(ratio(average(burley(s.base_color, r, l.z, v.z, vh)), average(burley(s.base_color, r, v.z, l.z, vh))));
  }
  record::claim("brdf_cos: reciprocity", "law", "light and view exchanged", 1e-11, layered.value, record::points());
  record::claim("lobes: reciprocity", "law", "light and view exchanged", 1e-13, lobes.value, record::points());
}

TEST_CASE("Laws: the surface may be turned about its normal, and mirrored", "[shade][symmetry]") {
  std::mt19937 random(4);
  record::Worst worst;
  for (int i = 0; i < record::points(); ++i) {
    const Surface<double> s = any_surface(random);
    const Vec v = any_above(random, 0.02), l = any_above(random, 0.02);
    const double a = tau * double(random()) / 4294967296.0, c = std::cos(a), t = std::sin(a);
    const auto turned = [&](const Vec& d) { return Vec(c * d.x - t * d.y, -(t * d.x + c * d.y), d.z); };
    worst(std::fabs(average(brdf_cos(s, up, turned(v), turned(l))) / average(brdf_cos(s, up, v, l)) - 1));
  }
  record::claim("brdf_cos: isotropy and mirror symmetry", "law", "a random turn with a reflection", 1e-9, worst.value,
                record::points());
}

TEST_CASE("Laws: limits leave what they name", "[shade][limit]") {
  std::mt19937 random(5);
  record::Worst bare, mirror;
  int mirrors = 0;
  for (int i = 0; i < record::points(); ++i) {
    const Surface<double> s = any_surface(random);
    const Vec v = any_above(random, 0.05), l = any_above(random, 0.05);
    // The coat's other numbers are anything, and nothing of it is left.
    const Grey g{s.base_color.x, double(i % 2), s.specular_roughness, 0, 0.5};
    Surface<double> base = g.surface();
    base.coat_color = s.coat_color, base.coat_ior = s.coat_ior, base.coat_roughness = s.coat_roughness;
    base.coat_darkening = s.coat_darkening;
    const Vec h = normalize(v + l);
    bare(std::fabs(brdf_cos(base, up, v, l).y / (g.f(l.z, v.z, h.z, dot(v, h)) * l.z) - 1));
    if (i % 20) continue;
    // As smooth as it gets, in a sky that varies slowly: what it reflects is the sky in the mirror direction.
    const auto sky = [](const Vec& d) { return 1 + 0.5 * d.x - 0.3 * d.y + 0.2 * d.z; };
    Surface<double> metal;
    metal.base_color = s.base_color, metal.base_metalness = 1, metal.specular_roughness = 0;
    const Vec w = quadrature::viewer(v.z), back(-w.x, -w.y, w.z), f = fresnel_schlick(v.z, s.base_color);
    mirror(std::fabs(average(quadrature::reflected_light(metal, v.z, 120, sky)) / (average(f) * sky(back)) - 1));
    ++mirrors;
  }
  record::claim("brdf_cos: coat_weight 0 is the bare base", "law", "Walter 2007 and Heitz 2014", 1e-6, bare.value,
                record::points());
  record::claim("brdf_cos: roughness 0 is a mirror", "law", "Schlick's weight times the mirrored sky", 5e-3,
                mirror.value, mirrors);
}
