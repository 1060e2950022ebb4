// tests/light/visibility.cpp -- what is blocked: of the rings, the hemisphere and the suns
// SPDX-License-Identifier: Apache-2.0
#include <mutex>
#include <burnish_test.h>
#include <burnish/light/illuminate.h>
#include <record.h>
#include "reference.h"
using namespace burnish;
using reference::Surfels;

namespace {
double soft(const vec3<double>& d) { return 1 + 0.6 * d.y + 0.3 * d.x; }
EnvironmentLight light_of(double (*L)(const vec3<double>&)) {
  return EnvironmentLight(reference::panorama(L, 64), 0, false);
}
const auto everything = [](int, auto, auto out) { std::fill(out.begin(), out.end(), std::uint8_t(1)); };
const auto nothing = [](int, auto, auto) {};

std::vector<float> all(const Illumination& light) {
  std::vector<float> y;
  for (int i = 0; i < light.size(); ++i) {
    float t[12], e[9];
    for (const float r : {0.02f, 0.1f, 0.5f, 1.0f}) light.table(float(i), r, 12, t), y.insert(y.end(), t, t + 12);
    light.irradiance(float(i), e), y.insert(y.end(), e, e + 9);
    for (int s = 0; s < light.suns(); ++s) y.push_back(light.sun_visibility(float(i), float(s)));
  }
  return y;
}
}  // namespace

TEST_CASE("Visibility: where nothing is blocked it changes nothing", "[light][limit]") {
  const Surfels s(40, 0.1);
  const EnvironmentLight e = light_of(soft);
  CHECK(all(Illumination(e, s)) == all(Illumination(e, s, nothing)));
}

TEST_CASE("Visibility: where all is blocked it is black, suns too", "[light][limit]") {
  EnvironmentLight e = light_of(soft);
  e.suns.resize(2);
  for (const float y : all(Illumination(e, Surfels(20, 0.1), everything))) CHECK(y == 0);
}

TEST_CASE("Visibility: where all is blocked by an even grey, it is that grey's even sky", "[light][energy]") {
  const Surfels s(20, 0.1);
  Illumination::Options grey;
  grey.occluded = {0.25f, 0.5f, 0.75f};
  const std::vector<float> a = all(Illumination(light_of(soft), s, everything, grey)),
                           b = all(Illumination(EnvironmentLight(Image(32, 16, grey.occluded)), s));
  REQUIRE(a.size() == b.size());
  for (std::size_t k = 0; k < a.size(); ++k) CHECK(a[k] == Approx(b[k]).epsilon(5e-3).margin(1e-5));
}

TEST_CASE("Visibility: half of the world blocked is the quadrature over the other half", "[light][value]") {
  // The edge falls between directions wherever it likes: what the fixed directions resolve, no more.
  const Surfels s(24, 0.2);
  const vec3<double> side = normalize(vec3<double>(0.7, 0.2, -0.5));
  const Illumination light(light_of(soft), s, [&](int, auto d, auto out) {
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = dot(vec3<double>(d[k]), side) < 0;
  });
  const auto half = [&](const vec3<double>& d) { return dot(d, side) < 0 ? 0 : soft(d); };
  double worst[3] = {}, specular = 0, rms = 0;
  for (int i = 0; i < s.size(); ++i) {
    const vec3<double> n = reference::unit_of(s.at(i).normal), v = reference::unit_of(s.at(i).view);
    const auto truth = reference::irradiance(half, n, 100);
    const double even[3] = {reference::pi, 2 * reference::pi / 42, 2 * reference::pi / 132};
    double e[9], y[12];
    light.irradiance(double(i), e);
    for (int k = 0; k < 3; ++k) worst[k] = std::max(worst[k], std::abs(e[3 * k] - truth[k]) / even[k]);
    for (const double r : {0.3, 0.6, 1.0}) {
      light.table(double(i), r, 12, y);
      const auto t = reference::specular(half, n, v, r, 1 << 13);
      const double off = std::abs(y[0] + y[3] - t[0] - t[1]);
      specular = std::max(specular, off), rms += off * off / (3 * s.size());
    }
  }
  const std::string against = "quadrature over the open half, of an even sky's";
  record::claim("Illumination, half the world blocked", "irradiance", against, 0.03, worst[0], s.size());
  record::claim("Illumination, half the world blocked", "irradiance x(nl)", against, 0.04, worst[1], s.size());
  record::claim("Illumination, half the world blocked", "irradiance x(nl)^2", against, 0.04, worst[2], s.size());
  record::claim("Illumination, half the world blocked", "value, worst", against, 0.05, specular, 3L * s.size());
  record::claim("Illumination, half the world blocked", "value, rms", against, 0.02, std::sqrt(rms), 3L * s.size());
}

TEST_CASE("Visibility: a sun half covered shines with half its strength, and each by its own", "[light][value]") {
  EnvironmentLight e(Image(32, 16));
  for (const float x : {0.0f, 1.0f}) {
    Sun<float> sun;
    sun.direction = x == 0 ? vec3<float>(0, 1, 0) : vec3<float>(1, 0, 0);
    sun.variance = 1e-3f;
    sun.index = x;
    e.suns.push_back(sun);
  }
  const Illumination light(e, Surfels(17, 0.1), [](int i, auto d, auto out) {
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = i < 8 ? d[k].z > 0 : d[k].y > 0.5f;
  });
  for (int i = 0; i < 17; ++i) {
    CHECK(light.sun_visibility(float(i), 0.0f) == Approx(i < 8 ? 0.5 : 0).margin(0.07));
    CHECK(light.sun_visibility(float(i), 1.0f) == Approx(i < 8 ? 0.5 : 1).margin(0.07));
  }
}

TEST_CASE("Visibility: each surfel is asked once, for unit directions above its horizon and around the suns",
          "[light][cost]") {
  const Surfels s(21, 0.1);
  EnvironmentLight e = light_of(soft);
  e.suns.resize(1);
  std::vector<int> asked(21);
  std::mutex mutex;
  int below = 0, not_unit = 0;
  std::size_t most = 0;
  const Illumination light(e, s, [&](int i, auto d, auto out) {
    const std::lock_guard lock(mutex);
    ++asked[i];
    most = std::max(most, d.size());
    REQUIRE(out.size() == d.size());
    for (std::size_t k = 0; k < d.size(); ++k) {
      not_unit += std::abs(dot(d[k], d[k]) - 1) > 1e-4f;
      below += k + Illumination::sun_rays < d.size() && dot(d[k], s.at(i).normal) < -1e-4f;
    }
  });
  CHECK(asked == std::vector<int>(21, 1));
  CHECK(below == 0);
  CHECK(not_unit == 0);
  CHECK(most < 500);
}
