// tests/light/sky.cpp -- the laws of burnish/light/sky.h
// SPDX-License-Identifier: Apache-2.0
#include <burnish/light/sky.h>
#include <differences.h>
#include "reference.h"
using namespace differences;

namespace {
/// Any of bands 0 to 4.
double soft(const vec3<double>& d) {
  return 2 + d.y - 0.5 * d.x + 0.7 * d.x * d.z + 0.4 * (3 * d.y * d.y - 1) + 0.3 * d.x * d.y * d.z +
         0.2 * (std::pow(d.x, 4) - 6 * d.x * d.x * d.z * d.z + std::pow(d.z, 4));
}
}  // namespace

TEST_CASE("HarmonicSky: bands that an environment has are found and given back", "[light][value]") {
  for (const float yaw : {0.0f, 0.8f}) {
    const auto sky = project_sky<HarmonicSky4>(EnvironmentLight(reference::panorama(soft, 128), yaw));
    for (int i = 0; i < 200; ++i) {
      const vec3<double> d = latlong_direction(std::fmod(i * 0.618, 1), (i + 0.5) / 200);
      CHECK(sky_radiance(sky, vec3<float>(turned(d, double(yaw)))).x == Approx(soft(d)).margin(3e-3));
    }
  }
}

TEST_CASE("HarmonicSky: irradiances are those of the hemisphere's quadrature", "[light][value]") {
  const auto sky = project_sky<HarmonicSky4>(EnvironmentLight(reference::panorama(soft, 128)));
  for (int i = 0; i < 12; ++i) {
    const vec3<double> n = latlong_direction(std::fmod(i * 0.618, 1), (i + 0.5) / 12);
    const auto e = reference::irradiance(soft, n, 200);
    CHECK(sky_irradiance(sky, vec3<float>(n)).y == Approx(e[0]).epsilon(1e-3));
    CHECK(sky_irradiance<1>(sky, vec3<float>(n)).y == Approx(e[1]).epsilon(2e-3));
    CHECK(sky_irradiance<2>(sky, vec3<float>(n)).y == Approx(e[2]).epsilon(3e-3));
  }
}

TEST_CASE("HarmonicSky: the cosine's bands are Ramamoorthi and Hanrahan's pi, 2 pi/3, pi/4, 0, -pi/24",
          "[light][value]") {
  const double known[5] = {1, 2.0 / 3, 0.25, 0, -1.0 / 24};
  for (int l = 0; l < 5; ++l) CHECK(detail::zonal(l, 0) == Approx(reference::pi * known[l]).margin(1e-6));
  CHECK(detail::zonal(0, 5) == Approx(2 * reference::pi / 42));
  CHECK(detail::zonal(0, 10) == Approx(2 * reference::pi / 132));
}

TEST_CASE("HarmonicSky: it starts as an even sky of radiance 1", "[light][value]") {
  CHECK(sky_radiance(HarmonicSky2<float>{}, vec3<float>(0, 1, 0)).x == Approx(1));
  CHECK(sky_irradiance(HarmonicSky4<float>{}, vec3<float>(0, 0, 1)).y == Approx(reference::pi));
}

TEST_CASE("HarmonicSky: suns enter the projection when asked for, with all their power", "[light][energy]") {
  Image p(128, 64, vec3<float>(0.1f));
  p.set(40, 10, vec3<float>(5000));
  const EnvironmentLight e(p);
  REQUIRE(e.suns.size() == 1);
  const double whole = e.energy().x, found = project_sky<HarmonicSky2>(e, true).l0m0.x * std::sqrt(4 * reference::pi);
  CHECK(found == Approx(whole).epsilon(1e-4));
  CHECK(project_sky<HarmonicSky2>(e).l0m0.x * std::sqrt(4 * reference::pi) ==
        Approx(whole - e.suns[0].power.x).epsilon(1e-4));
}

TEST_CASE("HarmonicSky: one value in every number, and right slopes by coefficients and direction",
          "[light][gradient]") {
  const auto long_enough = [](const auto&, const auto& d) { return length(d) > 0.3; };
  const auto poles = [](auto sky) {
    using Point = std::tuple<decltype(sky), vec3<double>>;
    return Hard<Point>{"poles, seam, a zero-length vector",
                       {Point{sky, {0, 1, 0}}, Point{sky, {0, -1, 0}}, Point{sky, {0, 0, -1}}, Point{sky, {0, 0, 1}}},
                       {Point{sky, {0, 0, 0}}}};
  };
  const HarmonicSky2<double> two;
  const HarmonicSky4<double> four;
  holds(
      "sky_radiance, HarmonicSky2", [](const auto& s, const auto& d) { return sky_radiance(s, normalize(d)); },
      within(long_enough, two, vec3<double>()), {}, poles(two));
  holds(
      "sky_irradiance, HarmonicSky4", [](const auto& s, const auto& d) { return sky_irradiance(s, normalize(d)); },
      within(long_enough, four, vec3<double>()), {}, poles(four));
  holds(
      "sky_irradiance, HarmonicSky2", [](const auto& s, const auto& d) { return sky_irradiance<2>(s, normalize(d)); },
      within(long_enough, two, vec3<double>()), {}, poles(two));
  holds("turned", [](const auto& d, const auto& yaw) { return turned(d, yaw); }, within(anywhere, vec3<double>(), 0.0),
        {}, {"no turn", {{{0, 1, 0}, 0.0}, {{0, 0, -1}, 0.0}}});
}
