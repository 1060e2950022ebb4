// tests/reference/bsdf.cpp -- Fresnel curves, GGX, rough metal and Lambert against Mitsuba 3.9.1, values and slopes
// SPDX-License-Identifier: Apache-2.0
//
// At 10,000 points, in double and in float, the worse of which makes the row. Mitsuba computes in single precision. Its
// alpha is roughness^2 here, so slopes by alpha run through the square root.
#include <burnish/shade/diffuse.h>
#include <burnish/shade/ggx.h>
#include <burnish_test.h>
#include "errors.h"
#include "inputs.h"
using namespace burnish;
using namespace reference;

namespace {
const auto mixture = [](const auto& c) { return c.x + 2.0f * c.y + 3.0f * c.z; };
template <class T> vec3<T> color(int stream, std::size_t i, int j, double low, double high) {
  return {T(between(stream, i, j, low, high)), T(between(stream, i, j + 1, low, high)),
          T(between(stream, i, j + 2, low, high))};
}
/// D G1(v) G1(l) / (4 nl nv) nl, of roughness = sqrt(alpha), and the cosine between v and h.
template <class U> std::pair<U, U> rough_mirror(const U& alpha, const vec3<U>& v, const vec3<U>& l) {
  const vec3<U> n(U(0.0f), U(0.0f), U(1.0f)), h = normalize(v + l);
  const U roughness = sqrt(alpha);
  return {ggx_d(roughness, n, h) * ggx_v_smith_separable(roughness, l.z, v.z) * l.z, dot(v, h)};
}
}  // namespace

TEST_CASE("Mitsuba: the Fresnel curves are its", "[reference][agreement]") {
  const auto dielectric = [](std::size_t, auto c, auto eta) { return fresnel_dielectric(c, eta); };
  agrees("fresnel_dielectric", "Mitsuba 3.9.1 fresnel()", "fresnel", {"c", "eta"}, dielectric,
         [](std::size_t i) { return std::tuple{between(2, i, 0, 0.02, 1), between(2, i, 1, 1.05, 3)}; }, 5e-6, 1e-5);
  const auto inside = [](std::size_t i) {
    const double eta = between(2, i, 2, 0.4, 0.95), least = std::sqrt(1 - eta * eta + 0.02);
    return std::tuple{rounded(least + (1 - least) * between(2, i, 3, 0, 1)), eta};
  };
  agrees("fresnel_dielectric", "Mitsuba 3.9.1 fresnel() from the denser side", "fresnel_inside", {"c", "eta"},
         dielectric, inside, 1e-5, 1e-5);
  agrees("fresnel_conductor", "Mitsuba 3.9.1 fresnel_conductor()", "fresnel_conductor", {"c", "eta", "k"},
         [](std::size_t, auto c, auto eta, auto k) { return fresnel_conductor(c, eta, k); },
         [](std::size_t i) {
           return std::tuple{between(3, i, 0, 0.02, 1), between(3, i, 1, 0.1, 4), between(3, i, 2, 0.2, 8)};
         },
         2e-6, 5e-6);
}

TEST_CASE("Mitsuba: GGX is its", "[reference][agreement]") {
  const auto alpha = [](std::size_t i) { return std::tuple{between(4, i, 8, 0.01, 1)}; };
  agrees("ggx_d", "Mitsuba 3.9.1 MicrofacetDistribution.eval", "ggx_d", {"alpha"},
         [&](std::size_t i, auto a) {
           const auto [v, l] = directions(4, i, std::get<0>(alpha(i)));
           return ggx_d(sqrt(a), constant<decltype(a)>(vec3<double>(0, 0, 1)),
                        constant<decltype(a)>(rounded(normalize(v + l))));
         },
         alpha, 1e-6, 2e-6);
  agrees("ggx_g1", "Mitsuba 3.9.1 MicrofacetDistribution.smith_g1", "ggx_g1", {"alpha"},
         [&](std::size_t i, auto a) {
           return ggx_g1(sqrt(a), constant<decltype(a)>(directions(4, i, std::get<0>(alpha(i))).first).z);
         },
         alpha, 1e-6, 1e-6);
}

TEST_CASE("Mitsuba: D V by the separable Smith term is its roughconductor", "[reference][agreement]") {
  const auto alpha = [](std::size_t i) { return std::tuple{between(5, i, 8, 0.01, 1)}; };
  agrees("ggx_d ggx_v_smith_separable nl", "Mitsuba 3.9.1 roughconductor, F = 1", "roughconductor_mirror", {"alpha"},
         [&](std::size_t i, auto a) {
           const auto [v, l] = directions(5, i, std::get<0>(alpha(i)));
           return rough_mirror(a, constant<decltype(a)>(v), constant<decltype(a)>(l)).first;
         },
         alpha, 5e-6, 5e-6);
}

