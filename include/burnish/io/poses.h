// burnish/io/poses.h -- what matching found, as a JSON file
// SPDX-License-Identifier: Apache-2.0
//
// {"sure": true, "candidates": [{"vehicle": "car.glb", "azimuth": 12.3, ...}, ...]}, the best first: angles in degrees
// (see twin/pose.h), distance in metres, focal in pixels, deviations under the same names in "deviation"; "iou",
// "edges" and "tone" are the evidence, "score" its sum, comparable within the file, "belief" that against the other
// headings of the same vehicle. "camera" is the pose as a camera file has it (io/camera.h).
#pragma once
#include <nlohmann/json.hpp>
#include <burnish/io/camera.h>
#include <burnish/twin/match_pose.h>

namespace burnish {

struct NamedPose {
  std::string vehicle;
  PoseCandidate pose;
};
inline void write_poses(const std::string& path, const std::vector<NamedPose>& found) {
  using Json = nlohmann::ordered_json;
  const auto number = [](double x) { return std::round(x * 1e5) / 1e5; };
  const auto angle = [&](float x) { return number(double(std::remainder(x, 2 * pi)) * 57.29577951308232); };
  const auto put = [&](Json& j, const Pose<float>& p, double width) {
    j["azimuth"] = angle(p.azimuth), j["elevation"] = angle(p.elevation), j["roll"] = angle(p.roll);
    j["distance"] = number(double(p.distance)), j["focal"] = number(double(p.focal) * width);
  };
  Json all = Json::array();
  for (const NamedPose& f : found) {
    const PoseCandidate& c = f.pose;
    Json j;
    j["vehicle"] = f.vehicle;
    put(j, c.pose, double(c.pose.width));
    put(j["deviation"], c.deviation, double(c.pose.width));
    j["iou"] = number(c.iou), j["edges"] = number(c.agreement.edges), j["tone"] = number(c.agreement.tone);
    j["score"] = number(c.score), j["belief"] = number(c.belief);
    j["stretch"] = {number(double(c.stretch.x)), number(double(c.stretch.y)), number(double(c.stretch.z))};
    j["camera"] = camera_json(c.pose.camera());
    all.push_back(j);
  }
  Json whole;
  whole["sure"] = !found.empty() && found.front().pose.sure();
  whole["candidates"] = all;
  write_text(path, whole.dump(2) + "\n");
}

}  // namespace burnish
