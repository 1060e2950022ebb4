// tests/shade/corners.cpp -- at every corner of their arguments, shade's functions have numbers for slopes
// SPDX-License-Identifier: Apache-2.0
//
// By the reverse sweep of an image in packets: it multiplies zero adjoints, too, and so finds what a tape, which skips
// them, does not: an infinite slope on the side of a select that is not taken.
#include <burnish/fit/render.h>
#include <burnish/shade/brdf.h>
#include <burnish_test.h>
using namespace burnish;

namespace {
template <class T> struct Corner {
  Surface<T> surface;
  vec3<T> n = {0.0f, 0.0f, 1.0f}, v, l;
  T c = 0.0f, eta = 1.5f;
  static constexpr auto parameters() {
    return std::tuple{Param{"surface", &Corner::surface},
                      Param{"n", &Corner::n},
                      Param{"v", &Corner::v},
                      Param{"l", &Corner::l},
                      Param{"c", &Corner::c},
                      Param{"eta", &Corner::eta}};
  }
};
template <class T> struct Dot {
  T x = 0.0f;
  static constexpr auto parameters() { return std::tuple{Param{"x", &Dot::x}}; }
};

std::vector<Corner<float>> corners() {
  std::vector<Corner<float>> list;
  for (const float extreme : {0.0f, 1.0f})
    for (const float r : {0.0f, min_roughness, 1.0f})
      for (const float ior : {1.0f, 1.6f, 3.0f})
        for (const float c : {0.0f, 1e-8f, 1e-3f, 1.0f})
          for (const float c2 : {-0.5f, 0.0f, 1e-8f, 1.0f, 2.0f})  // 2: opposite the viewer
            for (const float side : {1.0f, -1.0f}) {
              Corner<float> k;
              Surface<float>& s = k.surface;
              s.base_color = s.specular_color = s.coat_color = vec3<float>(extreme);
              s.base_weight = s.specular_weight = s.base_metalness = s.coat_weight = extreme;
              s.transmission_weight = 1 - extreme, s.base_diffuse_roughness = s.coat_darkening = extreme;
              s.specular_roughness = s.coat_roughness = r, s.specular_ior = s.coat_ior = ior;
              const auto at = [](float x, float y) { return vec3<float>(std::sqrt(1 - x * x) * y, 0, x); };
              k.v = at(c, 1), k.l = c2 > 1 ? -k.v : at(c2, side);
              k.c = c, k.eta = side > 0 ? ior : 1 / ior;
              list.push_back(k);
            }
  return list;
}
/// How many corners have a value or slope of f that is no number.
template <class F> int without_numbers(F f) {
  const auto list = corners();
  const int n = int(list.size());
  Planes<Corner> model(n), d(n);
  for (int i = 0; i < n; ++i) model.set(i, list[std::size_t(i)]);
  const auto look = [&](const auto& k, const auto&) { return f(k); };
  const double sum = sum_and_gradient<Player::replayed>(Planes<Dot>(n), look, model, d);
  int bad = !std::isfinite(sum);
  for (int i = 0; i < n; ++i) {
    bool ok = std::isfinite(f(list[std::size_t(i)]));
    Corner<float> slopes = d.at(i);
    each([&](float x) { ok = ok && std::isfinite(x); }, slopes);
    bad += !ok;
  }
  return bad;
}
constexpr auto weigh = [](const auto& c) { return c.x + 2.0f * c.y + 3.0f * c.z; };
}  // namespace

TEST_CASE("Shade: no corner has a slope that is no number", "[shade][limit]") {
  CHECK(without_numbers([](const auto& k) { return weigh(brdf_cos(k.surface, k.n, k.v, k.l)); }) == 0);
  CHECK(without_numbers([](const auto& k) { return weigh(transmittance(k.surface, k.c)); }) == 0);
  CHECK(without_numbers([](const auto& k) { return fresnel_dielectric(k.c, k.eta); }) == 0);
  CHECK(without_numbers([](const auto& k) {
          return fresnel_conductor(k.c, k.eta, k.surface.base_metalness) +
                 fresnel_conductor(k.c, k.surface.base_weight, k.surface.specular_ior) +
                 fresnel_f82(k.c, k.surface.base_weight, k.surface.coat_weight);
        }) == 0);
  CHECK(without_numbers([](const auto& k) {
          using T = std::remove_cvref_t<decltype(k.c)>;
          const T r = k.surface.specular_roughness, one = max(k.c, 1e-4f);
          return ggx_v_smith_separable(r, k.c, k.c) + ggx_g1(r, k.c) + ggx_visible_normal_pdf(r, one, k.c, k.eta);
        }) == 0);
  CHECK(without_numbers([](const auto& k) {
          using T = std::remove_cvref_t<decltype(k.c)>;
          const vec3<T> upward(k.v.x, k.v.y, max(k.v.z, 1e-3f));
          return weigh(
              ggx_sample_visible_normal(k.surface.specular_roughness, upward, vec2<T>(k.c, k.surface.base_weight)));
        }) == 0);
  CHECK(without_numbers([](const auto& k) {
          const auto a = oren_nayar(k.surface.base_color, k.surface.base_diffuse_roughness, k.c, k.c, k.v.x);
          return weigh(a + burley(k.surface.base_color, k.surface.base_diffuse_roughness, k.c, k.c, k.v.x));
        }) == 0);
}
