// tests/light/illuminate.cpp -- the laws of burnish/light/illuminate.h, transport.h and irradiance.h
// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <burnish/light/illuminate.h>
#include <differences.h>
#include "reference.h"
using namespace differences;
using reference::Surfels;

namespace {
using Radiance = std::function<double(const vec3<double>&)>;
const vec3<double> bright = normalize(vec3<double>(0.5, 0.6, -0.4));
const Radiance constant = [](const vec3<double>&) { return 1.0; };
const Radiance cosine = [](const vec3<double>& d) { return 1 + 0.6 * d.y + 0.3 * d.x; };
const Radiance blob = [](const vec3<double>& d) { return 0.1 + 5 * std::exp((dot(d, bright) - 1) / 0.09); };

EnvironmentLight light_of(const Radiance& L, int height = 128) {
  return EnvironmentLight(reference::panorama(L, height), 0, false);
}
/// F0 A + B of the table.
constexpr float f0 = 0.04f;
double specular(const Illumination& light, int i, double r) {
  double y[12];
  light.table(double(i), r, 12, y);
  return f0 * y[0] + y[3];
}
double specular_slope(const Illumination& light, int i, double r) {
  const double d[12] = {f0, 0, 0, 1};
  return light.table_slope(double(i), r, 12, d);
}
struct Errors {
  double value = 0, slope = 0;  // rms over surfels; of the value, of d ln value / d ln r
};
Errors against_quadrature(const Radiance& L, const Illumination& light, const Surfels& s, double r) {
  Errors e;
  for (int i = 0; i < s.size(); ++i) {
    const vec3<double> n = reference::unit_of(s.at(i).normal), v = reference::unit_of(s.at(i).view);
    const auto truth = [&](double x) {
      const auto y = reference::specular(L, n, v, x, 1 << 13);
      return f0 * y[0] + y[1];
    };
    const double y = truth(r), slope = (truth(r * 1.001) - truth(r * 0.999)) / 0.002;
    e.value += std::pow(specular(light, i, r) / y - 1, 2) / s.size();
    e.slope += std::pow((specular_slope(light, i, r) * r - slope) / y, 2) / s.size();
  }
  return {std::sqrt(e.value), std::sqrt(e.slope)};
}
/// The light as T sees it: floats the owner, others a view.
template <class T> decltype(auto) as(const LightOf<float>& light) {
  if constexpr (std::is_same_v<T, float>) return (light);
  else return LightOf<T>{&light};
}
/// A scene whose surfels have a tangent and an index.
struct At {
  vec3<float> normal, tangent, view;
  float index;
};
At at(const Surfels& s, int i) {
  const reference::Frame f(reference::unit_of(s.at(i).normal));
  return {s.at(i).normal, vec3<float>(f.x), s.at(i).view, float(i)};
}
Image soft_with_sun() {
  Image p = reference::panorama(blob, 64);
  for (int i = 0; i < 3; ++i) p.set(30 + i, 12, {4000, 3600, 3000});
  return p;
}
}  // namespace

TEST_CASE("Illumination: under an even sky A + B is the directional albedo, and E pi", "[light][energy]") {
  const Surfels s(24, 0.1);
  const Illumination light(light_of(constant, 32), s);
  for (const double r : {0.02, 0.05, 0.1, 0.3, 0.5, 0.7, 1.0})
    for (int i = 0; i < s.size(); ++i) {
      double y[12];
      light.table(double(i), r, 12, y);
      const auto truth = reference::specular(constant, reference::unit_of(s.at(i).normal),
                                             reference::unit_of(s.at(i).view), r, 1 << 12);
      CAPTURE(r, i);
      CHECK(y[0] + y[3] == Approx(truth[0] + truth[1]).epsilon(0.011));
      CHECK(y[6] + y[9] == Approx(truth[2] + truth[3]).margin(0.006));
      CHECK(y[0] + y[3] <= 1.005);
      CHECK(y[2] == Approx(y[0]).epsilon(1e-4));
      double e[9];
      light.irradiance(double(i), e);
      CHECK(e[0] == Approx(reference::pi).epsilon(1e-3));
      CHECK(e[3] == Approx(2 * reference::pi / 42).epsilon(1e-2));
      CHECK(e[6] == Approx(2 * reference::pi / 132).epsilon(2e-2));
    }
}

