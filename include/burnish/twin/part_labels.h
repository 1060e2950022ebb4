// burnish/twin/part_labels.h -- the kinds of a vehicle's parts, pixel by pixel, also where one texture holds several
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <burnish/math/color.h>
#include <burnish/scene/gbuffer.h>
#include <burnish/twin/parts.h>

namespace burnish {

/// For every surfel 1 paint, 2 glass, 3 rubber or 4 other. Where a texture shows that a part is not all of one kind
/// (dark seams and windows or small coloured lamps on a painted body, a bright rim in a wheel), those surfels are 4,
/// but for parts that the user gave a kind (confidence 1).
inline std::vector<int> part_labels(const GBuffer& g, const Mesh& mesh, const AssignedParts& parts) {
  std::vector<int> out(std::size_t(g.size()));
  std::vector<vec3<float>> color(out.size());
  std::map<int, std::map<int, int>> shades;  // of each textured painted part: how often a colour, 6 steps a channel
  const auto textured = [&](int part) {
    return g.parts[std::size_t(part)].texture >= 0 && parts.parts[std::size_t(part)].confidence < 1;
  };
  const auto key = [](const vec3<float>& c) {
    const auto step = [](float x) { return int(5.99f * std::sqrt(std::clamp(x, 0.0f, 1.0f))); };
    return (step(c.x) * 6 + step(c.y)) * 6 + step(c.z);
  };
  for (std::size_t i = 0; i < out.size(); ++i) {
    const int part = g.part[i];
    out[i] = photo_label(parts.parts[std::size_t(part)].kind);
    if (!textured(part)) continue;
    color[i] = mesh.color(g.parts[std::size_t(part)], g.at(int(i)).uv);
    if (out[i] == 1) ++shades[part][key(color[i])];
  }
  std::map<int, vec3<float>> main;  // the mean of the most frequent step
  for (const auto& [part, counts] : shades) {
    const int most = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
                       return a.second < b.second;
                     })->first;
    vec3<float> sum;
    float count = 0;
    for (std::size_t i = 0; i < out.size(); ++i)
      if (g.part[i] == part && key(color[i]) == most) sum += color[i], ++count;
    main[part] = sum / count;
  }
  std::map<int, std::array<int, 6>> sectors;  // of each such part: how many surfels have a strong hue, by sixth
  std::map<int, int> painted;
  const auto sector = [](const vec3<float>& c) {
    const vec3<float> hsv = rgbtohsv(c);
    return hsv.y > 0.5f && hsv.z > 0.05f ? int(std::lround(hsv.x * 6)) % 6 : -1;
  };
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (out[i] != 1 || main.find(g.part[i]) == main.end()) continue;
    ++painted[g.part[i]];
    if (const int s = sector(color[i]); s >= 0) ++sectors[g.part[i]][std::size_t(s)];
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    const int part = g.part[i];
    if (!textured(part)) continue;
    if (out[i] == 3 && luminance(color[i]) > 0.1f) out[i] = 4;
    if (out[i] != 1) continue;
    const int s = sector(color[i]);
    const auto value = [](const vec3<float>& c) { return std::max({c.x, c.y, c.z}); };
    const bool dark = s < 0 && value(color[i]) < 0.2f * value(main[part]);
    const bool rare = s >= 0 && float(sectors[part][std::size_t(s)]) < 0.04f * float(painted[part]);
    if (dark || rare) out[i] = 4;
  }
  return out;
}

}  // namespace burnish
