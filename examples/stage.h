// examples/stage.h -- light on a vehicle that stands on the ground, quickly: for pictures that turn, not for numbers
// SPDX-License-Identifier: Apache-2.0
//
// Instead of the exact tables of light/illuminate.h (some 10 us a pixel) a blurred panorama is looked up once a lobe,
// and weighted as an even sky would be (the split of Karis 2013): about 1 us. What is in the way is looked for by 15 rays
// that differ among 4 x 4 pixels and are meaned over them.
#pragma once
#include <burnish/light/illuminate.h>
#include <burnish/light/pyramid.h>
#include <burnish/math/color.h>
#include <burnish/math/frame.h>
#include <burnish/math/smooth.h>
#include <burnish/scene/raycast.h>

namespace turntable {
using namespace burnish;

/// The light around a vehicle that stands on y = 0, and what of it reaches where.
class Stage {
public:
  Stage(const EnvironmentLight& sky, const LightStrength<float>& strength, const vec3<float>& occluded,
        const Raycaster& blocking)
      : sky_(sky), strength_(strength), occluded_(occluded), scene_(blocking), pyramid_(sky), irradiance_(sky) {
    const Cosines cosines;
    const Illumination even(EnvironmentLight(Image(32, 16, vec3<float>(1))), cosines);
    lobes_.resize(std::size_t(cosine_steps * roughness_steps));
    for (int r = 0; r < roughness_steps; ++r)
      for (int c = 0; c < cosine_steps; ++c) {
        float y[12];
        even.table(float(c), roughness_of(r), 12, y);
        lobes_[std::size_t(r * cosine_steps + c)] = {y[0], y[3], y[6], y[9]};
      }
    lay_ground();
  }

