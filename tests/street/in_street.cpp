// tests/street/in_street.cpp -- slopes of a street's picture by paint, light and sun, and all of it found again
// SPDX-License-Identifier: Apache-2.0
#include <burnish/fit/adam.h>
#include <burnish/fit/loss.h>
#include <burnish/street/in_street.h>
#include <burnish_test.h>
#include <differences.h>
#include <record.h>
#include <scene/shapes.h>

using namespace burnish;

namespace {
/// A blue sky over grey ground with a sun of half a degree to the right, ahead.
Image panorama() {
  Image p(256, 128);
  const vec3<double> sun = normalize(vec3<double>(0.6, 0.7, -0.3));
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 256; ++x) {
      const vec3<double> d = latlong_direction((x + 0.5) / 256, (y + 0.5) / 128);
      p.set(x, y, d.y > 0 ? vec3<float>(0.5f, 0.6f, 0.8f) * (1 + 0.5f * float(d.x)) : vec3<float>(0.2f));
      if (dot(d, sun) > std::cos(0.02)) p.set(x, y, {2200, 2000, 1700});
    }
  return p;
}
struct Street {
  EnvironmentLight sky{panorama()};
  Raycaster scene{shapes::sphere({0.2f, 0.8f, -6}, 0.8f, 32)};
  Camera camera = [] {
    Camera c = Camera::pinhole(70, 70, 48, 28, 96, 64);
    c.aim({0, 1.6f, 0}, {0, 1.2f, -6});
    return c;
  }();
  StreetPicture picture{plate(), scene, camera, sky};

  static Image plate() {
    Image p(96, 64);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 96; ++x) p.set(x, y, vec3<float>(0.3f + 0.05f * std::sin(0.4f * float(x + 2 * y))));
    return p;
  }
};
InStreet<float> truth(const StreetPicture& picture) {
  InStreet<float> m = picture.start();
  m.paint.base_color = {0.15f, 0.3f, 0.55f}, m.paint.base_metalness = 0.1f, m.paint.specular_roughness = 0.45f;
  m.paint.coat_weight = 0.7f;
  m.strength.sky = {0.6f, 0.6f, 0.6f}, m.strength.sun = {0.5f, 0.5f, 0.5f};
  return m;
}
}  // namespace