TEST_CASE("Illumination: value and slope by roughness are those of a converged quadrature", "[light][value]") {
  const Surfels s(24, 0.15);
  const double r[] = {0.02, 0.1, 0.3, 0.6, 1};
  const double value[2][5] = {{1e-4, 1e-3, 0.005, 0.01, 0.015}, {1e-3, 2e-3, 0.01, 0.02, 0.045}};
  const double slope[2][5] = {{1e-3, 0.01, 0.02, 0.03, 0.05}, {1e-3, 0.02, 0.07, 0.07, 0.09}};
  const Radiance skies[2] = {cosine, blob};
  for (int k = 0; k < 2; ++k) {
    const Illumination light(light_of(skies[k], 256), s);
    for (int j = 0; j < 5; ++j) {
      const Errors e = against_quadrature(skies[k], light, s, r[j]);
      CAPTURE(k, r[j], e.value, e.slope);
      CHECK(e.value < value[k][j]);
      CHECK(e.slope < slope[k][j]);
    }
  }
}

TEST_CASE("Illumination: irradiances are those of the hemisphere's quadrature", "[light][value]") {
  const Surfels s(16, 0.1);
  for (const Radiance& L : {cosine, blob}) {
    const Illumination light(light_of(L), s);
    for (int i = 0; i < s.size(); ++i) {
      const auto truth = reference::irradiance(L, reference::unit_of(s.at(i).normal), 100);
      double e[9];
      light.irradiance(double(i), e);
      CHECK(e[0] == Approx(truth[0]).epsilon(8e-3));
      CHECK(e[3] == Approx(truth[1]).epsilon(0.03));
      CHECK(e[6] == Approx(truth[2]).epsilon(0.06));
    }
  }
}

TEST_CASE("Illumination: between its knots the table is within 0.2 % of the rings at that very roughness",
          "[light][value]") {
  const Surfels s(16, 0.1);
  const EnvironmentLight e = light_of(blob);
  const Illumination light(e, s);
  const Surroundings sky(e);
  std::vector<double> r, d;
  for (double x = 0.0201; x < 1; x *= 1.09) r.push_back(x), d.push_back(4 * x * x * x);
  vec3<Transport::P> n, v;
  for (int k = 0; k < 16; ++k) {
    n.x.v[k] = s.at(k).normal.x, n.y.v[k] = s.at(k).normal.y, n.z.v[k] = s.at(k).normal.z;
    v.x.v[k] = s.at(k).view.x, v.y.v[k] = s.at(k).view.y, v.z.v[k] = s.at(k).view.z;
  }
  std::vector<float> table(r.size() * 12 * 32);
  Transport(r, d).gather(sky, Transport::Block(n, v), nullptr, {}, table.data());
  for (std::size_t k = 0; k < r.size(); ++k)
    for (int i = 0; i < 16; ++i) {
      const auto direct = [&](int what) {
        const float* row = table.data() + k * 12 * 32 + what * 16 + i;
        return f0 * double(row[0]) + row[3 * 32];
      };
      CAPTURE(r[k], i);
      CHECK(specular(light, i, r[k]) == Approx(direct(0)).epsilon(2e-3));
      CHECK(specular_slope(light, i, r[k]) * r[k] == Approx(direct(1) * r[k]).epsilon(0.015).margin(0.02 * direct(0)));
    }
}

TEST_CASE("Illumination: value and slope join without a step at the knots and end at the range's ends",
          "[light][limit]") {
  const Surfels s(16, 0.1);
  const Illumination light(light_of(blob, 64), s);
  const double first = std::pow(0.02, 0.25), step = (1 - first) / (Illumination::knots - 1);
  for (int k = 1; k + 1 < Illumination::knots; ++k) {
    const double r = std::pow(first + k * step, 4), h = 1e-7 * r;
    CHECK(specular(light, 3, r + h) == Approx(specular(light, 3, r - h)).epsilon(1e-5));
    CHECK(specular_slope(light, 3, r + h) == Approx(specular_slope(light, 3, r - h)).epsilon(1e-4).margin(1e-6));
  }
  CHECK(specular(light, 3, 0.001) == specular(light, 3, 0.02f));
  CHECK(specular(light, 3, 5.0) == specular(light, 3, 1.0));
  CHECK(specular_slope(light, 3, 0.001) == 0);
  CHECK(specular_slope(light, 3, 1.5) == 0);
}

