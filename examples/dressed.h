// examples/dressed.h -- a vehicle with its fitted materials on, part by part: to be turned, and to be written as glTF
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/io/bake.h>
#include <burnish/scene/raycast.h>
#include <burnish/twin/parts.h>
#include <burnish/twin/pose.h>
#include "looks.h"
#include "vehicle_parts.h"

namespace dressed {
using namespace burnish;

/// A part's texture with its main colour exchanged: what is a darker shade of it (seams, baked shadows) stays so, and
/// what has another hue or is much brighter (lamps, chrome, a rim in a tyre) stays as it is.
class Recoloured {
public:
  Recoloured() = default;
  /// colors: some of what is seen of the part. The main colour explains most of them, as itself or a darker shade;
  /// most: how bright it may be.
  Recoloured(const std::vector<vec3<float>>& colors, float most) {
    std::map<int, std::pair<int, vec3<float>>> shades;  // how many, and their sum, by 6 steps a channel
    const auto step = [](float x) { return int(5.99f * std::sqrt(std::clamp(x, 0.0f, 1.0f))); };
    for (const vec3<float>& c : colors) {
      auto& [count, sum] = shades[(step(c.x) * 6 + step(c.y)) * 6 + step(c.z)];
      ++count, sum += c;
    }
    double best = 0;
    vec3<float> found = main_;
    for (const auto& [key, shade] : shades) {
      main_ = shade.second / float(shade.first);
      if (luminance(main_) > most) continue;
      double explained = 0;
      for (const auto& [other, o] : shades) {
        const auto [part, shade_of_main] = share(o.second / float(o.first));
        if (part > 0.5f && shade_of_main > 0.3f && shade_of_main < brightest) explained += o.first;
      }
      if (luminance(main_) < 0.03f) explained *= 0.4;  // black plastic is seen on cars of every colour
      if (explained > best || (explained == best && luminance(main_) > luminance(found)))
        best = explained, found = main_;
    }
    main_ = found;
    std::vector<float> bright;  // the paint in the light, not in the shadows that were baked into it
    for (const vec3<float>& c : colors)
      if (const auto [part, shade] = share(c); part > 0.5f && shade > 0.3f) bright.push_back(shade);
    if (bright.empty()) return;
    const auto at = bright.begin() + std::ptrdiff_t(bright.size() * 7 / 10);
    std::nth_element(bright.begin(), at, bright.end());
    main_ = main_ * *at;
  }
  /// The share of the main colour in a colour, and how bright that is of the main colour's brightness.
  struct Share {
    float part, shade;
  };
  Share share(const vec3<float>& color) const {
    const float shade = dot(color, main_) / std::max(dot(main_, main_), 1e-6f);
    const float apart = length(color - main_ * shade) / std::max(length(color), 0.02f);
    return {(1 - smoothstep(0.15f, 0.35f, apart)) * (1 - smoothstep(1.3f, 2.0f, shade)), std::min(shade, brightest)};
  }
  vec3<float> operator()(const vec3<float>& color, const vec3<float>& instead) const {
    const auto [part, shade] = share(color);
    return mix(color, min(instead * shade, vec3<float>(1)), part);
  }

private:
  static constexpr float brightest = 1.2f;  // of the main colour
  vec3<float> main_{0.5f, 0.5f, 0.5f};
};

/// Bodies bear the paint, windows the glass, tyres the rubber; everything else looks as its file says. Keeps a
/// reference to the scene's mesh.
class Dressed {
public:
  /// kinds: of each part of the mesh.
  Dressed(const Raycaster& scene, const std::vector<PartKind>& kinds, const looks::Vehicle& fitted)
      : mesh_(scene.mesh()), fitted_(fitted), role_(kinds.size(), Role::other), main_(kinds.size()) {
    std::vector<std::vector<vec3<float>>> seen(kinds.size());  // of the textured parts, from all round
    Pose<float> pose;
    pose.width = 160, pose.height = 100, pose.focal = 1.5f, pose.elevation = 0.3f;
    pose.center = bounds(mesh_).center(), pose.distance = 1.8f * length(bounds(mesh_).size());
    for (int view = 0; view < 8 && !mesh_.images.empty(); ++view) {
      pose.azimuth = 2 * pi * (float(view) + 0.5f) / 8;
      const GBuffer g = scene.trace(pose.camera(), 1);
      for (int i = 0; i < g.size(); ++i) {
        const std::size_t p = std::size_t(g.part[std::size_t(i)]);
        if (mesh_.parts[p].texture >= 0) seen[p].push_back(mesh_.color(mesh_.parts[p], g.at(i).uv));
      }
    }
    for (std::size_t p = 0; p < kinds.size(); ++p) {
      file_.push_back(parts::file_look(mesh_, mesh_.parts[p], {}));
      const bool textured = mesh_.parts[p].texture >= 0, dark = luminance(mesh_.parts[p].base_color) < 0.2f;
      if (kinds[p] == PartKind::body) role_[p] = Role::paint;
      if (kinds[p] == PartKind::window && !textured) role_[p] = Role::glass;
      if (kinds[p] == PartKind::tyre || (kinds[p] == PartKind::wheel && (textured || dark))) role_[p] = Role::rubber;
      if (textured && role_[p] != Role::other) main_[p] = Recoloured(seen[p], role_[p] == Role::paint ? 1 : 0.12f);
    }
  }
  Surface<float> operator()(int part, const Surfel<float>& at) const {
    const std::size_t p = std::size_t(part);
    if (role_[p] == Role::glass) return fitted_.window.glass(at);
    parts::FileLook<float> look = file_[p];
    if (mesh_.parts[p].texture >= 0) look.base_color = mesh_.color(mesh_.parts[p], at.uv);
    const Surface<float> own = look(at);
    if (role_[p] == Role::other) return own;
    Surface<float> s = role_[p] == Role::paint ? fitted_.paint(at) : fitted_.rubber(at);
    if (mesh_.parts[p].texture < 0) return s;
    const vec3<float> color = mesh_.color(mesh_.parts[p], at.uv);
    if (role_[p] == Role::rubber && main_[p].share(color).part < 0.5f) return own;
    s.base_color = main_[p](color, s.base_color);
    return s;
  }