TEST_CASE("ground_shadow: open ground is as bright as ever, ground that sees nothing black", "[street][value]") {
  const LightStrength<double> s;
  const SunAngles<double> sun;
  CHECK(ground_shadow(s, sun, {}, {1, 1, 1}, {2, 2, 2}).x == Approx(1));
  CHECK(ground_shadow(s, sun, {{0, 0, 0}, 0}, {1, 1, 1}, {2, 2, 2}).x == 0);
  // A sun at 30 degrees of power 2 gives what the sky gives.
  const SunAngles<double> low{0.0, 0.5235987756};
  CHECK(ground_shadow(s, low, {{1, 1, 1}, 0}, {1, 1, 1}, {2, 2, 2}).y == Approx(0.5));
}
TEST_CASE("ground_shadow: right slopes by the strengths and the sun's height", "[street][gradient]") {
  using differences::between;
  vec3<float> sky_light, power;
  GroundSight sight;
  differences::holds(
      "ground_shadow", differences::Unrecorded{[&](const auto& strength, const auto& sun) {
        const auto c = ground_shadow(strength, sun, sight, sky_light, power);
        return c.x + 0.5f * c.y + 0.25f * c.z;
      }},
      [&](differences::Random& random) {
        const auto any = [&](double low, double high) { return float(between(random, low, high)); };
        sky_light = {any(0.5, 3), any(0.5, 3), any(0.5, 3)}, power = {any(0.5, 9), any(0.5, 9), any(0.5, 9)};
        sight = {{any(0, 1), any(0, 1), any(0, 1)}, any(0, 1)};
        const auto some = [&] {
          return vec3<double>(between(random, 0.1, 3), between(random, 0.1, 3), between(random, 0.1, 3));
        };
        return std::tuple(LightStrength<double>{some(), some()},
                          SunAngles<double>{between(random, -3, 3), between(random, 0.05, 1.5)});
      });
}
TEST_CASE("SunAngles: the direction's angles are the direction", "[street][value]") {
  for (const vec3<float>& d : {vec3<float>(0.3f, 0.5f, -0.6f), vec3<float>(-1, 0.1f, 0.2f), vec3<float>(0, 1, 0)})
    CHECK(length(sun_angles(normalize(d)).direction() - normalize(d)) < 1e-6f);
  differences::holds(
      "SunAngles",
      [](const auto& sun) {
        const auto d = sun.direction();
        return d.x + 0.5f * d.y + 0.25f * d.z;
      },
      [](differences::Random& random) {
        return std::tuple(
            SunAngles<double>{differences::between(random, -3, 3), differences::between(random, 0.05, 1.5)});
      });
}
TEST_CASE("StreetPicture: its gradient agrees with differences of the whole picture", "[street][gradient]") {
  const Street s;
  const InStreet<float> m = truth(s.picture);
  // A smooth loss: a fixed weight for every pixel.
  Image weight(96, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x)
      weight.set(x, y,
                 vec3<float>(std::sin(0.31f * float(x)), std::cos(0.17f * float(y)), std::sin(0.1f * float(x + y))));
  const auto loss = [&](const InStreet<float>& at) {
    const Image image = s.picture(at);
    double sum = 0;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 96; ++x) sum += double(dot(image.at(x, y), weight.at(x, y)));
    return sum;
  };
  const InStreet<float> d = s.picture.backward(m, weight);
  std::vector<float> slopes;
  for_each_parameter(d, [&](const std::string&, const float& x, Range) { slopes.push_back(x); });
  record::Worst worst;
  std::size_t k = 0;
  int compared = 0;
  for_each_parameter(m, [&](const std::string& name, const float&, Range range) {
    const std::size_t i = k++;
    const bool wanted = name.find("base_color") != name.npos || name.find("strength") == 0 || name.find("sun") == 0 ||
                        name.find("exposure") == 0 || name == "paint.coat_weight" || name == "paint.specular_roughness";
    if (!wanted) return;
    const float step = name.find("sun") == 0 ? 4e-3f : 0.01f * std::min(range.high - range.low, 1.0f);
    const auto moved = [&](float by) {
      InStreet<float> n = m;
      std::size_t j = 0;
      for_each_parameter(n, [&](const std::string&, float& x, Range) {
        if (j++ == i) x += by;
      });
      return loss(n);
    };
    const double slope = (moved(step) - moved(-step)) / (2 * double(step));
    const double far = (moved(2 * step) - moved(-2 * step)) / (4 * double(step));
    const double better = (4 * slope - far) / 3;  // Richardson
    worst(std::abs(double(slopes[i]) - better) / std::max(std::abs(better), 1.0));
    ++compared;
  });
  CHECK(compared == 16);
  record::claim("StreetPicture: slopes by paint, strengths, sun and exposure", "gradient",
                "Richardson differences in float", 5e-3, worst.value, compared);
}
TEST_CASE("StreetPicture: the same light twice gives the same picture; a darker sun lightens the shadow",
          "[street][value]") {
  const Street s;
  InStreet<float> m = s.picture.start();
  float darkest = 1;
  vec2<int> place;
  const Image full = s.picture(m);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x)
      if (const float k = full.at(x, y).x / s.picture.plate.at(x, y).x; s.picture.coverage.at(x, y) == 0 && k < darkest)
        darkest = k, place = {x, y};
  CHECK(darkest < 0.5f);
  m.strength.sun = vec3<float>(0.1f);
  CHECK(s.picture(m).at(place.x, place.y).x > full.at(place.x, place.y).x * 1.2f);
}
TEST_CASE("StreetPicture: paint, light and sun are found again in the picture", "[street][agreement]") {
  const Street s;
  const InStreet<float> want = truth(s.picture);
  const Image photo = s.picture(want);
  const Mask all(96, 64, 1);
  InStreet<float> m = want;
  m.paint.base_color = {0.4f, 0.4f, 0.4f};
  m.strength.sky = vec3<float>(1), m.strength.sun = vec3<float>(1);
  m.sun.azimuth += 0.15f, m.sun.elevation -= 0.12f;
  Adam adam;
  adam.rate = 0.002f;
  double first = 0, last = 0;
  for (int step = 0; step < 700; ++step) {
    if (step == 450) adam.rate = 0.0003f;
    const auto [loss, d_image] = masked_l1(s.picture(m), photo, all);
    InStreet<float> d = s.picture.backward(m, d_image);
    for_each_parameter(d, [](const std::string& name, float& x, Range) {
      if (name.find("base_color") == name.npos && name.find("strength") != 0 && name.find("sun") != 0) x = 0;
    });
    adam.step(m, d);
    (step == 0 ? first : last) = loss;
  }
  CHECK(last < 0.05 * first);
  const float turn = std::acos(std::clamp(dot(m.sun.direction(), want.sun.direction()), -1.0f, 1.0f)) * 57.29578f;
  record::claim("StreetPicture: the sun found again from 10 degrees off, degrees", "law", "the sun it was drawn with",
                0.5, double(turn), 1);
  CHECK(length(m.paint.base_color - want.paint.base_color) < 0.04f);
  CHECK(m.strength.sun.x == Approx(0.5f).margin(0.05));
  CHECK(m.strength.sky.x == Approx(0.6f).margin(0.05));
}
