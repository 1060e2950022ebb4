// tests/shade/brdf.cpp -- the laws of burnish/shade/coat.h and brdf.h
// SPDX-License-Identifier: Apache-2.0
#include <burnish/shade/brdf.h>
#include <differences.h>
#include "corners.h"
#include "quadrature.h"
using namespace differences;
using namespace quadrature;

namespace {
const Vec z(0, 0, 1);
double total(const Vec& a) { return a.x + a.y + a.z; }
const auto weigh = [](const auto& c) { return c.x + 2.0f * c.y + 3.0f * c.z; };

template <class T> bool finite(const vec3<T>& c) {
  return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z);
}

Surface<double> white_metal(double roughness) {
  Surface<double> s;
  s.base_color = {1, 1, 1}, s.base_metalness = 1, s.specular_roughness = roughness;
  return s;
}
Surface<double> coated(double base, double metalness, double roughness, double ior) {
  Surface<double> s;
  s.base_color = {1, 1, 1}, s.base_metalness = metalness, s.specular_roughness = base;
  s.coat_weight = 1, s.coat_roughness = roughness, s.coat_ior = ior;
  return s;
}
}  // namespace

TEST_CASE("Coat: its formulas at their ends", "[shade][limit]") {
  CHECK(coated_roughness(0.3, 0.5, 0.0) == Approx(0.3).epsilon(1e-14));
  CHECK(coated_roughness(0.3, 0.0, 1.0) == Approx(0.3).epsilon(2e-5));  // a coat as smooth as it gets
  CHECK(coated_roughness(0.3, 0.5, 1.0) ==
        Approx(std::pow(std::pow(0.3, 4) + 2 * std::pow(0.5, 4), 0.25)).epsilon(1e-12));
  CHECK(coated_roughness(0.9, 1.0, 1.0) == 1);
  CHECK(coat_internal_reflectance(1.5, 0.0) == Approx(0.04).epsilon(1e-6));
  CHECK(coat_internal_reflectance(1.5, 1.0) == Approx(0.5963).epsilon(2e-3));  // Duntley 1942, table: .596 for 1.5
  CHECK(coat_internal_reflectance(1.0, 1.0) == Approx(0).margin(1e-12));
  // A white base loses nothing to the light it gets back; a grey one is the sum of the returns.
  CHECK(coat_darkening(Vec(1, 1, 1), 0.6).x == Approx(1).epsilon(1e-14));
  double sum = 0, caught = 1;
  for (int i = 0; i < 200; ++i, caught *= 0.3 * 0.6) sum += caught * 0.4;
  CHECK(coat_darkening(Vec(0.3, 0.3, 0.3), 0.6).x == Approx(sum).epsilon(1e-12));
}

TEST_CASE("Brdf: it is the formula of the file's head, term by term", "[shade][value]") {
  Surface<double> s = coated(0.35, 0.4, 0.1, 1.5);
  s.base_color = {0.6, 0.3, 0.1}, s.coat_weight = 0.8, s.coat_color = {0.9, 0.8, 0.7}, s.base_weight = 0.9;
  const Vec v = direction(0.8, 0.3), l = direction(0.6, 2.4), h = normalize(v + l);
  const double nl = 0.6, nv = 0.8, vh = dot(v, h), w = 0.8;
  const auto x5 = [](double c) { return std::pow(1 - c, 5); };
  const auto d = [&](double r) {
    const double a2 = std::pow(r, 4), k = h.z * h.z * (a2 - 1) + 1;
    return a2 / (tau / 2 * k * k);
  };
  const auto visible = [&](double r) {
    const double a2 = std::pow(r, 4);
    return 0.5 / (nl * std::sqrt(a2 + (1 - a2) * nv * nv) + nv * std::sqrt(a2 + (1 - a2) * nl * nl));
  };
  const auto coat = [&](double c) { return w * (0.04 + 0.96 * x5(c)); };
  const double rb = 0.35 * (1 - w) + w * std::pow(std::pow(0.35, 4) + 2e-4, 0.25);
  const double k = coat_internal_reflectance(1.5, 0.6 + 0.4 * 0.35);
  const Vec color(0.54, 0.27, 0.09), result = brdf_cos(s, z, v, l);
  const auto channel = [&](double albedo, double coat_color) {
    const double tint = (1 - w + w * coat_color) * (1 - w + w * (1 - k) / (1 - albedo * k));
    const double f0 = 0.6 * 0.04 + 0.4 * albedo, through = (1 - coat(nl)) * (1 - coat(nv));
    const double specular = d(rb) * visible(rb) * (f0 + (1 - f0) * x5(vh));
    const double diffuse = 0.6 * albedo * 2 / tau * (0.96 - 0.96 * x5(nl)) * (0.96 - 0.96 * x5(nv));
    return nl * (d(0.1) * visible(0.1) * coat(vh) + through * tint * (specular + diffuse));
  };
  // Schlick's white end and pi are floats in the library's text.
  CHECK(result.x == Approx(channel(color.x, 0.9)).epsilon(1e-6));
  CHECK(result.y == Approx(channel(color.y, 0.8)).epsilon(1e-6));
  CHECK(result.z == Approx(channel(color.z, 0.7)).epsilon(1e-6));
}

