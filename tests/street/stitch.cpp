// tests/street/stitch.cpp -- a world that is known, seen by lenses of known exposure, comes back as one panorama
// SPDX-License-Identifier: Apache-2.0
#include <burnish/street/stitch.h>
#include <burnish_test.h>

using namespace burnish;

namespace {
/// Smooth, coloured, nowhere dark, clipped nowhere.
vec3<float> world(const vec3<double>& d) {
  return {float(0.3 + 0.1 * d.x + 0.05 * std::sin(5 * d.y)), float(0.25 + 0.1 * d.y), float(0.35 - 0.1 * d.z * d.x)};
}
LensPicture picture(double ahead, const vec3<float>& exposure) {
  RadialFisheye<double> m;
  m.fx = m.fy = 150, m.cx = 300, m.cy = 300, m.widest = 1.75f;
  LensPicture p{Lens{"", m, 600, 600}, Image(600, 600)};
  const double c = std::cos(ahead), s = std::sin(ahead);
  p.lens.axes = {vec3<double>{c, 0, s}, {0, -1, 0}, {s, 0, -c}};
  for (int y = 0; y < 600; ++y)
    for (int x = 0; x < 600; ++x)
      p.image.set(x, y, world(p.lens.unproject({x + 0.5, y + 0.5})) * exposure);
  return p;
}
}  // namespace

TEST_CASE("stitch: two lenses of different exposure give the world back, without a seam", "[street][value]") {
  const vec3<float> first(1.2f, 1, 0.9f), second(0.8f, 1, 1.1f);
  const Stitched s = stitch({picture(0, first), picture(3.14159265358979, second)}, {.height = 128});
  // The gains take out what lies between the two; what they have in common stays.
  CHECK(s.gains[1].x / s.gains[0].x == Approx(1.5).epsilon(1e-3));
  CHECK(s.gains[1].z / s.gains[0].z == Approx(0.9 / 1.1).epsilon(1e-3));
  const vec3<float> common = first * s.gains[0];
  CHECK(s.seam < 2e-3);
  double worst = 0;
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 256; ++x) {
      REQUIRE(s.seen.at(x, y) == 1);
      const vec3<float> want = world(latlong_direction((x + 0.5) / 256, (y + 0.5) / 128)) * common;
      const vec3<float> off = s.panorama.at(x, y) - want;
      worst = std::max(worst, double(std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)})));
    }
  CHECK(worst < 1e-3);
}
TEST_CASE("stitch: what no lens sees is black and said to be; exposures are left alone when told", "[street][value]") {
  const Stitched s = stitch({picture(0, vec3<float>(1.0f))}, {.height = 64});
  CHECK(s.seen.at(64, 32) == 0);  // behind: u = 1/2
  CHECK(s.seen.at(0, 32) == 1);
  CHECK(s.panorama.at(64, 32).x == 0);
  const Stitched two = stitch({picture(0, vec3<float>(1.0f)), picture(3.1416, vec3<float>(0.5f))},
                              {.height = 64, .match_exposure = false});
  CHECK(two.gains[1].x == 1);
  CHECK(two.seam > 0.5);
}
TEST_CASE("stitch: a picture that is not its lens's is refused", "[street][value]") {
  LensPicture p = picture(0, vec3<float>(1.0f));
  p.lens.width = 500;
  CHECK_THROWS_AS(stitch({p}), Error);
  CHECK_THROWS_AS(stitch({}), Error);
}
