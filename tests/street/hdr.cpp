// tests/street/hdr.cpp -- light found again in panoramas that we made, and clipped
// SPDX-License-Identifier: Apache-2.0
#include <burnish/street/expose.h>
#include <burnish/street/hdr.h>
#include <burnish/street/light_field.h>
#include <burnish_test.h>
#include <record.h>

using namespace burnish;

namespace {
constexpr double degree = 0.017453292519943295;
vec3<double> at(double elevation, double azimuth) {
  return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), -std::cos(elevation) * std::cos(azimuth)};
}
/// Hosek and Wilkie's sky with the sun's disc in it, over a grey ground of that albedo and, towards one side, a row of
/// houses. Radiance in kcd/m^2.
Image clear_street(const vec3<double>& sun, double turbidity, double albedo = 0.12) {
  Image p(512, 256);
  HosekWilkieSky<double> s;
  s.turbidity = turbidity, s.albedo = albedo, s.sun = sun;
  const auto lobes = hosek_wilkie_lobes(s);
  const vec3<double> disc = sun_irradiance(turbidity, sun);
  vec3<double> down = disc * sun.y;
  double area = 0;
  const double radius = std::cos(0.012);
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 512; ++x) {
      const vec3<double> d = latlong_direction((x + 0.5) / 512, (y + 0.5) / 256);
      const vec3<double> l = clear_sky_radiance(lobes, d) * 0.683;
      p.set(x, y, vec3<float>(l));
      down += l * (d.y * detail::texel_area(512, 256, y));
      if (dot(d, sun) > radius) area += detail::texel_area(512, 256, y);
    }
  }
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 512; ++x) {
      const vec3<double> d = latlong_direction((x + 0.5) / 512, (y + 0.5) / 256);
      if (y >= 128) p.set(x, y, vec3<float>(down * (albedo / 3.14159265)));
      else if (dot(d, sun) > radius) p.set(x, y, p.at(x, y) + vec3<float>(disc / area));
      // Houses 10 to 16 degrees high, dark and brown, with windows.
      const double high = 10 + 3 * (1 + (x / 40) % 3);
      if (y < 128 && x > 100 && x < 330 && std::asin(d.y) < high * degree)
        p.set(x, y, vec3<float>(down * 0.02) * vec3<float>(1, 0.85f, 0.7f) * ((x / 6 + y / 4) % 2 ? 1.0f : 0.6f));
    }
  }
  return p;
}
/// A room: a ceiling, walls and a floor of warm white, a window that shines.
Image room() {
  Image p(256, 128);
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 256; ++x) {
      const double up = 90 - (y + 0.5) * 180 / 128;
      const float v = up > 35 ? 0.5f : up > -30 ? 0.4f : 0.3f;
      p.set(x, y, vec3<float>(v, 0.9f * v, 0.75f * v));
      if (x > 60 && x < 110 && up > -5 && up < 30) p.set(x, y, vec3<float>(9));
    }
  }
  return p;
}
double irradiance(const Image& p, const vec3<double>& n) {
  double sum = 0;
  for (int y = 0; y < p.height; ++y) {
    for (int x = 0; x < p.width; ++x) {
      const double c = dot(latlong_direction((x + 0.5) / p.width, (y + 0.5) / p.height), n);
      if (c > 0) sum += c * double(luminance(p.at(x, y))) * detail::texel_area(p.width, p.height, y);
    }
  }
  return sum;
}
}  // namespace