TEST_CASE("Illumination: one kilobyte and a quarter a surfel", "[light][cost]") {
  const Illumination light(light_of(constant, 16), Surfels(160, 0.1));
  CHECK(light.bytes() <= 160 * 1250);
}

TEST_CASE("Illumination: a surfel turned with the panorama sees the same", "[light][symmetry]") {
  const Image p = soft_with_sun();
  const float yaw = 2.2f;
  const Surfels s(24, 0.1);
  Surfels t = s;
  for (auto& a : t.all) a.normal = turned(a.normal, yaw), a.view = turned(a.view, yaw);
  const Illumination one(EnvironmentLight(p), s), two(EnvironmentLight(p, yaw), t);
  for (int i = 0; i < s.size(); ++i)
    for (const double r : {0.03, 0.2, 0.8}) {
      double a[9], b[9];
      CHECK(specular(one, i, r) == Approx(specular(two, i, r)).epsilon(3e-3));
      one.irradiance(double(i), a), two.irradiance(double(i), b);
      CHECK(a[0] == Approx(b[0]).epsilon(5e-3));
    }
}

TEST_CASE("Illumination: the same bits for any number of threads", "[light][agreement]") {
  const Surfels s(100, 0.1);
  const Image p = soft_with_sun();
  const int before = threads();
  const auto all = [&](int n) {
    set_threads(n);
    const Illumination light(EnvironmentLight(p), s, [](int i, auto d, auto out) {
      for (std::size_t k = 0; k < out.size(); ++k) out[k] = d[k].x > 0.01f * float(i);
    });
    std::vector<float> y;
    for (int i = 0; i < s.size(); ++i) {
      float t[12], e[9];
      light.table(float(i), 0.13f, 12, t), light.irradiance(float(i), e);
      y.insert(y.end(), t, t + 12), y.insert(y.end(), e, e + 9);
    }
    return y;
  };
  const auto one = all(1), two = all(2), five = all(5);
  set_threads(before);
  CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(float)) == 0);
  CHECK(std::memcmp(one.data(), five.data(), one.size() * sizeof(float)) == 0);
}

TEST_CASE("LightTable: floats, packets and doubles read one value, neighbours and strangers alike",
          "[light][agreement]") {
  const Surfels s(40, 0.1);
  const Illumination light(EnvironmentLight(soft_with_sun()), s);
  Random random(3);
  for (int turn = 0; turn < 200; ++turn) {
    Lanes x[2], y[12], d_y[12], d_x[2];
    Packet<double, 8> x8[2], y8[12];
    const double same_r = between(random, 0.01, 1.1);
    for (int k = 0; k < 16; ++k) {
      x[0].v[k] = turn % 3 == 0 ? float(16 + k) : float(random() % 45);  // past the end counts as the last
      x[1].v[k] = turn % 2 == 0 ? float(same_r) : float(between(random, 0.01, 1.1));
    }
    for (int k = 0; k < 8; ++k) x8[0].v[k] = x[0][k], x8[1].v[k] = x[1][k];
    for (auto& d : d_y) d = Lanes(1.0f);
    LightTable<12>::value(light, x, y);
    LightTable<12>::back(light, x, y, d_y, d_x, nullptr);
    LightTable<12>::value(light, x8, y8);
    for (int k = 0; k < 16; ++k) {
      const float one[2] = {x[0][k], x[1][k]}, ones[12] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
      float out[12], d_one[2];
      LightTable<12>::value(light, one, out);
      LightTable<12>::back(light, one, out, ones, d_one, nullptr);
      for (int c = 0; c < 12; ++c) {
        CHECK(y[c][k] == Approx(out[c]).epsilon(1e-5).margin(1e-6));
        if (k < 8) CHECK(y8[c][k] == Approx(out[c]).epsilon(2e-5).margin(2e-6));
      }
      CHECK(d_x[1][k] == Approx(d_one[1]).epsilon(1e-3).margin(1e-4));
      CHECK(d_x[0][k] == 0);
    }
  }
}

