// burnish/scene/clean.h -- what real CAD files need before a ray may meet them
// SPDX-License-Identifier: Apache-2.0
//
// Every function mends one kind of defect and says what it did in MeshReport, one line each. None ever fails.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <burnish/scene/pieces.h>

namespace burnish {

/// What was found and mended, in words.
struct MeshReport {
  std::vector<std::string> lines;

  void add(std::string line) { lines.push_back(std::move(line)); }
  /// "12 triangles without area dropped"; nothing for n = 0.
  void count(long n, const std::string& what) {
    if (n > 0) add(std::to_string(n) + " " + what);
  }
  bool says(const std::string& text) const {
    return std::any_of(lines.begin(), lines.end(), [&](const auto& l) { return l.find(text) != l.npos; });
  }
};

namespace detail {
/// v / |v|, or zero.
inline vec3<float> unit_or_zero(const vec3<float>& v) {
  const float n = std::sqrt(dot(v, v));
  return n > 1e-30f ? v / n : vec3<float>();
}
/// The angle of triangle t at its corner k, radians.
inline float corner_angle(const Mesh& m, int t, int k) {
  const auto& v = m.triangles[t];
  const vec3<float> a = m.positions[v[k]];
  const vec3<float> e = unit_or_zero(m.positions[v[(k + 1) % 3]] - a),
                    f = unit_or_zero(m.positions[v[(k + 2) % 3]] - a);
  return std::acos(std::clamp(dot(e, f), -1.0f, 1.0f));
}

/// Gives every corner (three a triangle) the normal and uv listed, making new vertices where corners of one differ.
inline void set_corners(Mesh& m, const std::vector<vec3<float>>& normals, const std::vector<vec2<float>>& uvs) {
  Mesh out;
  std::vector<std::vector<int>> made(m.positions.size());
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      int& v = m.triangles[t][k];
      const vec3<float> n = normals[3 * t + k];
      const vec2<float> uv = uvs[3 * t + k];
      const auto same = [&](int i) {
        return std::bit_cast<std::array<std::uint32_t, 3>>(
                   std::array{out.normals[i].x, out.normals[i].y, out.normals[i].z}) ==
                   std::bit_cast<std::array<std::uint32_t, 3>>(std::array{n.x, n.y, n.z}) &&
               std::bit_cast<std::array<std::uint32_t, 2>>(std::array{out.uvs[i].x, out.uvs[i].y}) ==
                   std::bit_cast<std::array<std::uint32_t, 2>>(std::array{uv.x, uv.y});
      };
      auto& candidates = made[v];
      const auto found = std::find_if(candidates.begin(), candidates.end(), same);
      if (found != candidates.end()) {
        v = *found;
        continue;
      }
      const int fresh = out.add(m.positions[v], n, uv);
      candidates.push_back(fresh);
      v = fresh;
    }
  }
  m.positions = std::move(out.positions);
  m.normals = std::move(out.normals);
  m.uvs = std::move(out.uvs);
}
inline std::vector<vec3<float>> corner_normals(const Mesh& m) {
  std::vector<vec3<float>> n;
  n.reserve(3 * m.triangles.size());
  for (const auto& t : m.triangles) {
    for (int v : t) n.push_back(m.normals[v]);
  }
  return n;
}
inline std::vector<vec2<float>> corner_uvs(const Mesh& m) {
  std::vector<vec2<float>> uv;
  uv.reserve(3 * m.triangles.size());
  for (const auto& t : m.triangles) {
    for (int v : t) uv.push_back(m.uvs[v]);
  }
  return uv;
}
}  // namespace detail

