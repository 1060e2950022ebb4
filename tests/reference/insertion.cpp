// tests/reference/insertion.cpp -- a grey ball and a cube put on grey ground under a known sky, against Mitsuba's paths
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include <record.h>
#include <burnish/street/insert_layers.h>
#include <burnish/street/place.h>
#include <scene/shapes.h>
#include "npy.h"

using namespace burnish;

namespace {
constexpr int width = 64, height = 48;
const vec3<double> sun = normalize(vec3<double>(0.55, 0.62, 0.56));

/// The sky of insertion.py, and below the horizon the radiance of the open ground.
Image panorama(const vec3<float>& ground) {
  const int rows = 512;
  Image p(2 * rows, rows);
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < 2 * rows; ++x) {
      const vec3<double> d = latlong_direction((x + 0.5) / (2 * rows), (y + 0.5) / rows);
      if (d.y < 0) {
        p.set(x, y, ground);
        continue;
      }
      const double angle = std::acos(std::clamp(dot(d, sun), -1.0, 1.0));
      const double grey = 0.5 + 0.3 * d.x + 0.4 * d.y, bright = 60 * std::exp(-0.5 * angle * angle / 0.0025);
      p.set(x, y, vec3<float>(vec3<double>(0.8 * grey + bright, grey + 0.95 * bright, 1.3 * grey + 0.8 * bright)));
    }
  return p;
}
Mesh object(const std::string& shape) {
  if (shape == "ball") return shapes::sphere({0, 0.5f, 0}, 0.5f, 96);
  Mesh cube;
  shapes::add_box(cube, "cube", {-0.4f, 0, -0.4f}, {0.4f, 0.8f, 0.4f});
  const float c = std::cos(0.5235988f), s = std::sin(0.5235988f);
  for (vec3<float>& p : cube.positions) p = {c * p.x + s * p.z, p.y, c * p.z - s * p.x};
  return cube;
}
Surface<float> grey(const Surfel<float>&, int) {
  Surface<float> s;
  s.base_color = vec3<float>(0.5f), s.specular_weight = 0, s.specular_ior = 1;
  return s;
}
struct Difference {
  double squares = 0, of = 0, mine = 0;
  long count = 0;
  void add(const vec3<float>& x, const reference::Array& a, int row, int column, const vec3<float>& by = {1, 1, 1}) {
    const double ours[3] = {double(x.x), double(x.y), double(x.z)},
                 scale[3] = {double(by.x), double(by.y), double(by.z)};
    for (int c = 0; c < 3; ++c) {
      const double y = a(row, column, c) / scale[c];
      squares += (ours[c] - y) * (ours[c] - y), of += y * y, mine += ours[c] / 3, ++count;
    }
  }
  double rms() const { return std::sqrt(squares / of); }
};
}  // namespace

TEST_CASE("Insertion: a grey ball and a cube look as Mitsuba's, and so do their shadows", "[reference][agreement]") {
  const reference::Array open_ground = reference::load("insertion_open");
  const vec3<float> open(float(open_ground(0)), float(open_ground(1)), float(open_ground(2)));
  const PanoramaSampler sky(panorama(open));
  // The open ground of albedo 0.25 in closed form.
  const vec3<float> e = sky.irradiance({0, 1, 0}) * (0.25f * inverse_pi);
  record::claim("insertion: radiance of the open ground", "image", "Mitsuba 3.9.1 path, sampled", 5e-3,
                double(std::max({std::abs(e.x / open.x - 1), std::abs(e.y / open.y - 1), std::abs(e.z / open.z - 1)})),
                3);
  const Camera camera =
      Camera::look_at({2.1f, 1.9f, 3.1f}, {0.05f, 0.3f, 0}, {0, 1, 0}, 46, width, height, Fov::horizontal);
  for (const std::string shape : {"ball", "cube"}) {
    const Raycaster scene(object(shape));
    PathOptions options;
    options.samples = 512;
    const PathTracer tracer(scene, sky, grey, Ground{}, options);
    const InsertLayers l = render_layers(tracer, camera, Mask(), true, [](int, int) {});
    const reference::Array seen = reference::load("insertion_" + shape + "_object"),
                           ground = reference::load("insertion_" + shape + "_ground");
    Difference on_object, on_ground, in_shadow;
    // Centre and extent of the shadow, by what is missing of the light: direction and softness in two numbers a picture.
    vec2<double> middle[2], spread[2];
    double missing[2] = {};
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        if (l.through.at(x, y).x == 0) on_object.add(l.object.at(x, y), seen, y, x);
        if (l.ground.at(x, y).x != 1) continue;
        on_ground.add(l.shadow.at(x, y), ground, y, x, open);
        if (l.shadow.at(x, y).y < 0.9f) in_shadow.add(l.shadow.at(x, y), ground, y, x, open);
        const double dark[2] = {1 - double(l.shadow.at(x, y).y), 1 - ground(y, x, 1) / double(open.y)};
        for (int k = 0; k < 2; ++k) {
          missing[k] += dark[k];
          middle[k] += vec2<double>(x, y) * dark[k], spread[k] += vec2<double>(double(x) * x, double(y) * y) * dark[k];
        }
      }
    const std::string by = "Mitsuba 3.9.1 path, sampled";
    record::claim("insertion of a " + shape + ": its picture, rms", "image", by, 0.01, on_object.rms(),
                  on_object.count);
    record::claim("insertion of a " + shape + ": the ground by the open ground, rms", "image", by, 0.01,
                  on_ground.rms(), on_ground.count);
    record::claim("insertion of a " + shape + ": in its shadow, rms", "image", by, 0.01, in_shadow.rms(),
                  in_shadow.count);
    double apart = 0;
    for (int k = 0; k < 2; ++k) {
      middle[k] = middle[k] * (1 / missing[k]);
      spread[k] = spread[k] * (1 / missing[k]) - vec2<double>(middle[k].x * middle[k].x, middle[k].y * middle[k].y);
    }
    apart = std::max({std::abs(middle[0].x - middle[1].x), std::abs(middle[0].y - middle[1].y),
                      std::abs(std::sqrt(spread[0].x) - std::sqrt(spread[1].x)),
                      std::abs(std::sqrt(spread[0].y) - std::sqrt(spread[1].y))});
    record::claim("insertion of a " + shape + ": shadow's middle and extent, pixels", "image", by, 0.1, apart, 4);
  }
}
