// tests/io/camera.cpp -- cameras as files
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include "files.h"
#include <burnish/io/camera.h>

using namespace burnish;
using files::error_of;

TEST_CASE("Camera file: written and read, it sees the same", "[io][agreement]") {
  const files::Folder folder;
  Camera c = Camera::pinhole(621.3f, 630, 380, 290, 768, 576);
  c.aim({-5.6f, 1.8f, 13.4f}, {-3.8f, -3.4f, -0.1f}, {-0.06f, 0.93f, -0.37f});
  write_camera(folder / "c.json", c);
  const Camera d = read_camera(folder / "c.json");
  CHECK(d.width == 768);
  CHECK(d.height == 576);
  for (const vec3<float>& p : {vec3<float>(0, 0, 0), vec3<float>(2, 1, -1), vec3<float>(-2, 0, 1)}) {
    const vec3<float> a = c.project(p), b = d.project(p);
    CHECK(b.x == Approx(a.x).margin(2e-3));
    CHECK(b.y == Approx(a.y).margin(2e-3));
    CHECK(b.z == Approx(a.z));
  }
}

TEST_CASE("Camera file: the pixel is what the format's formula says", "[io][value]") {
  const files::Folder folder;
  const std::string path = folder.write("c.json", R"({"width": 100, "height": 80, "fx": 90, "fy": 85,
    "cx": 48, "cy": 41, "position": [0, 0, 10], "look_at": [0, 0, 0], "up": [0, 1, 0]})");
  const vec3<float> q = read_camera(path).project({1, 2, 1});  // 9 m ahead, 1 m right, 2 m up
  CHECK(q.x == Approx(90 * 1 / 9.0 + 48));
  CHECK(q.y == Approx(85 * -2 / 9.0 + 41));
  const std::string fov = folder.write("f.json", R"({"width": 100, "height": 80, "fov": 90,
    "position": [0, 0, 10], "look_at": [0, 0, 0]})");
  const Camera c = read_camera(fov);
  CHECK(c.fx == Approx(40));
  CHECK(c.cx == Approx(50));
}

TEST_CASE("Camera file: what is missing or wrong is named", "[io][limit]") {
  const files::Folder folder;
  const auto error = [&](const std::string& text) {
    return error_of([&] { read_camera(folder.write("c.json", text)); });
  };
  CHECK(error("{").find("c.json: not JSON") != std::string::npos);
  CHECK(error("[1]").find("expected a JSON object") != std::string::npos);
  CHECK(error(R"({"width": 10})").find("no \"height\", expected a number") != std::string::npos);
  CHECK(error(R"({"width": "wide"})").find("\"width\" is \"wide\", expected a number") != std::string::npos);
  CHECK(error(R"({"width": 0, "height": 5})").find("0 x 5 pixels") != std::string::npos);
  CHECK(error(R"({"width": 4, "height": 5, "fx": -3})").find("expected both above 0") != std::string::npos);
  CHECK(error(R"({"width": 4, "height": 5, "fx": 3,
    "position": [0, 0]})").find("expected [x, y, z]") != std::string::npos);
  CHECK(error(R"({"width": 4, "height": 5, "fx": 3,
    "position": [0, 9, 0], "look_at": [0, 0, 0]})").find("one line") != std::string::npos);
  CHECK(error_of([&] { read_camera(folder / "none.json"); }) == (folder / "none.json") + ": no such file");
}

TEST_CASE("Camera file: KITTI's calibration text", "[io][value]") {
  const files::Folder folder;
  const std::string path =
      folder.write("000008.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\nP2: 700 0 600 45 0 700 170 -0.3 0 0 1 0.005\nP3: 1 2\n");
  const Camera c = read_kitti_camera(path, "P2", 1242, 375);
  CHECK(c.fx == 700);
  CHECK(c.cx == 600.5f);
  CHECK(c.position.x == Approx(-(45 - 600 * 0.005) / 700));
  CHECK(error_of([&] { read_kitti_camera(path, "P3", 10, 10); }).find("P3 has 2 numbers, expected 12") !=
        std::string::npos);
  CHECK(error_of([&] { read_kitti_camera(path, "P9", 10, 10); }).find("no line \"P9:\"") != std::string::npos);
}