TEST_CASE("Brdf: there and back are the same", "[shade][symmetry]") {
  Random random(3);
  double worst = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto s = inside<Surface<double>>(random);
    const Vec v = upward(random, 0.02), l = upward(random, 0.02), n = upward(random, 0.999), c = upward(random, 0.999);
    const Vec one = brdf_cos(s, z, v, l) / l.z, two = brdf_cos(s, z, l, v) / v.z;
    worst = std::max(worst, std::abs(total(one) / total(two) - 1));
    // Each layer over its own normal: the diffuse base alone, then the coat alone.
    Surface<double> base = s;
    base.coat_weight = 0, base.base_diffuse_roughness = 0;
    if (dot(n, v) > 0.01 && dot(n, l) > 0.01) {
      const Vec a = brdf_cos(layers(base), n, c, v, l) / dot(n, l), b = brdf_cos(layers(base), n, c, l, v) / dot(n, v);
      worst = std::max(worst, std::abs(total(a) / total(b) - 1));
    }
  }
  CHECK(worst < 1e-11);
}

TEST_CASE("Brdf: nothing reflects more than it gets", "[shade][energy]") {
  double most = 0;
  for (const double nv : {0.02, 0.1, 0.3, 0.6, 1.0})
    for (const double r : {0.02, 0.2, 0.5, 1.0}) {
      for (const double metalness : {0.0, 0.5, 1.0}) {
        Surface<double> s = white_metal(r);
        s.base_metalness = metalness;
        most = std::max(most, albedo(s, nv, 80).x);
        s.specular_ior = 2.5;
        most = std::max(most, albedo(s, nv, 80).x);
        for (const double coat : {0.02, 0.3, 1.0})
          for (const double ior : {1.0, 1.6, 3.0})
            most = std::max(most, albedo(coated(r, metalness, coat, ior), nv, 80).x);
      }
      Surface<double> s = white_metal(r);
      s.base_metalness = 0, s.specular_weight = 0, s.base_diffuse_roughness = r;
      most = std::max(most, albedo(s, nv, 80).x);
    }
  CHECK(most < 1.001);  // .0008 is the error of the fit in oren_nayar
  CHECK(most > 0.999);
}

TEST_CASE("Brdf: a thin wall splits the light into reflected and transmitted", "[shade][energy]") {
  for (const double nv : {0.1, 0.3, 0.7, 1.0})
    for (const double coat : {0.0, 1.0}) {
      Surface<double> s;
      s.transmission_weight = 1, s.specular_roughness = 0.02, s.coat_weight = coat, s.coat_roughness = 0.02;
      s.coat_darkening = 0;
      const double back = albedo(s, nv, 200).x, through = transmittance(s, nv).x;
      CHECK(back + through <= 1.0005);
      if (coat == 0) CHECK(back + through == Approx(1).margin(2e-3));
      s.transmission_color = {0.5, 0.5, 0.5};
      CHECK(transmittance(s, nv).x == Approx(0.5 * through));
    }
  Surface<double> s;
  s.transmission_weight = 1;
  CHECK(transmittance(s, 1.0).x == Approx(1 - 2 * 0.04 / 1.04).epsilon(1e-6));
  CHECK(transmittance(Surface<double>{}, 1.0).x == 0);
}