TEST_CASE("LightTable: one value in every number, and right slopes by roughness", "[light][gradient]") {
  // Edges: the knots, where the second slope jumps, and the range's ends; drawn off them.
  static const LightOf<float> light(EnvironmentLight(soft_with_sun(), 0, false), Surfels(40, 0.1));
  holds("LightTable",
        Unrecorded{[](const auto& i, const auto& r, const auto& strength) {  // strength: what a flat stretch's slope is
          using T = std::remove_cvref_t<decltype(r)>;                        // compared with
          const auto y = apply<LightTable<12>>(as<T>(light), floor(i), r);
          T sum = 0.0f;
          for (int c = 0; c < 12; ++c) sum += y[std::size_t(c)] * (1.0f + 0.3f * c);
          return sum * strength;
        }},
        [](Random& random) {
          const double first = std::pow(0.02, 0.25), step = (1 - first) / (Illumination::knots - 1);
          const double place = int(random() % (Illumination::knots - 1)) + between(random, 0.1, 0.9);
          return std::tuple(std::floor(between(random, 0, 40)) + 0.5, std::pow(first + place * step, 4), 1.0);
        },
        {.rounding = 2e-5, .scale = 1e-2, .step = 1e-3},
        {"both ends and beyond, past the last surfel",
         {{0.5, 1.0, 1.0}, {0.5, 0.01, 1.0}, {39.5, 1.5, 1.0}, {99.5, 0.0, 1.0}, {-3.5, 0.5, 1.0}},
         {{0.5, 0.02, 1.0}}});
}

TEST_CASE("illuminate: sky and suns on a layered surface are the integral of brdf_cos over the sphere",
          "[light][value]") {
  // The independent path: a midpoint rule over directions for the sky, and for the sun over its own disc.
  const EnvironmentLight e = [] {
    EnvironmentLight x = light_of(blob);
    Sun<float> sun;
    sun.direction = vec3<float>(normalize(vec3<double>(-0.3, 0.8, 0.4)));
    sun.power = {3, 2.5f, 2};
    sun.variance = 2e-5f;
    x.suns.push_back(sun);
    return x;
  }();
  const Surfels s(6, 0.3, 4);
  const LightOf<float> light(e, s);
  for (const double r : {0.25, 0.6})
    for (int i = 0; i < s.size(); ++i) {
      Surface<double> surface;
      surface.base_color = {0.7, 0.3, 0.1}, surface.base_metalness = i % 3 * 0.4, surface.specular_roughness = r;
      surface.coat_weight = i % 2 * 0.8, surface.coat_roughness = 0.3;
      const vec3<double> n = reference::unit_of(s.at(i).normal), v = reference::unit_of(s.at(i).view);
      vec3<double> truth;
      const int steps = 160;
      const reference::Frame f(n);
      for (int a = 0; a < steps; ++a)
        for (int b = 0; b < 4 * steps; ++b) {
          const double c = (a + 0.5) / steps, q = std::sqrt(1 - c * c),
                       phi = 2 * reference::pi * (b + 0.5) / (4 * steps);
          const vec3<double> l = f.world(q * std::cos(phi), q * std::sin(phi), c);
          truth += brdf_cos(surface, n, v, l) * (blob(l) * 2 * reference::pi / (4.0 * steps * steps));
        }
      const Sun<float>& sun = e.suns[0];
      const reference::Frame disc(reference::unit_of(sun.direction));
      for (int k = 0; k < 256; ++k) {
        const double d = std::sqrt(-2 * sun.variance * std::log(1 - (k + 0.5) / 256)), a = 2.399963229728653 * k;
        const vec3<double> l = normalize(disc.world(d * std::cos(a), d * std::sin(a), 1));
        truth += brdf_cos(surface, n, v, l) * vec3<double>(sun.power) / 256.0;
      }
      const vec3<float> found =
          illuminate(lift<float>(surface), at(s, i), light, List<Sun, float>{e.suns}, LightStrength<float>{});
      CAPTURE(r, i);
      CHECK(found.x == Approx(truth.x).epsilon(0.02));
      CHECK(found.y == Approx(truth.y).epsilon(0.02));
      CHECK(found.z == Approx(truth.z).epsilon(0.02));
    }
}