TEST_CASE("Mitsuba: with the conductor's Fresnel it is its roughconductor, by every parameter",
          "[reference][agreement]") {
  const Array value = load("roughconductor_value"), by_alpha = load("roughconductor_by_alpha"),
              by_eta = load("roughconductor_by_eta"), by_k = load("roughconductor_by_k"),
              by_reflectance = load("roughconductor_by_specular_reflectance");
  const auto in = [&]<class T>(T) {
    Errors of_value, of_alpha, of_eta, of_k, of_reflectance;
    for (std::size_t i = 0; i < 10000; ++i) {
      const double alpha = between(6, i, 8, 0.01, 1);
      const auto [v, l] = directions(6, i, alpha);
      const vec3<T> eta = color<T>(6, i, 9, 0.1, 4), k = color<T>(6, i, 12, 0.2, 8),
                    reflectance = color<T>(6, i, 15, 0.05, 1);
      const auto f = [&, to_v = v, to_l = l]<class U>(const U& a, const vec3<U>& e, const vec3<U>& j,
                                                      const vec3<U>& r) {
        const auto [lobe, vh] = rough_mirror<U>(a, constant<U>(to_v), constant<U>(to_l));
        return fresnel_conductor(vh, e, j) * r * lobe;
      };
      const vec3<double> y = f(T(alpha), eta, k, reflectance);
      const auto [total, d_alpha, d_eta, d_k, d_reflectance] = differentiate(
          [&](const auto&... x) { return mixture(f(x...)); }, T(alpha), eta, k, reflectance);
      of_alpha.add(double(d_alpha), by_alpha(i), double(total) / alpha);
      const auto by_channel = [&](Errors& errors, const Array& theirs, const vec3<double>& ours,
                                  const vec3<double>& p) {
        errors.add(ours.x, theirs(i, 0), y.x / p.x);
        errors.add(ours.y, theirs(i, 1), 2 * y.y / p.y);
        errors.add(ours.z, theirs(i, 2), 3 * y.z / p.z);
      };
      of_value.add(y.x, value(i, 0)), of_value.add(y.y, value(i, 1)), of_value.add(y.z, value(i, 2));
      by_channel(of_eta, by_eta, vec3<double>(d_eta), vec3<double>(eta));
      by_channel(of_k, by_k, vec3<double>(d_k), vec3<double>(k));
      by_channel(of_reflectance, by_reflectance, vec3<double>(d_reflectance), vec3<double>(reflectance));
    }
    const std::string what = "fresnel_conductor ggx_d ggx_v_smith_separable nl",
                      theirs = "Mitsuba 3.9.1 roughconductor";
    of_value.claim(what, "value", theirs + ", relative", 5e-6);
    const auto slope = [&](const Errors& e, const std::string& by) {
      e.claim(what, "gradient", theirs + " by " + by + ", relative to max(slope, value / parameter)", 1e-5);
      e.claim_share(what, "gradient", theirs + " by " + by, 0.1);
    };
    slope(of_alpha, "alpha"), slope(of_eta, "eta"), slope(of_k, "k"), slope(of_reflectance, "specular_reflectance");
  };
  in(double());
  in(float());
}

TEST_CASE("Mitsuba: gold, copper and aluminium are its", "[reference][agreement]") {
  const Array index = load("metals");
  const char* const names[] = {"Au", "Cu", "Al"};
  for (int m = 0; m < 3; ++m) {
    const Array value = load(std::string("roughconductor_") + names[m]);
    const auto in = [&]<class T>(T) {
      const vec3<T> eta(T(index(m, 0, 0)), T(index(m, 0, 1)), T(index(m, 0, 2))),
          k(T(index(m, 1, 0)), T(index(m, 1, 1)), T(index(m, 1, 2)));
      Errors errors;
      for (std::size_t i = 0; i < 2000; ++i) {
        const double alpha = between(7 + m, i, 8, 0.01, 1);
        const auto [v, l] = directions(7 + m, i, alpha);
        const auto [lobe, vh] = rough_mirror(T(alpha), constant<T>(v), constant<T>(l));
        const vec3<double> y = fresnel_conductor(vh, eta, k) * lobe;
        errors.add(y.x, value(i, 0)), errors.add(y.y, value(i, 1)), errors.add(y.z, value(i, 2));
      }
      errors.claim("fresnel_conductor ggx_d ggx_v_smith_separable nl", "value",
                   std::string("Mitsuba 3.9.1 roughconductor of ") + names[m] + ", relative", 5e-6);
    };
    in(double());
    in(float());
  }
}

TEST_CASE("Mitsuba: Lambert is its diffuse", "[reference][agreement]") {
  const Array value = load("diffuse_value"), by = load("diffuse_by_reflectance");
  const auto in = [&]<class T>(T) {
    Errors of_value, of_slope;
    for (std::size_t i = 0; i < 1000; ++i) {
      const double nl = directions(11, i, 0.3).second.z;
      const vec3<T> albedo = color<T>(11, i, 8, 0.05, 0.95);
      const auto f = [&]<class U>(const vec3<U>& a) { return lambert(a) * U(nl); };
      const vec3<double> y = f(albedo);
      const auto d = std::get<1>(differentiate([&](const auto& a) { return mixture(f(a)); }, albedo));
      of_value.add(y.x, value(i, 0)), of_value.add(y.y, value(i, 1)), of_value.add(y.z, value(i, 2));
      of_slope.add(double(d.x), by(i, 0)), of_slope.add(double(d.y), by(i, 1)), of_slope.add(double(d.z), by(i, 2));
    }
    of_value.claim("lambert", "value", "Mitsuba 3.9.1 diffuse, relative", 1e-6);
    of_slope.claim("lambert", "gradient", "Mitsuba 3.9.1 diffuse by reflectance, relative", 1e-6);
  };
  in(double());
  in(float());
}
