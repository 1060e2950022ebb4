// examples/vehicle_parts.h -- which part of a vehicle is paint, glass or rubber, and how the rest looks
// SPDX-License-Identifier: Apache-2.0
//
// What a part is, twin/assign_parts.h knows.
#pragma once
#include <functional>
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
GivenKind parse_role(const std::string& text);

/// Role of every surfel.
std::vector<Role> roles_of(const GBuffer& g, const Mesh& mesh, const AssignedParts& parts);

/// What each surfel of a G-buffer of one mesh is.
using RolesOf = std::function<std::vector<Role>(const GBuffer&)>;
/// By assign_parts, once. The scene must outlive it.
RolesOf roles_by_parts(const Raycaster& scene, const std::vector<GivenKind>& given);

/// How the file (or, where it says nothing, the name) wants a part to look at a uv.
FileLook<float> file_look(const Mesh& mesh, const Part& p, const vec2<float>& uv);

}  // namespace parts
