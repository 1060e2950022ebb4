// examples/vehicle_parts.h -- which part of a vehicle is paint, glass or rubber, and how the rest looks
// SPDX-License-Identifier: Apache-2.0
//
// What a part is, twin/assign_parts.h knows.
#pragma once
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>
#include <burnish/fit/planes.h>
#include <burnish/io/parts.h>
#include <burnish/nodes/surface.h>
#include <burnish/twin/part_labels.h>

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

/// "material=role", from the command line; outweighs all guesses. A role or any kind of twin/parts.h; Error for others.
inline GivenKind parse_role(const std::string& text) {
  constexpr std::array<PartKind, 4> kinds{PartKind::body, PartKind::window, PartKind::tyre, PartKind::other};
  const std::size_t eq = text.rfind('=');
  if (eq == std::string::npos || eq == 0)
    throw Error("--role " + text + ": expected material=paint, glass, rubber or other");
  for (std::size_t r = 0; r < role_names.size(); ++r)
    if (text.substr(eq + 1) == role_names[r]) {
      GivenKind given = detail::given_kind(text.substr(0, eq), std::string(name_of(kinds[r])), "--role " + text);
      given.from = "--role " + text.substr(0, eq);
      return given;
    }
  if (part_kind_of(text.substr(eq + 1))) return parse_kind(text, "--role");
  throw Error("--role " + text +
              ": expected material=paint, glass, rubber or other, or a kind: " + detail::all_kinds());
}

/// Role of every surfel.
inline std::vector<Role> roles_of(const GBuffer& g, const Mesh& mesh, const AssignedParts& parts) {
  std::vector<Role> out;
  for (const int label : part_labels(g, mesh, parts)) out.push_back(Role(label - 1));
  return out;
}

/// What each surfel of a G-buffer of one mesh is.
using RolesOf = std::function<std::vector<Role>(const GBuffer&)>;
/// By assign_parts, once. The scene must outlive it.
inline RolesOf roles_by_parts(const Raycaster& scene, const std::vector<GivenKind>& given) {
  AssignOptions options;
  options.given = given;
  return [&scene, parts = assign_parts(scene, options)](const GBuffer& g) { return roles_of(g, scene.mesh(), parts); };
}

/// How the file (or, where it says nothing, the name) wants a part to look at a uv.
inline FileLook<float> file_look(const Mesh& mesh, const Part& p, const vec2<float>& uv) {
  FileLook<float> look;
  look.base_color = mesh.color(p, uv);
  const std::string w = burnish::detail::words_of(p);
  const auto any_of = [](const std::string& text, std::initializer_list<const char*> words) {
    return std::any_of(words.begin(), words.end(), [&](const char* x) { return text.find(x) != std::string::npos; });
  };
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
