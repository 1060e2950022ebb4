// examples/turntable.h -- a vehicle seen from all round, picture by picture
// SPDX-License-Identifier: Apache-2.0
//
// The camera goes round; the vehicle, the light and the shadow on the ground stay.
#pragma once
#include <burnish/twin/pose.h>
#include "stage.h"

namespace turntable {

struct Options {
  int frames = 48, width = 640, height = 360;
  float elevation = 0.2f;  // rad
  float focal = 1.7f;      // in widths
  bool panorama = false;   // the panorama behind the vehicle, instead of a grey studio
};

/// Frame i of o.frames looks from azimuth 2 pi i / frames. look(part, surfel): the Surface there; film(light): display
/// values; done(i, picture as linear display values) is called frame by frame, false ends it. Parts that look says let
/// light through are looked through. Whether all frames were made.
template <class Look, class Film, class Done>
bool turn(const Raycaster& scene, const EnvironmentLight& sky, const LightStrength<float>& strength,
          const vec3<float>& occluded, const Look& look, const Film& film, const Options& o, const Done& done) {
  Mesh solid = scene.mesh();
  std::vector<bool> clear;
  for (int p = 0; p < int(solid.parts.size()); ++p)
    clear.push_back(look(p, Surfel<float>{}).transmission_weight > 0.05f);
  std::size_t kept = 0;
  for (std::size_t t = 0; t < solid.triangles.size(); ++t)
    if (!clear[std::size_t(solid.part[t])])
      solid.triangles[kept] = solid.triangles[t], solid.part[kept] = solid.part[t], ++kept;
  if (kept > 0) solid.triangles.resize(kept), solid.part.resize(kept);
  const Raycaster inside(std::move(solid));
  const Stage stage(sky, strength, occluded, inside);

  // Far enough that the vehicle stays in the picture from all sides.
  const Box box = bounds(scene.mesh());
  Pose<float> pose;
  pose.width = o.width, pose.height = o.height, pose.focal = o.focal, pose.elevation = o.elevation;
  pose.center = box.center();
  for (pose.distance = 2; pose.distance < 200; pose.distance *= 1.02f) {
    float most = 0;
    for (int a = 0; a < 64; ++a)
      for (int k = 0; k < 8; ++k) {
        pose.azimuth = float(a) * pi / 32;
        const vec3<float> corner(k & 1 ? box.low.x : box.high.x, k & 2 ? box.low.y : box.high.y,
                                 k & 4 ? box.low.z : box.high.z);
        const vec3<float> p = pose.project(corner);
        most = std::max(
            {most, p.z > 0.1f ? std::abs(2 * p.x / float(o.width) - 1) : 9, std::abs(2 * p.y / float(o.height) - 1)});
      }
    if (most < 0.9f) break;
  }
  for (int frame = 0; frame < o.frames; ++frame) {
    pose.azimuth = 2 * pi * float(frame) / float(o.frames);
    const Camera camera = pose.camera();
    const GBuffer g = scene.trace(camera, 4);
    const GBuffer all_behind = inside.trace(camera, 1);
    Image picture(o.width, o.height);
    parallel_for(o.height, [&](int y) {
      for (int x = 0; x < o.width; ++x) {
        const vec3<float> d = normalize(camera.toward(float(x) + 0.5f, float(y) + 0.5f));
        const float t = d.y < -1e-3f ? -camera.position.y / d.y : 0;
        const float kept_light = t > 0 ? stage.shadow(camera.position.x + d.x * t, camera.position.z + d.z * t) : 1;
        const vec3<float> wall = vec3<float>(mix(0.5f, 0.24f, smoothstep(-0.35f, 0.12f, d.y)));
        const vec3<float> behind = o.panorama ? linear_from_srgb(film(stage.panorama(d))) : wall;
        picture.set(x, y, behind * kept_light);
      }
    });
    const auto shade = [&](const GBuffer& seen_by, auto through) {
      const std::vector<Stage::Seen> seen = stage.look_around(seen_by);
      parallel_for((seen_by.size() + 255) / 256, [&](int block) {
        for (int i = 256 * block; i < std::min(seen_by.size(), 256 * block + 256); ++i) {
          const Surfel<float> at = seen_by.at(i);
          const Surface<float> s = look(seen_by.part[std::size_t(i)], at);
          vec3<float> light = stage.reflected_by(s, at, seen[std::size_t(i)]);
          const int p = seen_by.pixel[std::size_t(i)], x = p % o.width, y = p / o.width;
          const float cover = seen_by.plane[GBuffer::coverage][std::size_t(i)];
          vec3<float> color = linear_from_srgb(film(light));
          if (s.transmission_weight > 0.05f) color += transmittance(s, dot(at.normal, at.view)) * through(p);
          const vec3<float> below = picture.at(x, y);
          picture.set(x, y, mix(below, min(color, vec3<float>(1)), cover));
        }
      });
    };
    std::vector<int> panes(std::size_t(o.width) * std::size_t(o.height)), chosen;
    for (int i = 0; i < g.size(); ++i)
      panes[std::size_t(g.pixel[std::size_t(i)])] = clear[std::size_t(g.part[std::size_t(i)])];
    for (int i = 0; i < all_behind.size(); ++i)
      if (panes[std::size_t(all_behind.pixel[std::size_t(i)])]) chosen.push_back(i);
    shade(all_behind.picked(chosen), [](int) { return vec3<float>(); });
    const Image furnished = picture;
    shade(g, [&](int p) { return furnished.at(p % o.width, p / o.width); });
    if (!done(frame, picture)) return false;
  }
  return true;
}

}  // namespace turntable
