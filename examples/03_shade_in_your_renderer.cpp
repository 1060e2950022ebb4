// examples/03_shade_in_your_renderer.cpp -- a path tracer with vectors, camera and random numbers of its own, shaded by
// burnish and differentiated without a change
// SPDX-License-Identifier: Apache-2.0
//
// Only what paint touches is templated: Surface<float> gives a picture, Surface<Dual<float, 1>> also its slope by one
// number of the paint, Surface<double> what checks it; differentiate() gives a pixel's slopes by all numbers at once.
// Needs a compiler only: c++ -std=c++20 -O2 -march=native -I include examples/03_shade_in_your_renderer.cpp
#include <cstdio>
#include <burnish/ad/check.h>
#include <burnish/ad/dual.h>
#include <burnish/ad/parallel.h>
#include <burnish/math/color.h>
#include <burnish/math/frame.h>
#include <burnish/shade/brdf.h>
#include "program.h"
#include "progress.h"

using burnish::Surface, burnish::vec3;  // all that the host knows of burnish: a material is a Surface
struct float3 { float x, y, z; };
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
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u, z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return float((z ^ z >> 31) >> 40) * 0x1p-24f;
  }
};
struct Ray { float3 origin, direction; };
struct Sphere { float3 center; float radius; int material; };
struct Hit { float3 position, normal; int material; };  // -1: none, the sky
Surface<float> material(float3 color, float metalness, float roughness, float coat = 0) {
  Surface<float> s;
  s.base_color = color, s.base_metalness = metalness, s.specular_roughness = roughness;
  s.coat_weight = coat, s.coat_roughness = 0.05f;
  return s;
}

/// Spheres on a chequered floor, y up, under a sky with a lamp in it.
struct Scene {
  std::vector<Surface<float>> materials{
      material({0.6f, 0.06f, 0.05f}, 0.5f, 0.4f, 0.7f), material({0.8f, 0.8f, 0.8f}, 1, 0.05f),
      material({1, 0.72f, 0.32f}, 1, 0.3f),             material({0.75f, 0.75f, 0.7f}, 0, 0.8f),
      material({0.08f, 0.08f, 0.09f}, 0, 0.3f),         material({0.5f, 0.5f, 0.48f}, 0, 0.3f)};
  enum { paint, mirror, gold, clay, tiles };
  std::vector<Sphere> spheres{{{0, 1, 0}, 1, paint}, {{-1, 0.3f, 1.2f}, 0.3f, paint}, {{-1.9f, 0.7f, 0}, 0.7f, mirror},
                              {{0.9f, 0.3f, 1.2f}, 0.3f, gold}, {{1.7f, 0.6f, -0.2f}, 0.6f, clay}};

