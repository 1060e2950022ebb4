// burnish/io/light_field.h -- a file that says which panorama lights which place of a street
// SPDX-License-Identifier: Apache-2.0
//
// {"lights": [{"at": [right, ahead], "panorama": "file.exr", "yaw": degrees}, ...]}. Metres on the ground from below
// the camera, as street/place.h has them; yaw, about +y, may be left out. A panorama's path is relative to the file's
// folder.
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <burnish/io/model.h>
#include <burnish/street/light_field.h>

namespace burnish {

/// A lat-long panorama that is read when it is needed.
struct PanoramaFile {
  std::string path;
  float yaw = 0;  ///< radians that it is turned about +y

  bool operator==(const PanoramaFile&) const = default;
};
/// Positions are of the street's frame: x right, -z ahead, y 0. Error with the file and which light lacks what;
/// panoramas that are not there are errors too.
inline LightField<PanoramaFile> read_light_field(const std::string& path) {
  const nlohmann::ordered_json all = parse_json(path);
  if (!all.contains("lights") || !all["lights"].is_array() || all["lights"].empty())
    throw Error(path + ": no list \"lights\", expected one panorama at least");
  LightField<PanoramaFile> field;
  for (const auto& o : all["lights"]) {
    const std::string which = path + ", light " + std::to_string(field.lights.size() + 1) + ": ";
    try {
      const auto at = o.at("at").get<std::vector<float>>();
      if (at.size() != 2) throw Error("\"at\" has not two numbers, metres to the right and ahead");
      const std::filesystem::path file =
          std::filesystem::path(path).parent_path() / o.at("panorama").get<std::string>();
      if (!std::filesystem::exists(file)) throw Error(file.string() + ": no such file");
      field.lights.push_back({{at[0], 0, -at[1]}, {file.string(), o.value("yaw", 0.0f) * 0.017453292519943f}});
    } catch (const std::exception& e) {
      throw Error(which + e.what());
    }
  }
  return field;
}

}  // namespace burnish