  /// What reaches each surfel: open: of the sky's irradiance; mirror: of the mirror direction's light (1 open, less
  /// where it meets the shadow on the ground); suns: of each sun.
  struct Seen {
    float open = 1, mirror = 1;
    std::array<float, EnvironmentLight::most_suns> suns{};
  };
  std::vector<Seen> look_around(const GBuffer& g) const {
    const int n = g.size(), suns = int(sky_.suns.size()), rays = 15 - suns;
    std::vector<Seen> own(g.pixel.size()), out(g.pixel.size());
    parallel_for((n + 255) / 256, [&](int block) {
      std::vector<vec3<float>> d(16);
      std::vector<std::uint8_t> blocked(16);
      for (int i = 256 * block; i < std::min(n, 256 * block + 256); ++i) {
        const Surfel<float> s = g.at(i);
        const vec3<float> face = g.geometric_normal(i);
        const Frame<float> frame = frame_of(face);
        const int p = g.pixel[std::size_t(i)], pattern = p % g.width % 4 + p / g.width % 4 * 4;
        for (int k = 0; k < rays; ++k) d[std::size_t(k)] = frame.to_world(spread(pattern * rays + k));
        d[std::size_t(rays)] = reflect(s.view, s.normal);
        for (int k = 0; k < suns; ++k) d[std::size_t(rays + 1 + k)] = sun_ray(sky_.suns[std::size_t(k)], pattern, 16);
        std::fill(blocked.begin(), blocked.end(), std::uint8_t(0));
        scene_.blocked(g, i, d, blocked);
        Seen& to = own[std::size_t(i)];
        const auto part = [&](int k) {
          return blocked[std::size_t(k)] ? 0 : ground_along(s.position, d[std::size_t(k)]);
        };
        to.open = 0;
        for (int k = 0; k < rays; ++k) to.open += part(k) / float(rays);
        to.mirror = part(rays);
        for (int k = 0; k < suns; ++k) to.suns[std::size_t(k)] = blocked[std::size_t(rays + 1 + k)] ? 0.0f : 1.0f;
      }
    });
    std::vector<int> at(std::size_t(g.width) * std::size_t(g.height), -1);
    for (int i = 0; i < n; ++i) at[std::size_t(g.pixel[std::size_t(i)])] = i;
    parallel_for((n + 255) / 256, [&](int block) {
      for (int i = 256 * block; i < std::min(n, 256 * block + 256); ++i) {
        const int p = g.pixel[std::size_t(i)], x = p % g.width, y = p / g.width;
        const vec3<float> normal = g.geometric_normal(i), position = g.at(i).position;
        Seen& to = out[std::size_t(i)];
        to.open = 0, to.mirror = own[std::size_t(i)].mirror;
        int count = 0;
        for (int k = 0; k < 16; ++k) {
          const int u = x - 2 + k % 4, v = y - 2 + k / 4;
          if (u < 0 || v < 0 || u >= g.width || v >= g.height) continue;
          const int j = at[std::size_t(v * g.width + u)];
          if (j < 0) continue;
          const vec3<float> apart = g.at(j).position - position;
          if (dot(g.geometric_normal(j), normal) < 0.9f || std::abs(dot(apart, normal)) > 0.03f) continue;
          to.open += own[std::size_t(j)].open, ++count;
          for (int s = 0; s < suns; ++s) to.suns[std::size_t(s)] += own[std::size_t(j)].suns[std::size_t(s)];
        }
        to.open /= float(count);
        for (int s = 0; s < suns; ++s) to.suns[std::size_t(s)] /= float(count);
      }
    });
    return out;
  }
  /// Reflected radiance towards the viewer.
  vec3<float> reflected_by(const Surface<float>& s, const Surfel<float>& at, const Seen& seen) const {
    const Layers<float> a = layers(s);
    const float nv = std::max(dot(at.normal, at.view), 1e-4f);
    const auto e = irradiance_(at.normal);
    const vec3<float> hidden = occluded_ * ((1 - seen.open) * pi);
    const auto rgb = [&](int k) {
      const std::size_t c = std::size_t(3 * k);
      return vec3<float>(e[c], e[c + 1], e[c + 2]) * seen.open + (k == 0 ? hidden : vec3<float>());
    };
    const auto lobe = [&](float roughness) {  // the panorama, blurred like the lobe, where that looks to (Lagarde 2014)
      const float alpha = roughness * roughness, turn = (1 - alpha) * (std::sqrt(1 - alpha) + alpha);
      const vec3<float> d = mix(at.normal, reflect(at.view, at.normal), turn);
      const float sharp = std::max(0.0f, 1 - 4 * alpha), open = mix(seen.open, seen.mirror, sharp);
      return max(pyramid_.fetch(d, 2 * alpha * alpha), vec3<float>(0)) * open + occluded_ * (1 - open);
    };
    const vec3<float> coat = a.coat_f0 > 0 ? lobe(a.coat_roughness) : vec3<float>(), base = lobe(a.base_roughness);
    const std::array<float, 4>&c = weights(a.coat_roughness, nv), &b = weights(a.base_roughness, nv);
    const Moments<float> m{coat * c[0], coat * c[1], base * b[0], base * b[1], base * b[2],
                           base * b[3], rgb(0),      rgb(1),      rgb(2)};
    vec3<float> sum = reflected(a, nv, m) * strength_.sky;
    for (std::size_t k = 0; k < sky_.suns.size(); ++k) {
      if (!(seen.suns[k] > 0)) continue;
      const vec3<float> n = from_tangent_frame(s.geometry_normal, at.normal, at.tangent);
      sum += sunlit(a, n, at.normal, at.view, sky_.suns[k]) * strength_.sun * seen.suns[k];
    }
    return sum;
  }
  /// How much of its light the ground keeps under the vehicle, 1 far away.
  float shadow(float x, float z) const {
    const float u = (x - low_.x) / cell_ - 0.5f, v = (z - low_.y) / cell_ - 0.5f;
    if (!(u >= 0 && v >= 0 && u < float(columns_ - 1) && v < float(rows_ - 1))) return 1;
    const int i = int(u), j = int(v);
    const float fx = u - float(i), fy = v - float(j);
    const float* g = &ground_[std::size_t(j * columns_ + i)];
    return mix(mix(g[0], g[1], fx), mix(g[columns_], g[columns_ + 1], fx), fy);
  }
  vec3<float> panorama(const vec3<float>& direction) const {
    return max(pyramid_.fetch(direction, 1e-5f), vec3<float>(0)) * strength_.sky;
  }

private:
  static constexpr int cosine_steps = 64, roughness_steps = 64;
  struct Cosines {
    struct Place {
      vec3<float> normal, view;
    };
    int size() const { return cosine_steps; }
    Place at(int i) const {
      const float c = (float(i) + 0.5f) / cosine_steps;
      return {{0, 0, 1}, {std::sqrt(1 - c * c), 0, c}};
    }
  };
  const EnvironmentLight& sky_;
  LightStrength<float> strength_;
  vec3<float> occluded_;
  const Raycaster& scene_;
  Pyramid pyramid_;
  IrradianceMap irradiance_;
  std::vector<std::array<float, 4>> lobes_;
  std::vector<float> ground_;
  vec2<float> low_;
  float cell_ = 0.05f;
  int columns_ = 0, rows_ = 0;

