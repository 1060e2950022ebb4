// tests/shade/principled.cpp -- the laws of burnish/shade/principled.h; tests/reference holds it against Mitsuba
// SPDX-License-Identifier: Apache-2.0
#include <burnish/shade/ggx.h>
#include <burnish/shade/principled.h>
#include <differences.h>
using namespace differences;

namespace {
const auto weigh = [](const auto& c) { return c.x + 2.0f * c.y + 3.0f * c.z; };
const auto weighed = [](const auto& p, const auto& v, const auto& l) {
  return weigh(principled_normalized_cos(p, v, l));
};
double total(const vec3<double>& c) { return c.x + c.y + c.z; }
/// Off the edges: no lobe is narrow, alpha is not held.
Principled<double> drawn(Random& r) {
  auto p = inside<Principled<double>>(r);
  p.roughness = between(r, 0.3, 0.95), p.specular = between(r, 0.1, 0.95), p.clearcoat_gloss = between(r, 0, 0.5);
  return p;
}
}  // namespace

TEST_CASE("Principled: an isotropic metal is Schlick's GGX, the remaining lobes off", "[shade][agreement]") {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    Principled<double> p;
    p.base_color = {between(random, 0, 1), between(random, 0, 1), between(random, 0, 1)};
    p.roughness = between(random, 0.1, 1), p.metallic = 1;
    const vec3<double> v = upward(random, 0.05), l = upward(random, 0.05), h = normalize(v + l);
    const vec3<double> expected =
        fresnel_schlick(dot(v, h), p.base_color) * (ggx_d(p.roughness, vec3<double>(0, 0, 1), h) *
                                                    ggx_v_smith_separable(p.roughness, l.z, v.z) * l.z);
    CHECK(total(principled_cos(p, v, l)) == Approx(total(expected)).epsilon(1e-6));
  }
}

TEST_CASE("Principled: reciprocal, both with Mitsuba's and with Burley's clear coat", "[shade][symmetry]") {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const auto p = inside<Principled<double>>(random);
    const vec3<double> v = upward(random, 0.05), l = upward(random, 0.05);
    CHECK(total(principled_cos(p, v, l)) * v.z == Approx(total(principled_cos(p, l, v)) * l.z).epsilon(1e-12));
    CHECK(total(principled_normalized_cos(p, v, l)) * v.z ==
          Approx(total(principled_normalized_cos(p, l, v)) * l.z).epsilon(1e-12));
    const double coat = principled_clearcoat_cos(p, v, l);
    CHECK(total(principled_normalized_cos(p, v, l) - principled_base_cos(p, v, l)) ==
          Approx(3 * coat / (4 * l.z * v.z)).epsilon(1e-6).margin(1e-12));
  }
}

TEST_CASE("Principled: a quarter turn about the normal takes anisotropy to the other axis", "[shade][symmetry]") {
  Principled<double> p;
  p.metallic = 1, p.anisotropic = 0.8, p.roughness = 0.4;
  const vec3<double> v = normalize(vec3<double>(0.1, 0.0, 1.0));
  const auto along_x = principled_cos(p, v, normalize(vec3<double>(0.6, 0, 1))),
             along_y = principled_cos(p, normalize(vec3<double>(0, 0.1, 1)), normalize(vec3<double>(0, 0.6, 1)));
  CHECK(along_x.x > 1.5 * along_y.x);  // wider along x
}

TEST_CASE("Principled: black behind the horizon, finite at its corners", "[shade][limit]") {
  Principled<double> p;
  p.clearcoat = 1, p.sheen = 1;
  const vec3<double> up(0, 0, 1), down = normalize(vec3<double>(0.5, 0, -0.2));
  CHECK(total(principled_cos(p, up, down)) == 0);
  CHECK(total(principled_cos(p, down, up)) == 0);
  CHECK(total(principled_normalized_cos(p, down, up)) == 0);
  Principled<double> black;
  black.base_color = {0, 0, 0}, black.roughness = 0, black.specular = 0, black.clearcoat_gloss = 1, black.clearcoat = 1;
  black.sheen = 1, black.anisotropic = 1;
  const vec3<double> grazing(1, 0, 0);
  for (const vec3<double>& v : {up, grazing, -grazing})
    for (const vec3<double>& l : {up, grazing}) {
      CHECK(std::isfinite(weigh(principled_normalized_cos(lift<float>(black), lift<float>(v), lift<float>(l)))));
      const auto [y, d, d_v, d_l] = differentiate(weighed, black, v, l);
      CHECK(std::isfinite(y));
      const auto finite = [](const std::string& name, double x, Range) {
        INFO(name);
        CHECK(std::isfinite(x));
      };
      for_each_parameter(d, finite);
      for_each_parameter(d_v, finite);
      for_each_parameter(d_l, finite);
    }
}

TEST_CASE("Principled: all numbers agree and the slopes are right", "[shade][gradient]") {
  // Mitsuba's clear coat and Burley's together, the base in both.
  holds("Principled, principled_base_cos, principled_clearcoat_cos, principled_cos, principled_normalized_cos",
        [](const auto& p, const auto& v, const auto& l) {
          return weigh(principled_cos(p, v, l)) + 0.5f * weigh(principled_normalized_cos(p, v, l));
        },
        [](Random& r) { return std::tuple{drawn(r), upward(r, 0.3), upward(r, 0.3)}; },
        {.rounding = 1e-5, .scale = 1e-3});
}
