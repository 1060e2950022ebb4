// burnish/io/fisheye.h -- fisheye calibrations as the field's data sets and programs write them
// SPDX-License-Identifier: Apache-2.0
//
// Read by what is in the file: KITTI-360's image_02.yaml (MEI), OpenCV's and ROS's fisheye (Kannala and Brandt: camera
// matrix and four coefficients, YAML), WoodScape's JSON (radial polynomial), Hugin's .pto (one or two circular fisheyes
// in one frame). Pixels become ours: a centre that a file counts from the middle of the first pixel gets 0.5 more.
#pragma once
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>
#include <nlohmann/json.hpp>
#include <burnish/io/file.h>
#include <burnish/street/lens.h>

namespace burnish {

namespace detail {
/// Where the polynomial stops growing, or `most`: beyond, a lens has no picture.
inline double end_of(const RadialFisheye<double>& lens, double most) {
  for (double theta = 0; theta < most; theta += 1e-3)
    if (!(lens.slope(theta) > 1e-3 * lens.c[0])) return std::max(theta - 1e-3, 0.0);
  return most;
}
/// The angle at which the picture's farthest edge lies, at most `most`.
inline double edge_of(const RadialFisheye<double>& lens, int width, int height, double most) {
  const double x = std::max(lens.cx, width - lens.cx) / lens.fx, y = std::max(lens.cy, height - lens.cy) / lens.fy;
  const double r = std::hypot(x, y);
  double theta = 0;
  while (theta < most && lens.radius(theta) < r) theta += 1e-3;
  return std::min(theta, most);
}

/// "key: value" by "above.key", lists as their text without brackets: of YAML what calibrations use, and what writers
/// of them get wrong (no blank after a colon, tabs, a directive "%YAML:1.0").
inline std::map<std::string, std::string> yaml_entries(const std::string& text) {
  std::map<std::string, std::string> out;
  std::vector<std::pair<std::size_t, std::string>> above;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    const std::size_t indent = line.find_first_not_of(" \t");
    if (indent == std::string::npos || line[indent] == '#' || line[indent] == '%' || line[indent] == '-') continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) continue;
    const std::string key = line.substr(indent, colon - indent);
    std::string value = line.substr(colon + 1);
    if (value.find('[') != std::string::npos)
      for (std::string more; value.find(']') == std::string::npos && std::getline(lines, more);) value += " " + more;
    value.erase(0, std::min(value.find_first_not_of(" \t[\"'"), value.size()));
    if (value.rfind("!!", 0) == 0) value.clear();
    while (!value.empty() && std::string(" ]\"',").find(value.back()) != std::string::npos) value.pop_back();
    while (!above.empty() && above.back().first >= indent) above.pop_back();
    std::string name;
    for (const auto& a : above) name += a.second + ".";
    out[name + key] = value;
    if (value.empty()) above.emplace_back(indent, key);
  }
  return out;
}
inline std::vector<double> numbers_in(std::string text) {
  for (char& c : text)
    if (c == ',' || c == ';') c = ' ';
  std::istringstream in(text);
  std::vector<double> out;
  for (double x; in >> x;) out.push_back(x);
  return out;
}

/// Reads entries and says which is missing.
struct Calibration {
  std::string path;
  std::map<std::string, std::string> entries;

  std::vector<double> list(std::initializer_list<const char*> names, std::size_t least) const {
    for (const char* name : names)
      if (const auto i = entries.find(name); i != entries.end()) {
        const std::vector<double> n = numbers_in(i->second);
        bool finite = true;
        for (const double x : n) finite = finite && std::isfinite(x);
        if (n.size() < least || !finite)
          throw Error(path + ": \"" + name + "\" is \"" + i->second + "\", expected " + std::to_string(least) +
                      (least == 1 ? " number" : " numbers"));
        return n;
      }
    throw Error(path + ": no \"" + *names.begin() + "\", expected a fisheye calibration");
  }
  double number(std::initializer_list<const char*> names) const { return list(names, 1)[0]; }
};