/// Drops triangles with indices or positions that are none, without area (their height is under 1e-6 of their longest
/// side), and second copies of a triangle, which would make it a matter of luck which is seen.
inline void drop_bad_triangles(Mesh& m, MeshReport& report) {
  using namespace detail;
  const int vertices = int(m.positions.size());
  m.normals.resize(vertices);
  m.uvs.resize(vertices, vec2<float>(std::numeric_limits<float>::quiet_NaN(), 0.0f));
  report.count(keep_triangles(m, [&](int t) {
                 const auto& v = m.triangles[t];
                 return std::all_of(v.begin(), v.end(), [&](int i) { return i >= 0 && i < vertices; });
               }), "triangles with indices out of range dropped");
  report.count(keep_triangles(m, [&](int t) {
                 const auto& v = m.triangles[t];
                 return std::all_of(v.begin(), v.end(), [&](int i) { return finite(m.positions[i]); });
               }), "triangles with positions that are not numbers dropped");
  report.count(keep_triangles(m, [&](int t) {
                 const auto& [a, b, c] = m.triangles[t];
                 const vec3<double> p(m.positions[a].x, m.positions[a].y, m.positions[a].z);
                 const vec3<double> e(m.positions[b].x - p.x, m.positions[b].y - p.y, m.positions[b].z - p.z);
                 const vec3<double> f(m.positions[c].x - p.x, m.positions[c].y - p.y, m.positions[c].z - p.z);
                 const vec3<double> n = cross(e, f), g = f - e;
                 const double longest = std::max({dot(e, e), dot(f, f), dot(g, g)});
                 return dot(n, n) > 1e-12 * longest * longest;
               }), "triangles without area dropped");
  const std::vector<int> place = weld(m);
  std::vector<std::pair<std::array<int, 3>, int>> keys;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    std::array<int, 3> k{place[m.triangles[t][0]], place[m.triangles[t][1]], place[m.triangles[t][2]]};
    std::sort(k.begin(), k.end());
    keys.emplace_back(k, int(t));
  }
  std::sort(keys.begin(), keys.end());
  std::vector<bool> copy(m.triangles.size());
  for (std::size_t i = 1; i < keys.size(); ++i) copy[keys[i].second] = keys[i].first == keys[i - 1].first;
  report.count(keep_triangles(m, [&](int t) { return !copy[t]; }), "triangles that lie on another dropped");
}

/// Drops ground planes: pieces that hang together, are flat along one axis, lie at one end of all the rest along it and
/// reach further than the rest across it.
inline void drop_ground(Mesh& m, MeshReport& report) {
  using namespace detail;
  for (int round = 0; round < 8; ++round) {
    const std::vector<int> piece = pieces(m, weld(m));
    if (piece.empty()) return;
    std::vector<Box> boxes(*std::max_element(piece.begin(), piece.end()) + 1);
    for (std::size_t t = 0; t < m.triangles.size(); ++t) {
      for (int v : m.triangles[t]) boxes[piece[t]].add(m.positions[v]);
    }
    if (boxes.size() < 2) return;
    int ground = -1;
    for (std::size_t i = 0; i < boxes.size() && ground < 0; ++i) {
      const vec3<float> size = boxes[i].size();
      const float widest = std::max({size.x, size.y, size.z});
      const int flat = size.x < 0.02f * widest ? 0 : size.y < 0.02f * widest ? 1 : size.z < 0.02f * widest ? 2 : -1;
      if (flat < 0) continue;
      Box rest;
      for (std::size_t j = 0; j < boxes.size(); ++j) {
        if (j != i) rest.add(boxes[j]);
      }
      bool wider = true;
      for (int axis = 0; axis < 3; ++axis) {
        if (axis != flat && at(size, axis) < 1.02f * at(rest.size(), axis)) wider = false;
      }
      const float height = at(rest.size(), flat), middle = at(boxes[i].center(), flat);
      const bool at_an_end =
          middle < at(rest.low, flat) + 0.05f * height || middle > at(rest.high, flat) - 0.05f * height;
      if (wider && at_an_end) ground = int(i);
    }
    if (ground < 0) return;
    std::string name;
    for (std::size_t t = 0; t < piece.size() && name.empty(); ++t) {
      if (piece[t] == ground)
        name = m.parts.empty() ? "?" : m.parts[m.part[t]].name + "/" + m.parts[m.part[t]].material;
    }
    report.count(keep_triangles(m, [&](int t) { return piece[t] != ground; }),
                 "triangles of a ground plane dropped (" + name + ")");
  }
}

