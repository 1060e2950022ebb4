// tests/light/environment.cpp -- the laws of burnish/light/environment.h and pyramid.h
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include <burnish/light/pyramid.h>
#include <record.h>
#include "reference.h"
using namespace burnish;
constexpr double half_turn = reference::pi;

namespace {
/// Random texels; `sun` of them very bright.
Image noise(int width, int height, int sun = 0) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> any(0, 1);
  Image p(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) p.set(x, y, {any(random), any(random), any(random)});
  for (int i = 0; i < sun; ++i) p.set(width / 3 + i % 3, height / 4 + i / 3, {9000, 8000, 6000});
  return p;
}
/// Radiance x solid angle, summed over the texels of the file itself.
vec3<double> energy(const Image& p) {
  vec3<double> sum;
  for (int y = 0; y < p.height; ++y) {
    const double area =
        (std::cos(half_turn * y / p.height) - std::cos(half_turn * (y + 1) / p.height)) * 2 * half_turn / p.width;
    for (int x = 0; x < p.width; ++x) sum += vec3<double>(p.at(x, y)) * area;
  }
  return sum;
}
vec3<double> random_direction(std::mt19937& random) {
  std::normal_distribution<double> any;
  const double x = any(random), y = any(random), z = any(random);
  return normalize(vec3<double>(x, y, z));
}
vec3<float> narrow(const vec3<double>& d) { return vec3<float>(d); }
}  // namespace

TEST_CASE("latlong: leads there and back, at the poles and the seam too", "[light][limit]") {
  std::vector<vec3<double>> all = {{0, 1, 0}, {0, -1, 0}, {0, 0, -1}, {-1e-12, 0, -1}, {1e-12, 1, 0}, {-0.0, 0, -1}};
  std::mt19937 random(1);
  while (int(all.size()) < record::points()) all.push_back(random_direction(random));
  double worst = 0;
  for (const vec3<double>& d : all) {
    const vec2<double> uv = latlong(d);
    const double error = length(latlong_direction(uv.x, uv.y) - d);
    worst = uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1 && std::isfinite(error) ? std::max(worst, error) : 1e30;
  }
  record::claim("latlong, latlong_direction", "value", "there and back, poles and seam", 1e-11, worst, long(all.size()));
}

TEST_CASE("EnvironmentLight: a panorama of any size keeps its energy, suns and map together", "[light][energy]") {
  for (const auto& [w, h] : {std::pair(64, 32), {100, 50}, {301, 77}, {1500, 700}, {8, 4}}) {
    CAPTURE(w, h);
    const Image p = noise(w, h, h > 30 ? 9 : 0);
    const vec3<double> in = energy(p), out = EnvironmentLight(p).energy();
    CHECK(out.x == Approx(in.x).epsilon(1e-5));
    CHECK(out.y == Approx(in.y).epsilon(1e-5));
    CHECK(out.z == Approx(in.z).epsilon(1e-5));
  }
}

TEST_CASE("EnvironmentLight: a bright patch becomes one sun of its power, place and colour", "[light][value]") {
  Image p(1024, 512, {0.2f, 0.3f, 0.4f});
  p.set(255, 200, {5000, 4000, 3000});  // u = .25: +X
  p.set(256, 200, {5000, 4000, 3000});
  const EnvironmentLight e(p);
  REQUIRE(e.suns.size() == 1);
  const Sun<float>& s = e.suns[0];
  const double area = 2 * half_turn / 1024 * (std::cos(half_turn * 200 / 512) - std::cos(half_turn * 201 / 512));
  CHECK(s.power.x == Approx(2 * 5000 * area).epsilon(2e-3));
  CHECK(s.power.z / s.power.x == Approx(0.6).epsilon(1e-5));
  const double azimuth = 2 * half_turn * 256 / 1024, polar = half_turn * 200.5 / 512;
  CHECK(s.direction.x == Approx(std::sin(polar) * std::sin(azimuth)).margin(1e-4));
  CHECK(s.direction.y == Approx(std::cos(polar)).margin(1e-4));
  CHECK(s.direction.z == Approx(-std::sin(polar) * std::cos(azimuth)).margin(1e-4));
  // Two tents side by side, per axis, meaned over both: h^2/6 plus h^2/4 along one axis.
  const double h = half_turn / 512;
  CHECK(s.variance == Approx(h * h / 6 + h * h / 8).epsilon(0.1));
  CHECK(e.map.at(255, 200).x < 20);
}

TEST_CASE("EnvironmentLight: an even or black panorama, or none, has no sun", "[light][limit]") {
  CHECK(EnvironmentLight(Image(64, 32, vec3<float>(2))).suns.empty());
  CHECK(EnvironmentLight(Image(64, 32)).suns.empty());
  CHECK(EnvironmentLight().suns.empty());
  CHECK(EnvironmentLight(Image()).energy().x == 0);
}

TEST_CASE("EnvironmentLight: texels that are negative or no numbers count as black", "[light][limit]") {
  Image p(64, 32, vec3<float>(1));
  p.set(3, 4, {-1, std::nanf(""), std::numeric_limits<float>::infinity()});
  const EnvironmentLight e(p);
  CHECK(e.map.at(3, 4).x == 0);
  CHECK(e.map.at(3, 4).y == 0);
  CHECK(e.map.at(3, 4).z == 0);
  CHECK(std::isfinite(e.energy().z));
}

