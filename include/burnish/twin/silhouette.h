// burnish/twin/silhouette.h -- a mesh's mask in a picture, and what it does when the camera moves
// SPDX-License-Identifier: Apache-2.0
//
// A mask made by rays at the pixels' centres does not change with the camera until a pixel jumps. Its slope lies on the
// outline: the mesh's silhouette edges, projected. Each is cut into pieces at the rows of pixels that it crosses (or
// columns, where it is flat); where one side of a piece hits the mesh and the other does not, the pixel's share is what
// the piece leaves of its part of the row, linear in the piece's place, so value and slope belong together. Going by
// edges and not by the triangles that pixels see loses nothing on dense meshes, with triangles smaller than pixels:
// there the rule of Laine et al. 2020 finds no edge. What is left is a piece that goes behind another one half-way.
#pragma once
#include <algorithm>
#include <unordered_map>
#include <burnish/ad/dual.h>
#include <burnish/ad/model.h>
#include <burnish/scene/raycast.h>

namespace burnish {

/// The edges at which the outline of a mesh may lie: of vertices welded by position (to 1e-6 of the mesh's size, as
/// sines and files round), so that a seam of uvs is none.
class MeshEdges {
public:
  struct Edge {
    int a, b;           // vertices
    int face[2];        // triangles on both sides; -1: none, or more than two
    bool same_winding;  // both faces run a to b: their sides must be compared the other way round
  };
  explicit MeshEdges(const Mesh& mesh) {
    struct Bits {
      std::size_t operator()(const std::array<int, 3>& k) const {
        return (unsigned(k[0]) * 73856093u) ^ (unsigned(k[1]) * 19349663u) ^ (unsigned(k[2]) * 83492791u);
      }
    };
    const Box box = bounds(mesh);
    const float cell = std::max(1e-6f * length(box.size()), 1e-30f);
    std::unordered_map<std::array<int, 3>, int, Bits> first;
    std::vector<int> welded(mesh.positions.size());
    for (std::size_t v = 0; v < welded.size(); ++v) {
      const vec3<float> p = (mesh.positions[v] - box.low) * (1 / cell);
      const auto near = [](float x) { return int(std::clamp(x, -1e9f, 1e9f) + 0.5f); };  // unused ones may be far off
      welded[v] = first.try_emplace({near(p.x), near(p.y), near(p.z)}, int(v)).first->second;
    }
    struct Side {
      int a, b, face;
      bool forward;
    };
    std::vector<Side> sides;
    for (int t = 0; t < int(mesh.triangles.size()); ++t)
      for (int k = 0; k < 3; ++k) {
        const int a = welded[std::size_t(mesh.triangles[std::size_t(t)][std::size_t(k)])],
                  b = welded[std::size_t(mesh.triangles[std::size_t(t)][std::size_t((k + 1) % 3)])];
        if (a != b) sides.push_back({std::min(a, b), std::max(a, b), t, a < b});
      }
    std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
      return x.a != y.a ? x.a < y.a : x.b != y.b ? x.b < y.b : x.face < y.face;
    });
    for (std::size_t i = 0, j; i < sides.size(); i = j) {
      for (j = i; j < sides.size() && sides[j].a == sides[i].a && sides[j].b == sides[i].b;) ++j;
      const bool two = j - i == 2;
      edges.push_back({sides[i].a, sides[i].b, {sides[i].face, two ? sides[i + 1].face : -1},
                       two && sides[i].forward == sides[i + 1].forward});
    }
  }
  std::vector<Edge> edges;
};

/// The mask of a mesh in a camera's picture with what its outline did to it.
class Silhouette {
public:
  Mask mask;  // height x width: the share of each pixel that the mesh covers

