// tests/io/fisheye.cpp -- calibrations as they are written elsewhere, and what is said of broken ones
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include "files.h"
#include <burnish/io/fisheye.h>

using namespace burnish;
using files::error_of;

namespace {
// With what writers of it get wrong: the directive, and a colon without a blank.
const std::string mei =
    "%YAML:1.0\n---\nmodel_type: MEI\ncamera_name: image_02\nimage_width: 1400\nimage_height: 1400\n"
    "mirror_parameters:\n   xi: 2.2134\ndistortion_parameters:\n   k1: 1.6e-02\n   k2: 1.65\n   p1: 4.2e-04\n"
    "   p2:4.3e-04\nprojection_parameters:\n   gamma1: 1336.32\n   gamma2: 1335.79\n   u0: 716.94\n   v0: 705.76\n";
const std::string opencv =
    "%YAML:1.0\n---\nimage_width: 1280\nimage_height: 1080\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n"
    "   dt: d\n   data: [ 400., 0., 639.5, 0.,\n       401., 539.5, 0., 0., 1. ]\ndistortion_coefficients: "
    "!!opencv-matrix\n   rows: 4\n   cols: 1\n   dt: d\n   data: [ -0.02, 0.006,\n       -0.004, 0.0006 ]\n";
const std::string woodscape =
    R"({"name": "FV", "intrinsic": {"aspect_ratio": 1.0, "cx_offset": 4.0, "cy_offset": -3.0, "height": 966.0,
        "width": 1280.0, "k1": 339.7, "k2": -32.0, "k3": 48.3, "k4": -7.2, "model": "radial_poly", "poly_order": 4}})";
const std::string hugin =
    "# hugin project file\np f2 w2000 h1000 v360  E0 R0 n\"TIFF_m\"\nm g1 i0 f0 m2\n"
    "i w2000 h1000 f2 v400 Eev0 r0 p0 y0 TrX0 a0 b0 c0 d-500 e2 g0 t0 S0,1000,0,1000 n\"a.jpg\"\n"
    "i w2000 h1000 f2 v400 Eev0 r10 p5 y180 TrX0 a0.01 b-0.02 c0.03 d500 e0 g0 t0 S1000,2000,0,1000 n\"a.jpg\"\n";
std::vector<Lens> read(const std::string& text) {
  const files::Folder folder;
  return read_lenses(folder.write("lens.txt", text));
}
std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}
void refuses(const std::string& text, const std::string& why) {
  const std::string said = error_of([&] { read(text); });
  CAPTURE(said, why);
  CHECK(said.find("lens.txt: ") != std::string::npos);
  CHECK(said.find(why) != std::string::npos);
}
}  // namespace

TEST_CASE("read_lenses: KITTI-360's YAML, its colons without a blank too", "[io][value]") {
  const auto lens = read(mei).at(0);
  const auto m = std::get<MeiFisheye<double>>(lens.model);
  CHECK(lens.width == 1400);
  CHECK(m.xi == 2.2134);
  CHECK(m.p2 == 4.3e-4);
  CHECK(m.cy == Approx(706.26));
  // What lies ahead of the rig is seen in the middle, what lies up above it.
  CHECK(lens.project({0, 0, -1}).x == Approx(717.44));
  CHECK(lens.project({0, 0.1, -1}).y < 700);
  CHECK(lens.project({0.1, 0, -1}).x > 720);
  CHECK(length(lens.unproject(lens.project({0.6, 0.64, -0.48})) - vec3<double>(0.6, 0.64, -0.48)) < 1e-9);
}
TEST_CASE("read_lenses: OpenCV's fisheye and WoodScape's polynomial", "[io][value]") {
  const auto kb = std::get<RadialFisheye<double>>(read(opencv).at(0).model);
  CHECK(kb.fy == 401);
  CHECK(kb.cx == 640);
  CHECK(kb.c[3] == 0);
  CHECK(kb.c[8] == 0.0006);
  const Lens w = read(woodscape).at(0);
  const double t = 0.5;  // the angle off the axis
  CHECK(w.project({std::sin(t), 0, -std::cos(t)}).x ==
        Approx(644 + 339.7 * t - 32.0 * t * t + 48.3 * t * t * t - 7.2 * t * t * t * t));
  CHECK(w.project({0, 0, -1}).y == Approx(480));
}
TEST_CASE("read_lenses: the two lenses of a Hugin project", "[io][value]") {
  const auto lenses = read(hugin);
  REQUIRE(lenses.size() == 2);
  const double f = 2000 / (400 * 0.017453292519943295);
  CHECK(lenses[0].project({1, 0, 0}).x == Approx(500 + f * 1.5707963267948966));
  CHECK(lenses[0].project({0, 0, -1}).y == Approx(502));
  CHECK(lenses[1].sees({0, 0, 1}));
  CHECK_FALSE(lenses[1].sees({0, 0, -1}));
  // Its axis is pitched up by 5 degrees; the picture's circle ends 500 pixels from it.
  const vec3<double> axis = lenses[1].unproject({1500, 500});
  CHECK(axis.y == Approx(std::sin(5 * 0.017453292519943295)));
  CHECK(axis.z == Approx(std::cos(5 * 0.017453292519943295)));
  // a, b and c leave 1 - a - b - c to the first power, in half heights: at 500 pixels the sum is 500 again.
  const double theta = 500 / f;
  const auto m = std::get<RadialFisheye<double>>(lenses[1].model);
  CHECK(m.radius(theta) * f == Approx(500));
  CHECK(m.radius(theta / 2) * f == Approx(500 * (0.01 / 16 - 0.02 / 8 + 0.03 / 4 + 0.98 / 2)));
  CHECK(double(m.widest) == Approx(theta).margin(2e-3));
}
TEST_CASE("read_lenses: a calibration that is none is told in one line", "[io][value]") {
  refuses("", "empty");
  refuses("model_type: PINHOLE\nfx: 3\n", "no \"camera_matrix.data\"");
  refuses(with(mei, "   gamma1: 1336.32\n", ""), "no \"projection_parameters.gamma1\"");
  refuses(with(mei, "k1: 1.6e-02", "k1: n/a"), "k1\" is \"n/a\"");
  refuses(with(mei, "gamma2: 1335.79", "gamma2: -2"), "above 0");
  refuses(with(mei, "image_width: 1400", "image_width: 0"), "without width");
  refuses(with(opencv, "-0.02, 0.006,\n       ", ""), "expected 4 numbers");
  refuses(with(woodscape, "radial_poly", "pinhole"), "\"pinhole\"");
  refuses(with(woodscape, "\"k3\": 48.3,", ""), "not a WoodScape calibration");
  refuses(woodscape.substr(0, 60), "not a WoodScape calibration");
  refuses(with(hugin, "f2 v400 Eev0 r10", "f0 v400 Eev0 r10"), "projection f0");
  refuses(with(hugin, "v400 Eev0 r10", "v=0 Eev0 r10"), "v is linked");
  refuses("p f2 w2000 h1000 v360\n", "without a picture");
}
