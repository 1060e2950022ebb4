// tests/reference/images_suns.cpp -- the car under suns: picture and gradient against Mitsuba's `direct`
// SPDX-License-Identifier: Apache-2.0
//
// Everything is deterministic on both sides, shadows included. The chain is the whole one: ray caster, G-buffer,
// shadows, a look of public lobes, render and backward.
#include <burnish_test.h>
#include "images.h"
#include <burnish/fit/render.h>
#include <burnish/light/sun.h>
#include <burnish/nodes/image.h>
#include <burnish/nodes/normal.h>
#include <burnish/shade/brdf.h>
#include <burnish/shade/principled.h>

using namespace burnish;

namespace {
constexpr int width = 96, height = 64, map_width = 16, map_height = 8;

template <class T> struct Paint {
  vec3<T> color;
  T roughness, metalness;
  ImageNode<T> normal;
  static constexpr auto parameters() {
    return std::tuple{Param{"color", &Paint::color}, Param{"roughness", &Paint::roughness},
                      Param{"metalness", &Paint::metalness}, Param{"normal", &Paint::normal}};
  }
  /// In the tangent frame.
  constexpr vec3<T> bent(const vec2<T>& uv) const { return NormalMap<T>{}(normal(uv)); }
};
std::vector<Paint<float>> paints() {
  Texture<float> map(map_width, map_height, 3);
  const double turn = 2 * 3.141592653589793;
  for (int y = 0; y < map_height; ++y) {
    for (int x = 0; x < map_width; ++x) {
      const double u = (x + 0.5) / map_width, v = (y + 0.5) / map_height;
      map.at(x, y, 0) = float(0.5 + 0.09 * std::sin(turn * (2 * u + v)));
      map.at(x, y, 1) = float(0.5 + 0.07 * std::cos(turn * (u - 2 * v) + 0.4));
      map.at(x, y, 2) = float(0.95 + 0.04 * std::sin(turn * (u + v)));
    }
  }
  return {{{0.62f, 0.13f, 0.08f}, 0.38f, 0.45f, {map}},
          {{0.15f, 0.2f, 0.26f}, 0.24f, 0.7f, {map}},
          {{0.22f, 0.21f, 0.2f}, 0.62f, 0.3f, {map}},
          {{0.45f, 0.41f, 0.36f}, 0.8f, 0.1f, {map}}};
}
std::vector<Sun<float>> suns() {
  std::vector<Sun<float>> list(2);
  list[0].direction = normalize(vec3<float>(0.55f, 0.72f, 0.43f)), list[0].power = {2.4f, 2.2f, 1.9f};
  list[1].direction = normalize(vec3<float>(-0.35f, 0.5f, 0.8f)), list[1].power = {0.5f, 0.8f, 1.2f};
  for (std::size_t k = 0; k < 2; ++k) list[k].variance = 0, list[k].index = float(k);
  return list;
}

/// What Raycaster::visible found, sun after sun.
struct Shadows {
  int stride = 0;
  std::vector<float> seen;
};
template <class T> using ShadowsOf = Resource<T, Shadows>;
/// (surfel, sun) -> 1 where the one sees the other.
struct Seen {
  using Data = Shadows;
  static constexpr int inputs = 2, outputs = 1;
  static constexpr bool active = false;
  template <class T> static void value(const Shadows& s, const T* x, T* y) {
    y[0] = gather<T>(s.seen.data(), to_int(x[1] + 0.5f) * s.stride + to_int(x[0] + 0.5f));
  }
  template <class T> static void back(const Shadows&, const T*, const T*, const T*, T* d_x, Scatter*) {
    d_x[0] = d_x[1] = T(0.0f);
  }
};

/// Mitsuba's blendbsdf of diffuse and roughconductor (Fresnel 1, separable Smith) in its normalmap: black where light
/// or viewer are behind the bent normal, or the light behind the mesh's own.
constexpr auto blend = [](const auto& p, const auto& at, const auto& shadows, const auto& list) {
  using T = std::remove_cvref_t<decltype(p.roughness)>;
  const vec3<T> normal(at.normal), tangent(at.tangent), v(at.view);
  const vec3<T> n = from_tangent_frame(p.bent(vec2<T>(at.uv)), normal, tangent);
  return repeat(list, [&](const Sun<T>& sun) {
    const vec3<T>& l = sun.direction;
    const vec3<T> h = normalize(v + l);
    const T nl = dot(n, l), nv = dot(n, v), seen = apply<Seen>(shadows, T(at.index), sun.index);
    const T lit = select(nl > T(0.0f) && nv > T(0.0f) && dot(normal, l) > T(0.0f), nl * seen, T(0.0f));
    const T metal = ggx_d(p.roughness, n, h) * ggx_v_smith_separable(p.roughness, max(nl, 0.0f), max(nv, 0.0f));
    return p.color * sun.power * ((T(inverse_pi) * (1.0f - p.metalness) + metal * p.metalness) * lit);
  });
};
/// Mitsuba's principled with all its lobes in its normalmap: the bent frame's first axis is the tangent made
/// perpendicular to the bent normal.
constexpr auto principled = [](const auto& p, const auto& at, const auto& shadows, const auto& list) {
  using T = std::remove_cvref_t<decltype(p.roughness)>;
  const vec3<T> normal(at.normal), tangent(at.tangent), view(at.view);
  const vec3<T> n = from_tangent_frame(p.bent(vec2<T>(at.uv)), normal, tangent);
  const vec3<T> x = normalize(tangent - n * dot(n, tangent)), y = cross(n, x);
  Principled<T> s;
  s.base_color = p.color;
  s.roughness = p.roughness;
  s.metallic = p.metalness;
  s.anisotropic = 0.4f, s.specular = 0.6f, s.spec_tint = 0.2f, s.sheen = 0.3f, s.sheen_tint = 0.4f, s.flatness = 0.25f;
  s.clearcoat = 0.5f, s.clearcoat_gloss = 0.3f;
  const vec3<T> v{dot(x, view), dot(y, view), dot(n, view)};
  return repeat(list, [&](const Sun<T>& sun) {
    const vec3<T>& l = sun.direction;
    const T seen = select(dot(normal, l) > T(0.0f), apply<Seen>(shadows, T(at.index), sun.index), T(0.0f));
    return principled_cos(s, v, vec3<T>{dot(x, l), dot(y, l), dot(n, l)}) * sun.power * seen;
  });
};

struct Lit {
  Raycaster caster{images::car()};
  GBuffer g = caster.trace(images::camera(width, height), 1);
  ShadowsOf<float> shadows;
  Lit() {
    std::vector<vec3<float>> to;
    for (const Sun<float>& sun : suns()) to.push_back(sun.direction);
    const std::vector<std::uint8_t> seen = caster.visible(g, to);
    shadows.stride = g.padded_size();
    shadows.seen.assign(seen.begin(), seen.end());
  }
};

/// Claims for the first `lights` suns; name: of the stored numbers, car_<name>; how: the player.
template <Player Which, class Look>
void compare(const Lit& lit, const Look& look, const std::string& name, int lights, const std::string& how) {
  const GBuffer& g = lit.g;
  const reference::Array picture = reference::load("car_" + name), slope = reference::load("car_" + name + "_slope"),
                         texels = reference::load("car_" + name + "_texels");
  const std::vector<int> row = images::rows(reference::load("car_shaded"));
  std::vector<Sun<float>> list = suns();
  list.resize(std::size_t(lights));
  const auto sum = [&](const reference::Array& a, auto... at) {
    double s = 0;
    for (int k = 0; k < lights; ++k) s += a(k, at...);
    return s;
  };
  const Image d_image = images::weights(width, height);
  const auto shaded = with(look, lit.shadows, list);
  Image image(width, height);
  images::Difference pixels, color, roughness, metalness, texel;
  for (int part = 0; part < images::parts; ++part) {
    const GBuffer own = images::only(g, part, row);
    const Paint<float> paint = paints()[std::size_t(part)];
    render(own, shaded, paint, image);
    const Paint<float> d = backward<Which>(own, shaded, paint, d_image);
    color.add(double(d.color.x), sum(slope, part, 0));
    color.add(double(d.color.y), sum(slope, part, 1));
    color.add(double(d.color.z), sum(slope, part, 2));
    roughness.add(double(d.roughness), sum(slope, part, 3));
    metalness.add(double(d.metalness), sum(slope, part, 4));
    for (int y = 0; y < map_height; ++y)
      for (int x = 0; x < map_width; ++x)
        for (int c = 0; c < 3; ++c) texel.add(double(d.normal.file.at(x, y, c)), sum(texels, part, y, x, c));
  }
  for (int p = 0; p < width * height; ++p) {
    if (row[std::size_t(p)] < 0) continue;
    for (int c = 0; c < 3; ++c) pixels.add(double(image.plane(c)[p]), sum(picture, row[std::size_t(p)], c));
  }
  const std::string direct = images::mitsuba + "direct",
                    what = "a car of " + name + (lights == 1 ? ", one sun" : ", two suns") + ", " + how;
  record::claim(what, "image", direct, 1e-4, pixels.relative(), pixels.count());
  record::claim(what + ": by colour", "image gradient", direct, 1e-4, color.relative(), color.count());
  record::claim(what + ": by roughness", "image gradient", direct, 1e-4, roughness.relative(), roughness.count());
  record::claim(what + ": by metalness", "image gradient", direct, 1e-4, metalness.relative(), metalness.count());
  // Texels under a highlight collect what is nearly as often positive as negative: one alone keeps fewer digits.
  record::claim(what + ": by texels of the normal map", "image gradient", direct, 1e-4, texel.relative_rms(),
                texel.count());
  record::claim(what + ": by the worst texel", "image gradient", direct, 1e-3, texel.relative(), texel.count());
}
}  // namespace

TEST_CASE("Suns: picture and gradients of a car under a normal map and its own shadows are Mitsuba's",
          "[reference][gradient]") {
  const Lit lit;
  for (const int lights : {1, 2}) {
    compare<Player::replayed>(lit, blend, "blend", lights, "replayed");
    compare<Player::replayed>(lit, principled, "principled", lights, "replayed");
  }
}
