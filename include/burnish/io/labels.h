// burnish/io/labels.h -- what is true of an inserted vehicle, for perception: KITTI's and COCO's forms
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>
#include <nlohmann/json.hpp>
#include <burnish/scene/image.h>
#include <burnish/street/place.h>

namespace burnish {

/// What can be seen of a vehicle.
struct SeenVehicle {
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< around its visible pixels, pixel edges
  double area = 0;                       ///< pixels
  double truncated = 0;                  ///< the part of it that lies beyond the picture, 0 to 1
  int occluded = 0;                      ///< KITTI's: 0 all seen, 1 partly hidden, 2 largely
};
/// visible: its mask; whole: its mask were nothing in the way, in a picture that is larger by `margin` on each side (so
/// that what lies beyond counts).
inline SeenVehicle seen_vehicle(const Mask& visible, const Mask& whole, int margin) {
  SeenVehicle s;
  s.x0 = float(visible.width), s.y0 = float(visible.height);
  for (int y = 0; y < visible.height; ++y)
    for (int x = 0; x < visible.width; ++x) {
      if (visible.at(x, y) <= 0.5f) continue;
      s.x0 = std::min(s.x0, float(x)), s.x1 = std::max(s.x1, float(x + 1));
      s.y0 = std::min(s.y0, float(y)), s.y1 = std::max(s.y1, float(y + 1));
      ++s.area;
    }
  double all = 0, inside = 0;
  for (int y = 0; y < whole.height; ++y)
    for (int x = 0; x < whole.width; ++x) {
      if (whole.at(x, y) <= 0.5f) continue;
      const int i = x - margin, j = y - margin;
      ++all, inside += i >= 0 && j >= 0 && i < visible.width && j < visible.height;
    }
  if (s.area == 0) s.x0 = s.y0 = 0;
  s.truncated = all > 0 ? 1 - inside / all : 0;
  const double hidden = inside > 0 ? 1 - s.area / inside : 0;
  s.occluded = hidden < 0.05 ? 0 : hidden < 0.5 ? 1 : 2;
  return s;
}

/// A line of KITTI's label files (Geiger et al. 2012): type, truncated, occluded, alpha, box in the picture (left, top,
/// right, bottom), height, width, length, place x y z in the camera's frame, rotation_y.
inline std::string kitti_line(const std::string& type, const SeenVehicle& seen, const LabelBox& box) {
  char line[256];
  std::snprintf(line, sizeof line, "%s %.2f %d %.2f %.2f %.2f %.2f %.2f %.2f %.2f %.2f %.2f %.2f %.2f %.2f\n",
                type.c_str(), seen.truncated, seen.occluded, double(box.alpha), double(seen.x0), double(seen.y0),
                double(seen.x1), double(seen.y1), double(box.height), double(box.width), double(box.length),
                double(box.bottom.x), double(box.bottom.y), double(box.bottom.z), double(box.rotation_y));
  return line;
}
/// COCO's uncompressed run lengths: column by column, zeros first.
inline nlohmann::ordered_json coco_rle(const Mask& mask) {
  std::vector<int> counts;
  bool now = false;
  int run = 0;
  for (int x = 0; x < mask.width; ++x)
    for (int y = 0; y < mask.height; ++y) {
      if ((mask.at(x, y) > 0.5f) != now) counts.push_back(run), run = 0, now = !now;
      ++run;
    }
  counts.push_back(run);
  return {{"counts", counts}, {"size", {mask.height, mask.width}}};
}
/// A COCO file of one picture with one vehicle (Lin et al. 2014).
inline nlohmann::ordered_json coco_file(const std::string& picture, const Mask& visible, const SeenVehicle& seen) {
  // A list of one by push_back: compilers differ over whether one in braces is a list.
  nlohmann::ordered_json j, a;
  j["images"].push_back({{"id", 1}, {"file_name", picture}, {"width", visible.width}, {"height", visible.height}});
  j["categories"].push_back({{"id", 3}, {"name", "car"}, {"supercategory", "vehicle"}});
  a["id"] = 1, a["image_id"] = 1, a["category_id"] = 3, a["iscrowd"] = 0, a["area"] = seen.area;
  a["bbox"] = {seen.x0, seen.y0, seen.x1 - seen.x0, seen.y1 - seen.y0};
  a["segmentation"] = coco_rle(visible);
  j["annotations"].push_back(a);
  return j;
}

}  // namespace burnish
