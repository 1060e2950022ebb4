// burnish/io/camera.h -- cameras as JSON, and KITTI's calibration text
// SPDX-License-Identifier: Apache-2.0
//
// {"width": 768, "height": 576, "fx": 900, "fy": 900, "cx": 384, "cy": 288,
//  "position": [x, y, z], "look_at": [x, y, z], "up": [x, y, z]}
// Pixels as in scene/camera.h, metres, +Y up: forward = normalize(look_at - position), right = normalize(cross(forward,
// up)), down = cross(forward, right). "fov" (degrees, vertical) may stand for fx and fy; fy, cx, cy and up have
// defaults (fx, the middle, +Y).
#pragma once
#include <cmath>
#include <string>
#include <nlohmann/json.hpp>
#include <burnish/io/file.h>
#include <burnish/scene/camera.h>

namespace burnish {

/// Error names the file and the entry that is missing or wrong.
inline Camera read_camera(const std::string& path) {
  using nlohmann::json;
  json j;
  try {
    j = json::parse(read_text(path));
  } catch (const json::exception& e) {
    throw Error(path + ": not JSON: " + e.what());
  }
  if (!j.is_object()) throw Error(path + ": expected a JSON object with width, height, fx, position, look_at");
  const auto number = [&](const char* key, const double* otherwise) -> double {
    if (!j.contains(key)) {
      if (otherwise) return *otherwise;
      throw Error(path + ": no \"" + key + "\", expected a number");
    }
    if (!j[key].is_number()) throw Error(path + ": \"" + key + "\" is " + j[key].dump() + ", expected a number");
    return j[key].get<double>();
  };
  const auto triple = [&](const char* key, const vec3<float>* otherwise) -> vec3<float> {
    if (!j.contains(key) && otherwise) return *otherwise;
    const json v = j.contains(key) ? j[key] : json();
    if (!v.is_array() || v.size() != 3 || !v[0].is_number() || !v[1].is_number() || !v[2].is_number()) {
      throw Error(path + ": \"" + key + "\" is " + (j.contains(key) ? v.dump() : "missing") + ", expected [x, y, z]");
    }
    return {v[0].get<float>(), v[1].get<float>(), v[2].get<float>()};
  };
  const int w = int(number("width", nullptr)), h = int(number("height", nullptr));
  if (w <= 0 || h <= 0)
    throw Error(path + ": " + std::to_string(w) + " x " + std::to_string(h) + " pixels, expected at least 1 x 1");
  double fx;
  if (j.contains("fx") || !j.contains("fov")) fx = number("fx", nullptr);
  else fx = 0.5 * h / std::tan(number("fov", nullptr) * 0.00872664625997165);
  const double fy = number("fy", &fx), mx = 0.5 * w, my = 0.5 * h;
  if (!(fx > 0 && fy > 0))
    throw Error(path + ": fx " + std::to_string(fx) + ", fy " + std::to_string(fy) + ", expected both above 0");
  Camera c = Camera::pinhole(float(fx), float(fy), float(number("cx", &mx)), float(number("cy", &my)), w, h);
  const vec3<float> y(0, 1, 0), eye = triple("position", nullptr), target = triple("look_at", nullptr),
                                up = triple("up", &y);
  const vec3<float> side = cross(target - eye, up);
  if (!(dot(side, side) > 1e-12f * dot(target - eye, target - eye) * dot(up, up))) {
    throw Error(path + ": position, look_at and up lie on one line, expected a view that is not along up");
  }
  c.aim(eye, target, up);
  return c;
}

/// As read_camera wants it.
inline nlohmann::ordered_json camera_json(const Camera& c) {
  const auto list = [](const vec3<float>& v) { return nlohmann::json{v.x, v.y, v.z}; };
  nlohmann::ordered_json j;
  j["width"] = c.width, j["height"] = c.height;
  j["fx"] = c.fx, j["fy"] = c.fy, j["cx"] = c.cx, j["cy"] = c.cy;
  j["position"] = list(c.position), j["look_at"] = list(c.position + c.forward), j["up"] = list(-c.down);
  return j;
}
inline void write_camera(const std::string& path, const Camera& c) { write_text(path, camera_json(c).dump(2) + "\n"); }

/// One camera of a KITTI calibration text, such as "P2"; see Camera::kitti. Width and height are those of the picture.
inline Camera read_kitti_camera(const std::string& path, const std::string& name, int width, int height) {
  std::istringstream text(read_text(path));
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    std::string key;
    if (!(words >> key) || key != name + ":") continue;
    float p[12];
    for (int i = 0; i < 12; ++i) {
      if (!(words >> p[i])) throw Error(path + ": " + name + " has " + std::to_string(i) + " numbers, expected 12");
    }
    if (!(p[0] > 0 && p[5] > 0)) throw Error(path + ": " + name + " has focal lengths that are not above 0");
    return Camera::kitti(p, width, height);
  }
  throw Error(path + ": no line \"" + name + ":\", expected KITTI's calibration");
}

}  // namespace burnish
