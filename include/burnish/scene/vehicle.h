// burnish/scene/vehicle.h -- a vehicle put on its wheels: unit, axes and place made the same for all files
// SPDX-License-Identifier: Apache-2.0
//
// The normalised frame: metres, +Y up, the lowest point on y = 0, the bounding box centred at x = z = 0, the length
// along x and the front towards +x (so the vehicle's right side is +z). Only turned, moved and scaled evenly, never
// mirrored.
#pragma once
#include <burnish/scene/axes.h>
#include <burnish/scene/clean.h>

namespace burnish {

struct VehicleOptions {
  std::string up, front;     // axes of the file, like "+z"; empty: found from the shape and the parts' names
  float length = 0;          // metres; 0: as the file has it, if that can be
  bool metric_uvs = false;   // see fill_uvs
  float crease = 40;         // degrees, see fill_normals
};

/// Brings a vehicle into the normalised frame. A vehicle that stands askew in its file is turned straight. Unit: a
/// length of 2.4 to 25 is taken as metres; else as centimetres or millimetres where that makes 2.4 to 25 m, or as
/// inches or feet where that makes 3 to 7 m; else the length becomes 4.5 m.
inline void normalise_vehicle(Mesh& m, MeshReport& report, const VehicleOptions& options = {}) {
  using namespace detail;
  if (m.triangles.empty()) return;
  vec3<float> x, y, z;  // the axes of the normalised frame, in the file's
  const auto turn = [&](const vec3<float>& nx, const vec3<float>& ny, const vec3<float>& nz) {
    for (auto* list : {&m.positions, &m.normals}) {
      for (auto& p : *list) p = {dot(p, nx), dot(p, ny), dot(p, nz)};
    }
    const vec3<float> ox = x, oy = y, oz = z;
    const auto in_file = [&](const vec3<float>& v) { return ox * v.x + oy * v.y + oz * v.z; };
    x = in_file(nx), y = in_file(ny), z = in_file(nz);
  };
  Axis up{1, 1}, front{0, 1};
  std::string why_up = "as told", why_front = "as told";
  if (!parse(options.up, up)) up = find_up(m, why_up);
  const bool told = parse(options.front, front) && front.index != up.index;
  if (!told) front = {up.index == 0 ? 1 : 0, 1};
  x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1};
  turn(front.vector(), up.vector(), cross(front.vector(), up.vector()));
  if (!told) {
    if (const float yaw = find_yaw(m); std::abs(yaw) > 0.05f) {
      turn({std::cos(yaw), 0, std::sin(yaw)}, {0, 1, 0}, {-std::sin(yaw), 0, std::cos(yaw)});
      report.add("stands " + std::to_string(int(std::lround(std::abs(yaw) * 57.29578f))) +
                 " degrees askew in the file: turned");
    }
    if (const vec3<float> size = bounds(m).size(); size.z > size.x) turn({0, 0, 1}, {0, 1, 0}, {-1, 0, 0});
    if (!front_is_ahead(m, why_front)) turn({-1, 0, 0}, {0, 1, 0}, {0, 0, -1});
  }
  report.add("up is the file's " + axis_name(y) + " " + why_up + "; front is its " + axis_name(x) + " " + why_front);

  const float size = bounds(m).size().x;
  float scale = 1;
  std::string found = "metres";
  if (options.length > 0) scale = options.length / size, found = "scaled as told";
  else if (size < 2.4f || size > 25) {
    scale = 4.5f / size, found = "no known unit, scaled";
    struct Unit {
      float factor, low, high;
      const char* name;
    };
    for (const Unit& u : {Unit{0.01f, 2.4f, 25, "centimetres"}, Unit{0.001f, 2.4f, 25, "millimetres"},
                          Unit{0.0254f, 3, 7, "inches"}, Unit{0.3048f, 3, 7, "feet"}}) {
      if (size * u.factor < u.low || size * u.factor > u.high) continue;
      scale = u.factor, found = u.name;
      break;
    }
  }
  char line[128];
  std::snprintf(line, sizeof line, "%.4g long in the file: %s, %.2f m", double(size), found.c_str(),
                double(size * scale));
  report.add(line);
  const Box box = bounds(m);
  const vec3<float> origin(box.center().x, box.low.y, box.center().z);
  for (auto& p : m.positions) p = (p - origin) * scale;
}

/// Everything a vehicle as read from a file needs: clean.h's functions and normalise_vehicle, in the right order.
inline MeshReport clean_vehicle(Mesh& m, const VehicleOptions& options = {}) {
  MeshReport report;
  drop_bad_triangles(m, report);
  drop_ground(m, report);
  normalise_vehicle(m, report, options);
  fill_normals(m, report, options.crease);
  fill_uvs(m, report, options.metric_uvs);
  name_materials(m, report);
  return report;
}

}  // namespace burnish
