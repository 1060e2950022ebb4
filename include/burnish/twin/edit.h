// burnish/twin/edit.h -- a vehicle changed: opened, steered, rolled, parts hidden, turned over
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <map>
#include <set>
#include <burnish/twin/joints.h>

namespace burnish {

struct Edit {
  std::map<std::string, float> open;  ///< degrees, by a joint's name
  float spin = 0, steer = 0;          ///< degrees: of all wheels, rolling ahead; of the front ones, to the left
  std::set<std::string> hidden;       ///< kinds of parts (window, wheel, ...), names of parts or materials, joints
  float over = 0;                     ///< degrees about its length, to the right; then it lies on the ground
};
/// What came of it: cut panels have parts of their own, with the kinds they had, and seams and linings new ones.
struct EditedVehicle {
  Mesh mesh;
  std::vector<PartKind> kinds;       ///< of each part
  std::vector<std::string> missing;  ///< what was asked for and is not there
};

namespace detail {
/// p turned about a line by radians (Rodrigues).
inline vec3<float> turned_about(const vec3<float>& p, const vec3<float>& pivot, const vec3<float>& axis, float angle) {
  const vec3<float> d = p - pivot;
  const float c = std::cos(angle), s = std::sin(angle);
  return pivot + d * c + cross(axis, d) * s + axis * (dot(axis, d) * (1 - c));
}
/// A vertex of its own for each corner of the chosen triangles, so that they can be moved alone.
template <class Move> void move_triangles(Mesh& m, const std::vector<char>& chosen, Move move) {
  std::map<int, int> copy;
  for (std::size_t t = 0; t < chosen.size(); ++t) {
    if (!chosen[t]) continue;
    for (int& v : m.triangles[t]) {
      const auto [at, fresh] = copy.try_emplace(v, 0);
      if (fresh) {
        const std::size_t i = std::size_t(v);
        at->second = m.add(move(m.positions[i], true), move(m.normals[i], false), m.uvs[i]);
      }
      v = at->second;
    }
  }
}
/// Cuts a panel out, gives it and the opening an edge and a lining, and turns it.
inline void open_panel(EditedVehicle& v, const Joint& j, float angle) {
  CutMesh c = cut(v.mesh, j.region, [&](int part) { return !is_wheel(v.kinds[std::size_t(part)]); });
  v.mesh = std::move(c.mesh);
  Part dark;
  dark.name = j.name + "_lining", dark.material = "lining", dark.base_color = vec3<float>(0.02f);
  for (const Part& p : v.mesh.parts) dark.material_index = std::max(dark.material_index, p.material_index + 1);
  const int lining = int(v.mesh.parts.size());
  v.mesh.parts.push_back(dark), v.kinds.push_back(PartKind::other);
  std::vector<char> moves = c.inside;
  Mesh& m = v.mesh;
  // The edge: from each new edge inwards, once for the panel and once for what it leaves.
  const vec3<float> in = j.inward * j.thickness, well = j.inward * std::max(j.well, j.thickness);
  for (std::size_t k = 0; k < c.seam.size(); ++k) {
    const std::size_t a = std::size_t(c.seam[k].first), b = std::size_t(c.seam[k].second);
    const vec3<float> p = m.positions[a], q = m.positions[b];
    const vec3<float> n = cross(q - p, in);
    if (!(length(n) > 1e-9f)) continue;
    for (const bool panel : {true, false}) {
      const vec3<float> deep = panel ? in : well;
      const int w = m.add(p, n / length(n), {0, 0}), x = m.add(q, n / length(n), {0, 0}),
                y = m.add(q + deep, n / length(n), {0, 0}), z = m.add(p + deep, n / length(n), {0, 0});
      for (const std::array<int, 3>& t : {std::array{w, x, y}, std::array{w, y, z}})
        m.triangles.push_back(t), moves.push_back(panel),
            m.part.push_back(panel || j.well <= 0 ? c.seam_part[k] : lining);
    }
  }
  // The lining: the body's triangles of the panel once more, inwards and dark; and the well's floor.
  const std::size_t count = c.inside.size();
  for (std::size_t t = 0; t < count; ++t) {
    if (!c.inside[t] || v.kinds[std::size_t(m.part[t])] != PartKind::body) continue;
    for (const bool panel : {true, false}) {
      if (!panel && j.well <= 0) continue;
      std::array<int, 3> inner{};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = std::size_t(m.triangles[t][k]);
        const vec3<float> p = m.positions[i] + (panel ? in : well), normal = m.normals[i];
        inner[k] = m.add(p, normal, {0, 0});
      }
      m.triangles.push_back(inner), m.part.push_back(lining), moves.push_back(panel);
    }
  }
  move_triangles(m, moves, [&](const vec3<float>& p, bool place) {
    return turned_about(p, place ? j.pivot : vec3<float>(), j.axis, angle * 0.0174532925f);
  });
}
}  // namespace detail

