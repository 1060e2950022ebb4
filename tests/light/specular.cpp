// tests/light/specular.cpp -- how right the environment's specular light is, value and slope by roughness
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include <record.h>
#include "places.h"
using namespace burnish;

TEST_CASE("Illumination: under a sky with a sun it is the quadrature to 2 %, its slope by roughness of the right sign",
          "[light][value]") {
  const Image picture = places::sky_with_sun();
  const EnvironmentLight e(picture);
  const places::Surfels s{specular_reference::views(40)};
  const Illumination light(e, s);
  const places::Errors error =
      places::errors(light, e.suns, s, 0, 40, picture, [](int, double, double truth) { return truth; });
  record::claim("Illumination, a sky with a sun", "value", "quadrature in double, rms", 0.02, error.rms, error.points);
  record::claim("Illumination, a sky with a sun", "sign of the slope by roughness", "quadrature in double, share", 0.01,
                error.wrong, error.points);
}

TEST_CASE("Illumination: between windows and lamps it is the quadrature to 3.5 %, also behind a wall and a ball",
          "[light][value]") {
  // Surfels 40 to 79 are those before, with something in their way. A direction is open or not, and stands for its
  // cell: there the error is given as a part of what is seen with nothing in the way.
  const vec3<double> wall = normalize(vec3<double>(0.6, -0.3, 0.5)), ball = normalize(vec3<double>(0.5, 0.5, -0.6));
  const auto hidden = [&](const vec3<double>& d) { return dot(d, wall) > 0.4 || dot(d, ball) > 0.9; };
  const Image room = places::room();
  Image rest = room;
  for (int y = 0; y < rest.height; ++y) {
    for (int x = 0; x < rest.width; ++x) {
      if (hidden(latlong_direction((x + 0.5) / rest.width, (y + 0.5) / rest.height))) rest.set(x, y, vec3<float>(0));
    }
  }
  places::Surfels s{specular_reference::views(40)};
  for (int i = 0; i < 40; ++i) s.all.push_back(s.all[i]);
  const EnvironmentLight e(room, 0, false);
  const Illumination light(e, s, [&](int i, auto d, auto out) {
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = i >= 40 && hidden(vec3<double>(d[k]));
  });
  const auto unhidden = [&](int i, double r, double) { return places::seen(light, {}, s, i - 40, r).value; };
  const places::Errors open =
                           places::errors(light, {}, s, 0, 40, room, [](int, double, double truth) { return truth; }),
                       behind = places::errors(light, {}, s, 40, 80, rest, unhidden);
  const std::string sign = "sign of the slope by roughness", share = "quadrature in double, share";
  record::claim("Illumination, windows and lamps", "value", "quadrature in double, rms", 0.035, open.rms, open.points);
  record::claim("Illumination, windows and lamps", sign, share, 0.01, open.wrong, open.points);
  record::claim("Illumination, a wall and a ball in the way", "value", "quadrature in double, rms", 0.035, behind.rms,
                behind.points);
  record::claim("Illumination, a wall and a ball in the way", sign, share, 0.01, behind.wrong, behind.points);
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
  for (const Lamps::Lamp& l : lamps.all) sum += vec3<double>(l.power);
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
