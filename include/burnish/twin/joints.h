// burnish/twin/joints.h -- what of a vehicle moves, and about which line: wheels, doors, bonnet, boot
// SPDX-License-Identifier: Apache-2.0
//
// In the frame of scene/vehicle.h: metres, x ahead, y up, z to the vehicle's right. Few files have doors of their own;
// so a door is what lies in a convex region about its pane, between the wheels, and is cut out where it is opened.
#pragma once
#include <string>
#include <burnish/scene/cut.h>
#include <burnish/twin/parts.h>
#include <burnish/twin/wheels.h>

namespace burnish {

/// Something that turns about a line.
struct Joint {
  enum Kind { wheel, panel };
  Kind kind = panel;
  std::string name;          // front_left_wheel, front_left_door, bonnet, boot, ...
  vec3<float> pivot, axis;   // a place on the line; unit: positive angles open, or roll ahead
  float low = 0, high = 70;  // degrees that it may turn
  ConvexRegion region;       // of what moves
  vec3<float> inward;        // unit, of a panel: to the vehicle's inside
  float thickness = 0.05f;   // metres, of a panel
  float well = 0;            // metres: how deep a dark well closes the opening; 0: the inside is seen
  bool steered = false;      // of a wheel
  bool sure = true;          // false: where a panel ends was assumed, not found
};

namespace detail {
/// The faces of a prism along `along` (an axis, 0 to 2) whose outline is the convex hull of points (u, v), the other
/// two axes in order.
inline ConvexRegion hull_prism(std::vector<vec2<float>> p, int along) {
  std::sort(p.begin(), p.end(), [](const auto& a, const auto& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  const auto turn = [](const vec2<float>& a, const vec2<float>& b, const vec2<float>& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  };
  std::vector<vec2<float>> hull;  // Andrew 1979
  for (const bool upper : {false, true}) {
    const std::size_t first = hull.size();
    for (std::size_t i = 0; i < p.size(); ++i) {
      const vec2<float>& q = upper ? p[p.size() - 1 - i] : p[i];
      while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), q) <= 0) hull.pop_back();
      hull.push_back(q);
    }
    hull.pop_back();
  }
  ConvexRegion r;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const vec2<float> a = hull[i], b = hull[(i + 1) % hull.size()];
    const float l = std::hypot(b.x - a.x, b.y - a.y);
    if (!(l > 1e-5f)) continue;
    const vec2<float> n((b.y - a.y) / l, -(b.x - a.x) / l);
    const vec3<float> normal = along == 0   ? vec3<float>(0, n.x, n.y)
                               : along == 1 ? vec3<float>(n.x, 0, n.y)
                                            : vec3<float>(n.x, n.y, 0);
    r.push_back({normal, n.x * a.x + n.y * a.y});
  }
  return r;
}
/// All of a mesh's panes that look one way.
struct Panes {
  std::vector<vec3<float>> points;  // three a triangle
  Box box;
};
template <class Facing> Panes panes_of(const Mesh& m, const std::vector<PartKind>& kinds, Facing facing) {
  Panes out;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    if (kinds[std::size_t(m.part[t])] != PartKind::window) continue;
    const vec3<float> c = m.cross_of(int(t));
    const float l = length(c);
    const auto& v = m.triangles[t];
    const vec3<float> middle =
        (m.positions[std::size_t(v[0])] + m.positions[std::size_t(v[1])] + m.positions[std::size_t(v[2])]) / 3.0f;
    if (!(l > 1e-9f) || !facing(c / l, middle)) continue;
    for (int k : v) out.points.push_back(m.positions[std::size_t(k)]), out.box.add(m.positions[std::size_t(k)]);
  }
  return out;
}
/// Stretches of x that panes cover, front ones first; narrower than 6 cm do not count.
inline std::vector<vec2<float>> covered(const Panes& panes) {
  constexpr float step = 0.015f;
  if (panes.points.empty()) return {};
  const float low = panes.box.low.x;
  std::vector<char> cells(std::size_t((panes.box.high.x - low) / step) + 2);
  for (std::size_t i = 0; i + 2 < panes.points.size(); i += 3) {
    const float a = std::min({panes.points[i].x, panes.points[i + 1].x, panes.points[i + 2].x}),
                b = std::max({panes.points[i].x, panes.points[i + 1].x, panes.points[i + 2].x});
    for (int k = int((a - low) / step + 0.5f); k < int((b - low) / step + 0.5f); ++k) cells[std::size_t(k)] = 1;
  }
  std::vector<vec2<float>> out;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!cells[i]) continue;
    std::size_t j = i;
    while (j < cells.size() && cells[j]) ++j;
    if (float(j - i) * step > 0.06f) out.emplace_back(low + float(i) * step, low + float(j) * step);
    i = j;
  }
  std::reverse(out.begin(), out.end());
  return out;
}