  static float roughness_of(int r) { return std::max(float(r) / (roughness_steps - 1), min_roughness); }
  const std::array<float, 4>& weights(float roughness, float nv) const {
    const int r = int(std::lround(std::clamp(roughness, 0.0f, 1.0f) * (roughness_steps - 1)));
    const int c = std::clamp(int(nv * cosine_steps), 0, cosine_steps - 1);
    return lobes_[std::size_t(r * cosine_steps + c)];
  }
  /// Directions about z, as frequent as their cosine: the R2 sequence (Roberts 2018).
  static vec3<float> spread(int i) {
    const double a = 0.5 + i * 0.7548776662466927, b = 0.5 + i * 0.5698402909980532;
    const float u = float(a - std::floor(a)), turn = float(b - std::floor(b)) * 2 * pi, r = std::sqrt(u);
    return {r * std::cos(turn), r * std::sin(turn), std::sqrt(1 - u)};
  }
  float ground_along(const vec3<float>& from, const vec3<float>& d) const {
    if (d.y > -1e-3f) return 1;
    const float t = -from.y / d.y;
    return shadow(from.x + d.x * t, from.z + d.z * t);
  }
  /// Of all light on the ground around the vehicle the part that arrives, 5 cm apart.
  void lay_ground() {
    const Box box = bounds(scene_.mesh());
    const float margin = 1.2f * box.size().y;
    low_ = {box.low.x - margin, box.low.z - margin};
    columns_ = int((box.size().x + 2 * margin) / cell_) + 1, rows_ = int((box.size().z + 2 * margin) / cell_) + 1;
    ground_.assign(std::size_t(columns_ * rows_), 1.0f);
    constexpr int rays = 112;
    std::vector<vec3<float>> directions;
    std::vector<float> light;
    float all = 0;
    for (int k = 0; k < rays; ++k) {
      const vec3<float> d = spread(k);
      directions.emplace_back(d.x, d.z, d.y);
      light.push_back(luminance(max(pyramid_.fetch(directions.back(), 0.02f), vec3<float>(0)) * strength_.sky) * pi /
                      rays);
    }
    for (const Sun<float>& s : sky_.suns)
      for (int k = 0; k < 16 && s.direction.y > 0; ++k) {
        directions.push_back(sun_ray(s, k, 16));
        light.push_back(luminance(s.power * strength_.sun) * s.direction.y / 16);
      }
    for (const float x : light) all += x;
    GBuffer g;
    g.resize(columns_ * rows_);
    for (int i = 0; i < g.size(); ++i) {
      g.plane[0][std::size_t(i)] = low_.x + (float(i % columns_) + 0.5f) * cell_;
      g.plane[2][std::size_t(i)] = low_.y + (float(i / columns_) + 0.5f) * cell_;
      g.plane[GBuffer::geometric + 1][std::size_t(i)] = 1;
    }
    parallel_for(rows_, [&](int row) {
      std::vector<std::uint8_t> blocked(directions.size());
      for (int i = row * columns_; i < (row + 1) * columns_ && all > 0; ++i) {
        std::fill(blocked.begin(), blocked.end(), std::uint8_t(0));
        scene_.blocked(g, i, directions, blocked);
        float left = 0;
        for (std::size_t k = 0; k < directions.size(); ++k) left += blocked[k] ? 0 : light[k];
        const vec3<float> p = g.at(i).position;  // it fades out towards the border of what is looked at
        const float edge = std::min(
            {p.x - low_.x, p.z - low_.y, low_.x + float(columns_) * cell_ - p.x, low_.y + float(rows_) * cell_ - p.z});
        ground_[std::size_t(i)] = mix(1.0f, left / all, smoothstep(0.0f, 0.6f * margin, edge));
      }
    });
  }
};

}  // namespace turntable
