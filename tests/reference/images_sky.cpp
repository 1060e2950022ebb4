// tests/reference/images_sky.cpp -- the car under a sky: picture and gradient against Mitsuba's `direct`
// SPDX-License-Identifier: Apache-2.0
//
// Mitsuba integrates burnish's own layers (layered.py) by sampling; its standard errors are stored with its means.
#include <burnish_test.h>
#include "images.h"
#include <burnish/fit/render.h>
#include <burnish/light/illuminate.h>

using namespace burnish;

namespace {
constexpr int width = 36, height = 24;

template <class T> struct Layer {
  vec3<T> base_color;
  T specular_roughness, base_metalness, coat_weight, coat_roughness;
  static constexpr auto parameters() {
    return std::tuple{
        Param{"base_color", &Layer::base_color}, Param{"specular_roughness", &Layer::specular_roughness},
        Param{"base_metalness", &Layer::base_metalness}, Param{"coat_weight", &Layer::coat_weight},
        Param{"coat_roughness", &Layer::coat_roughness}};
  }
};
const Layer<float> layer[images::parts] = {{{0.55f, 0.09f, 0.06f}, 0.4f, 0.5f, 0.8f, 0.25f},
                                           {{0.1f, 0.13f, 0.16f}, 0.25f, 0.2f, 0, 0.3f},
                                           {{0.5f, 0.48f, 0.45f}, 0.5f, 0.9f, 0, 0.3f},
                                           {{0.4f, 0.37f, 0.33f}, 0.85f, 0.05f, 0.1f, 0.35f}};

constexpr auto look = [](const auto& p, const auto& at, const auto& light, const auto& suns) {
  using T = std::remove_cvref_t<decltype(p.coat_weight)>;
  Surface<T> s;
  s.base_color = p.base_color;
  s.specular_roughness = p.specular_roughness;
  s.base_metalness = p.base_metalness;
  s.coat_weight = p.coat_weight;
  s.coat_roughness = p.coat_roughness;
  return illuminate(s, at, light, suns, LightStrength<T>{});
};

/// The tolerances of a comparison: of the picture's root mean square and its worst channel of a pixel, and of the
/// derivatives by base colour, roughness, metalness, coat weight and roughness.
struct Within { double image, pixel, slope[4]; };

void compare(const std::string& name, const EnvironmentLight& sky, const GBuffer& g, const LightOf<float>& light,
             const Within& within) {
  const reference::Array picture = reference::load("sky_" + name), slope = reference::load("sky_" + name + "_slope");
  const std::vector<int> row = images::rows(reference::load("car_small_shaded"));
  const auto shaded = with(look, light, sky.suns);
  const Image d_image = images::weights(width, height);
  Image image(width, height);
  images::Difference pixels, slopes[4];
  for (int part = 0; part < images::parts; ++part) {
    const GBuffer own = images::only(g, part, row);
    render(own, shaded, layer[part], image);
    const Layer<float> d = backward<Player::replayed>(own, shaded, layer[part], d_image);
    int k = 0;
    each([&](float x) {
      slopes[k < 3 ? 0 : std::min(k - 2, 3)].add(double(x), slope(part, k));
      ++k;
    }, d);
  }
  for (std::size_t p = 0; p < row.size(); ++p) {
    for (int c = 0; c < 3 && row[p] >= 0; ++c) pixels.add(double(image.plane(c)[p]), picture(row[p], c));
  }
  const std::string direct = images::mitsuba + "direct, sampled", what = "a car under a sky, " + name;
  record::claim(what, "image", direct, within.image, pixels.relative_rms(), pixels.count());
  record::claim(what + ": worst pixel", "image", direct, within.pixel, pixels.relative(), pixels.count());
  const char* const by[4] = {"base colour", "roughness", "metalness", "coat"};
  for (int k = 0; k < 4; ++k) {
    record::claim(what + ": by " + by[k], "image gradient", direct, within.slope[k], slopes[k].relative(),
                  slopes[k].count());
  }
}
}  // namespace

TEST_CASE("Sky: Mitsuba's own noise is small enough to judge by", "[reference][limit]") {
  for (const std::string name : {"sky_open", "sky_blocked"}) {
    images::Difference noise, slope_noise;
    for (const auto& [of, to] : {std::pair{name, &noise}, std::pair{name + "_slope", &slope_noise}}) {
      const reference::Array mean = reference::load(of), error = reference::load(of + "_error");
      for (std::size_t i = 0; i < mean.size(); ++i) to->add(mean.values[i] + error.values[i], mean.values[i]);
    }
    CHECK(noise.relative_rms() < 0.003);
    CHECK(noise.relative() < 0.01);
    CHECK(slope_noise.relative() < 0.01);
  }
}

TEST_CASE("Sky: picture and gradients of a car's layers are what Mitsuba makes of them", "[reference][gradient]") {
  // What is blocked is found along the directions that are looked at, whole or not at all, and for the diffuse light
  // along 145: contact shadows are coarse.
  const Raycaster caster(images::car());
  const GBuffer g = caster.trace(images::camera(width, height), 1);
  const EnvironmentLight sky(images::panorama(512));
  // The surfels twice in one table: the first half sees all of the sky, the second what the car leaves of it.
  std::vector<int> open(std::size_t(g.size())), blocked = open, both;
  for (int i = 0; i < g.size(); ++i) open[std::size_t(i)] = i, blocked[std::size_t(i)] = g.size() + i;
  for (int i = 0; i < 2 * g.size(); ++i) both.push_back(i % g.size());
  const GBuffer twice = g.picked(both);
  const LightOf<float> light(sky, twice, [&](int i, auto directions, auto out) {
    if (i >= g.size()) caster.blocked(twice, i, directions, out);
  });
  compare("open", sky, twice.picked(open, false), light, {0.01, 0.02, {0.01, 0.01, 0.01, 0.01}});
  compare("blocked", sky, twice.picked(blocked, false), light, {0.025, 0.25, {0.01, 0.015, 0.01, 0.01}});
}
