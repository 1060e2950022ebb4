// burnish/street/path_tracer.h -- a vehicle on a virtual ground under a panorama, by path tracing
// SPDX-License-Identifier: Apache-2.0
//
// World: metres, +Y up. The panorama is infinitely far away; the ground is where its lower half is seen, and looks as
// the panorama does but for the vehicle's shadow: no albedo of the road is needed. Light is drawn from the panorama and
// from the surface, weighted by the power heuristic (Veach 1997). The same picture for any number of threads.
#pragma once
#include <cstdint>
#include <limits>
#include <burnish/light/panorama_sampler.h>
#include <burnish/scene/raycast.h>
#include <burnish/shade/sample.h>

namespace burnish {

/// A level plane; `wet` of it mirrors as water does (index 1.33).
struct Ground {
  float height = 0;
  float wet = 0;
};
struct PathOptions {
  int samples = 16;           ///< a pixel
  int bounces = 4;            ///< surfaces of the vehicle that a path may meet
  float brightest = 10;       ///< of what a bounce brings, in means of the panorama: no fireflies, a little light lost
  bool by_brightness = true;  ///< false: light is drawn evenly from the sphere (to compare with)
  std::uint32_t seed = 1;
};
/// One path through a pixel, as InsertLayers' pictures (insert_layers.h) are means of; and sums of such.
struct PlateSample {
  vec3<float> object, through{1, 1, 1}, shadow{1, 1, 1}, kept{1, 1, 1}, added;

  /// Whether anything of the vehicle is in it.
  bool busy() const { return kept.x != 1 || kept.y != 1 || kept.z != 1 || object.x + added.x != 0; }
  PlateSample& operator+=(const PlateSample& o) {
    object += o.object, through += o.through, shadow += o.shadow, kept += o.kept, added += o.added;
    return *this;
  }
};

namespace detail {
/// Numbers in [0, 1): PCG (O'Neill 2014).
class Random {
public:
  Random(std::uint32_t pixel, std::uint32_t sample, std::uint32_t seed) {
    state_ = (std::uint64_t(pixel) << 32 | sample) * 0x9e3779b97f4a7c15u + seed;
    next(), state_ ^= std::uint64_t(seed) * 0xda942042e4dd58b5u, next();
  }
  float operator()() { return float(next() >> 8) * 0x1p-24f; }

private:
  std::uint64_t state_;
  std::uint32_t next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    const auto shifted = std::uint32_t(((state_ >> 18) ^ state_) >> 27), turn = std::uint32_t(state_ >> 59);
    return shifted >> turn | shifted << ((32 - turn) & 31);
  }
};
inline float power_heuristic(float mine, float other) {
  const float a = mine * mine, b = other * other;
  return a + b > 0 ? a / (a + b) : 0;
}
}  // namespace detail

