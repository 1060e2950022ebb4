// burnish/scene/axes.h -- which way a vehicle's file has up and ahead, by its parts' names and its shape
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <burnish/scene/mesh.h>
#include <burnish/scene/words.h>

namespace burnish {

namespace detail {
struct Middle {
  float area = 0;
  vec3<float> place;
  Box box;
};
/// Of all parts whose words contain one of those: their area, mean place by area, and box.
inline Middle middle_of(const Mesh& m, std::initializer_list<const char*> wanted, const char* unwanted = "\n") {
  std::vector<bool> chosen;
  for (const Part& p : m.parts) {
    const std::string s = words_of(p);
    const auto in = [&](const char* w) { return s.find(w) != s.npos; };
    chosen.push_back(!in(unwanted) && std::any_of(wanted.begin(), wanted.end(), in));
  }
  vec3<double> sum;
  double area = 0;
  Middle out;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    if (!chosen[m.part[t]]) continue;
    const double a = std::sqrt(double(dot(m.cross_of(int(t)), m.cross_of(int(t))))) / 3;
    for (int v : m.triangles[t]) {
      const vec3<float> p = m.positions[v];
      sum = sum + vec3<double>(p.x, p.y, p.z) * a;
      out.box.add(p);
    }
    area += 3 * a;
  }
  out.area = float(area);
  if (area > 0) out.place = {float(sum.x / area), float(sum.y / area), float(sum.z / area)};
  return out;
}

/// How far a mesh is its own mirror image across the middle of one axis: the shared part of its corners, 0 to 1.
inline float symmetry(const Mesh& m, const Box& box, int axis) {
  constexpr int n = 16;
  std::vector<float> cells(n * n * n);
  for (const auto& triangle : m.triangles) {
    for (int v : triangle) {
      int index = 0;
      for (int a = 0; a < 3; ++a) {
        const float x = (at(m.positions[v], a) - at(box.low, a)) / std::max(at(box.size(), a), 1e-30f);
        index = index * n + std::clamp(int(x * n), 0, n - 1);
      }
      cells[index] += 1;
    }
  }
  float shared = 0;
  for (int i = 0; i < n * n * n; ++i) {
    std::array<int, 3> c{i / (n * n), i / n % n, i % n};
    c[axis] = n - 1 - c[axis];
    shared += std::min(cells[i], cells[(c[0] * n + c[1]) * n + c[2]]);
  }
  return shared / (3 * float(m.triangles.size()));
}
/// The mean distance from the middle of `across`, in half widths, over the slab of `along` between the shares lo and
/// hi.
inline float spread_in(const Mesh& m, const Box& box, int along, float lo, float hi, int across) {
  double sum = 0, area = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const auto& [i, j, k] = m.triangles[t];
    const vec3<float> p = (m.positions[i] + m.positions[j] + m.positions[k]) / 3.0f;
    const float s = (at(p, along) - at(box.low, along)) / at(box.size(), along);
    if (s < lo || s > hi) continue;
    const double a = std::sqrt(double(dot(m.cross_of(int(t)), m.cross_of(int(t)))));
    sum += a * std::abs(at(p, across) - at(box.center(), across)) / (0.5f * at(box.size(), across));
    area += a;
  }
  return area > 0 ? float(sum / area) : 0;
}

struct Axis {
  int index;
  float sign;
  vec3<float> vector() const { return {index == 0 ? sign : 0, index == 1 ? sign : 0, index == 2 ? sign : 0}; }
};
/// "+z", "-x", "y"; false for anything else.
inline bool parse(const std::string& text, Axis& axis) {
  const std::size_t i = std::string("xyz").find(text.empty() ? '?' : text.back());
  if (i == std::string::npos || text.size() > 2 || (text.size() == 2 && text[0] != '+' && text[0] != '-')) return false;
  axis = {int(i), text[0] == '-' ? -1.0f : 1.0f};
  return true;
}
/// "+z" for an axis, else "(0.87 0.00 -0.50)".
inline std::string axis_name(const vec3<float>& v) {
  for (int a = 0; a < 3; ++a) {
    if (std::abs(at(v, a)) > 0.9999f) return std::string(at(v, a) > 0 ? "+" : "-") + "xyz"[a];
  }
  char text[64];
  std::snprintf(text, sizeof text, "(%.2f %.2f %.2f)", double(v.x), double(v.y), double(v.z));
  return text;
}

inline Axis find_up(const Mesh& m, std::string& why) {
  const Box box = bounds(m);
  const vec3<float> size = box.size();
  const float longest = std::max({size.x, size.y, size.z});
  const Middle wheels = middle_of(m, {"wheel", "tire", "tyre", "_rim", "hubcap", "pneu"}, "steer");
  const vec3<float> reach = wheels.box.size();
  if (wheels.area > 0 && std::max({reach.x, reach.y, reach.z}) > 0.4f * longest) {  // not one wheel alone
    const vec3<float> d = wheels.place - box.center();
    Axis best{1, 1};
    float most = 0;
    for (int a = 0; a < 3; ++a) {
      const float offset = 2 * at(d, a) / std::max(at(size, a), 1e-30f);
      if (std::abs(offset) > most && at(size, a) < longest)
        most = std::abs(offset), best = {a, offset < 0 ? 1.0f : -1.0f};
    }
    if (most > 0.25f) {
      why = "by where the wheels are";
      return best;
    }
  }
  // Length is the longest axis; of the other two a vehicle is symmetric across one, and stands along the other.
  const int length = size.x == longest ? 0 : size.z == longest ? 2 : 1;
  const int a = (length + 1) % 3, b = (length + 2) % 3;
  const float in_a = symmetry(m, box, a), in_b = symmetry(m, box, b);
  int up = length == 1 ? 2 : 1;
  why = "by custom: the shape does not tell";
  if (std::max(in_a, in_b) > 1.3f * std::min(in_a, in_b)) up = in_a > in_b ? b : a, why = "by the mirror symmetry";
  const int across = 3 - length - up;
  if (spread_in(m, box, up, 0.8f, 1, across) < spread_in(m, box, up, 0, 0.2f, across) + 0.2f) return {up, 1};
  why += ", turned over as the narrower end is the roof";
  return {up, -1};
}