  Hit hit(const Ray& ray) const {
    const float down = -ray.origin.y / ray.direction.y;
    float nearest = down > 1e-3f ? std::min(down, 50.0f) : 50.0f;
    float3 at = ray.origin + ray.direction * nearest;
    Hit found{at, {0, 1, 0}, nearest < 50 ? tiles + ((int(std::floor(at.x)) + int(std::floor(at.z))) & 1) : -1};
    for (const Sphere& s : spheres) {
      const float3 to = s.center - ray.origin;
      const float b = dot(to, ray.direction), q = b * b - dot(to, to) + s.radius * s.radius;
      const float t = q < 0 ? -1 : b - std::sqrt(q);
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

/// A direction that light may come from, and its density per steradian (0: none). Local: the normal is z.
std::pair<vec3<float>, float> choose(const Surface<float>& s, const vec3<float>& v, Random& random) {
  using namespace burnish;
  const Layers<float> all = layers(s);
  const float coat = 0.3f * s.coat_weight, base = 0.5f * (1 - coat), which = random(), u = random(), w = random();
  const auto mirrored = [&](float roughness) { return reflect(v, ggx_sample_visible_normal(roughness, v, {u, w})); };
  vec3<float> l;
  if (which < coat) l = mirrored(all.coat_roughness);
  else if (which < coat + base) l = mirrored(all.base_roughness);
  else l = vec3<float>(cos(2 * pi * u), sin(2 * pi * u), 0) * sqrt(w) + vec3<float>(0, 0, sqrt(1 - w));
  if (l.z <= 0 || v.z <= 0) return {l, 0.0f};
  const vec3<float> h = normalize(v + l);
  const float vh = dot(v, h), sin2 = h.x * h.x + h.y * h.y;
  const auto density = [&](float r) { return ggx_visible_normal_pdf(r, v.z, vh, ggx_d(r, h.z, sin2)) / (4 * vh); };
  return {l, coat * density(all.coat_roughness) + base * density(all.base_roughness) + (1 - coat - base) * l.z / pi};
}

/// Radiance along a ray. Where a path goes is decided by the scene's own floats (any density will do), what it carries
/// is in T: so the slopes meet no edges, and are as unbiased as the radiance.
template <class T> vec3<T> trace(const Scene& scene, const Surface<T>& paint, Ray ray, Random random) {
  vec3<T> carried(T(1.0f));
  for (int bounce = 0; bounce < 5; ++bounce) {
    const auto [position, n, material] = scene.hit(ray);
    if (material < 0) return carried * scene.sky(ray.direction);
    const Surface<float>& own = scene.materials[std::size_t(material)];
    const auto frame = burnish::frame_of(vec3<float>(n));
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

/// The camera. A pixel's random numbers are the same whatever T.
struct View {
  const Scene& scene;
  int width, height, samples;

  template <class T> vec3<T> pixel(const Surface<T>& paint, int x, int y) const {
    vec3<T> sum;
    for (int i = 0; i < samples; ++i) {
      Random random{(std::uint64_t(y * width + x) << 20 | std::uint64_t(i)) * 0xd1342543de82ef95u};
      const float u = (x + random() - 0.5f * width) / height, v = (0.5f * height - y - random()) / height;
      sum += trace(scene, paint, {{0, 1.6f, 6}, normalize({0.72f * u, 0.72f * v - 0.16f, -1 - 0.115f * v})}, random);
    }
    return sum / samples;
  }
  template <class T> std::vector<vec3<T>> picture(const char* what, const Surface<T>& paint) const {
    std::vector<vec3<T>> pixels(std::size_t(width * height));
    Progress progress(what);
    for (int from = 0; from < height; from += 8) {
      burnish::parallel_for(std::min(8, height - from), [&](int row) {
        for (int x = 0, y = from + row; x < width; ++x) pixels[std::size_t(y * width + x)] = pixel(paint, x, y);
      });
      progress.show(from, height);
    }
    progress.finish(std::to_string(samples) + " paths a pixel");
    return pixels;
  }
};

void run(const std::string& output, const std::string& by, int width, int samples) {
  const Scene scene;
  const Surface<float>& paint = scene.materials[Scene::paint];
  // The number named `by`: a dual for its slope, and a little more or less of it in double, for the difference.
  using Slope = burnish::Dual<float, 1>;
  const auto changed = [&]<class T>(Surface<T> surface, auto change) {
    bool found = false;
    burnish::for_each_parameter(surface, [&](const std::string& name, T& x, burnish::Range) {
      if (name == by) found = true, x = change(x);
    });
    if (!found) throw std::runtime_error("--by " + by + ": no number of Surface (burnish/nodes/surface.h)");
    return surface;
  };
  const auto moving = changed(burnish::lift<Slope>(paint), [](const Slope& x) { return Slope(x.value, 0); });
  const auto more = changed(burnish::lift<double>(paint), [](double x) { return x + 1e-4; });
  const auto less = changed(burnish::lift<double>(paint), [](double x) { return x - 1e-4; });
  program::make_folder(output);

  const View view{scene, width, width * 5 / 8, samples};
  const auto picture = view.picture("with slopes", moving);
  const auto above = view.picture("a little more", more), below = view.picture("a little less", less);
  const auto slope = [&](std::size_t i) { return luminance(picture[i]).slope[0]; };
  const auto difference = [&](std::size_t i) { return float(luminance(above[i] - below[i]) / 2e-4); };
  float largest = 1e-9f, apart = 0;
  for (std::size_t i = 0; i < picture.size(); ++i)
    largest = std::max(largest, std::fabs(slope(i))), apart = std::max(apart, std::fabs(slope(i) - difference(i)));
  std::printf("d luminance / d %s: up to %.3g, at most %.1g from its difference\n", by.c_str(), largest, apart);
  // Blue where more of the number darkens, red where it brightens; by the cube root, so that reflections show.
  program::write_row_png(output + "/spheres.png", 3, width, view.height, [&](int k, int x, int y) {
    const std::size_t i = std::size_t(y * width + x);
    if (k == 0) return float3{picture[i].x.value, picture[i].y.value, picture[i].z.value};
    const float t = std::cbrt((k == 1 ? slope(i) : difference(i)) / largest);
    return float3{1 + t, 1 - std::fabs(t), 1 - t};
  });
  std::printf("The picture | its slope | its difference: %s/spheres.png\n", output.c_str());

  // One pixel by all numbers at once, and whether that is right.
  const int x = width * 45 / 100, y = view.height * 36 / 100;
  const auto light = [&](const auto& surface) { return luminance(view.pixel(surface, x, y)); };
  const auto [value, d] = burnish::differentiate(light, paint);
  std::printf("pixel (%d, %d) has luminance %.4f; its slopes by the paint:\n", x, y, value);
  burnish::for_each_parameter(d, [](const std::string& name, float s, burnish::Range) {
    if (s != 0) std::printf("  %-22s %8.4f\n", name.c_str(), s);
  });
  const auto check = burnish::check_gradient(light, burnish::lift<double>(paint));
  const bool right = check.verdict == burnish::Verdict::right;
  std::printf("%d slopes checked in double: %s\n", check.checked, right ? "all right" : check.text().c_str());
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