TEST_CASE("Brdf: the white furnace, as single scattering leaves it", "[shade][energy]") {
  const auto furnace = [](const Surface<double>& s) {  // both directions over the hemisphere
    double sum = 0;
    for (int i = 0; i < 12; ++i) sum += albedo(s, std::sqrt((i + 0.5) / 12), 120).x / 12;
    return sum;
  };
  CHECK(furnace(white_metal(0.02)) == Approx(1).margin(2e-3));
  CHECK(furnace(white_metal(0.2)) == Approx(0.995).margin(2e-3));
  CHECK(furnace(white_metal(0.4)) == Approx(0.940).margin(3e-3));
  CHECK(furnace(white_metal(0.6)) == Approx(0.803).margin(3e-3));
  CHECK(furnace(white_metal(1.0)) == Approx(0.408).margin(3e-3));
  Surface<double> diffuse;
  diffuse.base_color = {1, 1, 1};
  CHECK(furnace(diffuse) == Approx(0.911).margin(2e-3));
  diffuse.specular_weight = 0;
  CHECK(furnace(diffuse) == Approx(1).margin(1e-4));
  CHECK(furnace(coated(0.3, 0, 0.02, 1.6)) == Approx(0.846).margin(3e-3));
  CHECK(furnace(coated(0.3, 1, 0.02, 1.6)) == Approx(0.902).margin(3e-3));
}

TEST_CASE("Brdf: a smooth surface is a mirror of Schlick's weight", "[shade][limit]") {
  for (const double nv : {0.1, 0.5, 0.9}) {
    Surface<double> s = white_metal(0.02);
    s.base_color = {0.3, 0.6, 0.9};
    const Vec a = albedo(s, nv, 200), f = fresnel_schlick(nv, s.base_color);
    CHECK(a.x == Approx(f.x).epsilon(4e-3));
    CHECK(a.y == Approx(f.y).epsilon(4e-3));
    Surface<double> black;
    black.base_color = {0, 0, 0}, black.specular_roughness = 0;
    CHECK(albedo(black, nv, 200).z == Approx(fresnel_schlick(nv, 0.04)).epsilon(4e-3));
  }
}

TEST_CASE("Brdf: weights of 0 and 1 leave what they name", "[shade][limit]") {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    auto s = inside<Surface<double>>(random);
    const Vec v = upward(random, 0.05), l = upward(random, 0.05);
    // Coat weight 0: nothing of the coat is left.
    auto a = s, b = s;
    a.coat_weight = b.coat_weight = 0;
    b.coat_color = {0.1, 0.2, 0.3}, b.coat_roughness = 0.9, b.coat_ior = 2.5, b.coat_darkening = 0;
    CHECK(total(brdf_cos(a, z, v, l)) == Approx(total(brdf_cos(b, z, v, l))).epsilon(1e-12));
    // A coat that is none (index 1, no colour) is not there, if it is as smooth as it can be.
    a = b = s;
    a.coat_weight = 1, a.coat_ior = 1, a.coat_color = {1, 1, 1}, a.coat_roughness = 0, b.coat_weight = 0;
    a.specular_roughness = b.specular_roughness = std::max(0.2, s.specular_roughness);
    CHECK(total(brdf_cos(a, z, v, l)) == Approx(total(brdf_cos(b, z, v, l))).epsilon(1e-3));
    // Metal has no diffuse light and does not know of the dielectric.
    a = b = s;
    a.base_metalness = b.base_metalness = 1;
    b.specular_ior = 2.9, b.specular_color = {0.2, 0.9, 0.4}, b.base_diffuse_roughness = 0.77,
    b.transmission_weight = 0.3;
    CHECK(total(brdf_cos(a, z, v, l)) == Approx(total(brdf_cos(b, z, v, l))).epsilon(1e-12));
    // No specular weight, no metal, no coat: Lambert.
    Surface<double> lambertian;
    lambertian.base_color = s.base_color, lambertian.specular_weight = 0;
    CHECK(brdf_cos(lambertian, z, v, l).y == Approx(s.base_color.y * l.z * 2 / tau).epsilon(1e-6));
  }
}

