// burnish/scene/vehicle.h -- a vehicle put on its wheels: unit, axes and place made the same for all files
// SPDX-License-Identifier: Apache-2.0
//
// The normalised frame: metres, +Y up, the lowest point on y = 0, the bounding box centred at x = z = 0, the length along
// x and the front towards +x (so the vehicle's right side is +z). Only turned, moved and scaled evenly, never mirrored.
#pragma once
#include <cctype>
#include <initializer_list>
#include <burnish/scene/clean.h>

namespace burnish {

struct VehicleOptions {
  std::string up, front;     // axes of the file, like "+z"; empty: found from the shape and the parts' names
  float length = 0;          // metres; 0: as the file has it, if that can be
  bool metric_uvs = false;   // see fill_uvs
  float crease = 40;         // degrees, see fill_normals
};

namespace detail {
inline bool named(const Part& p, std::initializer_list<const char*> words) {
  std::string s = p.name + " " + p.material;
  for (char& c : s) c = char(std::tolower(static_cast<unsigned char>(c)));
  return std::any_of(words.begin(), words.end(), [&](const char* w) { return s.find(w) != s.npos; });
}
/// The mean place of the triangles of all parts that are named so, by area; false when there are none.
inline bool middle_of(const Mesh& m, std::initializer_list<const char*> words, vec3<float>& middle) {
  std::vector<bool> chosen;
  for (const Part& p : m.parts) chosen.push_back(named(p, words));
  vec3<double> sum;
  double area = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    if (!chosen[m.part[t]]) continue;
    const vec3<float> n = m.cross_of(int(t));
    const double a = std::sqrt(dot(n, n)) / 3;
    for (int v : m.triangles[t]) {
      const vec3<float> p = m.positions[v];
      sum = sum + vec3<double>(p.x, p.y, p.z) * a;
    }
    area += 3 * a;
  }
  if (area <= 0) return false;
  middle = {float(sum.x / area), float(sum.y / area), float(sum.z / area)};
  return true;
}
/// How far a mesh is its own mirror image across the middle of one axis: the shared part of its vertices' mass, 0 to 1.
inline float symmetry(const Mesh& m, const Box& box, int axis) {
  constexpr int n = 24;
  std::vector<float> cells(n * n * n);
  float total = 0;
  for (const auto& triangle : m.triangles) {
    for (int v : triangle) {
      int index = 0;
      for (int a = 0; a < 3; ++a) {
        const float x = (at(m.positions[v], a) - at(box.low, a)) / std::max(at(box.size(), a), 1e-30f);
        index = index * n + std::clamp(int(x * n), 0, n - 1);
      }
      cells[index] += 1;
      total += 1;
    }
  }
  float shared = 0;
  for (int i = 0; i < n * n * n; ++i) {
    std::array<int, 3> c{i / (n * n), i / n % n, i % n};
    c[axis] = n - 1 - c[axis];
    shared += std::min(cells[i], cells[(c[0] * n + c[1]) * n + c[2]]);
  }
  return shared / std::max(total, 1.0f);
}
/// The mean distance from the middle of `across`, in half widths, over the slab of `along` between the shares lo and hi.
inline float spread_in(const Mesh& m, const Box& box, int along, float lo, float hi, int across) {
  double sum = 0, area = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const vec3<float> n = m.cross_of(int(t));
    const double a = std::sqrt(dot(n, n));
    vec3<float> p = m.positions[m.triangles[t][0]] + m.positions[m.triangles[t][1]] + m.positions[m.triangles[t][2]];
    p = p / 3.0f;
    const float s = (at(p, along) - at(box.low, along)) / at(box.size(), along);
    if (s < lo || s > hi) continue;
    sum += a * std::abs(at(p, across) - at(box.center(), across)) / (0.5f * at(box.size(), across));
    area += a;
  }
  return area > 0 ? float(sum / area) : 0;
}
/// The height of the top, as a share of the box, over the slab of `along` between the shares lo and hi.
inline float height_in(const Mesh& m, const Box& box, int along, float lo, float hi, int up, float up_sign) {
  float top = 0;
  for (const auto& triangle : m.triangles) {
    for (int v : triangle) {
      const float s = (at(m.positions[v], along) - at(box.low, along)) / at(box.size(), along);
      const float h = (at(m.positions[v], up) - at(box.low, up)) / at(box.size(), up);
      if (s >= lo && s <= hi) top = std::max(top, up_sign > 0 ? h : 1 - h);
    }
  }
  return top;
}
struct Axis {
  int index;
  float sign;
  std::string name() const { return std::string(sign > 0 ? "+" : "-") + "xyz"[index]; }
  vec3<float> vector() const {
    return {index == 0 ? sign : 0, index == 1 ? sign : 0, index == 2 ? sign : 0};
  }
};
/// "+z", "-x", "y"; false for anything else.
inline bool parse(const std::string& text, Axis& axis) {
  const std::size_t i = std::string("xyz").find(text.empty() ? '?' : text.back());
  if (i == std::string::npos || text.size() > 2 || (text.size() == 2 && text[0] != '+' && text[0] != '-')) return false;
  axis = {int(i), text[0] == '-' ? -1.0f : 1.0f};
  return true;
}