inline void add_wheels(std::vector<Joint>& out, const std::vector<Wheel>& wheels, float middle) {
  for (const Wheel& w : wheels) {
    if (w.spare) continue;
    Joint j;
    j.kind = Joint::wheel;
    j.steered = w.center.x > middle;
    j.name = std::string(j.steered ? "front" : "rear") + (w.center.z > 0 ? "_right" : "_left") + "_wheel";
    j.pivot = w.center, j.axis = {0, 0, -1};  // rolling ahead, the top goes to +x
    j.low = -1e6f, j.high = 1e6f;
    const float r = 1.03f * std::max(w.radius, w.half_length);
    for (int k = 0; k < 24; ++k) {
      const float a = 6.2831853f * float(k) / 24;
      const vec3<float> n(std::cos(a), std::sin(a), 0);
      j.region.push_back({n, dot(n, w.center) + r});
    }
    for (const float s : {-1.0f, 1.0f}) j.region.push_back({{0, 0, s}, s * w.center.z + 1.15f * w.half_width + 0.02f});
    out.push_back(j);
  }
}
/// What the joints of a vehicle are found by.
struct JointSearch {
  const Mesh& mesh;
  const std::vector<PartKind>& kinds;
  Box box;
  float front, rear, radius, hub;  // x of the axles; the wheels' radius, and the height of their middles
  float waist;                     // panes lie above it, lamps below
  std::vector<Joint> joints;
  std::vector<std::string> notes;

  float half() const { return 0.5f * box.size().z; }
  float middle() const { return 0.5f * (front + rear); }
  void note(const std::string& line) { notes.push_back(line); }
  /// Windscreen or rear pane.
  Panes across(bool ahead) const {
    return panes_of(mesh, kinds, [&](const vec3<float>& n, const vec3<float>& p) {
      return std::abs(n.x) > 0.25f && std::abs(n.z) < 0.6f && (p.x > middle()) == ahead && p.y > waist;
    });
  }
  /// By the panes of each side, the pillar between them and the wheels' arches.
  void doors() {
    for (const float side : {-1.0f, 1.0f}) {
      const std::string name = side > 0 ? "right" : "left";
      const auto panes = panes_of(mesh, kinds, [&](const vec3<float>& n, const vec3<float>& p) {
        return std::abs(n.z) > 0.6f && p.z * side > 0.45f * half();
      });
      const auto stretches = covered(panes);
      if (stretches.empty()) {
        note("no panes on the " + name + ": its doors are not found");
        continue;
      }
      float pillar = middle() - 0.05f * (front - rear);
      bool sure = false;
      for (std::size_t k = 0; k + 1 < stretches.size(); ++k) {
        const float gap = 0.5f * (stretches[k].x + stretches[k + 1].y);
        if (std::abs(gap - middle()) < 0.2f * (front - rear) &&
            (!sure || std::abs(gap - middle()) < std::abs(pillar - middle())))
          pillar = gap, sure = true;
      }
      const float belt = panes.box.low.y, sill = std::max(box.low.y + 0.9f * hub, hub - 0.15f * radius);
      const auto door = [&](const std::string& which, float from, float to) {
        std::vector<vec2<float>> outline{{from, sill}, {to, sill}, {from, belt}, {to, belt}};
        float low_y = 1e9f, top_y = -1e9f;
        vec2<float> at_low, at_top;
        for (const vec3<float>& p : panes.points) {
          if (p.x < from || p.x > to) continue;
          for (const float dx : {-0.03f, 0.03f}) outline.push_back({std::clamp(p.x + dx, from, to), p.y + 0.035f});
          if (p.y < low_y) low_y = p.y, at_low = {p.z * side, p.y};
          if (p.y > top_y) top_y = p.y, at_top = {p.z * side, p.y};
        }
        if (to - from < 0.45f || !(top_y - low_y > 0.1f)) return;
        Joint j;
        j.name = which + "_" + name + "_door";
        j.region = hull_prism(outline, 2);
        // Inwards: a plane along the pane, 7 cm behind it; below, as deep as doors are.
        const vec2<float> along((at_top.x - at_low.x), (at_top.y - at_low.y));
        const float l = std::max(std::hypot(along.x, along.y), 1e-6f);
        const vec3<float> n = vec3<float>(0, along.x / l, -side * along.y / l);
        j.region.push_back({n, dot(n, vec3<float>(0, at_low.y, side * at_low.x)) + 0.07f});
        j.region.push_back({{0, 0, -side}, -(at_low.x - 0.14f)});
        // Off the wheels' arches.
        for (const float arch : {front, rear}) {
          const vec3<float> d(arch - 0.5f * (from + to), hub - 0.5f * (sill + belt), 0);
          const vec3<float> to_arch = d / length(d);
          j.region.push_back({to_arch, dot(to_arch, vec3<float>(arch, hub, 0)) - 1.22f * radius});
        }
        j.pivot = {to, belt, side * (half() - 0.05f)}, j.axis = {0, side, 0};
        j.inward = {0, 0, -side}, j.low = 0, j.high = 75;
        j.sure = sure;
        joints.push_back(j);
      };
      const float fore = front - 1.2f * radius;
      door("front", pillar, std::max(fore, pillar + 0.7f));
      const float aft = std::max(rear - 0.2f * radius, stretches.back().x - 0.04f);
      if (sure && pillar - aft > 0.5f) door("rear", aft, pillar);
    }
  }
  /// Between the windscreen and the nose.
  void bonnet() {
    const Panes screen = across(true);
    if (screen.points.empty()) return note("no windscreen: the bonnet is not found");
    vec3<float> foot(-1e9f, 0, 0);
    for (const vec3<float>& p : screen.points)
      if (p.x > foot.x) foot = p;
    const float to = box.high.x - 0.10f * (box.high.x - foot.x) - 0.06f;
    if (to - foot.x < 0.35f) return note("no room for a bonnet before the windscreen");
    Joint j;
    j.name = "bonnet";
    const float wide = 0.76f * half(), from = foot.x + 0.03f;
    // Its lower face falls from below the screen's foot to below the nose's edge.
    float nose = box.low.y;
    for (const vec3<float>& p : mesh.positions)
      if (std::abs(p.x - to) < 0.12f && std::abs(p.z) < 0.4f * half() && p.y < foot.y + 0.1f)
        nose = std::max(nose, p.y);
    j.region = hull_prism({{from, -wide}, {to, -wide}, {from, wide}, {to, wide}}, 1);
    const float slope = (nose - foot.y) / (to - from), l = std::hypot(1.0f, slope);
    const vec3<float> down(slope / l, -1 / l, 0);
    j.region.push_back({down, dot(down, vec3<float>(from, foot.y - 0.10f, 0))});
    j.pivot = {from, foot.y, 0}, j.axis = {0, 0, 1}, j.inward = {0, -1, 0}, j.high = 55;
    j.thickness = 0.03f, j.well = 0.3f;
    joints.push_back(j);
  }
  /// By the rear pane: a hatch where it reaches the rear end, else a lid.
  void boot() {
    const Panes back = across(false);
    if (back.points.empty()) return note("no rear pane: the boot is not found");
    vec3<float> top(0, -1e9f, 0), foot(0, 1e9f, 0);
    for (const vec3<float>& p : back.points) {
      if (p.y > top.y) top = p;
      if (p.y < foot.y) foot = p;
    }
    Joint j;
    j.name = "boot";
    const float wide = 0.78f * half(), bumper = box.low.y + 0.42f * (foot.y - box.low.y) + 0.1f;
    j.axis = {0, 0, -1}, j.thickness = 0.04f;
    if (foot.x - box.low.x > 1.1f) {
      return note("the rear pane is far from the rear end, as a pickup's: no boot");
    }
    if (foot.x - box.low.x > 0.38f) {  // a lid behind the pane
      const float from = box.low.x - 0.02f, to = foot.x - 0.03f;
      j.region = hull_prism({{from, -wide}, {to, -wide}, {from, wide}, {to, wide}}, 1);
      j.region.push_back({{0, -1, 0}, -std::max(bumper, foot.y - 0.35f)});
      j.pivot = {to, foot.y, 0}, j.inward = {0, -1, 0}, j.high = 70, j.well = 0.4f;
    } else {
      const float hinge = top.y + 0.03f;
      j.region = hull_prism({{bumper, -wide}, {hinge, -wide}, {bumper, wide}, {hinge, wide}}, 0);
      const vec3<float> a(top.x + 0.10f, hinge, 0), b(box.low.x + 0.20f, bumper, 0), d = a - b;
      const vec3<float> ahead = normalize(vec3<float>(d.y, -d.x, 0));
      j.region.push_back({ahead, dot(ahead, a)});
      j.pivot = {top.x + 0.02f, hinge, 0}, j.inward = {1, 0, 0}, j.high = 80;
    }
    joints.push_back(j);
  }
};
}  // namespace detail

