// tests/examples/turntable.cpp -- the quick light of examples/stage.h against the exact one, and a turn around a car
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include "../../examples/turntable.h"
#include "record.h"
#include <burnish/nodes/car_paint.h>
#include <burnish/nodes/window_glass.h>

using namespace burnish;

namespace {
Mesh sphere(const vec3<float>& middle, float radius) {
  constexpr int n = 48;
  Mesh m;
  m.parts.resize(1);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i < 2 * n; ++i) {
      const float t = pi * float(j) / n, p = pi * float(i) / n;
      const vec3<float> d(std::sin(t) * std::cos(p), std::cos(t), std::sin(t) * std::sin(p));
      m.add(middle + d * radius, d);
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < 2 * n; ++i) {
      const int a = j * 2 * n + i, b = j * 2 * n + (i + 1) % (2 * n);
      m.triangles.push_back({a, b, a + 2 * n}), m.triangles.push_back({b, b + 2 * n, a + 2 * n});
      m.part.insert(m.part.end(), 2, 0);
    }
  return m;
}
void add_box(Mesh& m, const vec3<float>& low, const vec3<float>& high) {
  const int first = int(m.positions.size()), part = int(m.parts.size());
  m.parts.emplace_back();
  for (int k = 0; k < 8; ++k) m.add({k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z});
  for (const auto& q : {std::array{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}})
    for (const auto& t : {std::array{0, 1, 2}, {0, 2, 3}})
      m.triangles.push_back({first + q[std::size_t(t[0])], first + q[std::size_t(t[1])], first + q[std::size_t(t[2])]}),
          m.part.push_back(part);
}
/// Brighter above, bluer on one side, with a sun.
Image panorama() {
  Image sky(128, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 128; ++x) {
      const float up = 1 - float(y) / 64, side = 0.5f + 0.5f * std::cos(float(x) / 128 * 2 * pi);
      sky.set(x, y, y < 32 ? vec3<float>(0.3f + up, 0.5f + up, 0.6f + up + 0.5f * side) : vec3<float>(0.25f));
    }
  for (const int x : {40, 41}) sky.set(x, 16, vec3<float>(400));
  return sky;
}
/// A surface for every part, the second of clear glass.
Surface<float> look(int part, const Surfel<float>& at) {
  if (part == 1) return WindowGlass<float>{}(at);
  return CarPaint<float>{}(at);
}
vec3<float> film(const vec3<float>& light) { return srgb_from_linear(min(light * 0.3f, vec3<float>(1))); }
}  // namespace

TEST_CASE("Stage: on a sphere in the open the quick light is the exact one, on the whole", "[examples][agreement]") {
  const EnvironmentLight sky(panorama(), 0.7f);
  REQUIRE(!sky.suns.empty());
  const Raycaster scene(sphere({0, 30, 0}, 1));  // too high for its shadow to matter
  const Camera camera = Camera::look_at({4, 31, 3}, {0, 30, 0}, {0, 1, 0}, 32, 64, 64);
  const GBuffer g = scene.trace(camera, 1);
  const LightStrength<float> strength;
  const turntable::Stage stage(sky, strength, {}, scene);
  const auto seen = stage.look_around(g);
  const LightOf<float> light(Illumination(sky, g));
  record::Worst worst;
  long count = 0;
  for (const float roughness : {0.1f, 0.3f, 0.5f, 0.8f})
    for (const float coat : {0.0f, 1.0f})
      for (const float metalness : {0.0f, 1.0f}) {
        CarPaint<float> paint;
        paint.specular_roughness = roughness, paint.coat_weight = coat, paint.base_metalness = metalness;
        vec3<double> quick, exact;
        for (int i = 0; i < g.size(); ++i) {
          const Surfel<float> at = g.at(i);
          quick += vec3<double>(stage.reflected_by(paint(at), at, seen[std::size_t(i)]));
          exact += vec3<double>(illuminate(paint(at), at, light, List<Sun, float>{sky.suns}, strength));
        }
        for (const double ratio : {quick.x / exact.x, quick.y / exact.y, quick.z / exact.z})
          worst(std::abs(ratio - 1)), ++count;
      }
  record::claim("turntable::Stage: mean radiance of a sphere", "value", "illuminate", 0.04, worst.value, count);
}

TEST_CASE("Stage: the ground is dark under the vehicle, and untouched far from it", "[examples][limit]") {
  Mesh m;
  add_box(m, {-2, 0.25f, -0.8f}, {2, 1.4f, 0.8f});
  const Raycaster scene(std::move(m));
  const EnvironmentLight even(Image(32, 16, vec3<float>(1)));
  const turntable::Stage stage(even, {}, {}, scene);
  CHECK(stage.shadow(0, 0) < 0.1f);
  CHECK(stage.shadow(40, 0) == 1);
  CHECK(stage.shadow(0, -8) == 1);
  // Beside a long wall, close to its foot, half of the sky is left.
  CHECK(stage.shadow(0, 0.83f) == Approx(0.5).margin(0.12));
  CHECK(stage.shadow(0, 0.83f) < stage.shadow(0, 1.4f));
}

TEST_CASE("Turntable: the whole vehicle is in every picture, glass is looked through, threads change nothing",
          "[examples][value]") {
  Mesh m;
  add_box(m, {-2, 0, -0.8f}, {2, 1, 0.8f});
  add_box(m, {-1, 1, -0.7f}, {1, 1.5f, 0.7f});
  const Raycaster scene(std::move(m));
  const EnvironmentLight sky(panorama());
  turntable::Options o;
  o.frames = 5, o.width = 96, o.height = 54;
  const auto turn = [&](int cores, int most) {
    set_threads(cores);
    std::vector<Image> all;
    const bool whole =
        turntable::turn(scene, sky, {}, vec3<float>(0.1f), look, film, o, [&](int i, const Image& picture) {
          CHECK(i == int(all.size()));
          all.push_back(picture);
          return int(all.size()) < most;
        });
    CHECK(whole == (most > 5));
    return all;
  };
  const int before = threads();
  const std::vector<Image> one = turn(1, 9), two = turn(2, 9);
  CHECK(turn(1, 2).size() == 2);
  set_threads(before);
  REQUIRE(one.size() == 5);
  for (std::size_t i = 0; i < 5; ++i) CHECK(one[i].values == two[i].values);
  for (const Image& picture : one) {
    int red = 0;
    for (int y = 0; y < 54; ++y)
      for (int x = 0; x < 96; ++x) {
        const vec3<float> c = picture.at(x, y);
        const bool paint = c.x > 2 * c.z;
        red += paint;
        if (x == 0 || y == 0 || x == 95 || y == 53) CHECK(!paint);
      }
    CHECK(red > 300);
  }
}
