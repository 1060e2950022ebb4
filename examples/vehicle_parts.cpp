// examples/vehicle_parts.cpp -- how vehicle_parts.h tells paint, glass and rubber apart
// SPDX-License-Identifier: Apache-2.0
#include "vehicle_parts.h"
#include <initializer_list>
#include <burnish/twin/part_labels.h>

namespace parts {

GivenKind parse_role(const std::string& text) {
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

std::vector<Role> roles_of(const GBuffer& g, const Mesh& mesh, const AssignedParts& parts) {
  std::vector<Role> out;
  for (const int label : part_labels(g, mesh, parts)) out.push_back(Role(label - 1));
  return out;
}

RolesOf roles_by_parts(const Raycaster& scene, const std::vector<GivenKind>& given) {
  AssignOptions options;
  options.given = given;
  return [&scene, parts = assign_parts(scene, options)](const GBuffer& g) { return roles_of(g, scene.mesh(), parts); };
}

FileLook<float> file_look(const Mesh& mesh, const Part& p, const vec2<float>& uv) {
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
