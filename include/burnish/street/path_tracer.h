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
#include <burnish/street/ground_shade.h>

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
/// One path through a pixel, as InsertLayers' pictures (insert_layers.h) are made of; and sums of such.
struct PlateSample {
  vec3<float> object, through{1, 1, 1}, added;
  vec3<float> to_ground;  ///< of through, what shows ground
  GroundLight ground;

  /// Whether anything of the vehicle is in it.
  bool busy() const {
    const vec3<float> hidden = ground.all - ground.seen;
    return through.x != 1 || through.y != 1 || through.z != 1 || hidden.x + hidden.y + hidden.z != 0 ||
           object.x + added.x != 0;
  }
  PlateSample& operator+=(const PlateSample& o) {
    object += o.object, through += o.through, added += o.added, to_ground += o.to_ground;
    ground.seen += o.ground.seen, ground.all += o.ground.all, ground.thrown += o.ground.thrown;
    return *this;
  }
};

namespace detail {
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
        over_ground_(sky.facing({0, 1, 0})), open_(sky.irradiance({0, 1, 0})) {
    const vec3<float> down = sky.irradiance({0, -1, 0}), mean = (open_ + down) * (0.5f * inverse_pi);
    limit_ = options.brightest * std::max({mean.x, mean.y, mean.z, 1e-6f});
    const auto draw = [&](const vec3<float>& at, PathNumbers& random) { return shadow_at(at, random, 0); };
    const int draws = std::clamp(options.samples, 32, 256);
    shade_ = GroundShade(bounds(scene.mesh()), ground.height, draws, draw, ~options.seed);
  }

  const Raycaster& scene() const { return scene_; }
  const Ground& ground() const { return ground_; }
  const PathOptions& options() const { return options_; }