  /// The same for glTF, whose textures hold colours alone: a part with a texture has one surface all over.
  PartMaterials materials(const BakeOptions& options = {}) const {
    PartMaterials out = file_materials(mesh_);
    std::map<std::pair<int, Role>, int> known;  // by the file's material
    const Surfel<float> nowhere{{}, {0, 0, 1}, {1, 0, 0}, {0, 0, 1}, {}, 0};
    for (std::size_t p = 0; p < mesh_.parts.size(); ++p) {
      const auto [at, fresh] = known.try_emplace({out.of_part[p], role_[p]}, int(out.materials.size()));
      if (fresh) out.materials.push_back(made(p, out.materials[std::size_t(out.of_part[p])], nowhere, options));
      out.of_part[p] = at->second;
    }
    return out;
  }

private:
  using Role = parts::Role;
  const Mesh& mesh_;
  looks::Vehicle fitted_;
  std::vector<Role> role_;
  std::vector<Recoloured> main_;
  std::vector<parts::FileLook<float>> file_;  // its colour where it has no texture

  GltfMaterial made(std::size_t p, const GltfMaterial& file, const Surfel<float>& at,
                    const BakeOptions& options) const {
    const Part& part = mesh_.parts[p];
    const std::string& name = part.material;
    if (part.texture < 0) {
      if (role_[p] == Role::paint) return bake(name, fitted_.paint, options);
      if (role_[p] == Role::glass) return bake(name, fitted_.window.glass, options);
      if (role_[p] == Role::rubber) return bake(name, fitted_.rubber, options);
    }
    if (role_[p] == Role::other) {
      Surface<float> s = parts::file_look(mesh_, part, {})(at);
      GltfMaterial m = file;
      m.metalness = s.base_metalness, m.roughness = s.specular_roughness;
      if (part.texture < 0) m.base_color = min(max(s.base_color, vec3<float>(0)), vec3<float>(1));
      return m;
    }
    Surface<float> s = role_[p] == Role::paint ? fitted_.paint(at) : fitted_.rubber(at);
    GltfMaterial m = gltf_material(name, s, options);
    Image image = mesh_.images[std::size_t(part.texture)];
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) image.set(x, y, main_[p](image.at(x, y) * part.base_color, m.base_color));
    m.base_color = {1, 1, 1};
    m.base_color_map = std::move(image);
    return m;
  }
};

/// A .glb of the vehicle; what has no texture of its own gets uvs in metres, for the baked ones.
inline void write(const std::string& path, const Mesh& mesh, const Dressed& look, const std::string& name) {
  Mesh metric = mesh;
  MeshReport unsaid;
  fill_uvs(metric, unsaid, true);
  write_gltf(path, metric, look.materials(), name);
}

}  // namespace dressed
