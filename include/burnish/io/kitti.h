// burnish/io/kitti.h -- KITTI's label and calibration files: a box to put a vehicle into, the camera that saw it
// SPDX-License-Identifier: Apache-2.0
//
// Geiger et al. 2012. Boxes are in the rectified camera's frame: x right, y down, z ahead, metres.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <burnish/io/file.h>
#include <burnish/street/place.h>

namespace burnish {

/// A line of a label file: fifteen fields or, of a detector, sixteen.
struct KittiLabel {
  std::string type;
  float truncated = 0, alpha = 0;
  int occluded = 0;
  float left = 0, top = 0, right = 0, bottom = 0;  ///< in the picture, pixels
  LabelBox box;
};
/// Line number `line`, from 1; 0: the first that is no DontCare. Error with the file and the line.
inline KittiLabel read_kitti_label(const std::string& path, int line = 0) {
  std::istringstream text(read_text(path));
  std::string row;
  for (int k = 1; std::getline(text, row); ++k) {
    if (line > 0 ? k != line : row.empty() || row.rfind("DontCare", 0) == 0) continue;
    KittiLabel l;
    std::istringstream in(row);
    float x = 0, y = 0, z = 0;
    if (!(in >> l.type >> l.truncated >> l.occluded >> l.alpha >> l.left >> l.top >> l.right >> l.bottom >>
          l.box.height >> l.box.width >> l.box.length >> x >> y >> z >> l.box.rotation_y))
      throw Error(path + ", line " + std::to_string(k) +
                  ": expected 15 fields: type, truncated, occluded, alpha, box, " +
                  "height, width, length, x, y, z, rotation_y");
    if (!(l.box.height > 0 && l.box.width > 0 && l.box.length > 0 && z > 0))
      throw Error(path + ", line " + std::to_string(k) + ": no box before the camera (sizes " +
                  std::to_string(l.box.height) + " " + std::to_string(l.box.width) + " " +
                  std::to_string(l.box.length) + ", z " + std::to_string(z) + ")");
    l.box.bottom = {x, y, z}, l.box.alpha = l.alpha;
    return l;
  }
  throw Error(path + ": no " + (line > 0 ? "line " + std::to_string(line) : std::string("labelled object")));
}

/// A calibration file's P2 (the left colour camera), P_rect_02 of the raw data's, P_rect_00 of KITTI-360's, or 12 or 16
/// numbers alone: 3 x 4 of it, row by row.
inline std::array<float, 12> read_kitti_projection(const std::string& path) {
  std::istringstream text(read_text(path));
  std::string row;
  while (std::getline(text, row)) {
    std::istringstream in(row);
    std::string name;
    in >> name;
    const bool bare = !name.empty() && name.find_first_not_of("0123456789.eE+-") == name.npos;
    if (bare) in.seekg(0);
    else if (name != "P2:" && name != "P_rect_02:" && name != "P_rect_00:") continue;
    std::array<float, 12> p{};
    for (float& x : p)
      if (!(in >> x)) throw Error(path + ": " + (bare ? "its first line" : name) + " has not 12 numbers");
    if (!(p[0] > 0 && p[5] > 0)) throw Error(path + ": " + (bare ? "its first line" : name) + " has no focal length");
    return p;
  }
  throw Error(path + ": no line P2:, P_rect_02: or P_rect_00:, and no 12 numbers alone");
}
/// A camera of that projection above a level ground, and how the label's frame lies in it: P2 looks from beside the
/// frame's origin, by its fourth column.
struct KittiCamera {
  Camera camera;
  vec3<float> offset;  ///< what is added to a place of the label's frame, metres
};
inline KittiCamera kitti_camera(const std::array<float, 12>& p, int width, int height, float above, float pitch = 0,
                                float roll = 0) {
  float rows[12];
  std::copy(p.begin(), p.end(), rows);
  const Camera lens = Camera::kitti(rows, width, height);
  KittiCamera k{street_camera(lens.fx, lens.cx, lens.cy, width, height, above, pitch, roll),
                {-lens.position.x, lens.position.y, lens.position.z}};
  k.camera.fy = lens.fy;
  return k;
}
/// Where a vehicle of that size in its own frame (x length) stands so that it is what the label says: its place, its
/// heading, its length. The world's ground is level with the box's bottom where the camera's height is chosen so; else
/// the vehicle stands as high as the label has it.
inline Placement kitti_placement(const LabelBox& box, const vec3<float>& size, const KittiCamera& k) {
  const vec3<float> p = box.bottom + k.offset;
  const vec3<float> world = k.camera.position + k.camera.right * p.x + k.camera.down * p.y + k.camera.forward * p.z;
  // The front, in the camera's frame: (cos, 0, -sin) of rotation_y.
  const vec3<float> front = k.camera.right * std::cos(box.rotation_y) - k.camera.forward * std::sin(box.rotation_y);
  Placement out;
  out.right = world.x, out.ahead = -world.z, out.height = world.y;
  out.heading = std::atan2(front.x, -front.z);
  out.scale = box.length / size.x;
  return out;
}

}  // namespace burnish