inline Axis find_up(const Mesh& m, const Box& box, std::string& why) {
  const vec3<float> half = box.size() * 0.5f;
  vec3<float> wheels;
  if (middle_of(m, {"wheel", "tire", "tyre", "rim", "hubcap", "pneu", "rubber"}, wheels)) {
    const vec3<float> d = wheels - box.center();
    Axis best{1, 1};
    float most = 0;
    for (int a = 0; a < 3; ++a) {
      const float offset = at(d, a) / std::max(at(half, a), 1e-30f);
      if (std::abs(offset) > most) most = std::abs(offset), best = {a, offset < 0 ? 1.0f : -1.0f};
    }
    // The wheels lie low, and up is not the longest axis.
    if (most > 0.25f && at(half, best.index) < 0.999f * std::max({half.x, half.y, half.z})) {
      why = "by where the wheels are";
      return best;
    }
  }
  const int length = half.x >= half.y && half.x >= half.z ? 0 : half.z >= half.y ? 2 : 1;
  const int a = (length + 1) % 3, b = (length + 2) % 3;
  const float symmetric_a = symmetry(m, box, a), symmetric_b = symmetry(m, box, b);
  int up, across;
  if (std::abs(symmetric_a - symmetric_b) > 0.1f) {
    across = symmetric_a > symmetric_b ? a : b;
    up = across == a ? b : a;
    why = "by the mirror symmetry";
  } else {
    up = length == 1 ? 2 : 1;
    across = 3 - length - up;
    why = "by custom: the shape does not tell";
  }
  const float top = spread_in(m, box, up, 0.8f, 1, across), bottom = spread_in(m, box, up, 0, 0.2f, across);
  const bool upside_down = top > bottom + 0.2f;
  if (upside_down) why += ", turned over as the narrower end is the roof";
  return {up, upside_down ? -1.0f : 1.0f};
}

inline Axis find_front(const Mesh& m, const Box& box, Axis up, std::string& why) {
  const int a = (up.index + 1) % 3, b = (up.index + 2) % 3;
  const int along = at(box.size(), a) >= at(box.size(), b) ? a : b;
  const float half = std::max(0.5f * at(box.size(), along), 1e-30f), center = at(box.center(), along);
  vec3<float> p;
  float score = 0;
  if (middle_of(m, {"front", "headl", "head_l", "head l", "hood", "bonnet", "windshield", "windscreen", "grill", "_fl",
                    "_fr", "fender_f", "parabri", "capot", "steer"}, p)) {
    score += (at(p, along) - center) / half;
  }
  if (middle_of(m, {"rear", "tail", "trunk", "boot", "brake_l", "brakel", "brake l", "exhaust", "muffler", "redl",
                    "red_l", "red l", "reverse", "_rl", "_rr", "stoplight", "backl", "back_l", "hatch"}, p)) {
    score -= (at(p, along) - center) / half;
  }
  if (std::abs(score) > 0.2f) {
    why = "by the names of parts";
    return {along, score > 0 ? 1.0f : -1.0f};
  }
  // A bonnet is lower than what is behind the cabin.
  const float low = height_in(m, box, along, 0, 0.12f, up.index, up.sign);
  const float high = height_in(m, box, along, 0.88f, 1, up.index, up.sign);
  if (std::abs(low - high) > 0.04f) {
    why = "as its end is the lower one";
    return {along, high < low ? 1.0f : -1.0f};
  }
  why = "by custom: neither names nor shape tell";
  return {along, 1};
}
}  // namespace detail

/// Brings a vehicle into the normalised frame. Unit: a length of 2 to 25 is taken as metres; else as millimetres,
/// centimetres, inches or feet where that makes 2.4 to 15 m; else the length becomes 4.5 m.
inline void normalise_vehicle(Mesh& m, MeshReport& report, const VehicleOptions& options = {}) {
  using namespace detail;
  if (m.triangles.empty()) return;
  const Box box = bounds(m);
  Axis up{1, 1}, front{0, 1};
  std::string why_up = "as told", why_front = "as told";
  if (!parse(options.up, up)) up = find_up(m, box, why_up);
  if (!parse(options.front, front) || front.index == up.index) front = find_front(m, box, up, why_front);
  report.add("up is the file's " + up.name() + " " + why_up + "; front is its " + front.name() + " " + why_front);

  const float size = at(box.size(), front.index);
  float scale = 1;
  std::string found = "metres";
  if (options.length > 0) scale = options.length / size, found = "scaled as told";
  else if (size < 2 || size > 25) {
    scale = 4.5f / size, found = "no known unit, scaled";
    constexpr std::pair<float, const char*> units[] = {
        {0.01f, "centimetres"}, {0.001f, "millimetres"}, {0.0254f, "inches"}, {0.3048f, "feet"}};
    for (const auto& [factor, name] : units) {
      if (size * factor < 2.4f || size * factor > 15) continue;
      scale = factor, found = name;
      break;
    }
  }
  char line[128];
  std::snprintf(line, sizeof line, "%.4g long in the file: %s, %.2f m", double(size), found.c_str(), double(size * scale));
  report.add(line);

  const vec3<float> x = front.vector(), y = up.vector(), z = cross(x, y);
  const auto turn = [&](const vec3<float>& p) { return vec3<float>(dot(p, x), dot(p, y), dot(p, z)); };
  for (auto& p : m.positions) p = turn(p) * scale;
  for (auto& n : m.normals) n = turn(n);
  const Box placed = bounds(m);
  const vec3<float> middle = placed.center();
  for (auto& p : m.positions) p = p - vec3<float>(middle.x, placed.low.y, middle.z);
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
