// burnish/street/in_street.h -- the picture of a vehicle in its street as a function of its paint and of the light
// SPDX-License-Identifier: Apache-2.0
//
// Differentiable by every number of InStreet: the paint, the strengths of sky and sun, where the sun stands, what the
// camera made of it. Visibility is held: what blocks what stays as it is, and so do the shadow's edges; how dark the
// shadow is follows the light. Path tracing (path_tracer.h) is for the last picture, this for the way there.
#pragma once
#include <burnish/ad/dual.h>
#include <burnish/fit/render.h>
#include <burnish/light/illuminate.h>
#include <burnish/light/panorama_sampler.h>
#include <burnish/nodes/car_paint.h>
#include <burnish/scene/raycast.h>
#include <burnish/street/ground_shade.h>

namespace burnish {

/// Where a sun stands, rad.
template <class T> struct SunAngles {
  T azimuth = 0.0f, elevation = 0.5f;  // from +x towards +z; above the horizon
  static constexpr auto parameters() {
    return std::tuple{Param{"azimuth", &SunAngles::azimuth, Range{-7, 7}},
                      Param{"elevation", &SunAngles::elevation, Range{0.02f, 1.56f}}};
  }
  constexpr vec3<T> direction() const {
    const T c = cos(elevation);
    return {c * cos(azimuth), sin(elevation), c * sin(azimuth)};
  }
};
/// Of a unit direction above the horizon.
inline SunAngles<float> sun_angles(const vec3<float>& d) {
  return {std::atan2(d.z, d.x), std::asin(std::clamp(d.y, -1.0f, 1.0f))};
}

/// What can be fitted of a vehicle in its street.
template <class T> struct InStreet {
  CarPaint<T> paint;
  LightStrength<T> strength;
  SunAngles<T> sun;
  vec3<T> exposure = {1.0f, 1.0f, 1.0f};  // plate by radiance, white balance in it
  static constexpr auto parameters() {
    return std::tuple{Param{"paint", &InStreet::paint}, Param{"strength", &InStreet::strength},
                      Param{"sun", &InStreet::sun}, Param{"exposure", &InStreet::exposure, Range{0, 100}}};
  }
};
/// The look of its paint, for render and backward: with(in_street, LightOf<float>, Sun<float>). The sun's own direction
/// is not used; the light's other suns are left out.
inline constexpr auto in_street = [](const auto& m, const auto& at, const auto& light, const auto& sun) {
  using T = std::remove_cvref_t<decltype(m.sun.azimuth)>;
  const Surface<T> s = m.paint(at);
  const Layers<T> a = layers(s);
  const vec3<T> normal(at.normal), tangent(at.tangent), view(at.view);
  const T index(at.index);
  const vec3<T> n = from_tangent_frame(s.geometry_normal, normal, tangent),
                c = from_tangent_frame(s.geometry_coat_normal, normal, tangent);
  const vec3<T> sky = reflected(a, dot(normal, view), moments(light, index, a)) * m.strength.sky;
  const Sun<T> there{m.sun.direction(), vec3<T>(sun.power), T(sun.variance), T(sun.index)};
  const vec3<T> seen = sunlit(a, n, c, view, there) * apply<SunVisibility>(light, index, T(sun.index));
  return (sky + seen * m.strength.sun) * m.exposure;
};

/// What a place of level ground sees past the vehicle: of the sky's light, by channel, and of the sun; 0 to 1.
struct GroundSight {
  vec3<float> sky{1, 1, 1};
  float sun = 1;
};
/// The ground's light with the vehicle by that without: sky_light is the irradiance of the open ground by the sky alone,
/// sun_power that of a plane which faces the sun, both at strength 1.
template <class T> constexpr vec3<T> ground_shadow(const LightStrength<T>& strength, const SunAngles<T>& sun,
                                                   const GroundSight& sight, const vec3<float>& sky_light,
                                                   const vec3<float>& sun_power) {
  const vec3<T> sky = strength.sky * vec3<T>(sky_light),
                lit = strength.sun * vec3<T>(sun_power) * max(sin(sun.elevation), 0.0f);
  const vec3<T> all = sky + lit, kept = sky * vec3<T>(sight.sky) + lit * T(sight.sun);
  return {kept.x / max(all.x, 1e-9f), kept.y / max(all.y, 1e-9f), kept.z / max(all.z, 1e-9f)};
}

/// A plate with a vehicle on it. Image = plate x (1 - coverage) x shadow where ground is seen + coverage x look.
class StreetPicture {
public:
  /// plate: linear RGB of the camera's size. scene: the vehicle, placed, on level ground at `height`; of one paint. sky:
  /// whose first sun is the sun that is fitted (there must be one). draws: rays for each place of the ground.
  StreetPicture(Image photo, const Raycaster& scene, const Camera& camera, const EnvironmentLight& sky,
                float height = 0, int draws = 64)
      : plate(std::move(photo)),
        g(scene.trace(camera)),
        coverage(g.frame("coverage")),
        light(Illumination(sky, g, [&](int i, auto to, auto out) { scene.blocked(g, i, to, out); })) {
    if (sky.suns.empty()) throw Error("a sky without a sun, expected one: its direction is fitted");
    if (plate.width != camera.width || plate.height != camera.height)
      throw Error("a plate of another size than the camera's picture");
    sun = sky.suns[0];
    const PanoramaSampler without(sky.map, sky.yaw);
    sky_light = without.irradiance({0, 1, 0});
    ground.resize(std::size_t(plate.width) * std::size_t(plate.height));
    parallel_for(plate.height, [&](int y) {
      for (int x = 0; x < plate.width; ++x) look_at_ground(scene, camera, without, height, draws, x, y);
    });
  }
  /// As the light has it.
  InStreet<float> start() const { return {{}, {}, sun_angles(sun.direction), {1, 1, 1}}; }

