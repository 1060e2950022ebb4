// tests/street/denoise.cpp -- noise goes, edges stay, lone bright pixels are dimmed; and where a vehicle goes in time
// SPDX-License-Identifier: Apache-2.0
#include <burnish/street/denoise.h>
#include <burnish/street/light_field.h>
#include <burnish/street/trajectory.h>
#include <burnish_test.h>
#include <random>
#include <record.h>

using namespace burnish;

namespace {
/// Two greys side by side, with a stripe that only the picture has, and noise of a known deviation.
struct Noisy {
  InsertLayers layers{64, 48};
  Image truth{64, 48};
  PlateFeatures features;

  explicit Noisy(float deviation) {
    std::mt19937 random(5);
    std::normal_distribution<float> normal(0, deviation);
    features.planes.assign(1, Mask(64, 48));
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) {
        const float light = y > 20 && y < 24 ? 2.0f : x < 32 ? 0.3f : 0.8f;
        truth.set(x, y, vec3<float>(light));
        layers.object.set(x, y, vec3<float>(light + normal(random), light + normal(random), light + normal(random)));
        layers.object_variance.set(x, y, vec3<float>(deviation * deviation));
        layers.through.set(x, y, {}), layers.kept.set(x, y, {});
        features.planes[0].at(x, y) = x < 32 ? 0.0f : 4.0f;
      }
  }
  double error(const Image& image) const {
    double sum = 0;
    for (std::size_t i = 0; i < image.values.size(); ++i)
      sum += double(image.values[i] - truth.values[i]) * double(image.values[i] - truth.values[i]);
    return std::sqrt(sum / double(image.values.size()));
  }
};
}  // namespace

TEST_CASE("denoise: the error falls to a third, and what the features do not show stays, too", "[street][value]") {
  Noisy n(0.1f);
  const double before = n.error(n.layers.object);
  denoise(n.layers, n.features);
  record::claim("denoise: error by that before, a step and a stripe in noise", "law", "the picture without noise", 0.35,
                n.error(n.layers.object) / before, 64 * 48);
  CHECK(n.layers.object.at(31, 40).x == Approx(0.3).margin(0.06));
  CHECK(n.layers.object.at(32, 40).x == Approx(0.8).margin(0.06));
  CHECK(n.layers.object.at(10, 22).x == Approx(2).margin(0.12));
  CHECK(n.layers.object.at(10, 19).x == Approx(0.3).margin(0.12));
}
TEST_CASE("denoise: stripes two deviations apart, which single pixels cannot tell, stay", "[street][value]") {
  Noisy n(0.1f);
  std::mt19937 random(7);
  std::normal_distribution<float> normal(0, 0.1f);
  n.features.planes[0] = Mask(64, 48);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const float light = x / 6 % 2 ? 0.7f : 0.5f;
      n.truth.set(x, y, vec3<float>(light));
      n.layers.object.set(x, y, vec3<float>(light + normal(random), light + normal(random), light + normal(random)));
    }
  const double before = n.error(n.layers.object);
  denoise(n.layers, n.features);
  record::claim("denoise: error by that before, stripes two deviations apart", "law", "the picture without noise", 0.35,
                n.error(n.layers.object) / before, 64 * 48);
}
TEST_CASE("denoise: a lone bright pixel of much noise goes, one that is sure stays", "[street][value]") {
  for (const bool sure : {false, true}) {
    Noisy n(0.01f);
    n.layers.object.set(12, 12, vec3<float>(50));
    n.layers.object_variance.set(12, 12, vec3<float>(sure ? 1e-6f : 800.0f));
    denoise(n.layers, n.features);
    if (sure) CHECK(n.layers.object.at(12, 12).x > 20);
    else CHECK(n.layers.object.at(12, 12).x < 0.5f);
    CHECK(n.layers.object.at(14, 12).x < 0.5f);
  }
}
TEST_CASE("InsertLayers: kept is what is let through, its ground in the shadow", "[street][value]") {
  InsertLayers l(2, 1);
  l.through.set(0, 0, vec3<float>(0.5f)), l.ground.set(0, 0, vec3<float>(0.25f)), l.shadow.set(0, 0, vec3<float>(0.4f));
  l.lay_shadow();
  CHECK(l.kept.at(0, 0).x == Approx(0.25 + 0.25 * 0.4));
  CHECK(l.kept.at(1, 0).x == 1);
}
TEST_CASE("moment: drives, turns, comes in from the border, opens", "[street][value]") {
  const Placement start{-2, 9, 1.5707963f};
  const Moment far = moment(Trajectory::drive, 1, start, 6);
  CHECK(far.place.right == Approx(4));
  CHECK(far.place.ahead == Approx(9));
  CHECK(far.rolled == Approx(6));
  const Moment half = moment(Trajectory::rotate, 0.5f, start, 6);
  CHECK(std::cos(half.place.heading - start.heading) == Approx(-1));
  CHECK(half.place.right == start.right);
  CHECK(moment(Trajectory::rotate, 0.25f, {0, 9, 0}, 6).place.turn({1, 0, 0}).x == Approx(-1));  // to the left
  const Moment out = moment(Trajectory::occluded, 0, start, 4, 0.6f),
               in = moment(Trajectory::occluded, 1, start, 4, 0.6f);
  CHECK(out.place.right + 2 == Approx(-0.6 * 5.5));  // its nose is on the border
  CHECK(in.place.right == Approx(-0.6 * 5.5));
  CHECK(moment(Trajectory::doors, 0.4f, start, 6).opened == 0);
  CHECK(moment(Trajectory::doors, 0.6f, start, 6).opened == 1);
  CHECK(trajectory_of("occluded") == Trajectory::occluded);
  CHECK_FALSE(trajectory_of("fly"));
}
TEST_CASE("six_lights_panorama: each axis gets the irradiance asked for, and nothing else shines", "[street][value]") {
  const PanoramaSampler sky(six_lights_panorama({3, 2, 1}, 256));
  for (const vec3<float>& axis :
       {vec3<float>(0, 1, 0), vec3<float>(0, -1, 0), vec3<float>(1, 0, 0), vec3<float>(0, 0, -1)})
    CHECK(sky.irradiance(axis).x == Approx(3).epsilon(0.05));
  CHECK(sky.irradiance({0, 1, 0}).z == Approx(1).epsilon(0.02));
  CHECK(sky.radiance(normalize(vec3<float>(1, 1, 1))).x == 0);
}
