// tests/street/path_tracer.cpp -- closed forms of what a path tracer must give: furnace, a ball's shadow, panes, depth
// SPDX-License-Identifier: Apache-2.0
#include <burnish/street/insert_layers.h>
#include <burnish_test.h>
#include <record.h>

using namespace burnish;

namespace {
/// A ball of 64 x 32 faces around (0, height, 0).
Mesh ball(float radius, float height) {
  Mesh m;
  const int columns = 64, rows = 32;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const vec3<float> n(latlong_direction(double(i) / columns, double(j) / rows));
      m.add(n * radius + vec3<float>(0, height, 0), n, {float(i) / columns, float(j) / rows});
    }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const int a = j * (columns + 1) + i, b = a + 1, c = a + columns + 1, d = c + 1;
      if (j > 0) m.triangles.push_back({a, b, d}), m.part.push_back(0);
      if (j + 1 < rows) m.triangles.push_back({a, d, c}), m.part.push_back(0);
    }
  m.parts.resize(1);
  return m;
}
Surface<float> lambert(float albedo) {
  Surface<float> s;
  s.base_color = vec3<float>(albedo), s.specular_weight = 0;
  return s;
}
const auto silent = [](int, int) {};
double mean(const Image& image) {
  double sum = 0;
  for (const float x : image.values) sum += double(x) / double(image.values.size());
  return sum;
}
}  // namespace

TEST_CASE("PathTracer: a convex Lambertian body under an even sky shows its albedo", "[street][energy]") {
  const Raycaster scene(ball(1, 50));
  const PanoramaSampler sky(Image(16, 8, vec3<float>(1.0f)));
  const PathTracer tracer(scene, sky, [](const auto&, int) { return lambert(0.6f); }, Ground{}, {.samples = 64});
  const Camera camera = Camera::look_at({0, 50, 4}, {0, 50, 0}, {0, 1, 0}, 8, 16, 16);  // the ball fills it
  const InsertLayers out = render_layers(tracer, camera, Mask(), true, silent);
  CHECK(mean(out.object) == Approx(0.6).epsilon(0.01));
  CHECK(mean(out.through) == 0);
}
TEST_CASE("PathTracer: the shadow of a black ball on the ground is its form factor", "[street][agreement]") {
  // A sphere seen whole from a plane element at distance d under the angle t from the normal: (r / d)^2 cos t.
  const float r = 1, height = 2;
  const Raycaster scene(ball(r, height));
  const PanoramaSampler sky(Image(16, 8, vec3<float>(1.0f)));
  const PathTracer tracer(scene, sky, [](const auto&, int) { return lambert(0); }, Ground{}, {.samples = 4096});
  record::Worst worst;
  for (const float x : {0.5f, 1.5f, 3.0f}) {
    const Camera camera = Camera::look_at({x + 0.3f, 0.6f, 3}, {x, 0, 0}, {0, 1, 0}, 0.2f, 4, 4);
    const double d2 = double(x * x + height * height), want = 1 - r * r / d2 * (height / std::sqrt(d2));
    worst(std::abs(mean(render_layers(tracer, camera, Mask(), true, silent).kept) - want));
  }
  record::claim("PathTracer: a black ball's shadow on the ground", "law", "the sphere's form factor", 6e-3, worst.value,
                3 * 16);
}
TEST_CASE("PathTracer: a pane keeps what its transmittance says, a photo's depth hides, threads change nothing",
          "[street][value]") {
  const Raycaster scene(ball(1, 1.5f));
  Image panorama(32, 16, vec3<float>(0.5f));
  panorama.set(7, 3, vec3<float>(400.0f));
  const PanoramaSampler sky(panorama);
  const Camera camera = Camera::look_at({0, 1.5f, 6}, {0, 1.5f, 0}, {0, 1, 0}, 30, 24, 24);
  const auto pane = [](const Surfel<float>&, int) {
    Surface<float> s;
    s.transmission_weight = 1, s.transmission_color = vec3<float>(0.5f), s.specular_weight = 0;
    return s;
  };
  const PathTracer through(scene, sky, pane, Ground{}, {.samples = 4});
  const InsertLayers glass = render_layers(through, camera, Mask(), true, silent);
  CHECK(glass.through.at(12, 12).x == Approx(0.25));  // in and out
  CHECK(glass.through.at(0, 0).x == 1);
  const auto paint = [](const Surfel<float>&, int) { return lambert(0.5f); };
  const PathTracer tracer(scene, sky, paint, Ground{}, {.samples = 8});
  const InsertLayers behind = render_layers(tracer, camera, Mask(24, 24, 3.0f), true, silent);
  CHECK(mean(behind.object) == 0);
  CHECK(mean(behind.kept) == Approx(1));
  const int before = threads();
  set_threads(1);
  const InsertLayers one = render_layers(tracer, camera, Mask(), true, silent);
  set_threads(3);
  const InsertLayers three = render_layers(tracer, camera, Mask(), true, silent);
  set_threads(before);
  CHECK(one.object.values == three.object.values);
  CHECK(one.kept.values == three.kept.values);
  CHECK(mean(one.object) > 0.05);
}
TEST_CASE("PathTracer: a wet ground mirrors a black ball as water does, a dry one not", "[street][agreement]") {
  const Raycaster scene(ball(1, 1.5f));
  const PanoramaSampler sky(Image(16, 8, vec3<float>(1.0f)));
  const auto black = [](const Surfel<float>&, int) { return lambert(0); };
  const auto added = [&](float wet, const vec3<float>& foot) {
    const PathTracer tracer(scene, sky, black, Ground{0, wet}, {.samples = 16});
    const Camera camera = Camera::look_at({0, 1, 6}, foot, {0, 1, 0}, 0.2f, 4, 4);  // that place fills it
    return double(render_layers(tracer, camera, Mask(), true, silent).added.at(1, 2).y);
  };
  // Fresnel 1823: where the mirrored ray meets the ball the even sky of 1 is missing.
  record::Worst worst;
  for (const float z : {2.4f, 3.0f, 3.6f}) {
    const double d = 6 - double(z), i = std::atan2(d, 1), t = std::asin(std::sin(i) / 1.33);
    const double s = std::sin(i - t) / std::sin(i + t), p = std::tan(i - t) / std::tan(i + t);
    for (const float wet : {0.5f, 1.0f})
      worst(std::abs(added(wet, {0, 0, z}) / (double(wet) * (s * s + p * p) / 2) + 1));
  }
  record::claim("PathTracer: a black ball mirrored by a wet ground", "law", "Fresnel's formulas", 5e-3, worst.value, 6);
  CHECK(added(0, {0, 0, 3}) == 0);
  CHECK(added(1, {4, 0, 3}) == 0);  // beside the mirrored ball
}