TEST_CASE("Brdf: light from below gives nothing, a coat's normal of its own moves only the coat", "[shade][limit]") {
  Surface<double> s = coated(0.3, 0.5, 0.2, 1.6);
  CHECK(total(brdf_cos(s, z, direction(0.5, 0), Vec(0.6, 0, -0.8))) == 0);
  CHECK(total(brdf_cos(s, z, direction(0.5, 0), Vec(1, 0, 0))) == 0);
  const Vec t(1, 0, 0), v = direction(0.9, 1), l = direction(0.8, 2), tilted = normalize(Vec(0.1, -0.05, 1));
  CHECK(total(brdf_cos(s, z, t, v, l)) == Approx(total(brdf_cos(s, z, v, l))).epsilon(1e-14));
  s.geometry_normal = s.geometry_coat_normal = tilted;
  CHECK(total(brdf_cos(s, z, t, v, l)) == Approx(total(brdf_cos(s, tilted, v, l))).epsilon(1e-14));
  s.coat_weight = 0, s.geometry_coat_normal = normalize(Vec(-1, 1, 1));
  CHECK(total(brdf_cos(s, z, t, v, l)) == Approx(total(brdf_cos(s, tilted, v, l))).epsilon(1e-12));
  // The tangent frame is right-handed: y is the bitangent cross(n, t).
  const Vec y = from_tangent_frame(Vec(0, 1, 0), Vec(0, 1, 0), Vec(1, 0, 0));
  CHECK((y.x == 0 && y.y == 0 && y.z == -1));
}

TEST_CASE("Brdf: an environment's moments give its integral exactly", "[shade][agreement]") {
  Random random(11);
  const int n = 120;
  const auto radiance = [](const Vec& l) { return 1 + 0.7 * l.x + 0.4 * l.y * l.z + 2 * l.z * l.z * l.z; };
  for (int i = 0; i < 6; ++i) {
    auto s = inside<Surface<double>>(random);
    s.base_diffuse_roughness = 0, s.specular_roughness = std::max(0.1, s.specular_roughness);
    const double nv = between(random, 0.1, 1);
    const Vec v = viewer(nv);
    const Layers<double> a = layers(s);
    const auto x5 = [](double c) { return std::pow(1 - c, 5); };
    const auto lobe = [&](double r, bool grazing, int fifth) {
      return Vec(over_half_vectors(r, v, n, [&](const Vec& l, const Vec& h) {
        const double w = x5(dot(v, h));
        return radiance(l) * ggx_d(r, z, h) * ggx_v_smith_correlated(r, l.z, nv) * l.z * (grazing ? w : 1 - w) *
               (fifth ? x5(l.z) : 1);
      }));
    };
    const auto light = [&](int k) {
      return Vec(over_hemisphere(n, [&](const Vec& l) { return radiance(l) * l.z * std::pow(x5(l.z), k); }));
    };
    const Moments<double> m{lobe(a.coat_roughness, false, 0),
                            lobe(a.coat_roughness, true, 0),
                            lobe(a.base_roughness, false, 0),
                            lobe(a.base_roughness, true, 0),
                            lobe(a.base_roughness, false, 1),
                            lobe(a.base_roughness, true, 1),
                            light(0),
                            light(1),
                            light(2)};
    const Vec direct = reflected_light(s, nv, n, radiance), by_moments = reflected(a, nv, m);
    // Both run over the same points, so they agree to rounding, but for points below nl = 1e-4.
    CHECK(by_moments.x == Approx(direct.x).epsilon(1e-6));
    CHECK(by_moments.z == Approx(direct.z).epsilon(1e-6));
  }
}