TEST_CASE("estimate_hdr: a clear street's sun, haze and light are found again", "[street][value]") {
  record::Worst direction, turbidity, light, plain;
  int n = 0;
  for (const auto& [high, azimuth, haze] : {std::tuple{50.0, 2.0, 3.0}, {30.0, -1.0, 2.5}, {40.0, 0.3, 4.5}}) {
    const vec3<double> sun = at(high * degree, azimuth);
    const Image truth = clear_street(sun, haze);
    const float exposure = metered_exposure(truth, 0.15f);
    const Image ldr = photographed(truth, exposure);
    const HdrPanorama found = estimate_hdr(ldr);
    REQUIRE(found.kind == SkyKind::sunny);
    direction(std::acos(std::min(1.0, dot(vec3<double>(found.sun_direction), sun))) / degree);
    turbidity(std::fabs(std::log(found.sky.sky.turbidity / haze)));
    CHECK(found.sky.residual < 0.05);
    for (const vec3<double>& normal : {vec3<double>(0, 1, 0), {1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}}) {
      const double want = irradiance(truth, normal) * double(exposure);
      light(std::fabs(irradiance(found.panorama, normal) / want - 1));
      plain(std::fabs(irradiance(ldr, normal) / want - 1));
      ++n;
    }
  }
  record::claim("estimate_hdr, the sun's direction, degrees", "law", "a sky that we made", 1, direction.value, 3);
  record::claim("estimate_hdr, ln turbidity", "law", "a sky that we made", 0.2, turbidity.value, 3);
  record::claim("estimate_hdr, irradiance of five planes", "law", "a sky that we made", 0.1, light.value, n);
  CHECK(plain.value > 0.5);  // and the clipped panorama has lost most of it
}
TEST_CASE("estimate_hdr: what is not clipped stays as it is", "[street][symmetry]") {
  const Image truth = clear_street(at(0.7, 1), 3), ldr = photographed(truth, metered_exposure(truth, 0.35f));
  const HdrPanorama found = estimate_hdr(ldr);
  const double disc = std::cos(0.05);
  int raised = 0;
  for (int y = 0; y < ldr.height; ++y) {
    for (int x = 0; x < ldr.width; ++x) {
      const vec3<float> a = ldr.at(x, y), b = found.panorama.at(x, y);
      const bool clipped = std::max({a.x, a.y, a.z}) >= clipped_from;
      if (dot(latlong_direction((x + 0.5) / ldr.width, (y + 0.5) / ldr.height), vec3<double>(found.sun_direction)) >
          disc)
        continue;
      if (!clipped || y > 130) REQUIRE((a.x == b.x && a.y == b.y && a.z == b.z));
      else raised += b.x >= a.x && b.y >= a.y && b.z >= a.z;
    }
  }
  CHECK(raised > 0);
}
TEST_CASE("find_sky: houses and the ground are none of it, all of the open sky is", "[street][value]") {
  const Image truth = clear_street(at(0.7, 4), 3), ldr = photographed(truth, metered_exposure(truth, 0.15f));
  const SkyMask m = find_sky(ldr);
  int wrong = 0, all = 0;
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 512; ++x) {
      const double up = std::asin(latlong_direction((x + 0.5) / 512, (y + 0.5) / 256).y) / degree;
      const bool house = x > 100 && x < 330 && up < 10 + 3 * (1 + (x / 40) % 3);
      if (std::fabs(up) < 1.5) continue;  // the horizon's rows
      wrong += (m.sky.at(x, y) > 0.5f) != (up > 0 && !house), ++all;
    }
  }
  CHECK(wrong < all / 200);
  CHECK(m.evidence > 0);
}
TEST_CASE("estimate_hdr: a room has no sky and is given back as it is", "[street][limit]") {
  const Image ldr = photographed(room(), 1);
  const HdrPanorama found = estimate_hdr(ldr);
  CHECK(found.kind == SkyKind::none);
  CHECK(found.mask.evidence < 0);
  CHECK(found.sun_irradiance.x == 0);
  CHECK(std::equal(ldr.values.begin(), ldr.values.end(), found.panorama.values.begin()));
}
TEST_CASE("estimate_hdr: an even grey sky has no sun", "[street][limit]") {
  Image ldr(256, 128, {0.1f, 0.08f, 0.06f});
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 256; ++x) ldr.set(x, y, {0.6f, 0.63f, 0.68f});
  }
  const HdrPanorama found = estimate_hdr(ldr);
  CHECK(found.kind == SkyKind::cloudy);
  CHECK(found.sun_irradiance.x == 0);
  CHECK(found.sun_sigma > 0.2);
}
TEST_CASE("estimate_hdr, compose_hdr: a picture that is no panorama is refused", "[street][limit]") {
  CHECK_THROWS_WITH(estimate_hdr(Image(100, 100)),
                    "panorama: 100 x 100, expected a lat-long panorama twice as wide as high");
  CHECK_THROWS_WITH(compose_hdr(Image(64, 32), Image(4, 4)),
                    "HDR prediction: 4 x 4, expected a lat-long panorama twice as wide as high");
}
TEST_CASE("compose_hdr: the prediction's sky, aligned, over the panorama's street", "[street][value]") {
  const Image truth = clear_street(at(0.7, 4), 3);
  const float exposure = metered_exposure(truth, 0.15f);
  const Image ldr = photographed(truth, exposure), out = compose_hdr(ldr, truth);  // in other units, by far
  record::Worst sky;
  const vec3<double> up(0, 1, 0);
  sky(std::fabs(irradiance(out, up) / (irradiance(truth, up) * double(exposure)) - 1));
  record::claim("compose_hdr, irradiance of the ground", "law", "the prediction is the truth", 0.02, sky.value, 1);
  for (int y = 140; y < 256; y += 10) CHECK(out.at(7, y).y == ldr.at(7, y).y);
}
TEST_CASE("LightField: the nearest panorama serves", "[street][value]") {
  LightField<EnvironmentLight> field;
  CHECK_THROWS_WITH(field.nearest({0, 0, 0}), "a light field without panoramas, expected one at least");
  for (int i = 0; i < 4; ++i)
    field.lights.push_back({{10.0f * float(i), 1, 0}, EnvironmentLight(Image(32, 16, vec3<float>(float(i + 1))))});
  CHECK(field.nearest({12, 0, 3}).position.x == 10);
  CHECK(field.nearest({1000, 0, 0}).position.x == 30);
  CHECK(field.nearest({5, 1, 0}).position.x == 0);  // as near as the next: the first
}
TEST_CASE("six_lights: a cube is lit alike on all sides, and as brightly as asked", "[street][symmetry]") {
  const EnvironmentLight six = six_lights({2, 3, 4});
  REQUIRE(six.suns.size() == 6);
  for (const vec3<float>& n : {vec3<float>(1, 0, 0), {0, -1, 0}, {0, 0, 1}}) {
    float sum = 0;
    for (const Sun<float>& s : six.suns) sum += std::max(dot(s.direction, n), 0.0f) * s.power.y;
    CHECK(sum == 3);
  }
  for (int i = 0; i < 6; ++i) CHECK(six.suns[std::size_t(i)].index == float(i));
  const EnvironmentLight sky(Image(64, 32, vec3<float>(0.5f)));
  CHECK(six_lights(sky).energy().x == Approx(sky.energy().x).epsilon(1e-5));
}
