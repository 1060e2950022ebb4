// burnish/twin/tones.h -- how bright one expects the places of a vehicle to be against its paint, whatever the light
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/scene/gbuffer.h>
#include <burnish/twin/parts.h>
#include <burnish/twin/wheels.h>

namespace burnish {

/// A tone is -1 for black, 0 for the paint, above 0 for what is brighter. What a part's name and opacity tell comes
/// first, then whether a place is on a wheel, then the file's colours and textures against those of most of the
/// vehicle.
class Tones {
public:
  /// given: a tone for every part, which outweighs all else; empty: none. The mesh stays with the caller.
  explicit Tones(const Mesh& m, const std::vector<float>& given = {}) : mesh(&m), of_part(given) {
    if (!given.empty()) return;
    bool painted = false;  // whether the paint is told
    for (const Part& p : m.parts) of_part.push_back(told(p)), painted = painted || of_part.back() == paint;
    wheels = find_wheels(m);
    std::vector<std::pair<float, float>> shades;  // luminance and area of the paint, or of what nothing is told of
    float all = 0;
    for (std::size_t t = 0; t < m.triangles.size(); t += 1 + m.triangles.size() / 20000) {
      const Part& p = m.parts[std::size_t(m.part[t])];
      if (of_part[std::size_t(m.part[t])] != (painted ? paint : untold)) continue;
      const auto& [a, b, c] = m.triangles[t];
      const vec2<float> uv((m.uvs[std::size_t(a)].x + m.uvs[std::size_t(b)].x + m.uvs[std::size_t(c)].x) / 3,
                           (m.uvs[std::size_t(a)].y + m.uvs[std::size_t(b)].y + m.uvs[std::size_t(c)].y) / 3);
      const vec3<float> cross = m.cross_of(int(t));
      shades.emplace_back(luminance_of(m.color(p, uv)), length(cross));
      all += shades.back().second;
    }
    std::sort(shades.begin(), shades.end());
    float sum = 0;
    for (const auto& [shade, area] : shades) {
      if ((sum += area) < 0.5f * all) continue;
      usual = shade;
      break;
    }
  }
  /// Of a surfel of this mesh's G-buffer.
  float at(const GBuffer& g, int i) const {
    const std::size_t part = std::size_t(g.part[std::size_t(i)]);
    if (of_part[part] < untold) return of_part[part];
    const Surfel<float> s = g.at(i);
    for (const Wheel& w : wheels)
      if (const float r = w.radius_at(s.position); r < 1.03f) return r > 0.65f ? -1.0f : -0.2f;
    const Part& p = g.parts[part];
    return std::clamp(0.35f * std::log2((luminance_of(mesh->color(p, s.uv)) + 0.02f) / (usual + 0.02f)), -1.0f, 0.4f);
  }

private:
  static constexpr float paint = 0, bright = 0.05f, untold = 1;
  const Mesh* mesh;
  std::vector<float> of_part;
  std::vector<Wheel> wheels;
  float usual = 0;  // luminance

  static float luminance_of(const vec3<float>& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }
  static float told(const Part& p) {
    NameHints h = name_hints(p.material);
    if (!h.any()) h = name_hints(p.name);
    if (h.tyre) return -1;
    if (!h.lamp && (h.glass || p.opacity < 0.75f)) return -0.8f;
    if (h.rim || h.lamp) return bright;
    if (h.wheel) return -0.6f;
    const std::string words = detail::words_of(p);
    for (const char* dark : {"black", "interi", "interna", "under", "grill", "exhaust", "seat", "plastic", "shadow"})
      if (words.find(dark) != words.npos) return -0.8f;
    return h.paint ? paint : untold;
  }
};

}  // namespace burnish