  /// scene's mesh is the one whose edges these are. The camera is a Camera, or what has its width, height, position,
  /// ray and project.
  template <class C> Silhouette(const Raycaster& scene, const MeshEdges& mesh_edges, const C& camera)
      : mask(camera.width, camera.height), mesh(&scene.mesh()) {
    const std::size_t pixels = std::size_t(mask.width) * std::size_t(mask.height);
    std::vector<vec3<float>> origins(pixels, camera.position), directions(pixels);
    for (std::size_t p = 0; p < pixels; ++p)
      directions[p] = camera.ray(float(p % std::size_t(mask.width)) + 0.5f, float(p / std::size_t(mask.width)) + 0.5f)
                          .direction;
    std::vector<std::uint8_t> hit(pixels);
    scene.occluded(origins, directions, hit);
    for (std::size_t p = 0; p < pixels; ++p) mask.values[p] = hit[p];
    find(scene, mesh_edges, camera);
    for (const Crossing& c : crossings) {
      // The row's inside ends at `at`, on the side that `sign` points to; the pixel's centre may be on either.
      const float from = c.sign > 0 ? c.at - std::floor(c.at) : std::ceil(c.at) - c.at;
      float& m = mask.values[std::size_t(c.pixel)];
      m += c.share * (from < 0.5f ? from : from - 1);
    }
    for (float& m : mask.values) m = std::clamp(m, 0.0f, 1.0f);
  }

  /// The outline's pieces.
  int size() const { return int(crossings.size()); }

  /// f(pixel, its share's derivative by model) at every piece of the outline. project(model, point): where a vertex is
  /// seen, pixel x and y first, for a model of any number; the camera is the one that the mask was made with.
  template <class M, class Project, class F> void each_slope(const M& model, Project project, F f) const {
    constexpr int n = count<M>();
    using D = Dual<double, n>;
    auto lifted = lift<D>(model);
    int k = 0;
    each([&](D& x) { x = D(x.value, k++); }, lifted);
    for (const Crossing& c : crossings) {
      const auto a = project(lifted, mesh->positions[std::size_t(c.a)]),
                 b = project(lifted, mesh->positions[std::size_t(c.b)]);
      const double ax = c.column ? a.y.value : a.x.value, ay = c.column ? a.x.value : a.y.value,
                   bx = c.column ? b.y.value : b.x.value, by = c.column ? b.x.value : b.y.value;
      const double lean = (bx - ax) / (by - ay), t = (c.line - ay) / (by - ay);
      std::array<double, n> d;
      for (std::size_t i = 0; i < n; ++i) {
        const double dax = c.column ? a.y.slope[i] : a.x.slope[i], day = c.column ? a.x.slope[i] : a.y.slope[i],
                     dbx = c.column ? b.y.slope[i] : b.x.slope[i], dby = c.column ? b.x.slope[i] : b.y.slope[i];
        d[i] = c.sign * c.share * ((1 - t) * (dax - lean * day) + t * (dbx - lean * dby));
      }
      f(c.pixel, d);
    }
  }
  /// The derivative of a loss by model, d_mask its derivative by every pixel's share.
  template <class M, class Project> M backward(const Mask& d_mask, const M& model, Project project) const {
    std::array<double, std::size_t(count<M>())> sum{};
    each_slope(model, project, [&](int pixel, const auto& d) {
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += double(d_mask.values[std::size_t(pixel)]) * d[i];
    });
    M out = model;
    std::size_t i = 0;
    each([&](float& x) { x = float(sum[i++]); }, out);
    return out;
  }

private:
  struct Crossing {
    int pixel, a, b;
    bool column;    // the edge is followed along columns: x and y change places
    float at, line;  // the piece's middle: along the row, and across it
    float share;     // the part of the row that it spans
    float sign;      // +1 where the mesh lies before `at`
  };
  static constexpr int cuts = 2;  // pieces a row: an edge that goes behind another is seen or not by pieces
  const Mesh* mesh;
  std::vector<Crossing> crossings;

