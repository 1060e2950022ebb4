// examples/vehicle_parts.h -- which part of a vehicle is paint, glass or rubber, and how the rest looks
// SPDX-License-Identifier: Apache-2.0
//
// CAD files say little and never in the same words; what they say is in names, opacities, colours and textures.
#pragma once
#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>
#include <burnish/fit/planes.h>
#include <burnish/math/color.h>
#include <burnish/nodes/surface.h>
#include <burnish/scene/error.h>
#include <burnish/scene/vehicle.h>

namespace parts {
using namespace burnish;

enum class Role { paint, glass, rubber, other };
inline constexpr std::array<const char*, 4> role_names{"paint", "glass", "rubber", "other"};

/// What is not fitted looks as the file says.
template <class T> struct FileLook {
  vec3<T> base_color = {0.8f, 0.8f, 0.8f};
  T base_metalness = 0.0f, specular_roughness = 0.5f;
  static constexpr auto parameters() {
    return std::tuple{Param{"base_color", &FileLook::base_color, unit},
                      Param{"base_metalness", &FileLook::base_metalness, unit},
                      Param{"specular_roughness", &FileLook::specular_roughness, Range{min_roughness, 1}}};
  }
  template <class At> constexpr Surface<T> operator()(const At&) const {
    Surface<T> s;
    s.base_color = base_color;
    s.base_metalness = base_metalness;
    s.specular_roughness = specular_roughness;
    return s;
  }
};

inline std::string lower(std::string s) {
  for (char& c : s) c = char(std::tolower(static_cast<unsigned char>(c)));
  return s;
}
inline bool any_of(const std::string& text, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* w) { return text.find(w) != std::string::npos; });
}
/// "_words_of_the_material_" or of the part.
inline std::string words(const std::string& material, const std::string& name = "") {
  Part p;
  p.material = material, p.name = name;
  return burnish::detail::words_of(p);
}

/// "material=role", from the command line; outweighs all guesses.
struct GivenRole {
  std::string material;
  Role role;
};
/// Error for what is not of that form.
inline GivenRole parse_role(const std::string& text) {
  const std::size_t eq = text.rfind('=');
  if (eq != std::string::npos && eq > 0)
    for (std::size_t r = 0; r < role_names.size(); ++r)
      if (text.substr(eq + 1) == role_names[r]) return {text.substr(0, eq), Role(r)};
  throw Error("--role " + text + ": expected material=paint, glass, rubber or other");
}

/// What a part's words and opacity tell; nothing when they do not.
inline std::optional<Role> told_role(const Part& p) {
  constexpr auto tell = [](const std::string& w, float opacity) -> std::optional<Role> {
    const bool lamp =
        any_of(w, {"light", "lamp", "optic", "_red", "orange", "yellow", "white", "indicator", "blinker", "luz"});
    if (any_of(w, {"glass", "window", "windsh", "windsc", "vitre", "verre", "_glas", "vidro"}))
      return lamp && opacity > 0.85f ? Role::other : Role::glass;
    if (any_of(w, {"tire", "tyre", "rubber", "pneu", "borracha"})) return Role::rubber;
    if (lamp || any_of(w, {"chrom",     "interior", "interna",   "seat",  "plate",    "mirror",  "black",
                           "grill",     "doorline", "door_line", "_rim",  "alloy",    "hubcap",  "metal_",
                           "steel",     "plastic",  "logo",      "badge", "under",    "exhaust", "engine",
                           "reflector", "shadow",   "lowpart",   "holes", "textured", "brake",   "caliper"}))
      return Role::other;
    return {};
  };
  if (const auto role = tell(words(p.material), p.opacity)) return role;
  if (const auto role = tell(words("", p.name), p.opacity)) return role;
  if (any_of(words(p.material, p.name), {"wheel", "wheek"})) return Role::rubber;
  if (p.opacity < 0.75f) return Role::glass;
  return {};
}