/// Gives every corner a unit normal. Missing ones become the mean of the faces that meet there at less than `crease`
/// degrees, weighted by their angle, vertices welded by position. Triangles whose three normals all point through the
/// back are wound the other way round; single corners that do get a new normal, and so do all of a part where a tenth
/// or more are like that or stand over 70 degrees from their face. Which side is outside stays unknown: the winding of
/// a neighbour is not relied on.
inline void fill_normals(Mesh& m, MeshReport& report, float crease = 40) {
  using namespace detail;
  const int n = int(m.triangles.size());
  std::vector<vec3<float>> faces(n), corners = corner_normals(m);
  std::vector<long> bad(m.parts.size()), all(m.parts.size());
  long missing = 0, wrong = 0, turned = 0, disbelieved = 0;
  for (int t = 0; t < n; ++t) {
    faces[t] = unit_or_zero(m.cross_of(t));
    int behind = 0, steep = 0;
    for (int k = 0; k < 3; ++k) {
      vec3<float>& c = corners[3 * t + k];
      c = finite(c) ? unit_or_zero(c) : vec3<float>();
      if (dot(c, c) == 0) {
        ++missing;
        continue;
      }
      const float d = dot(c, faces[t]);
      behind += d < 0, steep += std::abs(d) < 0.34f;
      ++all[m.part[t]];
    }
    bad[m.part[t]] += std::max(steep, behind < 3 ? behind : 0);
  }
  for (std::size_t p = 0; p < m.parts.size(); ++p) disbelieved += bad[p] > 0.1 * double(all[p]);
  for (int t = 0; t < n; ++t) {
    const bool disbelieve = bad[m.part[t]] > 0.1 * double(all[m.part[t]]);
    std::array<bool, 3> behind{};
    for (int k = 0; k < 3; ++k) behind[k] = dot(corners[3 * t + k], faces[t]) < 0;
    if (!disbelieve && behind[0] && behind[1] && behind[2]) {
      std::swap(m.triangles[t][1], m.triangles[t][2]);
      std::swap(corners[3 * t + 1], corners[3 * t + 2]);
      faces[t] = -faces[t];
      ++turned;
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      if (!behind[k] && !disbelieve) continue;
      corners[3 * t + k] = {};
      wrong += !disbelieve;
    }
  }
  if (missing + wrong + disbelieved > 0) {
    const std::vector<int> place = weld(m);
    std::vector<std::vector<std::pair<int, float>>> around(m.positions.size());  // faces and their angles at each place
    for (int t = 0; t < n; ++t) {
      for (int k = 0; k < 3; ++k) around[place[m.triangles[t][k]]].emplace_back(t, corner_angle(m, t, k));
    }
    const float limit = std::cos(crease * 0.01745329252f);
    for (int t = 0; t < n; ++t) {
      for (int k = 0; k < 3; ++k) {
        vec3<float>& c = corners[3 * t + k];
        if (dot(c, c) > 0) continue;
        for (const auto& [other, angle] : around[place[m.triangles[t][k]]]) {
          const float d = dot(faces[other], faces[t]);
          if (std::abs(d) > limit) c = c + faces[other] * (d < 0 ? -angle : angle);
        }
        c = unit_or_zero(c);
        if (dot(c, c) == 0) c = faces[t];
      }
    }
  }
  set_corners(m, corners, corner_uvs(m));
  report.count(missing, "corners without a normal: made from the faces around them, creases from " +
                            std::to_string(int(crease)) + " degrees");
  report.count(wrong, "corner normals that pointed through the back: made anew");
  report.count(disbelieved, "parts with normals that do not fit their faces: made anew");
  report.count(turned, "triangles wound against their normals: turned");
}

/// Gives every corner a uv. Triangles of parts that have none, or whose uvs span no area, get a box projection in
/// metres: on a face that looks mostly along an axis, u and v are the other two coordinates, v upwards on the sides.
/// A part that has a texture keeps its uvs in any case. metric: do so for all other parts, so that one unit of uv is one
/// metre there.
inline void fill_uvs(Mesh& m, MeshReport& report, bool metric = false) {
  using namespace detail;
  std::vector<vec2<float>> uv = corner_uvs(m);
  std::vector<double> area(m.parts.size());
  const auto has = [&](std::size_t t) { return finite(uv[3 * t]) && finite(uv[3 * t + 1]) && finite(uv[3 * t + 2]); };
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const vec2<float>&a = uv[3 * t], &b = uv[3 * t + 1], &c = uv[3 * t + 2];
    if (has(t)) area[m.part[t]] += std::abs((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y));
  }
  long made = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const bool textured = m.parts[m.part[t]].texture >= 0;
    if (has(t) && (textured || (!metric && area[m.part[t]] > 1e-8))) continue;
    const vec3<float> n = m.cross_of(int(t));
    const vec3<float> a(std::abs(n.x), std::abs(n.y), std::abs(n.z));
    for (int k = 0; k < 3; ++k) {
      const vec3<float> p = m.positions[m.triangles[t][k]];
      uv[3 * t + k] = a.y >= a.x && a.y >= a.z ? vec2<float>(p.x, n.y < 0 ? p.z : -p.z)
                      : a.x >= a.z             ? vec2<float>(n.x < 0 ? p.z : -p.z, p.y)
                                               : vec2<float>(n.z < 0 ? -p.x : p.x, p.y);
    }
    ++made;
  }
  if (made > 0) set_corners(m, corner_normals(m), uv);
  report.count(made, metric ? "triangles given uvs in metres by box projection"
                            : "triangles without usable uvs: box projection, one unit is a metre");
}

/// Gives materials without a name one: material_07.
inline void name_materials(Mesh& m, MeshReport& report) {
  std::map<int, bool> unnamed;
  for (Part& p : m.parts) {
    if (!p.material.empty()) continue;
    char name[32];
    std::snprintf(name, sizeof name, "material_%02d", p.material_index);
    p.material = name;
    unnamed[p.material_index] = true;
  }
  report.count(long(unnamed.size()),
               "materials without a name: called material_00 and so on, by their place in the file");
}

}  // namespace burnish