  /// place: in the camera's picture. hidden: metres along the camera's axis from which on something else is seen.
  /// grounded: whether the ground's shadow is seen.
  PlateSample sample(const Camera& camera, const vec2<float>& place, float hidden, bool grounded,
                     PathNumbers& random) const {
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
    p.through = left;
    if (!grounded || left.x + left.y + left.z <= 0) return p;
    const float t = to_ground(ray);
    const vec3<float> foot = ray.origin + ray.direction * t;
    if (!std::isfinite(t) || dot(foot - camera.position, camera.forward) >= hidden + 0.05f * along) return p;
    p.ground = shadow_at(foot, random, options_.bounces - 1);
    p.to_ground = left;
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
  PanoramaSampler::Table over_ground_;
  vec3<float> open_;  // irradiance of the ground without the vehicle
  float limit_;
  GroundShade shade_;

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

  static constexpr float even = 0.25f * inverse_pi;
  PanoramaSampler::Sample light(const vec2<float>& u, const PanoramaSampler::Table& by) const {
    if (options_.by_brightness) return sky_.sample(u, by);
    const float z = 1 - 2 * u.x, r = std::sqrt(std::max(0.0f, 1 - z * z)), phi = 2 * pi * u.y;
    const vec3<float> d(r * std::cos(phi), z, r * std::sin(phi));
    return {d, sky_.radiance(d), even};
  }
  float light_density(const vec3<float>& d, const PanoramaSampler::Table& by) const {
    return options_.by_brightness ? sky_.density(d, by) : even;
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
  vec3<float> arriving(const vec3<float>& from, const vec3<float>& d, const vec3<float>& radiance) const {
    const Ray ray{from, d};
    const float far = to_ground(ray);
    const vec3<float> left = passes(ray, far);
    if (left.x + left.y + left.z <= 0 || !std::isfinite(far)) return radiance * left;
    return radiance * left * shade_(from + d * far);
  }

  /// One draw by the light and one by the cosine; with what the vehicle throws back if bounces > 0.
  GroundLight shadow_at(const vec3<float>& place, PathNumbers& random, int bounces) const {
    const vec3<float> up(0, 1, 0), from = place + up * ((1 + length(place)) * 1e-4f);
    constexpr float far = std::numeric_limits<float>::infinity();
    GroundLight out;
    const auto relative = [&](const vec3<float>& e) {
      return e / max(open_, vec3<float>(1e-9f));
    };
    const vec2<float> to_light = random.pair(), about = random.pair();
    const auto s = light(to_light, over_ground_);
    if (const float c = s.direction.y; c > 0 && s.density > 0) {
      const vec3<float> e =
          relative(s.radiance * (c * detail::power_heuristic(s.density, c * inverse_pi) / s.density));
      out.all = e, out.seen = e * passes({from, s.direction}, far);
    }
    const float phi = 2 * pi * about.y, r = std::sqrt(about.x), c = std::sqrt(std::max(1 - about.x, 1e-7f));
    const Ray ray{from, {r * std::cos(phi), c, r * std::sin(phi)}};
    const float weight = detail::power_heuristic(c * inverse_pi, light_density(ray.direction, over_ground_));
    const vec3<float> e = relative(sky_.radiance(ray.direction) * (weight * pi));
    out.all += e;
    if (!scene_.blocked(ray)) {
      out.seen += e;
      return out;
    }
    out.seen += e * passes(ray, far);
    if (bounces > 0) out.thrown = relative(thrown_back(ray, random, bounces) * pi);
    return out;
  }
  /// What comes along a ray from the vehicle itself, not from the sky through its panes.
  vec3<float> thrown_back(const Ray& ray, PathNumbers& random, int bounces) const {
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
  vec3<float> reflected_by(const SeenSurface& hit, const Surface<float>& surface, PathNumbers& random,
                           int bounces) const {
    const Surfel<float>& at = hit.surfel;
    const Layers<float> s = layers(surface);
    const vec3<float>&n = at.normal, &v = at.view;
    const vec3<float> base = normalize(from_tangent_frame(surface.geometry_normal, n, at.tangent)),
                      coat = normalize(from_tangent_frame(surface.geometry_coat_normal, n, at.tangent));
    const LobeChances chances = lobe_chances(s, std::max(dot(n, v), 1e-4f));
    vec3<float> sum;
    // Drawn before the light's way takes numbers or does not: each pair keeps its use from path to path.
    const vec2<float> to_light = random.pair(), in_lobe = random.pair();
    const float which = random();
    const auto sun = light(to_light, sky_.everywhere());
    if (sun.density > 0 && dot(n, sun.direction) > 0 && dot(hit.face, sun.direction) > 0) {
      const vec3<float> f = brdf_cos(s, base, coat, v, sun.direction);
      const float weight = detail::power_heuristic(sun.density, brdf_density(s, chances, n, v, sun.direction));
      if (f.x + f.y + f.z > 0)
        sum += f * arriving(lifted(hit, sun.direction), sun.direction, sun.radiance) * (weight / sun.density);
    }
    const vec3<float> l = sample_brdf(s, chances, n, v, {in_lobe.x, in_lobe.y, which});
    const float density = brdf_density(s, chances, n, v, l);
    if (!(density > 0) || dot(hit.face, l) <= 0) return sum;
    const vec3<float> f = brdf_cos(s, base, coat, v, l) / density;
    const Ray on{lifted(hit, l), l};
    const SeenSurface next = scene_.first_hit(on);
    if (next.part < 0) {
      const float weight = detail::power_heuristic(density, light_density(l, sky_.everywhere()));
      return sum + f * arriving(on.origin, l, sky_.radiance(l)) * weight;
    }
    return sum + clipped(f * seen(next, on, random, bounces - 1, density));
  }
  /// The radiance of a place that a ray meets, and of what lies behind it where it is a pane: one of both, by chance.
  /// density: with which the ray was drawn, 0 where it was not. Without bounces: of what lies beyond panes only.
  vec3<float> seen(SeenSurface hit, Ray ray, PathNumbers& random, int bounces, float density) const {
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
      const float by_light = light_density(ray.direction, sky_.everywhere());
      const float weight = density > 0 ? detail::power_heuristic(density, by_light) : 1;
      return left * arriving(ray.origin, ray.direction, sky_.radiance(ray.direction)) * weight;
    }
    return {};
  }
};

}  // namespace burnish