/// material(surfel, part) gives the Surface<float> of a place; transmission_weight above 0 makes it a pane, through
/// which paths and shadow rays go straight. It is called from many threads.
template <class Material> class PathTracer {
public:
  /// scene and sky must outlive this.
  PathTracer(const Raycaster& scene, const PanoramaSampler& sky, Material material, const Ground& ground,
             const PathOptions& options)
      : scene_(scene), sky_(sky), material_(std::move(material)), ground_(ground), options_(options),
        open_(sky.irradiance({0, 1, 0})) {
    const vec3<float> down = sky.irradiance({0, -1, 0}), mean = (open_ + down) * (0.5f * inverse_pi);
    limit_ = options.brightest * std::max({mean.x, mean.y, mean.z, 1e-6f});
  }

  const Raycaster& scene() const { return scene_; }
  const Ground& ground() const { return ground_; }
  const PathOptions& options() const { return options_; }

  /// place: in the camera's picture. hidden: metres along the camera's axis from which on something else is seen.
  /// grounded: whether the ground's shadow is seen.
  PlateSample sample(const Camera& camera, const vec2<float>& place, float hidden, bool grounded,
                     detail::Random& random) const {
    PlateSample p;
    Ray ray = camera.ray(place.x, place.y);
    const float along = dot(ray.direction, camera.forward);
    vec3<float> left(1.0f);
    for (int wall = 0; wall < 12; ++wall) {
      const SeenSurface hit = scene_.first_hit(ray);
      if (hit.part < 0) break;
      if (dot(hit.surfel.position - camera.position, camera.forward) >= hidden) break;
      const Surface<float> s = material_(hit.surfel, hit.part);
      p.object += left * reflected_by(hit, s, random, options_.bounces);
      left = left * let_through(hit, s);
      if (left.x + left.y + left.z <= 0) break;
      ray.origin = lifted(hit, ray.direction);
    }
    p.through = p.kept = left;
    if (!grounded || left.x + left.y + left.z <= 0) return p;
    const float t = to_ground(ray);
    const vec3<float> foot = ray.origin + ray.direction * t;
    if (!std::isfinite(t) || dot(foot - camera.position, camera.forward) >= hidden + 0.05f * along) return p;
    p.shadow = shadow_at(foot, random, options_.bounces - 1);
    p.kept = left * p.shadow;
    if (ground_.wet > 0) {
      const vec3<float> up(0, 1, 0), mirrored(ray.direction.x, -ray.direction.y, ray.direction.z);
      const Ray away{foot + up * ((1 + length(foot)) * 1e-4f), mirrored};
      const SeenSurface hit = scene_.first_hit(away);
      const float f = ground_.wet * fresnel_dielectric(-ray.direction.y, 1.33f);
      if (hit.part >= 0)
        p.added += left * (clipped(seen(hit, away, random, options_.bounces - 1, 0)) - sky_.radiance(mirrored)) * f;
    }
    return p;
  }

private:
  const Raycaster& scene_;
  const PanoramaSampler& sky_;
  Material material_;
  Ground ground_;
  PathOptions options_;
  vec3<float> open_;  // irradiance of the ground without the vehicle
  float limit_;

  float to_ground(const Ray& r) const {
    const float t = (ground_.height - r.origin.y) / r.direction.y;
    return r.direction.y < 0 && t > 1e-4f ? t : std::numeric_limits<float>::infinity();
  }
  vec3<float> lifted(const SeenSurface& s, const vec3<float>& to) const {
    return Raycaster::lift(s.surfel.position, dot(to, s.face) < 0 ? -s.face : s.face);
  }
  static vec3<float> let_through(const SeenSurface& hit, const Surface<float>& s) {
    return s.transmission_weight > 0 ? transmittance(s, dot(hit.surfel.normal, hit.surfel.view)) : vec3<float>();
  }

  PanoramaSampler::Sample light(detail::Random& random) const {
    const float u = random(), v = random();
    if (options_.by_brightness) return sky_.sample({u, v});
    const float z = 1 - 2 * u, r = std::sqrt(std::max(0.0f, 1 - z * z)), phi = 2 * pi * v;
    const vec3<float> d(r * std::cos(phi), z, r * std::sin(phi));
    return {d, sky_.radiance(d), 0.25f * inverse_pi};
  }
  float light_density(const vec3<float>& d) const {
    return options_.by_brightness ? sky_.density(d) : 0.25f * inverse_pi;
  }

  /// What panes leave of light along a ray; 0 behind what is opaque.
  vec3<float> passes(Ray ray, float far) const {
    vec3<float> left(1.0f);
    if (!scene_.blocked(ray, far)) return left;
    for (int wall = 0; wall < 12; ++wall) {
      const SeenSurface hit = scene_.first_hit(ray);
      const float distance = hit.part < 0 ? far : dot(hit.surfel.position - ray.origin, ray.direction);
      if (hit.part < 0 || distance >= far) return left;
      const Surface<float> s = material_(hit.surfel, hit.part);
      if (!(s.transmission_weight > 0)) break;
      left = left * let_through(hit, s);
      far -= distance;
      ray.origin = lifted(hit, ray.direction);
    }
    return {};
  }
  /// Light of the panorama from a direction as it arrives at a place on the vehicle: past the vehicle, off the ground.
  vec3<float> arriving(const vec3<float>& from, const vec3<float>& d, const vec3<float>& radiance,
                       detail::Random& random) const {
    const Ray ray{from, d};
    const float far = to_ground(ray);
    const vec3<float> left = passes(ray, far);
    if (left.x + left.y + left.z <= 0 || !std::isfinite(far)) return radiance * left;
    return radiance * left * shadow_at(from + d * far, random, 0);
  }

  /// One draw of the ground's irradiance with the vehicle by that without: 1 less what the vehicle keeps away, with
  /// what it throws back if bounces > 0.
  vec3<float> shadow_at(const vec3<float>& place, detail::Random& random, int bounces) const {
    const vec3<float> up(0, 1, 0), from = place + up * ((1 + length(place)) * 1e-4f);
    vec3<float> ratio(1.0f);
    const auto relative = [&](const vec3<float>& e) {
      return e / max(open_, vec3<float>(1e-9f));
    };
    // By the light.
    const auto s = light(random);
    if (const float c = s.direction.y; c > 0 && s.density > 0) {
      const vec3<float> left = passes({from, s.direction}, std::numeric_limits<float>::infinity());
      const float weight = detail::power_heuristic(s.density, c * inverse_pi);
      ratio = ratio - relative(s.radiance * (vec3<float>(1.0f) - left) * (c * weight / s.density));
    }
    // By the cosine.
    const float u = random(), phi = 2 * pi * random(), r = std::sqrt(u), c = std::sqrt(std::max(1 - u, 1e-7f));
    const Ray ray{from, {r * std::cos(phi), c, r * std::sin(phi)}};
    if (!scene_.blocked(ray)) return ratio;
    const float density = c * inverse_pi, weight = detail::power_heuristic(density, light_density(ray.direction));
    const vec3<float> left = passes(ray, std::numeric_limits<float>::infinity());
    ratio = ratio - relative(sky_.radiance(ray.direction) * (vec3<float>(1.0f) - left) * (weight * pi));
    if (bounces > 0) ratio += relative(thrown_back(ray, random, bounces) * pi);
    return ratio;
  }
  /// What comes along a ray from the vehicle itself, not from the sky through its panes.
  vec3<float> thrown_back(const Ray& ray, detail::Random& random, int bounces) const {
    const SeenSurface hit = scene_.first_hit(ray);
    if (hit.part < 0) return {};
    const Surface<float> s = material_(hit.surfel, hit.part);
    if (s.transmission_weight > 0) return {};
    return clipped(reflected_by(hit, s, random, bounces));
  }
  vec3<float> clipped(const vec3<float>& c) const {
    const float most = std::max({c.x, c.y, c.z});
    return most > limit_ ? c * (limit_ / most) : c;
  }

  /// What a place of the vehicle reflects towards its view.
  vec3<float> reflected_by(const SeenSurface& hit, const Surface<float>& surface, detail::Random& random,
                           int bounces) const {
    const Surfel<float>& at = hit.surfel;
    const Layers<float> s = layers(surface);
    const vec3<float>&n = at.normal, &v = at.view;
    const vec3<float> base = normalize(from_tangent_frame(surface.geometry_normal, n, at.tangent)),
                      coat = normalize(from_tangent_frame(surface.geometry_coat_normal, n, at.tangent));
    const LobeChances chances = lobe_chances(s, std::max(dot(n, v), 1e-4f));
    vec3<float> sum;
    const auto sun = light(random);
    if (sun.density > 0 && dot(n, sun.direction) > 0 && dot(hit.face, sun.direction) > 0) {
      const vec3<float> f = brdf_cos(s, base, coat, v, sun.direction);
      const float weight = detail::power_heuristic(sun.density, brdf_density(s, chances, n, v, sun.direction));
      if (f.x + f.y + f.z > 0)
        sum += f * arriving(lifted(hit, sun.direction), sun.direction, sun.radiance, random) * (weight / sun.density);
    }
    const float u1 = random(), u2 = random(), u3 = random();
    const vec3<float> l = sample_brdf(s, chances, n, v, {u1, u2, u3});
    const float density = brdf_density(s, chances, n, v, l);
    if (!(density > 0) || dot(hit.face, l) <= 0) return sum;
    const vec3<float> f = brdf_cos(s, base, coat, v, l) / density;
    const Ray on{lifted(hit, l), l};
    const SeenSurface next = scene_.first_hit(on);
    if (next.part < 0) {
      const float weight = detail::power_heuristic(density, light_density(l));
      return sum + f * arriving(on.origin, l, sky_.radiance(l), random) * weight;
    }
    return sum + clipped(f * seen(next, on, random, bounces - 1, density));
  }
  /// The radiance of a place that a ray meets, and of what lies behind it where it is a pane: one of both, by chance.
  /// density: with which the ray was drawn, 0 where it was not. Without bounces: of what lies beyond panes only.
  vec3<float> seen(SeenSurface hit, Ray ray, detail::Random& random, int bounces, float density) const {
    vec3<float> left(1.0f);
    for (int wall = 0; wall < 12; ++wall) {
      const Surface<float> s = material_(hit.surfel, hit.part);
      const vec3<float> through = let_through(hit, s);
      const float most = std::max({through.x, through.y, through.z});
      const float chance = most <= 0 ? 0 : bounces < 1 ? 1 : std::clamp(most, 0.1f, 0.9f);
      if (chance < 1 && (chance <= 0 || random() >= chance))
        return bounces < 1 ? vec3<float>() : left * reflected_by(hit, s, random, bounces) / (1 - chance);
      left = left * through / chance;
      ray.origin = lifted(hit, ray.direction);
      hit = scene_.first_hit(ray);
      if (hit.part >= 0) continue;
      const float weight = density > 0 ? detail::power_heuristic(density, light_density(ray.direction)) : 1;
      return left * arriving(ray.origin, ray.direction, sky_.radiance(ray.direction), random) * weight;
    }
    return {};
  }
};

}  // namespace burnish
