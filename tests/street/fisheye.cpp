// tests/street/fisheye.cpp -- lenses: there and back again, published formulas, slopes
// SPDX-License-Identifier: Apache-2.0
#include <burnish/street/fisheye.h>
#include <differences.h>

using namespace differences;

namespace {
vec3<double> toward(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}
/// A side camera of KITTI-360, a front camera of WoodScape, and lenses with numbers of our own.
MeiFisheye<double> mei() {
  MeiFisheye<double> l;
  l.xi = 2.2134, l.k1 = 0.0168, l.k2 = 1.6549, l.p1 = 4.22e-4, l.p2 = 4.25e-4, l.fx = 1336.3, l.fy = 1335.8;
  l.cx = 716.9, l.cy = 705.8, l.widest = 2;  // the model ends at 2.04
  return l;
}
RadialFisheye<double> woodscape() {
  RadialFisheye<double> l;
  l.c = {339.749, -31.988, 48.275, -7.201}, l.fx = l.fy = 1, l.cx = 643.442, l.cy = 479.407, l.widest = 1.7f;
  return l;
}
RadialFisheye<double> kannala_brandt() {
  RadialFisheye<double> l;
  l.c = {1, 0, -0.02, 0, 0.006, 0, -0.004, 0, 0.0006}, l.fx = 420, l.fy = 418, l.widest = 1.57f;
  return l;
}
template <class Lens> double round_trip(const Lens& lens) {
  Random random(1);
  double worst = 0;
  for (int i = 0; i < 20 * record::points(); ++i) {
    const vec3<double> d = toward(between(random, 0, double(lens.widest)), between(random, -3.14, 3.14));
    const double error = length(lens.unproject(lens.project(d)) - d);
    if (!(error <= worst)) worst = error;
  }
  return worst;
}
}  // namespace

TEST_CASE("RadialFisheye, MeiFisheye: unproject undoes project over all that the lens sees", "[street][value]") {
  const double worst = std::max({round_trip(mei()), round_trip(woodscape()), round_trip(kannala_brandt())});
  record::claim("fisheye lenses: a direction to a pixel and back", "value", "itself", 1e-9, worst,
                60 * record::points());
}
TEST_CASE("MeiFisheye: the point is moved by xi and laid on a plane, as Mei and Rives have it", "[street][value]") {
  const MeiFisheye<double> l = mei();
  const vec3<double> d = toward(0.7, 0.3);  // by hand, in the paper's order
  const double mx = d.x / (d.z + 2.2134), my = d.y / (d.z + 2.2134), rho = mx * mx + my * my;
  const double radial = 1 + 0.0168 * rho + 1.6549 * rho * rho;
  const double u = mx * radial + 2 * 4.22e-4 * mx * my + 4.25e-4 * (rho + 2 * mx * mx);
  const double v = my * radial + 4.22e-4 * (rho + 2 * my * my) + 2 * 4.25e-4 * mx * my;
  CHECK(l.project(d).x == Approx(1336.3 * u + 716.9).epsilon(1e-12));
  CHECK(l.project(d).y == Approx(1335.8 * v + 705.8).epsilon(1e-12));
  CHECK(l.sees(toward(1.9, 1)));
  CHECK_FALSE(l.sees(toward(2.1, 1)));
}
TEST_CASE("RadialFisheye: equidistant, and OpenCV's polynomial in theta", "[street][value]") {
  RadialFisheye<double> l;
  l.widest = 3;
  CHECK(l.project(toward(1.2, 0)).x == Approx(300 * 1.2 + 500).epsilon(1e-12));
  CHECK(l.project(toward(2.5, pi / 2)).y == Approx(300 * 2.5 + 500).epsilon(1e-6));
  const RadialFisheye<double> k = kannala_brandt();
  const double t = 1.1, t2 = t * t;
  const double theta_d = t * (1 - 0.02 * t2 + 0.006 * t2 * t2 - 0.004 * t2 * t2 * t2 + 0.0006 * t2 * t2 * t2 * t2);
  CHECK(k.project(toward(t, 0)).x == Approx(420 * theta_d + 500).epsilon(1e-12));
}
TEST_CASE("RadialFisheye, MeiFisheye: slopes by lens, direction and pixel", "[street][gradient]") {
  const auto draw = [](Random& r, auto lens) {
    return std::tuple{lens, toward(between(r, 0.1, 0.9 * double(lens.widest)), between(r, -3, 3))};
  };
  const auto there = [](const auto& l, const auto& d) { return l.project(d); };
  const auto back = [](const auto& l, const auto& p) { return l.unproject(p); };
  // A pixel's rounding in float is 1e-4 of the picture: directions come back to that.
  holds("MeiFisheye", there, [&](Random& r) { return draw(r, mei()); }, {.scale = 1000});
  holds("RadialFisheye", there, [&](Random& r) { return draw(r, kannala_brandt()); }, {.scale = 1000});
  holds("MeiFisheye::unproject", back, [&](Random& r) {
    const auto [l, d] = draw(r, mei());
    return std::tuple{l, l.project(d)};
  }, {.rounding = 1e-4, .step = 1e-3});
  holds("RadialFisheye::unproject", back, [&](Random& r) {
    const auto [l, d] = draw(r, woodscape());
    return std::tuple{l, l.project(d)};
  }, {.rounding = 1e-4, .step = 1e-3});
}