TEST_CASE("illuminate: a white surface under an even sky gives back no more than it gets", "[light][energy]") {
  const Surfels s(32, 0.05);
  const LightOf<float> light(light_of(constant, 16), s);
  Random random(8);
  for (int k = 0; k < 2000; ++k) {
    Surface<float> white = lift<float>(inside<Surface<double>>(random));
    white.base_color = vec3<float>(1);
    const vec3<float> c = illuminate(white, at(s, k % 32), light, List<Sun, float>{}, LightStrength<float>{});
    REQUIRE(std::isfinite(c.x));
    REQUIRE(c.x >= 0);
    REQUIRE(c.x <= 1.01f);
  }
}

TEST_CASE("illuminate: one value in every number, and right slopes by surface and strength", "[light][gradient]") {
  // Edges: the table's knots (second slope), roughnesses at the least, coated_roughness at 1; a sun behind the horizon.
  static const EnvironmentLight e{soft_with_sun()};
  static const Surfels s = [] {
    Surfels few(16, 0.3, 2);
    for (auto& a : few.all) {  // towards the sun
      a.normal = normalize(a.normal + e.suns[0].direction * 2.0f);
      a.view = normalize(a.view + a.normal);
    }
    return few;
  }();
  static const LightOf<float> light(e, s);
  int which = 0;
  // No surface reflects a sky of its own with roughness below the table's least; its slope there is 0.
  using Point = std::tuple<Surface<double>, LightStrength<double>>;
  const Hard<Point> extremes{"roughness 0, .01 and 1; black, white; metal, dielectric; no light", {}, [] {
                               std::vector<Point> list;
                               for (const double extreme : {0.0, 1.0})
                                 for (const double r : {0.0, 0.01, 1.0})
                                   for (const double part : {0.0, 0.5, 1.0}) {
                                     Surface<double> x;
                                     x.base_color = x.specular_color = x.coat_color = vec3<double>(extreme);
                                     x.base_weight = x.coat_weight = extreme, x.base_metalness = part;
                                     x.specular_roughness = x.coat_roughness = r;
                                     x.specular_ior = x.coat_ior = 1 + extreme, x.transmission_weight = 1 - extreme;
                                     list.push_back({x, {vec3<double>(part), vec3<double>(extreme)}});
                                   }
                               return list;
                             }()};
  for (int normals = 0; normals < 2; ++normals)
    holds(
        "illuminate, moments, sunlit, LightStrength, Sun", Unrecorded{[&](const auto& drawn, const auto& strength) {
          using T = std::remove_cvref_t<decltype(drawn.base_weight)>;
          auto surface = drawn;  // normals of unit length are an edge of their own: a difference would leave the sphere
          surface.geometry_normal = normalize(drawn.geometry_normal);
          surface.geometry_coat_normal = normalize(drawn.geometry_coat_normal);
          const vec3<T> c = illuminate(surface, at(s, which), as<T>(light), List<Sun, T>{e.suns}, strength);
          return c.x + 0.5f * c.y + 0.25f * c.z;
        }},
        [&](Random& random) {
          which = int(random() % 16);
          Surface<double> surface = inside<Surface<double>>(random);
          const double first = std::pow(0.02, 0.25), step = (1 - first) / (Illumination::knots - 1);
          const auto off_knots = [&](double low, double high) {
            for (;;) {
              const double r = between(random, low, high), place = (std::pow(r, 0.25) - first) / step;
              if (std::abs(place - std::round(place)) > 0.1) return r;
            }
          };
          surface.coat_roughness = off_knots(0.1, 0.6);
          do surface.specular_roughness = between(random, 0.1, 0.6);
          while ([&] {
            const double place =
                (std::pow(coated_roughness(surface.specular_roughness, surface.coat_roughness, surface.coat_weight),
                          0.25) -
                 first) /
                step;
            return std::abs(place - std::round(place)) < 0.1;
          }());
          surface.geometry_normal = surface.geometry_coat_normal = {0, 0, 1};
          if (normals) {
            surface.geometry_normal = upward(random, 0.98);
            surface.geometry_coat_normal = upward(random, 0.98);
          }
          return std::tuple(surface, inside<LightStrength<double>>(random));
        },
        {.rounding = 1e-3, .scale = 1e-2, .step = 3e-4}, extremes);
}
