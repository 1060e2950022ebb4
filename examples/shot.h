// examples/shot.h -- a vehicle seen by a camera, lit by a panorama, and drawn over a photo
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/fit/render.h>
#include <burnish/io/photo.h>
#include <burnish/light/illuminate.h>
#include <burnish/scene/raycast.h>
#include "vehicle_parts.h"

namespace shot {
using namespace burnish;
using parts::Role;

struct World {
  EnvironmentLight sky;
  LightStrength<float> strength;
  vec3<float> occluded;  // radiance of what hides the sky: the vehicle itself, taken as a rough grey
};
/// What the camera sees, apart by role, and the light on all of it, gathered once.
struct Shot {
  std::array<GBuffer, 4> parts;
  LightOf<float> light;
  const GBuffer& operator[](Role r) const { return parts[std::size_t(r)]; }
};
inline Shot gather(const World& world, const Raycaster& scene, const GBuffer& g, const std::vector<Role>& roles,
                   Rings::Size rings) {
  std::vector<int> order;  // the paint's surfels first: they lie together in the light's tables
  std::array<std::vector<int>, 4> places;
  for (std::size_t r = 0; r < 4; ++r)
    for (int i = 0; i < g.size(); ++i)
      if (roles[std::size_t(i)] == Role(r)) places[r].push_back(int(order.size())), order.push_back(i);
  const GBuffer sorted = g.picked(order);
  const auto blocked = [&](int i, std::span<const vec3<float>> directions, std::span<std::uint8_t> out) {
    scene.blocked(sorted, i, directions, out);
  };
  Shot shot{{}, LightOf<float>(Illumination(world.sky, sorted, blocked, {.rings = rings, .occluded = world.occluded}))};
  for (std::size_t r = 0; r < 4; ++r) shot.parts[r] = sorted.picked(places[r], false);
  return shot;
}
template <class Look> auto lit(const Look& look, const Shot& shot, const World& world) {
  return with(look, shot.light, world.sky.suns, world.strength);
}
inline Image linear(const Image& shown) {
  Image out = shown;
  for (float& x : out.values) x = detail::from_srgb(x);
  return out;
}

/// The vehicle over the photo (display values), as linear light. Pixels where everything is alike are drawn once,
/// others 2 x 2 times.
class Compositor {
public:
  static constexpr int fine = 2;
  Compositor(const Image& photo, const Camera& camera, const Raycaster& scene, const World& w,
             const parts::RolesOf& roles_of)
      : world(w), background(linear(photo)), width(camera.width * fine) {
    const GBuffer full = scene.trace(camera.scaled(fine), 1);
    const std::vector<Role> roles = roles_of(full);
    hits.resize(std::size_t(camera.width) * std::size_t(camera.height));
    std::vector<std::array<int, fine * fine>> samples(hits.size());
    for (int i = 0; i < full.size(); ++i) {
      const std::size_t p = pixel(full.pixel[std::size_t(i)]);
      samples[p][std::size_t(hits[p]++)] = i;
    }
    std::vector<int> chosen;
    std::vector<Role> role;
    for (std::size_t p = 0; p < hits.size(); ++p) {
      const auto& s = samples[p];
      bool alike = hits[p] == fine * fine && full.parts[std::size_t(full.part[std::size_t(s[0])])].texture < 0;
      for (int k = 1; k < hits[p] && alike; ++k)
        alike = full.part[std::size_t(s[std::size_t(k)])] == full.part[std::size_t(s[0])] &&
                dot(full.at(s[std::size_t(k)]).normal, full.at(s[0]).normal) > 0.995f;
      for (int k = 0; k < (alike ? 1 : hits[p]); ++k)
        chosen.push_back(s[std::size_t(k)]), role.push_back(roles[std::size_t(s[std::size_t(k)])]);
    }
    shot = gather(world, scene, full.picked(chosen), role, Rings::Size::small);
    const GBuffer& other = shot[Role::other];
    looks = Planes<parts::FileLook>(other.size());
    for (int i = 0; i < other.size(); ++i)
      looks.set(i,
                parts::file_look(scene.mesh(), other.parts[std::size_t(other.part[std::size_t(i)])], other.at(i).uv));
  }
  /// draw(shot, looks of what is not fitted, image) renders display values, of every role.
  template <class Draw> Image operator()(Draw draw) const {
    Image image(width, background.height * fine), out = background;
    draw(shot, looks, image);
    std::vector<vec3<float>> sum(hits.size());
    std::vector<int> count(hits.size());
    for (const GBuffer& g : shot.parts)
      for (const int p : g.pixel) {
        const vec3<float> c = image.at(p % width, p / width);
        sum[pixel(p)] += vec3<float>(detail::from_srgb(c.x), detail::from_srgb(c.y), detail::from_srgb(c.z));
        ++count[pixel(p)];
      }
    for (int i = 0; i < int(hits.size()); ++i) {
      if (hits[std::size_t(i)] == 0) continue;
      const int x = i % out.width, y = i / out.width;
      const float a = float(hits[std::size_t(i)]) / (fine * fine);
      out.set(x, y, out.at(x, y) * (1 - a) + sum[std::size_t(i)] * (a / float(count[std::size_t(i)])));
    }
    return out;
  }

private:
  const World& world;
  Image background;
  int width;
  std::vector<int> hits;  // of each pixel's fine ones, how many the vehicle covers
  Shot shot;
  Planes<parts::FileLook> looks;

  std::size_t pixel(int p) const {
    return std::size_t(p / width / fine) * std::size_t(background.width) + std::size_t(p % width / fine);
  }
};

/// How far apart two pictures are under both masks; display values in, linear light out.
inline Image difference(const Image& a, const Image& b, const Mask& mask, const Mask& other) {
  Image out(a.width, a.height);
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      const vec3<float> d = a.at(x, y) - b.at(x, y);
      const float inside = std::min(mask.at(x, y), other.at(x, y));
      out.set(x, y, vec3<float>(std::abs(d.x), std::abs(d.y), std::abs(d.z)) * inside);
    }
  return linear(out);
}
/// Normals as colours, and the roles.
inline std::pair<Image, Image> shown_gbuffer(const GBuffer& g, const std::vector<Role>& roles) {
  constexpr std::array<vec3<float>, 4> colors{
      {{0.75f, 0.2f, 0.15f}, {0.2f, 0.5f, 0.8f}, {0.25f, 0.25f, 0.25f}, {0.8f, 0.7f, 0.3f}}};
  Image normals(g.width, g.height), kinds(g.width, g.height);
  for (int i = 0; i < g.size(); ++i) {
    const int p = g.pixel[std::size_t(i)];
    const Surfel<float> s = g.at(i);
    normals.set(p % g.width, p / g.width, s.normal * 0.5f + vec3<float>(0.5f));
    kinds.set(p % g.width, p / g.width,
              colors[std::size_t(roles[std::size_t(i)])] * (0.4f + 0.6f * dot(s.normal, s.view)));
  }
  return {linear(normals), linear(kinds)};
}

}  // namespace shot
