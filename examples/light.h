// examples/light.h -- the light on a photographed vehicle: how strong a panorama is, and which way it is turned
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/fit/loss.h>
#include <burnish/light/irradiance.h>
#include "fitted.h"
#include "looks.h"
#include "shot.h"
#include "street.h"

namespace fitting {
using namespace burnish;
using fitted::hold_back;
using looks::first_paint, looks::painted, looks::undeveloped;
using parts::Role;
using shot::Shot, shot::World, shot::lit;
using street::Photo, street::both;

/// Neutral on average, and as strong as a street of middling grey (albedo 0.2) must have been lit to give the photo's
/// mean brightness.
inline World world_of(const Settings& settings, const Image& photo, const Image& panorama, float yaw) {
  World world{EnvironmentLight(panorama, yaw * pi / 180), {}, {}};
  const IrradianceMap irradiance(world.sky);
  vec3<float> mean;
  for (const vec3<float>& n : {vec3<float>{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}}) {
    const auto e = irradiance(n);
    mean += vec3<float>(e[0], e[1], e[2]) * 0.2f;
    for (const Sun<float>& s : world.sky.suns) mean += s.power * (0.2f * std::max(0.0f, dot(n, s.direction)));
  }
  world.occluded = mean * (0.2f * inverse_pi);
  double brightness = 0;
  const int n = photo.width * photo.height;
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < n; ++i) brightness += double(undeveloped(photo.plane(c)[i])) / (3.0 * n);
  const vec3<float> grey = vec3<float>(float(brightness) / (0.2f * inverse_pi)) / mean;
  world.strength.sky = world.strength.sun = settings.exposure > 0 ? vec3<float>(settings.exposure) : grey;
  return world;
}
/// How many times stronger the light must be for half of the paint's pixels to need no albedo above 0.8, the most that
/// paints have, in any channel; at least 1.
inline float white_point(const Shot& seen, const World& world, const Photo& photo) {
  const Mask overlap = both(photo.of(Role::paint), seen[Role::paint].frame("coverage"));
  CarPaint<float> white;
  white.base_color = {0.8f, 0.8f, 0.8f}, white.base_metalness = 0;
  const Image image = render(seen[Role::paint], lit(painted, seen, world), white);
  float most = 1;
  for (int c = 0; c < 3; ++c) {
    std::vector<float> ratio;
    for (std::size_t i = 0; i < overlap.values.size(); ++i)
      if (overlap.values[i] > 0.5f)
        ratio.push_back(undeveloped(photo.image.plane(c)[i]) / std::max(undeveloped(image.plane(c)[i]), 1e-4f));
    if (ratio.empty()) break;
    std::nth_element(ratio.begin(), ratio.begin() + std::ptrdiff_t(ratio.size() / 2), ratio.end());
    most = std::max(most, ratio[ratio.size() / 2]);
  }
  return std::min(most, 8.0f);
}

/// The panorama's yaw, of eight, under which a few steps on a few of the paint's pixels come closest to the photo.
inline float best_yaw(const Settings& settings, const Image& whole_photo, const Image& panorama, const GBuffer& g,
                      const std::vector<Role>& roles, const Photo& photo) {
  const Mask target = photo.of(Role::paint);
  std::vector<int> all, some;
  for (int i = 0; i < g.size(); ++i)
    if (roles[std::size_t(i)] == Role::paint && target.values[std::size_t(g.pixel[std::size_t(i)])] > 0.5f)
      all.push_back(i);
  for (std::size_t i = 0; i < all.size(); i += 1 + all.size() / 1500) some.push_back(all[i]);
  if (some.empty()) return 0;
  Shot seen;
  seen.parts[0] = g.picked(some);
  const Mask overlap = both(target, seen[Role::paint].frame("coverage"));
  const CarPaint<float> start = first_paint();
  const Image coarse = resized(panorama, 256, 128);
  Image image(g.width, g.height), d_image = image;
  float best = 0;
  double least = 1e9;
  for (const float yaw : {0.0f, 45.0f, 90.0f, 135.0f, 180.0f, 225.0f, 270.0f, 315.0f}) {
    World world = world_of(settings, whole_photo, coarse, yaw);
    seen.light = LightOf<float>(Illumination(world.sky, seen[Role::paint], {}, {.rings = Rings::Size::small}));
    const float up = settings.exposure > 0 ? 1 : white_point(seen, world, photo);
    world.strength.sky *= up, world.strength.sun *= up;
    const auto look = lit(painted, seen, world);
    FitState state(start, Adam{.rate = 0.05f});
    fit(
        state,
        [&](const CarPaint<float>& model, CarPaint<float>& d) {
          render(seen[Role::paint], look, model, image);
          std::fill(d_image.values.begin(), d_image.values.end(), 0.0f);
          const double loss = masked_l1(image, photo.image, overlap, 1, d_image);
          backward(seen[Role::paint], look, model, d_image, d);
          return loss + hold_back(model, start, d, settings, settings.prior);
        },
        Patience{.steps = 50, .window = 0});
    if (state.best_loss < least) least = state.best_loss, best = yaw;
  }
  return best;
}

}  // namespace fitting
