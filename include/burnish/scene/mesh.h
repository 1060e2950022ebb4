// burnish/scene/mesh.h -- triangles with named parts
// SPDX-License-Identifier: Apache-2.0
//
// World: metres, +Y up, right-handed, front faces counter-clockwise; both are laws for a cleaned mesh and hopes for one
// just read (clean.h). Nothing here relies on the winding: rays hit both sides and turn the normal to the viewer.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <cmath>
#include <limits>
#include <string>
#include <vector>
#include <burnish/math/vec.h>
#include <burnish/scene/error.h>
#include <burnish/scene/image.h>

namespace burnish {

/// A piece of a mesh that has one material.
struct Part {
  std::string name;                           // of the node or mesh in the file
  std::string material;                       // its name in the file, or material_07
  int material_index = 0;                     // its place among the file's materials
  vec3<float> base_color{0.8f, 0.8f, 0.8f};   // a hint: what the file says, taken as linear RGB
  float opacity = 1;                          // a hint: 0 clear to 1
  int texture = -1;                           // of Mesh::images: multiplies base_color; -1: none
};

struct Mesh {
  std::vector<vec3<float>> positions;            // a vertex each
  std::vector<vec3<float>> normals;              // a vertex each, unit; of length zero where missing
  std::vector<vec2<float>> uvs;                  // a vertex each, v upwards; NaN where missing
  std::vector<std::array<int, 3>> triangles;     // vertex indices
  std::vector<int> part;                         // a triangle each: index into parts
  std::vector<Part> parts;
  std::vector<Image> images;                     // textures, linear RGB, the first row at v = 1

  /// Appends a vertex, returns its index.
  int add(const vec3<float>& position, const vec3<float>& normal = {},
          const vec2<float>& uv = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::quiet_NaN()}) {
    positions.push_back(position);
    normals.push_back(normal);
    uvs.push_back(uv);
    return int(positions.size()) - 1;
  }
  /// The file's colour of a part at a uv: its texture is bilinear and repeats.
  vec3<float> color(const Part& p, const vec2<float>& uv) const {
    if (p.texture < 0 || !(std::abs(uv.x) < 1e6f && std::abs(uv.y) < 1e6f)) return p.base_color;
    const Image& image = images[p.texture];
    const auto wrap = [](int i, int n) { return ((i % n) + n) % n; };
    const float x = uv.x * float(image.width) - 0.5f, y = (1 - uv.y) * float(image.height) - 0.5f;
    const float u = std::floor(x), v = std::floor(y);
    const int x0 = wrap(int(u), image.width), y0 = wrap(int(v), image.height), x1 = wrap(x0 + 1, image.width),
              y1 = wrap(y0 + 1, image.height);
    const vec3<float> top = image.at(x0, y0) * (1 - (x - u)) + image.at(x1, y0) * (x - u);
    const vec3<float> bottom = image.at(x0, y1) * (1 - (x - u)) + image.at(x1, y1) * (x - u);
    return p.base_color * (top * (1 - (y - v)) + bottom * (y - v));
  }
  /// Twice the area times the geometric normal of triangle t, on the counter-clockwise side.
  vec3<float> cross_of(int t) const {
    const auto& [a, b, c] = triangles[t];
    return cross(positions[b] - positions[a], positions[c] - positions[a]);
  }
};

/// An axis-aligned box; empty until something is added.
struct Box {
  vec3<float> low = vec3<float>(std::numeric_limits<float>::max());
  vec3<float> high = vec3<float>(std::numeric_limits<float>::lowest());

  void add(const vec3<float>& p) {
    low = {p.x < low.x ? p.x : low.x, p.y < low.y ? p.y : low.y, p.z < low.z ? p.z : low.z};
    high = {p.x > high.x ? p.x : high.x, p.y > high.y ? p.y : high.y, p.z > high.z ? p.z : high.z};
  }
  void add(const Box& b) {
    if (b.low.x <= b.high.x) add(b.low), add(b.high);
  }
  vec3<float> size() const { return high - low; }
  vec3<float> center() const { return (low + high) * 0.5f; }
};

/// Of all triangles (vertices that no triangle uses do not count).
inline Box bounds(const Mesh& mesh) {
  Box box;
  for (const auto& triangle : mesh.triangles) {
    for (int v : triangle) box.add(mesh.positions[v]);
  }
  return box;
}

namespace detail {
/// Neither NaN nor infinite, also where the compiler is told that there are none.
constexpr bool finite(float x) { return (std::bit_cast<std::uint32_t>(x) & 0x7f800000u) != 0x7f800000u; }
constexpr bool finite(const vec2<float>& p) { return finite(p.x) && finite(p.y); }
constexpr bool finite(const vec3<float>& p) { return finite(p.x) && finite(p.y) && finite(p.z); }
inline float at(const vec3<float>& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
}  // namespace detail

/// Error where a mesh has no triangle, an index is out of range or a position is not a number.
inline void require_usable(const Mesh& m) {
  const int vertices = int(m.positions.size()), triangles = int(m.triangles.size());
  if (triangles == 0) throw Error("mesh without triangles, expected at least one");
  if (m.part.size() != m.triangles.size() || m.parts.empty())
    throw Error("mesh without a part for every triangle");
  if (m.normals.size() != m.positions.size() || m.uvs.size() != m.positions.size()) {
    throw Error("mesh of " + std::to_string(vertices) + " positions, " + std::to_string(m.normals.size()) +
                " normals, " + std::to_string(m.uvs.size()) + " uvs: expected as many of each");
  }
  for (int t = 0; t < triangles; ++t) {
    for (int v : m.triangles[t]) {
      if (v < 0 || v >= vertices || !detail::finite(m.positions[v])) {
        throw Error("triangle " + std::to_string(t) + " of the mesh has no usable vertex " + std::to_string(v));
      }
    }
    if (m.part[t] < 0 || m.part[t] >= int(m.parts.size()))
      throw Error("triangle " + std::to_string(t) + " of an unknown part");
  }
}

}  // namespace burnish
