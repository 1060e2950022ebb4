// burnish/twin/preview.h -- a quick picture of a vehicle in the file's own colours: soft light, white ground
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>
#include <burnish/scene/raycast.h>
#include <burnish/twin/pose.h>

namespace burnish {

/// From that side (rad, as in Pose), so far away that the box fills the picture but for a margin.
inline Pose<float> framed(const Box& box, float azimuth, float elevation, int width, int height, float focal = 1.8f) {
  Pose<float> p;
  p.azimuth = azimuth, p.elevation = elevation, p.focal = focal, p.center = box.center();
  p.width = width, p.height = height, p.distance = focal * length(box.size()) + 1;
  for (int round = 0; round < 6; ++round) {
    Box seen;
    for (int k = 0; k < 8; ++k)
      seen.add(p.project(vec3<float>(k & 1 ? box.low.x : box.high.x, k & 2 ? box.low.y : box.high.y,
                                     k & 4 ? box.low.z : box.high.z)));
    const float f = focal * float(width);
    const float scale = std::max(seen.size().x / (0.9f * float(width)), seen.size().y / (0.86f * float(height)));
    p.right -= (seen.center().x - 0.5f * float(width)) / f, p.down -= (seen.center().y - 0.5f * float(height)) / f;
    p.distance = std::max(p.distance * scale, 0.6f * length(box.size()));
  }
  return p;
}

/// Linear RGB. The sky is bright all over, brightest to the viewer's upper left; what is clear is dark and shines.
inline Image preview(const Raycaster& scene, const Camera& camera, int directions = 48) {
  constexpr int fine = 2;
  const Camera c = camera.scaled(fine);
  const GBuffer g = scene.trace(c, 1);
  const vec3<float> key = normalize(vec3<float>(0, 1, 0) * 0.9f - c.right * 0.5f - c.forward * 0.45f);
  const auto sky = [&](const vec3<float>& d) {
    const float k = std::max(0.0f, dot(d, key));
    return 0.55f + 0.2f * d.y + 1.6f * k * k * k * k;
  };
  // Evenly over the upper half: rings of a golden spiral.
  std::vector<vec3<float>> toward;
  for (int i = 0; i < directions; ++i) {
    const float y = (float(i) + 0.5f) / float(directions), r = std::sqrt(1 - y * y), turn = 2.39996323f * float(i);
    toward.push_back({r * std::cos(turn), y, r * std::sin(turn)});
  }
  float open = 0;  // what a free ground receives
  for (const vec3<float>& d : toward) open += d.y * sky(d);
  Image out(c.width, c.height, {1, 1, 1});
  const std::vector<std::uint8_t> seen = scene.visible(g, toward);
  const std::size_t stride = std::size_t(g.padded_size());
  parallel_for(g.size(), [&](int i) {
    const Surfel<float> s = g.at(i);
    float light = 0, free = 0;
    for (std::size_t d = 0; d < toward.size(); ++d) {
      if (!seen[d * stride + std::size_t(i)]) continue;
      const float cosine = std::max(0.0f, dot(s.normal, toward[d]));
      light += cosine * sky(toward[d]), free += cosine;
    }
    light = light / open + 0.2f * std::max(0.0f, 0.6f - 0.6f * s.normal.y);
    const Part& part = g.parts[std::size_t(g.part[std::size_t(i)])];
    const float clear = 1 - part.opacity * part.opacity;  // a dark inside is behind it
    const vec3<float> base = scene.mesh().color(part, s.uv) * (1 - clear) + vec3<float>(0.02f, 0.025f, 0.03f) * clear;
    const float nv = std::clamp(dot(s.normal, s.view), 0.0f, 1.0f);
    const vec3<float> mirrored = s.normal * (2 * nv) - s.view;
    const float fresnel = 0.04f + 0.6f * std::pow(1 - nv, 5.0f);
    const float up = std::clamp(mirrored.y * 4 + 0.5f, 0.0f, 1.0f);
    const float shine =
        fresnel * (up * sky(mirrored) + (1 - up) * 0.35f) * std::min(1.0f, 3 * free / float(directions));
    const vec3<float> color = base * (0.9f * light) + vec3<float>(shine);
    const int p = g.pixel[std::size_t(i)];
    out.set(p % c.width, p / c.width, color);
  });
  // The shadow on the ground, where it can be seen.
  std::vector<bool> covered(std::size_t(c.width) * std::size_t(c.height));
  for (const int p : g.pixel) covered[std::size_t(p)] = true;
  const Box box = bounds(scene.mesh());
  const vec3<float> reach = box.size() * 0.5f + vec3<float>(box.size().y * 1.5f);
  parallel_for(c.height, [&](int y) {
    std::vector<vec3<float>> from;
    std::vector<std::uint8_t> hit(toward.size());
    for (int x = 0; x < c.width; ++x) {
      if (covered[std::size_t(y) * std::size_t(c.width) + std::size_t(x)]) continue;
      const vec3<float> ray = c.toward(float(x) + 0.5f, float(y) + 0.5f);
      if (ray.y > -1e-4f || c.position.y <= 0) continue;
      const vec3<float> at = c.position + ray * (-c.position.y / ray.y);
      if (std::abs(at.x - box.center().x) > reach.x || std::abs(at.z - box.center().z) > reach.z) continue;
      from.assign(toward.size(), Raycaster::lift({at.x, 0, at.z}, {0, 1, 0}));
      scene.occluded(from, toward, hit);
      float lost = 0;
      for (std::size_t d = 0; d < toward.size(); ++d)
        if (hit[d]) lost += toward[d].y * sky(toward[d]);
      const float out_there =
          std::max(std::abs(at.x - box.center().x) / reach.x, std::abs(at.z - box.center().z) / reach.z);
      const float shade = 1 - 0.85f * lost / open * std::clamp(3 - 3 * out_there, 0.0f, 1.0f);
      out.set(x, y, vec3<float>(shade));
    }
  });
  return resized(out, camera.width, camera.height);
}

}  // namespace burnish