  Image operator()(const InStreet<float>& m) const {
    const Image vehicle = render(g, with(in_street, light, sun), m);
    Image out(plate.width, plate.height);
    for (int y = 0; y < plate.height; ++y)
      for (int x = 0; x < plate.width; ++x) {
        const float c = coverage.at(x, y);
        out.set(x, y, plate.at(x, y) * shadow(m, x, y) * (1 - c) + vehicle.at(x, y) * c);
      }
    return out;
  }
  /// The derivative of a loss by m, given that by the picture.
  InStreet<float> backward(const InStreet<float>& m, const Image& d_picture) const {
    Image d_vehicle = d_picture;
    using D = Dual<float, 8>;
    auto strength = lift<D>(m.strength);
    auto angles = lift<D>(m.sun);
    int k = 0;
    const auto name = [&](D& x) { x = D(x.value, k++); };
    each(name, strength), each(name, angles);
    std::array<double, 8> sum{};
    for (int y = 0; y < plate.height; ++y)
      for (int x = 0; x < plate.width; ++x) {
        const float c = coverage.at(x, y);
        d_vehicle.set(x, y, d_picture.at(x, y) * c);
        const GroundSight& sight = ground[std::size_t(y) * std::size_t(plate.width) + std::size_t(x)];
        if (c >= 1 || (sight.sun >= 1 && sight.sky.x >= 1 && sight.sky.y >= 1 && sight.sky.z >= 1)) continue;
        const vec3<D> s = ground_shadow(strength, angles, sight, sky_light, sun.power);
        const vec3<float> d = d_picture.at(x, y) * plate.at(x, y) * (1 - c);
        for (std::size_t i = 0; i < 8; ++i)
          sum[i] += double(d.x * s.x.slope[i] + d.y * s.y.slope[i] + d.z * s.z.slope[i]);
      }
    InStreet<float> out = burnish::backward(g, with(in_street, light, sun), m, d_vehicle);
    std::size_t i = 0;
    const auto add = [&](float& x) { x += float(sum[i++]); };
    each(add, out.strength), each(add, out.sun);
    return out;
  }

  Image plate;
  GBuffer g;
  Mask coverage;
  LightOf<float> light;
  Sun<float> sun;
  vec3<float> sky_light;
  std::vector<GroundSight> ground;  // a pixel each

private:
  vec3<float> shadow(const InStreet<float>& m, int x, int y) const {
    const GroundSight& sight = ground[std::size_t(y) * std::size_t(plate.width) + std::size_t(x)];
    return ground_shadow(m.strength, m.sun, sight, sky_light, sun.power);
  }
  void look_at_ground(const Raycaster& scene, const Camera& camera, const PanoramaSampler& sky, float height, int draws,
                      int x, int y) {
    const Ray ray = camera.ray(float(x) + 0.5f, float(y) + 0.5f);
    const float t = (height - ray.origin.y) / ray.direction.y;
    if (!(ray.direction.y < 0 && t > 0 && t < 200)) return;
    const std::size_t at = std::size_t(y) * std::size_t(plate.width) + std::size_t(x);
    const vec3<float> place = ray.origin + ray.direction * t, from = place + vec3<float>(0, 1e-3f, 0);
    GroundLight by_sky;
    int sunny = 0;
    for (int k = 0; k < draws; ++k) {
      PathNumbers numbers(std::uint32_t(at), std::uint32_t(k), 1);
      const vec2<float> u = numbers.pair();
      const float r = std::sqrt(u.x), phi = 2 * pi * u.y;
      const vec3<float> d(r * std::cos(phi), std::sqrt(std::max(1 - u.x, 1e-7f)), r * std::sin(phi));
      const vec3<float> radiance = sky.radiance(d);
      by_sky.all += radiance;
      if (!scene.blocked({from, d})) by_sky.seen += radiance;
      if (k % 4 == 0) sunny += !scene.blocked({from, sun_ray(sun, k / 4, (draws + 3) / 4)});
    }
    ground[at] = {by_sky.shadow(), float(sunny) / float((draws + 3) / 4)};
  }
};

}  // namespace burnish