inline Lens kitti360_lens(const Calibration& c) {
  MeiFisheye<double> m;
  m.xi = c.number({"mirror_parameters.xi"});
  m.k1 = c.number({"distortion_parameters.k1"}), m.k2 = c.number({"distortion_parameters.k2"});
  m.p1 = c.number({"distortion_parameters.p1"}), m.p2 = c.number({"distortion_parameters.p2"});
  m.fx = c.number({"projection_parameters.gamma1"}), m.fy = c.number({"projection_parameters.gamma2"});
  m.cx = c.number({"projection_parameters.u0"}) + 0.5, m.cy = c.number({"projection_parameters.v0"}) + 0.5;
  const double end = m.xi > 1 ? std::acos(-1 / m.xi) : 3.0;
  m.widest = float(std::min(end - 0.02, 1.65));  // their lenses show 185 to 190 degrees
  Lens lens{"", m, int(c.number({"image_width"})), int(c.number({"image_height"}))};
  if (!(m.fx > 0 && m.fy > 0)) throw Error(c.path + ": gamma1 and gamma2 expected above 0");
  return lens;
}
inline Lens opencv_lens(const Calibration& c) {
  const std::vector<double> k = c.list({"camera_matrix.data", "K.data", "intrinsic_matrix.data", "K"}, 9),
                            d = c.list({"distortion_coefficients.data", "D.data", "dist_coeffs.data", "D"}, 4);
  if (!(k[0] > 0 && k[4] > 0)) throw Error(c.path + ": focal lengths expected above 0");
  RadialFisheye<double> m;
  m.c = {1, 0, d[0], 0, d[1], 0, d[2], 0, d[3]};
  m.fx = k[0], m.fy = k[4], m.cx = k[2] + 0.5, m.cy = k[5] + 0.5;
  Lens lens{"", m, int(c.number({"image_width", "width"})), int(c.number({"image_height", "height"}))};
  m.widest = float(edge_of(m, lens.width, lens.height, end_of(m, 2)));
  lens.model = m;
  return lens;
}
/// A turn by yaw (to the right), pitch (up) and roll, degrees, as Hugin has them, of a camera that looked ahead.
inline std::array<vec3<double>, 3> hugin_axes(double yaw, double pitch, double roll) {
  const double d = 0.017453292519943295, cy = std::cos(yaw * d), sy = std::sin(yaw * d), cp = std::cos(pitch * d),
               sp = std::sin(pitch * d), cr = std::cos(roll * d), sr = std::sin(roll * d);
  const vec3<double> forward(sy * cp, sp, -cy * cp), right(cy, 0, sy), down = cross(forward, right);
  return {right * cr + down * sr, down * cr - right * sr, forward};
}
inline Lens woodscape_lens(const std::string& path, const std::string& text) {
  nlohmann::json j;
  try {
    j = nlohmann::json::parse(text);
    const auto& in = j.at("intrinsic");
    if (const std::string model = in.value("model", ""); model != "radial_poly")
      throw Error(path + ": intrinsic.model is \"" + model + "\", expected \"radial_poly\"");
    RadialFisheye<double> m;
    m.c = {in.at("k1"), in.at("k2"), in.at("k3"), in.at("k4")};
    m.fx = 1, m.fy = in.value("aspect_ratio", 1.0);
    Lens lens{j.value("name", ""), m, int(double(in.at("width"))), int(double(in.at("height")))};
    // Their offsets are from the middle of the picture.
    m.cx = 0.5 * lens.width + double(in.at("cx_offset")), m.cy = 0.5 * lens.height + double(in.at("cy_offset"));
    if (!(m.c[0] > 0 && m.fy > 0)) throw Error(path + ": k1 and aspect_ratio expected above 0");
    m.widest = float(edge_of(m, lens.width, lens.height, end_of(m, 2)));
    lens.model = m;
    return lens;
  } catch (const nlohmann::json::exception& e) {
    throw Error(path + ": not a WoodScape calibration: " + e.what());
  }
}
/// Hugin's image lines. A number that is linked to lens 0 is not followed: an Error.
inline std::vector<Lens> hugin_lenses(const std::string& path, const std::string& text) {
  std::vector<Lens> lenses;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("i ", 0) != 0) continue;
    std::map<std::string, double> v;
    std::istringstream words(line.substr(2));
    for (std::string word; words >> word;) {
      std::size_t letters = 0;
      while (letters < word.size() && std::isalpha(static_cast<unsigned char>(word[letters]))) ++letters;
      const std::string number = word.substr(letters);
      // "v=0": as lens 0 has it.
      if (number.rfind('=', 0) == 0 && !lenses.empty()) v[word.substr(0, letters)] = std::nan("");
      else v[word.substr(0, letters)] = std::atof(number.c_str());
      if (word[0] == 'S' && number.find(',') != std::string::npos) {
        const std::vector<double> crop = numbers_in(number);
        if (crop.size() == 4) v["radius"] = 0.5 * std::min(crop[1] - crop[0], crop[3] - crop[2]);
      }
    }
    if (v.count("f") == 0 || (v["f"] != 2 && v["f"] != 3))
      throw Error(path + ": lens " + std::to_string(lenses.size()) + " has projection f" +
                  std::to_string(int(v["f"])) + ", expected 2 or 3, a fisheye");
    const auto linked = [&](const char* key) {
      if (std::isnan(v[key])) throw Error(path + ": " + key + " is linked to another lens's, expected a number");
      return v[key];
    };
    Lens lens{std::to_string(lenses.size()), RadialFisheye<double>{}, int(v["w"]), int(v["h"])};
    const double fov = linked("v"), a = linked("a"), b = linked("b"), c = linked("c");
    if (!(lens.width > 0 && lens.height > 0 && fov > 0))
      throw Error(path + ": lens " + lens.name + " without width, height or field of view");
    RadialFisheye<double> m;
    m.fx = m.fy = lens.width / (fov * 0.017453292519943295);
    const double s = m.fx / (0.5 * std::min(lens.width, lens.height));  // their radius 1 is half the shorter side
    m.c = {1 - a - b - c, c * s, b * s * s, a * s * s * s};
    m.cx = 0.5 * lens.width + linked("d"), m.cy = 0.5 * lens.height + linked("e");
    m.widest = float(end_of(m, 2));
    if (v.count("radius")) {
      double theta = 0;
      while (theta < double(m.widest) && m.radius(theta) * m.fx < v["radius"]) theta += 1e-3;
      m.widest = float(theta);
    }
    lens.model = m, lens.axes = hugin_axes(linked("y"), linked("p"), linked("r"));
    lenses.push_back(lens);
  }
  if (lenses.empty()) throw Error(path + ": a Hugin project without a picture, expected one or two lenses");
  return lenses;
}
}  // namespace detail

/// The lenses of a calibration; two for a Hugin project of a dual-fisheye frame. Error names the file and what is
/// wrong.
inline std::vector<Lens> read_lenses(const std::string& path) {
  using namespace detail;
  const std::string text = read_text(path);
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string::npos) throw Error(path + ": empty, expected a fisheye calibration");
  if (text[begin] == '{') return {woodscape_lens(path, text)};
  if (text.find("\np f") != std::string::npos || text.rfind("p f", 0) == 0) return hugin_lenses(path, text);
  const Calibration c{path, yaml_entries(text)};
  const Lens lens = c.entries.count("mirror_parameters.xi") ? kitti360_lens(c) : opencv_lens(c);
  if (lens.width <= 0 || lens.height <= 0) throw Error(path + ": picture without width or height");
  return {lens};
}

}  // namespace burnish
