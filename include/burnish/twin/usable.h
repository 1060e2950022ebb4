// burnish/twin/usable.h -- whether a mesh is a vehicle whose parts can be told apart, and if not, why not
// SPDX-License-Identifier: Apache-2.0
//
// Lu et al. 2024 (UrbanCAD), "CAD Model Filtering": models of which materials do not separate the parts are sorted out.
// They leave open how; here it is asked of what is seen from all round. All in the normalised frame (scene/vehicle.h).
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <vector>
#include <burnish/scene/raycast.h>
#include <burnish/scene/words.h>
#include <burnish/twin/pose.h>

namespace burnish {

/// How many different materials the triangles have.
inline int materials_of(const Mesh& mesh) {
  std::set<int> used;
  for (const int p : mesh.part) used.insert(mesh.parts[std::size_t(p)].material_index);
  return int(used.size());
}

namespace detail {
inline std::string in_words(const char* format, double x) {
  char text[160];
  std::snprintf(text, sizeof text, format, x);
  return text;
}
}  // namespace detail

/// "" unless the last word of a name says that it is a piece of a vehicle, or one without a body: "suv_tire", "Bike 2".
inline std::string odd_name(const std::string& name) {
  static const std::set<std::string> odd = {
      "wheel",       "wheels",   "tire", "tires",    "tyre",      "tyres",   "rim",        "rims",       "hubcap",
      "light",       "lights",   "lamp", "lamps",    "mirror",    "mirrors", "suspension", "steering",   "instruments",
      "accessories", "interior", "seat", "seats",    "engine",    "kit",     "pointer",    "pivot",      "bumper",
      "door",        "doors",    "top",  "plate",    "bike",      "bicycle", "motorbike",  "motorcycle", "scooter",
      "moped",       "stroller", "pram", "tricycle", "skateboard"};
  std::string last;
  detail::each_word(name, [&](const std::string& word) { last = word; });
  return odd.count(last) ? "by its name no whole vehicle: " + last : "";
}

/// "" for what may be a car, a van, a truck or a bus by its box and by where it stands; else what is odd.
inline std::string odd_proportions(const Mesh& mesh) {
  using detail::in_words;
  const Box box = bounds(mesh);
  const double l = double(box.size().x), h = double(box.size().y), w = double(box.size().z);
  if (!(l > 0 && h > 0 && w > 0)) return "flat: no vehicle by its proportions";
  if (l < 1.1 * w) return in_words("%.2f times as long as wide: no vehicle by its proportions", l / w);
  if (l > 11 * w) return in_words("%.0f times as long as wide: no vehicle by its proportions", l / w);
  if (l < 1.1 * h) return in_words("%.2f times as long as high: no vehicle by its proportions", l / h);
  if (h < 0.14 * l) return in_words("its height is %.2f of its length: no vehicle by its proportions", h / l);
  if (h > 2.2 * w) return in_words("%.1f times as high as wide: no vehicle by its proportions", h / w);
  // What stands on two wheels in line touches the ground along its middle.
  double area = 0, aside = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [i, j, k] = mesh.triangles[t];
    const vec3<float> p =
        (mesh.positions[std::size_t(i)] + mesh.positions[std::size_t(j)] + mesh.positions[std::size_t(k)]) / 3.0f;
    if (double(p.y - box.low.y) > 0.08 * h) continue;
    const vec3<float> c = mesh.cross_of(int(t));
    const double a = std::sqrt(double(dot(c, c)));
    area += a, aside += a * std::abs(double(p.z - box.center().z)) / (0.5 * w);
  }
  if (h > 1.1 * w && aside < 0.3 * area) return "it stands on its middle line: two wheels, expected more";
  return "";
}

/// What is seen of a mesh from all round, and of which part it is.
struct SeenParts {
  struct Place {
    int part = 0;
    float along = 0, high = 0;  // 0 rear to 1 front; 0 ground to 1 roof
    float up = 0;               // of its normal
  };
  std::vector<Place> places;  // a pixel each

  explicit SeenParts(const Raycaster& scene) {
    const Box box = bounds(scene.mesh());
    const vec3<float> size = box.size();
    for (int view = 0; view < 16; ++view) {
      Pose<float> p;
      p.azimuth = 2 * pi * float(view % 8) / 8 + 0.2f, p.elevation = view < 8 ? 0.1f : 0.5f;
      p.center = box.center(), p.width = 96, p.height = 64, p.focal = 1.6f;
      p.distance = 1.9f * length(size);
      const GBuffer g = scene.trace(p.camera(), 1);
      for (int i = 0; i < g.size(); ++i) {
        const vec3<float> at = g.at(i).position - box.low;
        places.push_back({g.part[std::size_t(i)], at.x / size.x, at.y / size.y, g.geometric_normal(i).y});
      }
    }
  }
};

/// "" where windows and body, and wheels if there are any, belong to different parts or materials; else what does not.
/// A piece is a part of the mesh: one material of one node of the file.
inline std::string inseparable(const Mesh& mesh, const SeenParts& seen) {
  using detail::in_words;
  const std::size_t n = mesh.parts.size();
  std::vector<double> all(n), body(n), glass(n), low(n);
  std::map<int, double> by_material;
  for (const SeenParts::Place& p : seen.places) {
    const std::size_t part = std::size_t(p.part);
    all[part] += 1, by_material[mesh.parts[part].material_index] += 1;
    if (p.high > 0.3f && p.high < 0.6f) body[part] += 1;
    if (p.high > 0.6f && p.high < 0.95f && std::abs(p.up) < 0.85f) glass[part] += 1;
    if (p.high < 0.1f) low[part] += 1;
  }
  const auto sum = [](const std::vector<double>& x) {
    double s = 0;
    for (const double v : x) s += v;
    return s;
  };
  const double total = sum(all);
  if (total == 0) return "nothing of it is seen from outside";
  if (std::count_if(all.begin(), all.end(), [&](double a) { return a > 0.003 * total; }) < 2) {
    return materials_of(mesh) == 1 ? "one material on the whole of it: its parts cannot be told apart"
                                   : "one part is all that is seen of it: its parts cannot be told apart";
  }
  // The body: the material seen most, in all parts of which the flanks consist.
  const int paint = std::max_element(by_material.begin(), by_material.end(), [](const auto& a, const auto& b) {
                      return a.second < b.second;
                    })->first;
  std::vector<bool> is_body(n);
  const double flanks = sum(body);
  for (std::size_t i = 0; i < n; ++i)
    is_body[i] = mesh.parts[i].material_index == paint && body[i] >= 0.03 * flanks;
  const auto share = [&](const std::vector<double>& of) {
    double s = 0;
    for (std::size_t i = 0; i < n; ++i) s += is_body[i] ? of[i] : 0.0;
    const double whole = sum(of);
    return whole > 0 ? s / whole : 0.0;
  };
  if (share(glass) > 0.97)
    return in_words("windows and body are one part: %.0f %% of what is seen below the roof", 100 * share(glass));
  // Wheels that are there touch the ground in few places; where the lowest is a long sill, they are missing.
  std::array<bool, 40> touched{};
  for (const SeenParts::Place& p : seen.places)
    if (p.high < 0.06f) touched[std::size_t(std::clamp(int(p.along * 40), 0, 39))] = true;
  if (share(low) > 0.9 && std::count(touched.begin(), touched.end(), true) < 20)
    return in_words("wheels and body are one part: %.0f %% of what is seen near the ground", 100 * share(low));
  return "";
}

}  // namespace burnish