TEST_CASE("Brdf: no corner of its parameters gives NaN, in value or slope", "[shade][limit]") {
  int bad = 0, points = 0;
  const auto corners = [&]<class S>(S) {
    for (const float extreme : {0.0f, 1.0f})
      for (const float r : {0.0f, min_roughness, 1.0f})
        for (const float ior : {1.0f, 1.6f, 3.0f})
          for (const float c : {1e-8f, 1e-3f, 1.0f})
            for (const float c2 : {-0.5f, 0.0f, 1e-8f, 1.0f, 2.0f}) {  // 2: opposite the viewer
              Surface<S> s;
              s.base_color = vec3<S>(S(extreme)), s.specular_color = s.base_color, s.coat_color = s.base_color;
              s.base_weight = s.specular_weight = s.base_metalness = s.coat_weight = S(extreme);
              s.transmission_weight = S(1 - extreme), s.base_diffuse_roughness = s.coat_darkening = S(extreme);
              s.specular_roughness = s.coat_roughness = S(r), s.specular_ior = s.coat_ior = S(ior);
              const auto at = [](S x, S y) { return vec3<S>(x < 1 ? std::sqrt(1 - x * x) * y : S(0), 0, x); };
              for (const S side : {S(1), S(-1)}) {
                const vec3<S> v = at(S(c), 1), l = c2 > 1 ? -v : at(S(c2), side), up(0, 0, 1);
                const auto [y, d, d_n, d_v] = differentiate(
                    [&](const auto& p, const auto& n, const auto& from) { return weigh(brdf_cos(p, n, from, l)); }, s,
                    up, v);
                bool ok = std::isfinite(y) && y >= 0 && finite(d_n) && finite(d_v) && finite(transmittance(s, S(c)));
                each([&](const S& x) { ok = ok && std::isfinite(x); }, d);
                bad += !ok;
                ++points;
              }
            }
  };
  corners(0.0f);
  corners(0.0);
  CHECK(bad == 0);
  CHECK(points == 2 * 2 * 3 * 3 * 3 * 5 * 2);
}

TEST_CASE("Brdf: a host's own vectors and the compiler are welcome", "[shade][agreement]") {
  struct Host {
    double x, y, z;
  };
  const Surface<float> s;
  const vec3<float> a = brdf_cos(s, Host{0, 0, 1}, Host{0.6, 0, 0.8}, Host{0, 0.6, 0.8});
  constexpr vec3<float> b =
      brdf_cos(Surface<float>{}, vec3<float>(0, 0, 1), vec3<float>(0.6f, 0, 0.8f), vec3<float>(0, 0.6f, 0.8f));
  CHECK(a.x == Approx(b.x).epsilon(1e-6));
}