  template <class C> void find(const Raycaster& scene, const MeshEdges& of, const C& camera) {
    std::vector<vec3<float>> seen(mesh->positions.size());
    parallel_for(int(seen.size() + 4095) / 4096, [&](int block) {
      for (std::size_t v = std::size_t(block) * 4096; v < std::min(seen.size(), std::size_t(block + 1) * 4096); ++v)
        seen[v] = camera.project(mesh->positions[v]);
    });
    std::vector<signed char> side(mesh->triangles.size());
    for (std::size_t t = 0; t < side.size(); ++t) {
      const vec3<float> to = camera.position - mesh->positions[std::size_t(mesh->triangles[t][0])];
      side[t] = dot(mesh->cross_of(int(t)), to) > 0 ? 1 : -1;
    }
    std::vector<Crossing> found;
    for (const MeshEdges::Edge& e : of.edges) {
      if (e.face[1] >= 0) {
        const bool alike = side[std::size_t(e.face[0])] == side[std::size_t(e.face[1])];
        if (alike != e.same_winding) continue;
      }
      const vec3<float>&a = seen[std::size_t(e.a)], &b = seen[std::size_t(e.b)];
      if (!(a.z > 1e-3f && b.z > 1e-3f)) continue;
      const bool column = std::abs(b.x - a.x) > std::abs(b.y - a.y);
      follow(e, column ? vec2<float>(a.y, a.x) : vec2<float>(a.x, a.y),
             column ? vec2<float>(b.y, b.x) : vec2<float>(b.x, b.y), column, found);
    }
    keep_outline(scene, camera, found);
  }
  /// Cuts an edge into its pieces. Pixels amid the mask are left out: no outline can be there.
  void follow(const MeshEdges::Edge& e, vec2<float> a, vec2<float> b, bool column, std::vector<Crossing>& to) const {
    const int rows = column ? mask.width : mask.height, length = column ? mask.height : mask.width;
    const float low = std::max(std::min(a.y, b.y), 0.0f), high = std::min(std::max(a.y, b.y), float(rows));
    for (int cut = int(low * cuts); float(cut) < high * cuts; ++cut) {
      const float y0 = std::max(low, float(cut) / cuts), y1 = std::min(high, float(cut + 1) / cuts);
      const float line = 0.5f * (y0 + y1);
      const float x = a.x + (line - a.y) / (b.y - a.y) * (b.x - a.x);
      if (!(y1 - y0 > 1e-5f && x >= 0 && x < float(length))) continue;
      const int row = cut / cuts, i = column ? row : int(x), j = column ? int(x) : row;
      bool amid = true;
      for (int k = 0; k < 9 && amid; ++k) {
        const int u = std::clamp(i + k % 3 - 1, 0, mask.width - 1), v = std::clamp(j + k / 3 - 1, 0, mask.height - 1);
        amid = mask.at(u, v) > 0.5f;
      }
      if (!amid) to.push_back({j * mask.width + i, e.a, e.b, column, x, line, y1 - y0, 0});
    }
  }
  /// Of the pieces those with the mesh on one side and nothing on the other; of several that lie together the outermost
  /// one.
  template <class C> void keep_outline(const Raycaster& scene, const C& camera, std::vector<Crossing>& found) {
    constexpr float beside = 0.01f;  // pixels
    std::vector<vec3<float>> origins(2 * found.size(), camera.position), directions(origins.size());
    for (std::size_t i = 0; i < found.size(); ++i)
      for (const int s : {0, 1}) {
        const float x = found[i].at + (s ? beside : -beside), y = found[i].line;
        directions[2 * i + std::size_t(s)] = camera.ray(found[i].column ? y : x, found[i].column ? x : y).direction;
      }
    std::vector<std::uint8_t> hit(origins.size());
    scene.occluded(origins, directions, hit);
    for (std::size_t i = 0; i < found.size(); ++i)
      if (hit[2 * i] != hit[2 * i + 1]) {
        found[i].sign = hit[2 * i] ? 1.0f : -1.0f;
        crossings.push_back(found[i]);
      }
    std::sort(crossings.begin(), crossings.end(), [](const Crossing& x, const Crossing& y) {
      if (x.column != y.column) return x.column < y.column;
      if (int(x.line) != int(y.line)) return int(x.line) < int(y.line);
      if (x.sign != y.sign) return x.sign < y.sign;
      if (x.at != y.at) return x.sign > 0 ? x.at > y.at : x.at < y.at;
      return x.a != y.a ? x.a < y.a : x.b < y.b;
    });
    for (std::size_t i = 0; i < crossings.size(); ++i) {
      Crossing& c = crossings[i];
      const float whole = c.share;
      for (std::size_t j = i; j-- > 0;) {
        const Crossing& o = crossings[j];
        if (o.column != c.column || int(o.line) != int(c.line) || o.sign != c.sign) break;
        if (std::abs(o.at - c.at) > 2 * beside) break;
        const float overlap = 0.5f * (whole + o.share) - std::abs(o.line - c.line);
        if (overlap > 0) c.share -= std::min(overlap, c.share);
      }
    }
    std::erase_if(crossings, [](const Crossing& c) { return c.share < 1e-5f; });
  }
};

}  // namespace burnish
