// tests/street/insert.cpp -- plates, placements and labels: what is put in comes out where and as it must
// SPDX-License-Identifier: Apache-2.0
#include <burnish/street/insert.h>
#include <burnish/street/place.h>
#include <burnish_test.h>
#include <random>

using namespace burnish;

namespace {
InsertLayers layers(int w, int h) { return InsertLayers(w, h); }
/// Grey, with noise of that deviation in display values, or a step from dark to light, blurred.
Image noisy(float deviation) {
  std::mt19937 random(1);
  std::normal_distribution<float> n(0, deviation);
  Image out(200, 200);
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) out.set(x, y, vec3<float>(linear_from_srgb(0.5f + n(random))));
  return out;
}
Image steps(float blur) {
  Image out(200, 200);
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      const float t = float(x % 50) + 0.5f - 25;  // edges every 50 pixels, in display values
      const float up = 0.5f * (1 + std::erf(t / (1.41421356f * std::max(blur, 1e-3f))));
      out.set(x, y, vec3<float>(linear_from_srgb(0.2f + 0.6f * (x / 50 % 2 ? 1 - up : up))));
    }
  return out;
}
const PanoramaSampler& grey() {
  static const PanoramaSampler sky(Image(16, 8, vec3<float>(0.5f, 0.25f, 0.2f)));
  return sky;
}
}  // namespace

TEST_CASE("composite: object + plate * kept + added, the rendered part exposed", "[street][value]") {
  InsertLayers l = layers(2, 1);
  l.object.set(0, 0, {0.2f, 0.4f, 0.6f}), l.kept.set(0, 0, {0.5f, 0.5f, 0.5f}), l.added.set(0, 0, {0.1f, 0, 0});
  const Image out = composite(Image(2, 1, vec3<float>(0.8f)), l, {2, 1, 1});
  CHECK(out.at(0, 0).x == Approx(0.8 * 0.5 + 2 * 0.3));
  CHECK(out.at(0, 0).z == Approx(0.8 * 0.5 + 0.6));
  CHECK(out.at(1, 0).y == Approx(0.8));  // no vehicle: the plate
}
TEST_CASE("composite_backward: the slope of the composite by the object's light", "[street][gradient]") {
  InsertLayers l = layers(3, 2);
  for (float& x : l.object.values) x = 0.3f;
  const vec3<float> exposure(1.5f, 0.5f, 2);
  const Image plate(3, 2, vec3<float>(0.4f));
  Image weights(3, 2);
  for (std::size_t i = 0; i < weights.values.size(); ++i) weights.values[i] = 0.1f * float(i % 7) - 0.2f;
  const auto loss = [&] {
    const Image c = composite(plate, l, exposure);
    double sum = 0;
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 3; ++x) sum += double(dot(c.at(x, y), weights.at(x, y)));
    return sum;
  };
  const Image d = composite_backward(weights, exposure);
  for (int x = 0; x < 3; ++x) {
    const double before = loss();
    l.object.set(x, 1, l.object.at(x, 1) + vec3<float>(0, 0, 0.125f));
    CHECK((loss() - before) / 0.125 == Approx(double(d.at(x, 1).z)).margin(1e-5));
  }
}
TEST_CASE("plate_look: exposure by the ground, noise and blur as they were made", "[street][agreement]") {
  const Camera camera = street_camera(150, 100, 100, 200, 200, 1.5f, 0.6f);  // the ground all over
  const Mask all(200, 200, 1);
  const PlateLook exposed = plate_look(Image(200, 200, {0.2f, 0.11f, 0.08f}), all, camera, grey());
  CHECK(exposed.exposure.x == Approx(0.4));
  CHECK(exposed.exposure.y == Approx(0.44));
  // Red ground where the panorama's is not: brighter by what it is, redder by a quarter at most.
  const PlateLook red = plate_look(Image(200, 200, {0.5f, 0.1f, 0.08f}), all, camera, grey());
  const float brightness = 0.2126f * 1 + 0.7152f * 0.4f + 0.0722f * 0.4f;
  CHECK(red.exposure.x == Approx(1.25f * brightness));
  CHECK(red.exposure.y == Approx(0.8f * brightness));
  CHECK(exposed.noise < 1e-4f);
  for (const float noise : {0.005f, 0.015f})
    CHECK(plate_look(noisy(noise), all, camera, grey()).noise == Approx(noise).epsilon(0.25));
  CHECK(plate_look(steps(0), all, camera, grey()).blur < 0.35f);
  CHECK(plate_look(steps(1.2f), all, camera, grey()).blur == Approx(1.2).epsilon(0.25));
}
TEST_CASE("match_look: the object gets the plate's noise, all else keeps its own", "[street][agreement]") {
  InsertLayers l = layers(120, 120);
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 60; ++x) l.object.set(x, y, vec3<float>(0.2f)), l.through.set(x, y, {}), l.kept.set(x, y, {});
  InsertLayers same = l;
  match_look(l, {{1, 1, 1}, 0.02f, 0}, 7);
  match_look(same, {{1, 1, 1}, 0.02f, 0}, 7);
  CHECK(l.object.values == same.object.values);
  double sum = 0, squares = 0;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 60; ++x) {
      const double shown = double(srgb_from_linear(l.object.at(x, y).y) - srgb_from_linear(0.2f));
      sum += shown / 7200, squares += shown * shown / 7200;
    }
  CHECK(sum == Approx(0).margin(1e-3));
  CHECK(std::sqrt(squares) == Approx(0.02).epsilon(0.05));
  CHECK(l.object.at(100, 60).x == 0);  // where the vehicle is not
}
TEST_CASE("Placement, label_box: KITTI's frame", "[street][value]") {
  const Camera camera = street_camera(700, 320, 240, 640, 480, 1.65f);
  // Ten metres ahead, driving away: its front is further off than its middle, its right side to the right.
  const Placement away{1, 10, 0};
  CHECK(away({2, 0, 0}).z == Approx(-12));
  CHECK(away({0, 0, 0.8f}).x == Approx(1.8));
  const LabelBox box = label_box({4.5f, 1.5f, 1.8f}, away, camera);
  CHECK(box.bottom.x == Approx(1));
  CHECK(box.bottom.y == Approx(1.65));
  CHECK(box.bottom.z == Approx(10));
  CHECK(box.length == Approx(4.5));
  CHECK(double(box.rotation_y) == Approx(-3.14159265 / 2));  // KITTI: 0 to the right, clockwise from above
  CHECK(double(box.alpha) == Approx(-3.14159265 / 2 - std::atan2(1, 10)));
  CHECK(double(label_box({4, 1, 2}, Placement{0, 10, 3.14159265f / 2}, camera).rotation_y) == Approx(0).margin(1e-5));
  // The middle of its bottom is seen where the ground's place is.
  const vec3<float> seen = camera.project(away({0, 0, 0}));
  vec3<float> foot;
  REQUIRE(on_ground(camera, seen.x, seen.y, foot));
  CHECK(foot.z == Approx(-10).epsilon(1e-4));
  CHECK_FALSE(on_ground(camera, 320, 100, foot));
}
