// examples/03_shade_in_your_renderer.cpp -- a path tracer with vectors, camera and random numbers of its own, shaded by
// burnish and differentiated without a change
// SPDX-License-Identifier: Apache-2.0
//
// Needs a compiler and nothing else: c++ -std=c++20 -O2 -march=native -I include examples/03_shade_in_your_renderer.cpp
//
// The tracer is templated where the paint is used: Surface<float> gives a picture; Surface<Dual<float, 1>> the picture and
// its slope by one number of the paint; Surface<double> what the slope is checked against; and differentiate puts in a
// number of its own, for one pixel's slopes by all numbers of the paint.
#include <cstdio>
#include <burnish/ad/check.h>
#include <burnish/ad/dual.h>
#include <burnish/ad/parallel.h>
#include <burnish/math/color.h>
#include <burnish/math/frame.h>
#include <burnish/shade/brdf.h>
#include "program.h"
#include "progress.h"

// ---- the host: all that it knows of burnish is that a material is a Surface ------------------------------------------

struct float3 {
  float x, y, z;
};
float3 operator+(float3 a, float3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
float3 operator-(float3 a, float3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
float3 operator*(float3 a, float s) { return {a.x * s, a.y * s, a.z * s}; }
float dot(float3 a, float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
float3 normalize(float3 a) { return a * (1 / std::sqrt(dot(a, a))); }

/// SplitMix64 (Steele, Lea and Flood 2014); each call gives a number in [0, 1).
struct Random {
  std::uint64_t state;
  float operator()() {
    std::uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return float((z ^ z >> 31) >> 40) * 0x1p-24f;
  }
};
struct Ray {
  float3 origin, direction;
};
struct Sphere {
  float3 center;
  float radius;
  int material;
};
struct Hit {
  float3 position, normal;
  int material = -1;  // none: the sky
};
burnish::Surface<float> material(float3 color, float metalness, float roughness, float coat = 0) {
  burnish::Surface<float> s;
  s.base_color = color, s.base_metalness = metalness, s.specular_roughness = roughness;
  s.coat_weight = coat, s.coat_roughness = 0.05f;
  return s;
}

/// Spheres on a chequered floor, y up, under a sky with a lamp in it.
struct Scene {
  std::vector<burnish::Surface<float>> materials{
      material({0.6f, 0.06f, 0.05f}, 0.5f, 0.4f, 0.7f), material({0.8f, 0.8f, 0.8f}, 1, 0.05f), material({1, 0.72f, 0.32f}, 1, 0.3f),
      material({0.75f, 0.75f, 0.7f}, 0, 0.8f), material({0.08f, 0.08f, 0.09f}, 0, 0.3f), material({0.5f, 0.5f, 0.48f}, 0, 0.3f)};
  enum { paint, mirror, gold, clay, floor };
  std::vector<Sphere> spheres{{{0, 1, 0}, 1, paint}, {{-1.9f, 0.7f, -0.6f}, 0.7f, mirror}, {{1.75f, 0.6f, -0.2f}, 0.6f, clay},
                              {{0.95f, 0.3f, 1.2f}, 0.3f, gold}, {{-0.9f, 0.35f, 1.2f}, 0.35f, paint}};

  Hit hit(const Ray& ray) const {
    Hit found;
    const float down = -ray.origin.y / ray.direction.y;
    float nearest = down > 1e-3f ? std::min(down, 50.0f) : 50.0f;
    float3 at = ray.origin + ray.direction * nearest;
    if (nearest == down) found = {at, {0, 1, 0}, floor + ((int(std::floor(at.x)) + int(std::floor(at.z))) & 1)};
    for (const Sphere& s : spheres) {
      const float3 to = s.center - ray.origin;
      const float b = dot(to, ray.direction), q = b * b - dot(to, to) + s.radius * s.radius, t = q < 0 ? -1 : b - std::sqrt(q);
      if (t < 1e-3f || t >= nearest) continue;
      nearest = t, at = ray.origin + ray.direction * t;
      found = {at, normalize(at - s.center), s.material};
    }
    return found;
  }
  float3 sky(float3 d) const {
    const float up = std::max(d.y, 0.0f), x = d.x / (up + 0.01f) + 0.9f, z = d.z / (up + 0.01f) - 0.6f;
    const float lamp = std::fabs(x) < 0.8f && std::fabs(z) < 0.6f ? 4.0f : 0.0f;
    return float3{0.75f, 0.72f, 0.7f} * (1 - up) + float3{0.2f, 0.35f, 0.65f} * up + float3{1, 0.95f, 0.85f} * lamp;
  }
};

// ---- where the two meet ----------------------------------------------------------------------------------------------

/// A direction that light may come from, and its density per steradian (0: none). Local: the normal is z.
std::pair<burnish::vec3<float>, float> choose(const burnish::Surface<float>& s, const burnish::vec3<float>& v, Random& random) {
  const burnish::Layers<float> layers = burnish::layers(s);
  const float coat = 0.3f * s.coat_weight, base = 0.5f * (1 - coat), which = random(), u = random(), w = random();
  const auto mirrored = [&](float roughness) { return reflect(v, burnish::ggx_sample_visible_normal(roughness, v, {u, w})); };
  burnish::vec3<float> l;
  if (which < coat) l = mirrored(layers.coat_roughness);
  else if (which < coat + base) l = mirrored(layers.base_roughness);
  else l = {std::sqrt(w) * std::cos(2 * burnish::pi * u), std::sqrt(w) * std::sin(2 * burnish::pi * u), std::sqrt(1 - w)};
  if (l.z <= 0 || v.z <= 0) return {l, 0};
  const burnish::vec3<float> h = normalize(v + l);
  const float vh = dot(v, h), sin2 = h.x * h.x + h.y * h.y;
  const auto density = [&](float roughness) {
    return burnish::ggx_visible_normal_pdf(roughness, v.z, vh, burnish::ggx_d(roughness, h.z, sin2)) / (4 * vh);
  };
  return {l, coat * density(layers.coat_roughness) + base * density(layers.base_roughness) +
                 (1 - coat - base) * l.z * burnish::inverse_pi};
}

/// Radiance along a ray. Where a path goes is decided by the scene's own floats (any density will do), what it carries is
/// in T: so the slopes meet no edges, and are as unbiased as the radiance.
template <class T> burnish::vec3<T> trace(const Scene& scene, const burnish::Surface<T>& paint, Ray ray, Random random) {
  burnish::vec3<T> carried(T(1.0f));
  for (int bounce = 0; bounce < 5; ++bounce) {
    const auto [position, n, material] = scene.hit(ray);
    if (material < 0) return carried * scene.sky(ray.direction);
    const burnish::Surface<float>& own = scene.materials[std::size_t(material)];
    const auto frame = burnish::frame_of(burnish::vec3<float>(n));
    const float3 v = ray.direction * -1;
    const auto [local, density] = choose(own, frame.to_local(v), random);
    if (density <= 0) break;
    const auto l = frame.to_world(local);
    if (material == Scene::paint) carried *= burnish::brdf_cos(paint, n, v, l) / density;
    else carried *= burnish::brdf_cos(own, n, v, l) / density;
    ray = {position, {l.x, l.y, l.z}};
  }
  return {};
}

/// The host's camera. The random numbers of a pixel are the same whatever T.
struct View {
  int width, height, samples;

  template <class T> burnish::vec3<T> pixel(const Scene& scene, const burnish::Surface<T>& paint, int x, int y) const {
    burnish::vec3<T> sum;
    for (int i = 0; i < samples; ++i) {
      Random random{std::uint64_t((y * width + x) * samples + i) * 0xd1342543de82ef95u};
      const float u = (x + random() - 0.5f * width) / height, v = (0.5f * height - y - random()) / height;
      sum += trace(scene, paint, {{0, 1.6f, 6}, normalize({0.72f * u, 0.72f * v - 0.16f, -1 - 0.115f * v})}, random);
    }
    return sum / samples;
  }
  template <class T> std::vector<burnish::vec3<T>> picture(const char* what, const Scene& scene, const burnish::Surface<T>& paint) const {
    std::vector<burnish::vec3<T>> pixels(std::size_t(width * height));
    Progress progress(what);
    for (int from = 0; from < height; from += 8) {
      burnish::parallel_for(std::min(8, height - from), [&](int row) {
        for (int x = 0, y = from + row; x < width; ++x) pixels[std::size_t(y * width + x)] = pixel(scene, paint, x, y);
      });
      progress.show(from, height);
    }
    progress.finish(std::to_string(samples) + " paths a pixel");
    return pixels;
  }
};

void run(const std::string& output, const std::string& by, int width, int samples) {
  const Scene scene;
  const burnish::Surface<float>& paint = scene.materials[Scene::paint];
  // The number named `by`: as a dual, and a little down and up in double.
  using Slope = burnish::Dual<float, 1>;
  constexpr double step = 1e-4;
  auto moving = burnish::lift<Slope>(paint);
  auto down = burnish::lift<double>(paint), up = down;
  std::string names;
  burnish::for_each_parameter(moving, [&](const std::string& name, Slope& x, burnish::Range) {
    names += " " + name;
    if (name == by) x = Slope(x.value, 0);
  });
  burnish::for_each_parameter(down, [&](const std::string& name, double& x, burnish::Range) { x -= name == by ? step : 0; });
  burnish::for_each_parameter(up, [&](const std::string& name, double& x, burnish::Range) { x += name == by ? step : 0; });
  if ((names + " ").find(" " + by + " ") == std::string::npos) throw std::runtime_error("--by " + by + ": expected one of" + names);
  program::make_folder(output);

  const View view{width, width * 5 / 8, samples};
  const auto picture = view.picture("with slopes", scene, moving);
  const auto below = view.picture("a little down", scene, down), above = view.picture("a little up", scene, up);
  std::vector<float> slope, difference;
  float largest = 0, apart = 0, sum = 0;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    slope.push_back(luminance(picture[i]).slope[0]);
    difference.push_back(float((luminance(above[i]) - luminance(below[i])) / (2 * step)));
    largest = std::max(largest, std::fabs(slope[i]));
    apart = std::max(apart, std::fabs(slope[i] - difference[i]));
    sum += std::fabs(slope[i]);
  }
  std::printf("d luminance / d %s: up to %.3g, and %.1g at most from its difference\n", by.c_str(), double(largest), double(apart));
  // Blue where the number darkens the picture, red where it brightens it; full at ten times the mean.
  program::write_row_png(output + "/spheres.png", 3, width, view.height, [&](int k, int x, int y) {
    const std::size_t i = std::size_t(y * width + x);
    if (k == 0) return float3{picture[i].x.value, picture[i].y.value, picture[i].z.value};
    const float t = (k == 1 ? slope : difference)[i] / std::max(sum * 10 / float(slope.size()), 1e-9f);
    return float3{1 + t, 1 - std::fabs(t), 1 - t};
  });
  std::printf("The picture | its slope | its difference: %s/spheres.png\n", output.c_str());

  // One pixel by all numbers at once, and whether that is right.
  const int x = width * 45 / 100, y = view.height * 36 / 100;
  const auto light = [&](const auto& surface) { return luminance(view.pixel(scene, surface, x, y)); };
  const auto [value, d] = burnish::differentiate(light, paint);
  std::printf("pixel (%d, %d) has luminance %.4f; its slopes by the paint:\n", x, y, double(value));
  burnish::for_each_parameter(d, [](const std::string& name, float s, burnish::Range) {
    if (s != 0) std::printf("  %-22s %8.4f\n", name.c_str(), double(s));
  });
  const auto check = burnish::check_gradient(light, burnish::lift<double>(paint));
  std::printf("In double, %d slopes checked, %d undecided, largest error %.1g: %s\n", check.checked, check.undecided, check.error,
              check ? "right" : check.text().c_str());
}

int main(int argc, char** argv) {
  std::string output = "burnish-spheres", by = "specular_roughness";
  int width = 320, samples = 64;
  return program::main(argc, argv, "Traces painted spheres, and how the picture changes with a number of the paint.",
                       {{"--output", "FOLDER", "where spheres.png goes", &output},
                        {"--by", "NAME", "the number of the paint, as Surface names it", &by},
                        {"--width", "N", "of the picture, in pixels", &width, 16, 4096},
                        {"--samples", "N", "paths through each pixel", &samples, 1, 65536}},
                       [&] { run(output, by, width, samples); });
}