/// How far the mesh is turned in the plane y = 0 away from the nearest axis, by the principal axes of its surface,
/// which for a mirror-symmetric body are its own; radians. 0 when it is as wide as long, or its box would hardly be
/// smaller.
inline float find_yaw(const Mesh& m) {
  double area = 0, x = 0, z = 0, xx = 0, xz = 0, zz = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const double a = std::sqrt(double(dot(m.cross_of(int(t)), m.cross_of(int(t)))));
    for (int v : m.triangles[t]) {
      const double px = m.positions[v].x, pz = m.positions[v].z;
      area += a, x += a * px, z += a * pz, xx += a * px * px, xz += a * px * pz, zz += a * pz * pz;
    }
  }
  x /= area, z /= area;
  xx = xx / area - x * x, xz = xz / area - x * z, zz = zz / area - z * z;
  const double split = std::hypot(xx - zz, 2 * xz), sum = xx + zz;
  if (sum + split < 1.5 * (sum - split)) return 0;
  const double angle = 0.5 * std::atan2(2 * xz, xx - zz);
  const float yaw = float(angle - std::round(angle / 1.5707963267949) * 1.5707963267949);
  Box turned;
  for (const auto& triangle : m.triangles) {
    for (int v : triangle) {
      const vec3<float> p = m.positions[v];
      turned.add({p.x * std::cos(yaw) + p.z * std::sin(yaw), 0, p.z * std::cos(yaw) - p.x * std::sin(yaw)});
    }
  }
  const vec3<float> before = bounds(m).size(), after = turned.size();
  return after.x * after.z < 0.95f * before.x * before.z ? yaw : 0;
}

/// Whether the front of a vehicle that stands along x with +Y up is at +x: by the names of parts, else by its profile.
inline bool front_is_ahead(const Mesh& m, std::string& why) {
  const Box box = bounds(m);
  const float half = 0.5f * box.size().x, center = box.center().x;
  const Middle front = middle_of(m, {"front", "headl", "head_l", "hood", "bonnet", "windsh", "windsc", "grill",
                                     "parabri", "capot", "_fl_", "_fr_", "_f_l_", "_f_r_", "steer"});
  const Middle rear =
      middle_of(m, {"rear", "taill", "tail_l", "trunk", "exhaust", "muffler", "redl", "red_l", "reverse", "brakel",
                    "brake_l", "stop_l", "stopl", "_rl_", "_rr_", "_r_l_", "_r_r_", "_back_"});
  float score = 0;
  if (front.area > 0) score += (front.place.x - center) / half;
  if (rear.area > 0) score -= (rear.place.x - center) / half;
  if (std::abs(score) > 0.2f) {
    why = "by the names of parts";
    return score > 0;
  }
  // The profile: height over the wheels' ground as a share, along the length.
  constexpr int n = 100;
  std::array<float, n> profile{};
  for (const auto& triangle : m.triangles) {
    for (int k = 0; k < 3; ++k) {  // the highest point of a triangle in each slice lies on an edge
      const vec3<float> p = (m.positions[triangle[k]] - box.low) / (2 * half) * float(n);
      const vec3<float> q = (m.positions[triangle[(k + 1) % 3]] - box.low) / (2 * half) * float(n);
      const int steps = 1 + int(2 * std::abs(q.x - p.x));
      for (int s = 0; s <= steps; ++s) {
        const vec3<float> r = p + (q - p) * (float(s) / float(steps));
        float& top = profile[std::clamp(int(r.x), 0, n - 1)];
        top = std::max(top, r.y * (2 * half) / (float(n) * box.size().y));
      }
    }
  }
  const auto from_end = [&](bool ahead, int i) { return profile[ahead ? n - 1 - i : i]; };
  float ends[2], ramps[2];
  int cabin[2];
  for (bool ahead : {false, true}) {
    float sum = 0;
    for (int i = 2; i < 22; ++i) sum += from_end(ahead, i) / 20;
    int top = 0, foot;
    while (top < n - 1 && from_end(ahead, top) < 0.93f) ++top;
    for (foot = top; foot > 0 && from_end(ahead, foot) > 0.75f; --foot) {}
    ends[ahead] = sum, ramps[ahead] = float(top - foot), cabin[ahead] = foot;
  }
  if (std::abs(ends[1] - ends[0]) > 0.06f) {
    why = "as its end is the lower one";
    return ends[1] < ends[0];
  }
  if (std::max(ramps[0], ramps[1]) > 1.8f * std::min(ramps[0], ramps[1]) + 2) {
    why = "as its side of the cabin slopes more";
    return ramps[1] > ramps[0];
  }
  why = cabin[0] == cabin[1] ? "by custom: neither names nor shape tell" : "as the bonnet is longer than the boot";
  return cabin[1] >= cabin[0];
}
}  // namespace detail

}  // namespace burnish
