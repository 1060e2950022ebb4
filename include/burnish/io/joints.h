// burnish/io/joints.h -- joints of a vehicle as a file that one may edit
// SPDX-License-Identifier: Apache-2.0
//
// {"joints": [{"name", "kind": "wheel" | "panel", "pivot": [x, y, z], "axis": [x, y, z], "low", "high": degrees,
// "inward": [x, y, z], "thickness", "well": metres, "steered": bool, "sure": bool,
// "region": [[nx, ny, nz, offset], ...]}]}.
// Frame of scene/vehicle.h, metres. What moves lies in all half-spaces n . p <= offset of the region.
#pragma once
#include <nlohmann/json.hpp>
#include <burnish/io/model.h>
#include <burnish/twin/joints.h>

namespace burnish {

inline void write_joints(const std::string& path, const std::vector<Joint>& joints) {
  nlohmann::ordered_json all;
  all["joints"] = nlohmann::ordered_json::array();
  const auto triple = [](const vec3<float>& v) { return nlohmann::ordered_json::array({v.x, v.y, v.z}); };
  for (const Joint& j : joints) {
    nlohmann::ordered_json o;
    o["name"] = j.name, o["kind"] = j.kind == Joint::wheel ? "wheel" : "panel";
    o["pivot"] = triple(j.pivot), o["axis"] = triple(j.axis), o["low"] = j.low, o["high"] = j.high;
    o["inward"] = triple(j.inward), o["thickness"] = j.thickness, o["well"] = j.well;
    o["steered"] = j.steered, o["sure"] = j.sure;
    o["region"] = nlohmann::ordered_json::array();
    for (const HalfSpace& h : j.region)
      o["region"].push_back(nlohmann::ordered_json::array({h.normal.x, h.normal.y, h.normal.z, h.offset}));
    all["joints"].push_back(o);
  }
  write_text(path, all.dump(1) + "\n");
}
/// Error with the file and what is missing in which joint.
inline std::vector<Joint> read_joints(const std::string& path) {
  const nlohmann::ordered_json all = parse_json(path);
  if (!all.contains("joints") || !all["joints"].is_array()) throw Error(path + ": no list \"joints\"");
  std::vector<Joint> out;
  for (const auto& o : all["joints"]) {
    Joint j;
    try {
      const auto triple = [&](const char* name) {
        const auto v = o.at(name).get<std::vector<float>>();
        if (v.size() != 3) throw Error(std::string("\"") + name + "\" has not three numbers");
        return vec3<float>(v[0], v[1], v[2]);
      };
      j.name = o.at("name").get<std::string>();
      const std::string kind = o.at("kind").get<std::string>();
      if (kind != "wheel" && kind != "panel") throw Error("kind \"" + kind + "\", expected wheel or panel");
      j.kind = kind == "wheel" ? Joint::wheel : Joint::panel;
      j.pivot = triple("pivot"), j.axis = triple("axis");
      const float l = length(j.axis);
      if (!(l > 1e-6f)) throw Error("\"axis\" has no direction");
      j.axis = j.axis / l;
      j.low = o.at("low").get<float>(), j.high = o.at("high").get<float>();
      if (j.kind == Joint::panel) j.inward = triple("inward");
      j.thickness = o.value("thickness", j.thickness), j.well = o.value("well", 0.0f);
      j.steered = o.value("steered", false);
      j.sure = o.value("sure", true);
      for (const auto& h : o.at("region")) {
        const auto v = h.get<std::vector<float>>();
        if (v.size() != 4) throw Error("a half-space of \"region\" has not four numbers");
        const vec3<float> n(v[0], v[1], v[2]);
        const float size = length(n);
        if (!(size > 1e-6f)) throw Error("a half-space of \"region\" has no direction");
        j.region.push_back({n / size, v[3] / size});
      }
    } catch (const std::exception& e) {
      throw Error(path + ", joint " + std::to_string(out.size() + 1) + ": " + e.what());
    }
    out.push_back(std::move(j));
  }
  return out;
}

}  // namespace burnish