/// Joints found from geometry: wheels by their roundness; side doors by the panes of each side, the pillar between them
/// and the wheels' arches; the bonnet between the windscreen and the nose; the boot by the rear pane: a hatch where it
/// reaches the rear end, else a lid. What cannot be found is missing, and `notes` says why, a line each.
inline std::vector<Joint> find_joints(const Mesh& m, const std::vector<PartKind>& kinds,
                                      std::vector<std::string>* notes = nullptr) {
  const Box box = bounds(m);
  detail::JointSearch s{m, kinds, box, -1e9f, 1e9f, 0, 0, box.low.y + 0.52f * box.size().y, {}, {}};
  const std::vector<Wheel> wheels = find_wheels(m);
  int standing = 0;
  for (const Wheel& w : wheels) {
    if (w.spare) continue;
    s.front = std::max(s.front, w.center.x), s.rear = std::min(s.rear, w.center.x);
    s.radius = std::max(s.radius, w.radius), s.hub += w.center.y, ++standing;
  }
  if (standing < 4 || !(s.front - s.rear > 1)) {
    s.note("no wheels that stand apart from the rest: none can turn, and doors are not looked for");
  } else {
    s.hub /= float(standing);
    detail::add_wheels(s.joints, wheels, s.middle());
    s.doors(), s.bonnet(), s.boot();
  }
  if (notes) notes->insert(notes->end(), s.notes.begin(), s.notes.end());
  return s.joints;
}

}  // namespace burnish
