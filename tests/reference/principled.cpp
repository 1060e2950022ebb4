// tests/reference/principled.cpp -- the principled BRDF against Mitsuba 3.9.1, value and slope by every parameter
// SPDX-License-Identifier: Apache-2.0
//
// At 10,000 points with all lobes on, in double and in float, the worse of which makes the row. Mitsuba computes the
// clear coat's t = 1 + (a^2 - 1) nh^2 in single precision, of which at the peak little is left: normalising h and
// squaring nh may be off by 3 2^-23, and t by that over t. What this alone may cost is taken from the differences. Who
// is right where they differ, the generator's third path tells: the published formulas in double.
#include <burnish/shade/principled.h>
#include <burnish_test.h>
#include "errors.h"
#include "inputs.h"
using namespace burnish;
using namespace reference;

namespace {
const auto mixture = [](const auto& c) { return c.x + 2.0f * c.y + 3.0f * c.z; };

template <class T> Principled<T> drawn(std::size_t i) {
  const auto u = [&](int j, double low, double high) { return T(between(10, i, j, low, high)); };
  Principled<T> p;
  p.base_color = {u(8, 0.05, 0.95), u(9, 0.05, 0.95), u(10, 0.05, 0.95)};
  p.roughness = u(11, 0.1, 1), p.anisotropic = u(12, 0.02, 0.98), p.metallic = u(13, 0.02, 0.98);
  p.specular = u(14, 0.05, 1), p.spec_tint = u(15, 0.02, 0.98);
  p.sheen = u(16, 0.02, 0.98), p.sheen_tint = u(17, 0.02, 0.98), p.flatness = u(18, 0.02, 0.98);
  p.clearcoat = u(19, 0.02, 0.98), p.clearcoat_gloss = u(20, 0.02, 0.98);
  return p;
}
std::pair<vec3<double>, vec3<double>> drawn_directions(std::size_t i) {
  const double r = between(10, i, 11, 0.1, 1);
  return directions(10, i, i % 4 == 3 ? 0.02 : r * r);
}
const char* const names[] = {"base_color", "roughness",  "anisotropic", "metallic", "specular",       "spec_tint",
                             "sheen",      "sheen_tint", "flatness",    "clearcoat", "clearcoat_gloss"};
}  // namespace

TEST_CASE("Mitsuba: principled_cos is its principled, by every parameter, and the formulas in double decide",
          "[reference][agreement]") {
  const std::string theirs = "Mitsuba 3.9.1 principled",
                    formulas = "the published formulas and complex steps in NumPy's double";
  const Array value = load("principled_value"), exact = load("principled_exact_value"),
              exact_by_coat = load("principled_exact_by_clearcoat"),
              exact_by_gloss = load("principled_exact_by_clearcoat_gloss");
  std::vector<Array> slopes;
  for (const char* n : names) slopes.push_back(load(std::string("principled_by_") + n));
  const auto in = [&]<class T>(T, double tolerance) {
    Errors of_value, of_exact, of_coat, of_gloss;
    std::vector<Errors> of_slopes(slopes.size());
    for (std::size_t i = 0; i < 10000; ++i) {
      const auto [v, l] = drawn_directions(i);
      const Principled<T> p = drawn<T>(i);
      const vec3<double> y = principled_cos(p, constant<T>(v), constant<T>(l));
      const auto [total, d] = differentiate(
          [to_v = v, to_l = l]<class U>(const Principled<U>& q) {
            return mixture(principled_cos(q, constant<U>(to_v), constant<U>(to_l)));
          },
          p);
      of_exact.add(double(total), exact(i));
      of_coat.add(double(d.clearcoat), exact_by_coat(i), exact(i));
      of_gloss.add(double(d.clearcoat_gloss), exact_by_gloss(i), exact(i));

      // What t's rounding costs the coat, which goes by 1 / t, and its slope by the gloss, whose parts go by 1 / t^2
      // and 1 / t.
      const Principled<double> in_double = drawn<double>(i);
      const vec3<double> h = normalize(v + l);
      const double a = 0.1 - 0.099 * in_double.clearcoat_gloss, t = h.x * h.x + h.y * h.y + a * a * h.z * h.z;
      const double coat = principled_clearcoat_cos(in_double, v, l), rounding = 3 * std::exp2(-23) / t;
      of_value.add(y.x, value(i, 0), 0, coat * rounding);
      of_value.add(y.y, value(i, 1), 0, coat * rounding);
      of_value.add(y.z, value(i, 2), 0, coat * rounding);
      const double by_coat = 6 * coat / in_double.clearcoat * rounding,
                   by_gloss = 6 * coat * 0.099 * (2 * a / t * (2 + rounding) - 1 / (a * std::log(a))) * rounding;
      std::size_t k = 0;
      for_each_parameter(d, [&](const std::string&, const T& ours, Range) {
        const std::size_t parameter = k < 3 ? 0 : k - 2;
        of_slopes[parameter].add(double(ours), k < 3 ? slopes[0](i, k) : slopes[parameter](i), exact(i),
                                 parameter == 9 ? by_coat : parameter == 10 ? by_gloss : 0);
        ++k;
      });
    }
    of_value.claim("principled_cos", "value", theirs + ", relative, its rounding of the clear coat apart", 1e-5);
    of_value.claim_unforgiven("principled_cos", "value", theirs + ", relative, its rounding included", 1e-3);
    of_value.claim_share("principled_cos", "value", theirs, 0.03);
    for (std::size_t k = 0; k < slopes.size(); ++k) {
      const std::string by = theirs + " by " + names[k];
      of_slopes[k].claim("principled_cos", "gradient",
                         by + ", relative to max(slope, value)" +
                             (k > 8 ? ", its rounding of the clear coat apart" : ""), 1e-5);
      if (k > 8)
        of_slopes[k].claim_unforgiven("principled_cos", "gradient",
                                      by + ", relative to max(slope, value), its rounding included", 5e-3);
      of_slopes[k].claim_share("principled_cos", "gradient", by, k > 8 ? 0.25 : 0.1);
    }
    const std::string what = sizeof(T) == 4 ? "principled_cos in float" : "principled_cos in double";
    of_exact.claim(what, "value", formulas + ", relative", tolerance);
    of_coat.claim(what, "gradient", formulas + " by clearcoat, relative to max(slope, value)", tolerance);
    of_gloss.claim(what, "gradient", formulas + " by clearcoat_gloss, relative to max(slope, value)", tolerance);
  };
  in(double(), 1e-6);
  in(float(), 5e-6);
  double rounded_by_them = 0;
  for (std::size_t i = 0; i < 10000; ++i)
    rounded_by_them = std::max(
        rounded_by_them, std::fabs((value(i, 0) + 2 * value(i, 1) + 3 * value(i, 2)) / exact(i) - 1));
  CHECK(rounded_by_them > 1e-4);  // else the allowance above is for nothing
}
