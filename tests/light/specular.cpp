// tests/light/specular.cpp -- how right the environment's specular light is, value and slope by roughness
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include <record.h>
#include "places.h"
using namespace burnish;

namespace {
places::Errors of(const Image& picture) {
  const EnvironmentLight e(picture);
  const places::Surfels s{specular_reference::views(40)};
  return places::errors(Illumination(e, s), e.suns, s, picture, [](int, double, double truth) { return truth; });
}
}  // namespace

TEST_CASE("Illumination: under a sky with a sun it is the quadrature to 2 %, its slope by roughness of the right sign",
          "[light][value]") {
  const places::Errors e = of(places::sky_with_sun());
  record::claim("Illumination, a sky with a sun", "value", "quadrature in double, rms", 0.02, e.rms, e.points);
  record::claim("Illumination, a sky with a sun", "sign of the slope by roughness", "quadrature in double, share", 0.01,
                e.wrong, e.points);
}
TEST_CASE("Illumination: between windows and lamps it is the quadrature to 3.5 %, its slope of the right sign",
          "[light][value]") {
  const places::Errors e = of(places::room());
  record::claim("Illumination, windows and lamps", "value", "quadrature in double, rms", 0.035, e.rms, e.points);
  record::claim("Illumination, windows and lamps", "sign of the slope by roughness", "quadrature in double, share",
                0.01, e.wrong, e.points);
}
TEST_CASE("Lamps: with the rest of the map they are its light, the rest nowhere above the threshold",
          "[light][energy]") {
  const EnvironmentLight e(
      reference::panorama([](const vec3<double>& d) { return d.x > 0.9    ? 12.0
                                                             : d.z > 0.95 ? 3.0
                                                                          : 0.3; }, 128), 0.7f,
      false);
  const Lamps lamps(e);
  vec3<double> sum = lamps.rest.energy();
  for (const Lamp& l : lamps.all) sum += vec3<double>(l.power);
  record::claim("Lamps", "law", "lamps + rest = the map", 1e-5, std::abs(sum.x / e.energy().x - 1), 1);
  REQUIRE(lamps.all.size() > 20);
  CHECK(lamps.all.size() < std::size_t(Lamps::most));
  const double limit = Lamps::threshold * e.energy().x / (4 * reference::pi);
  double most = 0;
  for (int y = 0; y < lamps.rest.map.height; ++y)
    for (int x = 0; x < lamps.rest.map.width; ++x) most = std::max(most, double(lamps.rest.map.at(x, y).x));
  CHECK(most == Approx(limit).epsilon(1e-4));
  for (std::size_t i = 1; i < lamps.all.size(); ++i) CHECK(lamps.all[i].power.x <= lamps.all[i - 1].power.x * 1.00001f);
}