/// kinds: of each part of the mesh. Angles beyond a joint's limits stop there. An edit that changes nothing gives the
/// mesh as it is.
inline EditedVehicle edited(const Mesh& mesh, const std::vector<PartKind>& kinds, const std::vector<Joint>& joints,
                            const Edit& edit) {
  constexpr float degree = 0.0174532925f;
  EditedVehicle v{mesh, kinds, {}};
  std::set<std::string> unknown;
  for (const auto& [name, angle] : edit.open) unknown.insert(name);
  for (const Joint& j : joints) {
    unknown.erase(j.name);
    const auto asked = edit.open.find(j.name);
    float angle = asked == edit.open.end() ? 0 : std::clamp(asked->second, j.low, j.high);
    if (j.kind == Joint::panel) {
      if (angle != 0) detail::open_panel(v, j, angle);
      continue;
    }
    angle += edit.spin;
    const float steer = j.steered ? edit.steer : 0;
    if (angle == 0 && steer == 0) continue;
    std::vector<char> moves;
    for (const auto& t : v.mesh.triangles)
      moves.push_back(
          std::all_of(t.begin(), t.end(), [&](int i) { return contains(j.region, v.mesh.positions[std::size_t(i)]); }));
    detail::move_triangles(v.mesh, moves, [&](const vec3<float>& p, bool place) {
      const vec3<float> pivot = place ? j.pivot : vec3<float>();
      return detail::turned_about(detail::turned_about(p, pivot, j.axis, angle * degree), pivot, {0, 1, 0},
                                  steer * degree);
    });
  }
  for (const std::string& h : edit.hidden) {
    bool any = false;
    std::vector<char> gone(v.mesh.triangles.size());
    const auto kind = part_kind_of(h);
    for (std::size_t t = 0; t < gone.size(); ++t) {
      const std::size_t p = std::size_t(v.mesh.part[t]);
      const bool is = kind ? v.kinds[p] == *kind || (*kind == PartKind::wheel && is_wheel(v.kinds[p]))
                           : v.mesh.parts[p].name == h || v.mesh.parts[p].material == h;
      gone[t] = is, any = any || is;
    }
    for (const Joint& j : joints) {
      if (j.name != h) continue;
      for (std::size_t t = 0; t < gone.size(); ++t) {
        const auto& c = v.mesh.triangles[t];
        const vec3<float> sum = v.mesh.positions[std::size_t(c[0])] + v.mesh.positions[std::size_t(c[1])] +
                                v.mesh.positions[std::size_t(c[2])];
        gone[t] = gone[t] || contains(j.region, sum / 3.0f);
        any = any || gone[t];
      }
    }
    if (!any) unknown.insert(h);
    detail::keep_triangles(v.mesh, [&](int t) { return !gone[std::size_t(t)]; });
  }
  v.missing.assign(unknown.begin(), unknown.end());
  if (v.mesh.triangles.empty() || edit.over == 0) return v;
  const vec3<float> middle = bounds(v.mesh).center(), ahead(1, 0, 0);
  for (vec3<float>& p : v.mesh.positions) p = detail::turned_about(p, middle, ahead, edit.over * degree);
  for (vec3<float>& n : v.mesh.normals) n = detail::turned_about(n, {}, ahead, edit.over * degree);
  const float lowest = bounds(v.mesh).low.y;
  for (vec3<float>& p : v.mesh.positions) p.y -= lowest;
  return v;
}

}  // namespace burnish
