// tests/io/kitti.cpp -- KITTI's label and calibration files: what is read is where it was
// SPDX-License-Identifier: Apache-2.0
#include <burnish/io/kitti.h>
#include <burnish/io/labels.h>
#include <burnish_test.h>
#include <io/files.h>

using namespace burnish;

namespace {
const char* calibration =
    "P0: 721.5 0 609.6 0 0 721.5 172.9 0 0 0 1 0\n"
    "P2: 721.5 0 609.6 44.86 0 721.5 172.9 0.2163 0 0 1 0.002746\n";
}

TEST_CASE("kitti_placement: a label of a placement gives the placement back", "[io][agreement]") {
  const files::Folder folder;
  const KittiCamera k = kitti_camera(read_kitti_projection(folder.write("calib.txt", calibration)), 1242, 375, 1.65f);
  CHECK(k.camera.cx == Approx(610.1));
  CHECK(k.offset.x == Approx((44.86 - 609.6 * 0.002746) / 721.5).epsilon(1e-4));
  const vec3<float> size(4.2f, 1.5f, 1.8f);
  for (const float heading : {0.3f, 2.0f, -1.2f, 3.1f}) {
    const Placement there{2.5f, 14, heading};
    LabelBox b = label_box(size, there, k.camera);
    b.bottom = b.bottom - k.offset;  // the label's frame is that of the reference camera
    const std::string line = kitti_line("Car", {10, 20, 30, 40, 1, 0, 0}, b);
    const KittiLabel l = read_kitti_label(
        folder.write("label.txt", "DontCare -1 -1 -10 0 0 9 9 -1 -1 -1 -1000 -1000 -1000 -10\n" + line));
    const Placement back = kitti_placement(l.box, size, k);
    CHECK(back.right == Approx(there.right).margin(0.02));
    CHECK(back.ahead == Approx(there.ahead).margin(0.02));
    CHECK(back.height == Approx(0).margin(0.02));
    CHECK(std::remainder(back.heading - heading, 6.2831853f) == Approx(0).margin(0.011));
    CHECK(back.scale == Approx(1).margin(0.002));
  }
}
TEST_CASE("read_kitti_projection: numbers alone, and those of KITTI-360", "[io][value]") {
  const files::Folder folder;
  const char* rest = "700 0 600 45 0 701 170 0.2 0 0 1 0.003";
  for (const std::string& text : {std::string(rest), rest + std::string(" 0 0 0 1\n"),
                                  std::string("R_rect_00: 1 0 0\nP_rect_00: ") + rest}) {
    const auto p = read_kitti_projection(folder.write("c.txt", text));
    CHECK(p[0] == 700);
    CHECK(p[5] == 701);
    CHECK(p[11] == Approx(0.003));
  }
}
TEST_CASE("read_kitti_label: what is wrong is said with file and line", "[io][value]") {
  const files::Folder folder;
  const auto says = [&](const std::string& text, int line = 0) {
    const std::string path = folder.write("l.txt", text);
    return files::error_of([&] { read_kitti_label(path, line); });
  };
  CHECK(says("Car 0 0 1 2 3\n").find("line 1: expected 15 fields") != std::string::npos);
  CHECK(says("DontCare 0 0\n").find("no labelled object") != std::string::npos);
  CHECK(says("Car 0 0 0 0 0 9 9 1.5 1.8 4.2 0 1.6 -3 0\n").find("no box before the camera") != std::string::npos);
  CHECK(says("", 4).find("no line 4") != std::string::npos);
  CHECK(files::error_of([&] { read_kitti_projection(folder.write("c.txt", "P0: 1\n")); }).find("no line P2:") !=
        std::string::npos);
  CHECK(files::error_of([&] { read_kitti_projection(folder.write("c.txt", "P2: 1 2\n")); }).find("not 12 numbers") !=
        std::string::npos);
}
