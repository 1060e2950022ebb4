// tests/light/panorama_sampler.cpp -- directions are drawn by the density that is said, and give the panorama's light
// SPDX-License-Identifier: Apache-2.0
#include <burnish/light/panorama_sampler.h>
#include <burnish_test.h>
#include <random>
#include <record.h>

using namespace burnish;

namespace {
/// A dim sky over dark ground, and a sun of one texel.
Image street() {
  Image p(128, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 128; ++x)
      p.set(x, y, y < 32 ? vec3<float>(0.4f, 0.5f, 0.7f) * (1 + 0.5f * std::sin(0.2f * float(x))) : vec3<float>(0.1f));
  p.set(40, 12, {3000, 2800, 2500});
  return p;
}
}  // namespace

TEST_CASE("PanoramaSampler: radiance / density over what it draws is the panorama's light", "[light][agreement]") {
  const float yaw = 0.7f;
  const PanoramaSampler sky(street(), yaw);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> u(0, 1);
  const vec3<float> n = normalize(vec3<float>(0.3f, 1, 0.2f));
  const int count = 200000;
  double drawn = 0;
  record::Worst apart;
  for (int i = 0; i < count; ++i) {
    const auto s = sky.sample({u(random), u(random)});
    REQUIRE(s.density > 0);
    apart(std::abs(double(sky.density(s.direction) / s.density) - 1) > 1e-3);
    const float cosine = dot(n, s.direction);
    if (cosine > 0) drawn += double(s.radiance.y * cosine / s.density) / count;
  }
  CHECK(apart.value == 0);  // that of the direction is that of the draw
  record::claim("PanoramaSampler: irradiance under a sun of one texel, drawn", "law", "quadrature", 0.01,
                std::abs(drawn / double(sky.irradiance(n).y) - 1), count);
}
TEST_CASE("PanoramaSampler: drawn for a plane, the same light, and hardly any from behind", "[light][agreement]") {
  const PanoramaSampler sky(street(), 2.1f);
  const vec3<float> n = normalize(vec3<float>(1, 0.3f, 0.2f));
  const PanoramaSampler::Table by = sky.facing(n);
  std::mt19937 random(2);
  std::uniform_real_distribution<float> u(0, 1);
  const int count = 200000;
  double drawn = 0, behind = 0;
  for (int i = 0; i < count; ++i) {
    const auto s = sky.sample({u(random), u(random)}, by);
    REQUIRE(sky.density(s.direction, by) == Approx(s.density).epsilon(1e-3));
    const float cosine = dot(n, s.direction);
    if (cosine > 0) drawn += double(s.radiance.y * cosine / s.density) / count;
    else behind += 1.0 / count;
  }
  record::claim("PanoramaSampler: irradiance, drawn for the plane", "law", "quadrature", 0.01,
                std::abs(drawn / double(sky.irradiance(n).y) - 1), count);
  CHECK(behind < 0.06);  // half of the tenth that is drawn evenly
}
TEST_CASE("PanoramaSampler: its density integrates to one, and the sun is where the panorama has it",
          "[light][value]") {
  const PanoramaSampler sky(street());
  double sum = 0;
  const int rows = 512;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < 2 * rows; ++x) {
      const vec3<double> d = latlong_direction((x + 0.5) / (2 * rows), (y + 0.5) / rows);
      sum += double(sky.density(vec3<float>(d))) * detail::texel_area(2 * rows, rows, y);
    }
  CHECK(sum == Approx(1).epsilon(1e-4));
  const vec3<float> sun(latlong_direction(40.5 / 128, 12.5 / 64));
  CHECK(sky.radiance(sun).x == Approx(3000).epsilon(1e-3));
  std::mt19937 random(3);
  std::uniform_real_distribution<float> u(0, 1);
  int near = 0;
  for (int i = 0; i < 1000; ++i) near += dot(sky.sample({u(random), u(random)}).direction, sun) > 0.995f;
  CHECK(near > 300);  // of the light nearly half is the sun's
}
TEST_CASE("PanoramaSampler: a black panorama is drawn from evenly", "[light][limit]") {
  const PanoramaSampler sky(Image(16, 8));
  CHECK(double(sky.density({0, 1, 0})) == Approx(0.0795775).epsilon(1e-3));
  CHECK(sky.sample({0.3f, 0.9f}).radiance.x == 0);
}