/// A role for every surfel. The paint is the material of the largest seen area among what nothing is told of, one that
/// is called so before others. Where a texture shows that a part is not all of one kind (dark seams and windows or
/// small coloured lamps on a painted body, a bright rim in a tyre), those surfels are `other`. Error for a given
/// material that the file has not.
inline std::vector<Role> roles_of(const GBuffer& g, const Mesh& mesh, const std::vector<GivenRole>& given) {
  const std::size_t n = g.parts.size();
  std::vector<Role> role(n, Role::other);
  std::vector<bool> open(n), fixed(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto told = told_role(g.parts[i]);
    role[i] = told.value_or(Role::other), open[i] = !told;
  }
  for (const GivenRole& r : given) {
    bool found = false;
    for (std::size_t i = 0; i < n; ++i)
      if (lower(g.parts[i].material) == lower(r.material)) found = fixed[i] = true, open[i] = false, role[i] = r.role;
    if (found) continue;
    std::string all;
    std::map<std::string, int> names;
    for (const Part& p : g.parts)
      if (names[p.material]++ == 0) all += (all.empty() ? "" : ", ") + p.material;
    throw Error("--role " + r.material + ": the vehicle has no such material; it has " + all);
  }
  std::map<int, double> area;  // by material
  for (int i = 0; i < g.size(); ++i) {
    const Part& p = g.parts[std::size_t(g.part[std::size_t(i)])];
    if (!open[std::size_t(g.part[std::size_t(i)])]) continue;
    area[p.material_index] +=
        any_of(words(p.material), {"paint", "body", "carroc", "pintura", "firstcolor", "main_color", "lack"}) ? 3 : 1;
  }
  const auto largest =
      std::max_element(area.begin(), area.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const bool told_paint =
      std::any_of(given.begin(), given.end(), [](const GivenRole& r) { return r.role == Role::paint; });
  for (std::size_t i = 0; i < n && !told_paint && largest != area.end(); ++i)
    if (open[i] && g.parts[i].material_index == largest->first) role[i] = Role::paint;

  std::vector<Role> out(std::size_t(g.size()));
  std::map<int, std::map<int, int>> shades;  // of each textured painted part: how often a colour, 6 steps a channel
  std::vector<vec3<float>> color(out.size());
  const auto key = [](const vec3<float>& c) {
    const auto step = [](float x) { return int(5.99f * std::sqrt(std::clamp(x, 0.0f, 1.0f))); };
    return (step(c.x) * 6 + step(c.y)) * 6 + step(c.z);
  };
  for (std::size_t i = 0; i < out.size(); ++i) {
    const int part = g.part[i];
    out[i] = role[std::size_t(part)];
    if (g.parts[std::size_t(part)].texture < 0) continue;
    color[i] = mesh.color(g.parts[std::size_t(part)], g.at(int(i)).uv);
    if (out[i] == Role::paint) ++shades[part][key(color[i])];
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
    if (out[i] != Role::paint || main.find(g.part[i]) == main.end()) continue;
    ++painted[g.part[i]];
    if (const int s = sector(color[i]); s >= 0) ++sectors[g.part[i]][std::size_t(s)];
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t part = std::size_t(g.part[i]);
    if (g.parts[part].texture < 0 || fixed[part]) continue;
    if (out[i] == Role::rubber && luminance(color[i]) > 0.1f) out[i] = Role::other;
    if (out[i] != Role::paint) continue;
    const int s = sector(color[i]);
    const auto value = [](const vec3<float>& c) { return std::max({c.x, c.y, c.z}); };
    const bool dark = s < 0 && value(color[i]) < 0.2f * value(main[int(part)]);
    const bool rare = s >= 0 && float(sectors[int(part)][std::size_t(s)]) < 0.04f * float(painted[int(part)]);
    if (dark || rare) out[i] = Role::other;
  }
  return out;
}

/// What each surfel of a G-buffer of one mesh is.
using RolesOf = std::function<std::vector<Role>(const GBuffer&)>;

/// How the file (or, where it says nothing, the name) wants a part to look at a uv.
inline FileLook<float> file_look(const Mesh& mesh, const Part& p, const vec2<float>& uv) {
  FileLook<float> look;
  look.base_color = mesh.color(p, uv);
  const std::string w = words(p.material, p.name);
  const vec3<float>& c = p.base_color;
  const bool untold = p.texture < 0 && c.x == c.y && c.y == c.z && c.x > 0.45f;  // exporters' defaults are light greys
  const auto grey = [&](float x) {
    if (untold) look.base_color = {x, x, x};
  };
  if (any_of(w, {"chrom", "mirror", "reflector"})) grey(0.6f), look.base_metalness = 1, look.specular_roughness = 0.12f;
  else if (any_of(w, {"alloy", "_rim", "hubcap", "steel", "metal_", "exhaust"}))
    grey(0.5f), look.base_metalness = 0.9f, look.specular_roughness = 0.35f;
  else if (any_of(w, {"red", "tail", "brake"}) && any_of(w, {"light", "lamp", "glass"})) {
    if (untold) look.base_color = {0.25f, 0.01f, 0.01f};
    look.specular_roughness = 0.15f;
  } else if (any_of(w, {"light", "lamp", "optic", "glass"})) grey(0.55f), look.specular_roughness = 0.12f;
  else if (any_of(w, {"black", "plastic", "grill", "line"})) grey(0.03f), look.specular_roughness = 0.4f;
  else if (any_of(w, {"interior", "seat", "under", "shadow", "lowpart", "hole", "engine"}))
    grey(0.04f), look.specular_roughness = 0.8f;
  else if (any_of(w, {"wheel", "wheek"})) look.base_metalness = 0.5f, look.specular_roughness = 0.35f;
  return look;
}

}  // namespace parts