TEST_CASE("EnvironmentLight: yaw turns suns and map alike, -Z towards -X", "[light][symmetry]") {
  const vec3<double> t = turned(vec3<double>(0, 0, -1), half_turn / 2);
  CHECK(t.x == Approx(-1));
  CHECK(t.z == Approx(0).margin(1e-12));
  const Image p = noise(256, 128, 6);
  const EnvironmentLight straight(p), yawed(p, 1.1f);
  const Pyramid a(straight), b(yawed);
  REQUIRE(straight.suns.size() == yawed.suns.size());
  for (std::size_t i = 0; i < straight.suns.size(); ++i) {
    const vec3<double> d =
        turned(vec3<double>(straight.suns[i].direction), double(yawed.yaw)) - vec3<double>(yawed.suns[i].direction);
    CHECK(length(d) < 1e-6);
  }
  std::mt19937 random(2);
  for (int i = 0; i < 200; ++i) {
    const vec3<double> d = random_direction(random);
    const float variance = i % 2 ? 0.0f : 0.002f;
    CHECK(b.fetch(narrow(turned(d, double(yawed.yaw))), variance).x ==
          Approx(a.fetch(narrow(d), variance).x).margin(1e-3));
  }
}

TEST_CASE("Pyramid: at a texel's centre it is the texel, at variance 0", "[light][value]") {
  const EnvironmentLight e(noise(64, 32));
  const Pyramid sky(e);
  for (int i = 0; i < 500; ++i) {
    const int x = (i * 37) % 64, y = (i * 11) % 32;
    const vec3<float> a = sky.fetch(narrow(latlong_direction((x + 0.5) / 64, (y + 0.5) / 32)), 0), b = e.map.at(x, y);
    CHECK(a.x == Approx(b.x).margin(2e-4));
    CHECK(a.z == Approx(b.z).margin(2e-4));
  }
}

TEST_CASE("Pyramid: there is no step at the seam, at the poles or between levels", "[light][limit]") {
  const Pyramid sky(EnvironmentLight(noise(128, 64), 0.3f));
  const double step = 1e-5;
  for (const float variance : {0.0f, 1e-3f, 1e-2f, 0.3f, 4.0f}) {
    CAPTURE(variance);
    double most = 0;
    for (int i = 0; i < 64; ++i) {
      for (const double seam : {0.0, 0.3 / (2 * half_turn), 1 - 0.3 / (2 * half_turn)}) {
        const auto at = [&](double u) { return sky.fetch(narrow(latlong_direction(u, (i + 0.5) / 64)), variance).y; };
        most = std::max(most, double(std::abs(at(seam - step) - at(seam + step))));
      }
      for (const double pole : {1e-5, 1 - 1e-5}) {  // from every side the same
        const auto at = [&](double u) { return sky.fetch(narrow(latlong_direction(u, pole)), variance).y; };
        most = std::max(most, double(std::abs(at(i / 64.0) - at(0.37))));
      }
    }
    CHECK(most < 5e-3);
  }
  const vec3<float> d = narrow(reference::unit_of({0.3f, 0.2f, -0.8f}));
  float before = sky.fetch(d, 1e-5f).x;
  for (double v = 1e-5; v < 3; v *= 1.01) {
    const float now = sky.fetch(d, float(v)).x;
    CHECK(std::abs(now - before) < 0.01f);
    before = now;
  }
}

TEST_CASE("Pyramid: its kernel dims the first band as two Gaussians on the sphere do", "[light][value]") {
  // The heat kernel of variance s2 an axis multiplies band l by exp(-l (l + 1) s2 / 2): closed form. At the levels'
  // own variances.
  const auto L = [](const vec3<double>& d) { return 1 + 0.5 * d.y + 0.4 * d.x; };
  const Pyramid sky(EnvironmentLight(reference::panorama(L, 64), 0, false));
  std::mt19937 random(4);
  double worst = 0;
  for (int level = 1; level < 5; ++level) {
    const double s2 = std::pow(half_turn / 64, 2) * std::pow(4, level - 1),
                 dim = (4 * std::exp(-s2) - std::exp(-4 * s2)) / 3;
    for (int i = 0; i < 100; ++i) {
      const vec3<double> d = random_direction(random);
      worst = std::max(worst, std::abs(sky.fetch(narrow(d), float(s2)).x - (1 + dim * (L(d) - 1))));
    }
  }
  record::claim("Pyramid::fetch", "value", "heat kernel on the first band", 0.02, worst, 400);
}
TEST_CASE("Pyramid: an even sky is even at every width", "[light][energy]") {
  const Pyramid sky(EnvironmentLight(Image(64, 32, {0.5f, 1, 2})));
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i) {
    const vec3<float> c = sky.fetch(narrow(random_direction(random)), float(std::pow(10, -6 + 0.025 * i)));
    CHECK(c.x == Approx(0.5).epsilon(1e-5));
    CHECK(c.z == Approx(2).epsilon(1e-5));
  }
}
