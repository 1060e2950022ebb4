// bench/insertion.cpp -- what drawing light by brightness is worth: errors at equal time, fireflies; and how long it takes
// SPDX-License-Identifier: Apache-2.0
//
//   bench_insertion [PANORAMA ...]
//
// A car of boxes and balls (painted, glazed, on rubber) on the ground under each panorama; without arguments, under
// those of Blender. A converged picture by other random numbers is the reference. Pictures by 16 paths a pixel, light
// drawn by its brightness, are compared with pictures of as much CPU time by light drawn evenly from the sphere.
// Errors: root of the mean of (picture - reference)^2 / (reference^2 + (a tenth of its mean)^2) over the vehicle's
// pixels; of the shadow, of the ratio itself. clean: after denoising, by before. A firefly: a pixel over twice the
// brightest of the reference's nine about it, and over it by more than the reference's mean. At last the time, by the
// clock, that a picture of 1280 x 720 takes, tracing and denoising.
#include <chrono>
#include <ctime>
#include <cstdio>
#include <string>
#include <burnish/io/photo.h>
#include <burnish/math/color.h>
#include <burnish/street/denoise.h>
#include <burnish/street/insert_layers.h>
#include <burnish/street/place.h>

using namespace burnish;
namespace {

/// A box from corner to corner, or a ball that fills it, as a part.
void add_solid(Mesh& m, const vec3<float>& low, const vec3<float>& high, bool ball, int material) {
  const int steps = ball ? 24 : 2, part = int(m.parts.size()), first = int(m.positions.size());
  m.parts.push_back({"", std::to_string(material), material});
  const vec3<float> middle = (low + high) * 0.5f, half = (high - low) * 0.5f;
  for (int side = 0; side < 6; ++side)
    for (int j = 0; j < steps; ++j)
      for (int i = 0; i < steps; ++i) {
        const float u = 2 * float(i) / float(steps - 1) - 1, v = 2 * float(j) / float(steps - 1) - 1;
        const float s = side % 2 ? 1.0f : -1.0f;
        vec3<float> p = side / 2 == 0   ? vec3<float>(s, u, v)
                        : side / 2 == 1 ? vec3<float>(v, s, u)
                                        : vec3<float>(u, v, s);
        vec3<float> n = side / 2 == 0   ? vec3<float>(s, 0, 0)
                        : side / 2 == 1 ? vec3<float>(0, s, 0)
                                        : vec3<float>(0, 0, s);
        if (ball) p = n = normalize(p);
        m.add(middle + p * half, normalize(n / half), {u, v});
      }
  for (int side = 0; side < 6; ++side)
    for (int j = 0; j + 1 < steps; ++j)
      for (int i = 0; i + 1 < steps; ++i) {
        const int a = first + (side * steps + j) * steps + i;
        m.triangles.push_back({a, a + 1, a + steps}), m.triangles.push_back({a + 1, a + steps + 1, a + steps});
        m.part.push_back(part), m.part.push_back(part);
      }
}
/// Length along x, metres.
Mesh box_car() {
  Mesh m;
  add_solid(m, {-2.1f, 0.25f, -0.9f}, {2.1f, 0.85f, 0.9f}, false, 0);
  add_solid(m, {-1.6f, 0.7f, -0.8f}, {1.2f, 1.5f, 0.8f}, true, 0);
  add_solid(m, {-1.2f, 0.86f, -0.75f}, {0.9f, 1.3f, 0.75f}, false, 1);
  for (const float x : {-1.3f, 1.3f})
    for (const float z : {-0.8f, 0.8f}) add_solid(m, {x - 0.32f, 0, z - 0.12f}, {x + 0.32f, 0.64f, z + 0.12f}, true, 2);
  return m;
}
Surface<float> material(const Surfel<float>&, int part) {
  Surface<float> s;
  if (part < 2) {
    s.base_color = {0.4f, 0.05f, 0.04f}, s.base_metalness = 0.3f, s.specular_roughness = 0.35f;
    s.coat_weight = 1, s.coat_roughness = 0.05f;
  } else if (part == 2) {
    s.transmission_weight = 1, s.specular_roughness = 0.02f;
    s.base_color = {0.6f, 0.7f, 0.7f};
  } else {
    s.base_color = vec3<float>(0.03f), s.specular_roughness = 0.7f;
  }
  return s;
}

double cpu() { return double(std::clock()) / CLOCKS_PER_SEC; }
struct Errors {
  double object = 0, shadow = 0;
  int fireflies = 0;
};
Errors error_of(const InsertLayers& x, const InsertLayers& truth) {
  const int w = truth.object.width, h = truth.object.height;
  Errors e;
  double mean = 0, vehicle = 0, ground = 0;
  for (int y = 0; y < h; ++y)
    for (int i = 0; i < w; ++i)
      if (truth.through.at(i, y).y < 0.5f) mean += double(luminance(truth.object.at(i, y))), ++vehicle;
  mean /= std::max(vehicle, 1.0);
  for (int y = 0; y < h; ++y)
    for (int i = 0; i < w; ++i) {
      const double a = double(luminance(x.object.at(i, y))), b = double(luminance(truth.object.at(i, y)));
      if (truth.through.at(i, y).y < 0.5f) {
        e.object += (a - b) * (a - b) / (b * b + 0.01 * mean * mean);
        double most = 0;
        for (int v = std::max(0, y - 1); v <= std::min(h - 1, y + 1); ++v)
          for (int u = std::max(0, i - 1); u <= std::min(w - 1, i + 1); ++u)
            most = std::max(most, double(luminance(truth.object.at(u, v))));
        e.fireflies += a > 2 * most && a - most > mean;
      }
      const double s = double(luminance(x.shadow.at(i, y))), t = double(luminance(truth.shadow.at(i, y)));
      if (t < 0.98 && truth.ground.at(i, y).y > 0.5f) e.shadow += (s - t) * (s - t), ++ground;
    }
  e.object = std::sqrt(e.object / std::max(vehicle, 1.0)), e.shadow = std::sqrt(e.shadow / std::max(ground, 1.0));
  return e;
}
}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> files(argv + 1, argv + argc);
  if (files.empty())
    for (const char* name : {"city", "courtyard", "forest", "interior", "night", "studio", "sunrise", "sunset"})
      files.push_back("/usr/share/blender/datafiles/studiolights/world/" + std::string(name) + ".exr");
  const Camera camera = street_camera(152, 96, 54, 192, 108, 1.65f, 0.06f);
  const Raycaster scene(placed(box_car(), {0.3f, 6.5f, 2.5f}));
  std::printf("192 x 108 pixels, 16 paths a pixel, compiler %s; equal CPU time, 4 rounds\n", __VERSION__);
  std::printf("%-12s %28s %28s %22s\n", "", "error on the vehicle", "error of the shadow", "fireflies");
  std::printf("%-12s %8s %8s %5s %5s %8s %8s %5s %5s %7s %7s %7s\n", "", "drawn", "evenly", "ratio", "clean", "drawn",
              "evenly", "ratio", "clean", "drawn", "evenly", "clean");
  double worst = 0;
  for (const std::string& file : files) {
    try {
      const PanoramaSampler sky(read_photo(file));
      const auto picture = [&](int samples, std::uint32_t seed, bool by_brightness, double* seconds = nullptr) {
        PathOptions o;
        o.samples = samples, o.seed = seed, o.by_brightness = by_brightness;
        const PathTracer tracer(scene, sky, material, Ground{}, o);
        const double start = cpu();
        InsertLayers layers = render_layers(tracer, camera, Mask(), true, [](int, int) {});
        if (seconds) *seconds += cpu() - start;
        return layers;
      };
      const InsertLayers truth = picture(512, 77, true);
      double drawn_time = 0, even_time = 0;
      picture(16, 1, true, &drawn_time), picture(16, 1, false, &even_time);
      const int even_samples = std::max(1, int(std::lround(16 * drawn_time / even_time)));
      Errors drawn, even, clean;
      constexpr int rounds = 4;
      for (int round = 0; round < rounds; ++round) {
        const auto add = [&](Errors& to, const InsertLayers& layers) {
          const Errors e = error_of(layers, truth);
          to.object += e.object / rounds, to.shadow += e.shadow / rounds, to.fireflies += e.fireflies;
        };
        InsertLayers layers = picture(16, std::uint32_t(2 + round), true);
        add(drawn, layers);
        add(even, picture(even_samples, std::uint32_t(2 + round), false));
        denoise(layers, features(scene, material, camera));
        add(clean, layers);
      }
      const std::string name = file.substr(file.rfind('/') + 1);
      std::printf("%-12.12s %8.3f %8.3f %5.2f %5.2f %8.4f %8.4f %5.2f %5.2f %7d %7d %7d\n", name.c_str(), drawn.object,
                  even.object, drawn.object / even.object, clean.object / drawn.object, drawn.shadow, even.shadow,
                  drawn.shadow / even.shadow, clean.shadow / drawn.shadow, drawn.fireflies, even.fireflies,
                  clean.fireflies);
      std::fflush(stdout);
      worst = std::max(worst, drawn.object / even.object);
    } catch (const burnish::Error& e) {
      std::printf("%s\n", e.what());
    }
  }
  std::printf("worst ratio on the vehicle: %.2f\n", worst);
  try {
    const PanoramaSampler sky(read_photo(files[0]));
    const Camera large = street_camera(1013, 640, 360, 1280, 720, 1.65f, 0.06f);
    for (const int samples : {4, 64}) {
      const auto start = std::chrono::steady_clock::now();
      PathOptions o;
      o.samples = samples, o.bounces = samples > 4 ? 4 : 2;
      InsertLayers layers =
          render_layers(PathTracer(scene, sky, material, Ground{}, o), large, Mask(), true, [](int, int) {});
      denoise(layers, features(scene, material, large), samples > 4 ? 6 : 4);
      std::printf("1280 x 720, %d paths a pixel, on %d threads: %.1f s\n", samples, threads(),
                  std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
  } catch (const burnish::Error& e) {
    std::printf("%s\n", e.what());
  }
  return 0;
}