TEST_CASE("Brdf: all numbers agree and the slopes are right", "[shade][gradient]") {
  // Off the edges: horizons, the coated roughness reaching 1, f0 = .02 (ior 1.33) and those of oren_nayar, which
  // base_diffuse_roughness 0 hides from the value, not from the slope.
  const auto surface = [](Random& r) {
    auto s = inside<Surface<double>>(r);
    s.specular_roughness = between(r, 0.3, 0.7), s.coat_roughness = between(r, 0.25, 0.6);
    s.specular_ior = between(r, 1.4, 3), s.coat_ior = between(r, 1.4, 3), s.specular_weight = between(r, 0.8, 1);
    return s;
  };
  const auto directions = [](Random& r) {
    for (;;) {
      const Vec v = upward(r, 0.15), l = upward(r, 0.15);
      if (std::abs(dot(v, l) - v.z * l.z) > 0.05 && std::abs(v.z - l.z) > 0.05) return std::pair{v, l};
    }
  };
  using corners::Corner;
  const How fine{.rounding = 1e-5, .scale = 1e-3};
  holds(
      "brdf_cos, brdf_cos_with, Cosines, layers, Layers",
      [](const auto& s, const auto& n, const auto& v, const auto& l) { return weigh(brdf_cos(s, n, v, l)); },
      [&](Random& r) {
        const auto [v, l] = directions(r);
        return std::tuple{surface(r), z, v, l};
      },
      fine, corners::of([](const Corner& k) {
        return std::tuple{k.surface, z, k.v, k.l};
      }));
  holds(
      "brdf_cos, from_tangent_frame, Surface",
      [](const auto& s, const auto& v, const auto& l) {
        const vec3<float> n(0, 0, 1), t(1, 0, 0);
        return weigh(brdf_cos(s, n, t, v, l));
      },
      [&](Random& r) {
        const auto [v, l] = directions(r);
        auto s = surface(r);
        s.geometry_normal = s.geometry_coat_normal = z;
        s.geometry_coat_normal = normalize(Vec(between(r, -0.1, 0.1), between(r, -0.1, 0.1), 1));
        return std::tuple{s, v, l};
      },
      fine);
  // A lobe as sharp as a car's coat, inside of it, by surface and half vector, in steps that it can bear.
  holds(
      "brdf_cos, brdf_cos_with, Cosines, layers, Layers",
      [](const auto& s, const auto& h) {
        using T = std::remove_cvref_t<decltype(h.x)>;
        const vec3<T> v(T(0.6f), T(0.0f), T(0.8f)), up(T(0.0f), T(0.0f), T(1.0f));
        return weigh(brdf_cos(s, up, v, h * (2.0f * dot(v, h)) - v));
      },
      [&](Random& r) {
        auto s = surface(r);
        s.coat_roughness = between(r, 0.05, 0.2);
        const double a = s.coat_roughness * s.coat_roughness, x = a * between(r, -1, 1) + 1e-3,
                     y = a * between(r, 0.1, 1);
        return std::tuple{s, Vec(x, y, std::sqrt(1 - x * x - y * y))};
      },
      {.rounding = 1e-4, .scale = 1e-3, .step = 1e-3});
  holds(
      "transmittance", [](const auto& s, auto nv) { return weigh(transmittance(s, nv)); },
      [&](Random& r) {
        return std::tuple{surface(r), between(r, 0.1, 1)};
      },
      fine, corners::of([](const Corner& k) {
        return std::tuple{k.surface, k.l.z};
      }));
  const auto coat = [](Random& r) {
    return std::tuple{between(r, 0.05, 0.6), between(r, 0.05, 0.6), between(r, 0, 1)};
  };
  holds(
      "coated_roughness", [](auto b, auto c, auto w) { return coated_roughness(b, c, w); }, coat, fine,
      corners::of([](const Corner& k) {
        return std::tuple{k.surface.specular_roughness, k.c, k.surface.coat_weight};
      }));
  holds(
      "coat_internal_reflectance", [](auto ior, auto r) { return coat_internal_reflectance(ior, r); },
      [](Random& r) {
        return std::tuple{between(r, 1.05, 3), between(r, 0, 1)};
      },
      fine, {"no interface, both ends of roughness", {{1.0, 0.0}, {1.0, 1.0}}});
  holds(
      "coat_darkening", [](const auto& a, auto k) { return weigh(coat_darkening(a, k)); },
      [](Random& r) {
        return std::tuple{Vec(between(r, 0, 1), between(r, 0, 1), between(r, 0, 1)), between(r, 0, 0.9)};
      },
      fine, {"black, white", {{Vec(0.0), 0.0}, {Vec(1.0), 0.0}, {Vec(1.0), 0.999}, {Vec(0.0), 0.999}}});
  holds(
      "reflected, Moments",
      [](const auto& s, const auto& m, const auto& e, auto nv) {
        using T = std::remove_cvref_t<decltype(nv)>;
        return weigh(reflected(layers(s), nv, Moments<T>{m, e, m * e, m + e, e, m, e, m * m, e * e}));
      },
      [&](Random& r) {
        return std::tuple{surface(r), upward(r, 0.3), upward(r, 0.3), between(r, 0.05, 1)};
      },
      {.rounding = 1e-5}, corners::of([](const Corner& k) {
        return std::tuple{k.surface, Vec(k.v), Vec(1.0), k.l.z};
      }));
}
