// burnish/scene/gbuffer.h -- what the camera sees of a mesh: the surface at every pixel that was hit, packed
// SPDX-License-Identifier: Apache-2.0
//
// Only pixels that were hit are held, in the order of the picture's rows, every field in a plane of its own, so that
// shading touches nothing else and runs in packets. Planes are padded to a multiple of 256 by repeating the last
// surfel.
#pragma once
#include <algorithm>
#include <array>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>
#include <burnish/ad/model.h>
#include <burnish/scene/camera.h>
#include <burnish/scene/image.h>
#include <burnish/scene/mesh.h>

namespace burnish {

/// The surface at one pixel, as a material sees it.
template <class T> struct Surfel {
  vec3<T> position;  // metres, world
  vec3<T> normal;    // unit, of shading, on the viewer's side: dot(normal, view) > 0
  vec3<T> tangent;   // unit, along +u, perpendicular to normal; the bitangent is cross(normal, tangent)
  vec3<T> view;      // unit, to the camera
  vec2<T> uv;
  T index{};         // place in this G-buffer, 0 .. size - 1

  static constexpr auto parameters() {
    return std::tuple{Param{"position", &Surfel::position}, Param{"normal", &Surfel::normal},
                      Param{"tangent", &Surfel::tangent},   Param{"view", &Surfel::view},
                      Param{"uv", &Surfel::uv},             Param{"index", &Surfel::index}};
  }
};

struct GBuffer {
  /// The planes' places and names; the first `fields` are a Surfel's numbers in the order of its parameters().
  static constexpr int fields = 15, geometric = 15, depth = 18, coverage = 19, planes = 20;
  static constexpr std::array<std::string_view, planes> names{
      "position.x",    "position.y",    "position.z",    "normal.x",           "normal.y",
      "normal.z",      "tangent.x",     "tangent.y",     "tangent.z",          "view.x",
      "view.y",        "view.z",        "uv.x",          "uv.y",               "index",
      "geometric_normal.x", "geometric_normal.y", "geometric_normal.z", "depth", "coverage"};

  int width = 0, height = 0;
  Camera camera;
  std::vector<Part> parts;
  std::vector<int> pixel;    // of each surfel: y * width + x; ascending as traced
  std::vector<int> part;     // of each surfel: index into parts
  /// See names. depth: metres along the view axis. geometric_normal: unit, on the viewer's side. coverage: the part of
  /// the pixel's area that the mesh covers, 0 < coverage <= 1; where the pixel's centre misses, the surfel is the
  /// covered one nearest to it.
  std::array<Floats, planes> plane;

  /// Surfels, without the padding.
  int size() const { return int(pixel.size()); }
  /// Length of the planes: a multiple of 256.
  int padded_size() const { return int(padded(pixel.size(), 256)); }
  /// A surfel's planes as the players of a recording want them.
  std::array<const float*, fields> pointers() const {
    std::array<const float*, fields> p{};
    for (int i = 0; i < fields; ++i) p[i] = plane[i].data();
    return p;
  }
  Surfel<float> at(int i) const {
    const auto v = [&](int first) { return vec3<float>(plane[first][i], plane[first + 1][i], plane[first + 2][i]); };
    return {v(0), v(3), v(6), v(9), vec2<float>(plane[12][i], plane[13][i]), plane[14][i]};
  }
  vec3<float> geometric_normal(int i) const { return {plane[15][i], plane[16][i], plane[17][i]}; }

  /// Room for n surfels: pixel and part are resized, the planes to the padded length. close() after they are written.
  void resize(int n) {
    pixel.resize(n);
    part.resize(n);
    for (Floats& p : plane) p.resize(padded(n, 256));
  }
  /// Numbers the surfels and fills the padding.
  void close(bool renumber = true) {
    for (int i = 0; i < size() && renumber; ++i) plane[14][i] = float(i);
    if (size() == 0) return;
    for (Floats& p : plane) std::fill(p.begin() + size(), p.end(), p[size() - 1]);
  }

  /// The surfels for which keep(part id) or keep(Surfel<float>) holds, numbered anew; the picture keeps its size.
  template <class F> GBuffer only(F keep) const {
    std::vector<int> chosen;
    for (int i = 0; i < size(); ++i) {
      bool yes;
      if constexpr (std::is_invocable_v<F&, int>) yes = keep(part[i]);
      else yes = keep(at(i));
      if (yes) chosen.push_back(i);
    }
    return picked(chosen);
  }
  /// These surfels in this order. renumber = false: their index stays what it is here, for tables made for this.
  GBuffer picked(const std::vector<int>& chosen, bool renumber = true) const {
    GBuffer g;
    g.width = width, g.height = height, g.camera = camera, g.parts = parts;
    g.resize(int(chosen.size()));
    for (int i = 0; i < g.size(); ++i) {
      g.pixel[i] = pixel[chosen[i]];
      g.part[i] = part[chosen[i]];
      for (int k = 0; k < planes; ++k) g.plane[k][i] = plane[k][chosen[i]];
    }
    g.close(renumber);
    return g;
  }

  /// A value per surfel spread over the whole picture, height x width; background where nothing was hit.
  Mask spread(const float* values, float background = 0) const {
    Mask frame(width, height, background);
    for (int i = 0; i < size(); ++i) frame.values[pixel[i]] = values[i];
    return frame;
  }
  /// One of names, or "part", spread over the whole picture; the background is 0, for "part" -1.
  Mask frame(std::string_view name) const {
    if (name == "part") {
      Floats ids(part.begin(), part.end());
      return spread(ids.data(), -1);
    }
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? Mask(width, height) : spread(plane[found - names.begin()].data());
  }
};

}  // namespace burnish
