// tests/io/labels.cpp -- labels of an inserted vehicle: boxes, truncation, occlusion, run lengths
// SPDX-License-Identifier: Apache-2.0
#include <burnish/io/labels.h>
#include <burnish_test.h>

using namespace burnish;

namespace {
Mask box(int w, int h, int x0, int y0, int x1, int y1) {
  Mask m(w, h);
  for (int y = std::max(0, y0); y < std::min(h, y1); ++y)
    for (int x = std::max(0, x0); x < std::min(w, x1); ++x) m.at(x, y) = 1;
  return m;
}
}  // namespace

TEST_CASE("seen_vehicle: what the picture's border cuts is truncated, what others hide is occluded", "[io][value]") {
  // 40 x 10 pixels of vehicle, a quarter of them beyond the left border; of what is inside, a third is hidden.
  const Mask whole = box(300, 300, 90, 150, 130, 160);
  const SeenVehicle seen = seen_vehicle(box(100, 100, 10, 50, 30, 60), whole, 100);
  CHECK(seen.truncated == Approx(0.25));
  CHECK(seen.occluded == 1);
  CHECK(seen.x0 == 10);
  CHECK(seen.x1 == 30);
  CHECK(seen.area == 200);
  CHECK(seen_vehicle(box(100, 100, 0, 50, 30, 60), whole, 100).occluded == 0);
  CHECK(seen_vehicle(box(100, 100, 0, 50, 10, 60), whole, 100).occluded == 2);
  CHECK(seen_vehicle(Mask(100, 100), whole, 100).area == 0);
}
TEST_CASE("kitti_line: fifteen fields in KITTI's order", "[io][value]") {
  const LabelBox b{1.5f, 1.8f, 4.5f, {1, 1.65f, 10}, -1.57f, -1.67f};
  CHECK(kitti_line("Car", {10, 50, 30, 60, 200, 0.25, 1}, b) ==
        "Car 0.25 1 -1.67 10.00 50.00 30.00 60.00 1.50 1.80 4.50 1.00 1.65 10.00 -1.57\n");
}
TEST_CASE("coco_file: column by column, zeros first, and they give the mask back", "[io][agreement]") {
  const Mask m = box(5, 4, 1, 1, 3, 4);
  const auto j = coco_file("a.png", m, {1, 1, 3, 4, 6, 0, 0});
  const auto& a = j["annotations"][0];
  CHECK(a["segmentation"]["size"] == nlohmann::ordered_json({4, 5}));
  CHECK(a["bbox"] == nlohmann::ordered_json({1.0, 1.0, 2.0, 3.0}));
  Mask back(5, 4);
  int at = 0;
  bool on = false;
  for (const int run : a["segmentation"]["counts"]) {
    for (int k = 0; k < run; ++k, ++at) back.at(at / 4, at % 4) = on;
    on = !on;
  }
  CHECK(at == 20);
  CHECK(back.values == m.values);
  CHECK(coco_rle(box(2, 2, 0, 0, 2, 2))["counts"] == nlohmann::ordered_json({0, 4}));
}
