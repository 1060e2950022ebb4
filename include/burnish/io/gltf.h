// burnish/io/gltf.h -- a vehicle with its materials as one glTF 2.0 file (.glb) that viewers and editors open
// SPDX-License-Identifier: Apache-2.0
//
// Khronos, glTF 2.0 specification (2021) and its extensions KHR_materials_clearcoat, _transmission, _ior, _specular and
// KHR_texture_transform. Metres, +Y up; the vehicle's front, +x here, looks to +Z there, as glTF wants it: the root
// node turns it, everything below stays in the frame of scene/vehicle.h.
#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <burnish/io/photo.h>
#include <burnish/scene/mesh.h>

namespace burnish {

/// A material in glTF's own terms (io/bake.h makes one of a Surface or a node). Colours are linear RGB. Pictures are
/// empty where a number says all; they repeat, `tiles` times over one unit of uv, the first row at the larger v.
struct GltfMaterial {
  std::string name;
  vec3<float> base_color{0.8f, 0.8f, 0.8f};  // 0 to 1
  float alpha = 1;                           // coverage; below 1 it is blended
  float metalness = 0, roughness = 0.5f;
  float clearcoat = 0, clearcoat_roughness = 0;
  float transmission = 0;
  float ior = 1.5f, specular = 1;
  vec3<float> specular_color{1, 1, 1};
  Image base_color_map;           // linear, multiplies base_color
  Image roughness_metalness_map;  // green: multiplies roughness, blue: metalness
  Image normal_map;               // the normal in the tangent frame (x along u, y along v, z out), as it is: -1 to 1
  vec2<float> tiles{1, 1};
};

namespace detail {
/// A picture as the bytes of a PNG of 8 bits; values as they are stored, 0 to 1.
inline std::string png_of(const Image& image) {
  std::vector<float> rgb(std::size_t(image.width) * std::size_t(image.height) * 3);
  for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = std::clamp(image.plane(int(i % 3))[i / 3], 0.0f, 1.0f);
  return encoded("png", OIIO::ImageSpec(image.width, image.height, 3, OIIO::TypeDesc::UINT8), rgb.data());
}

/// The parts of a .glb as they are put together.
class GltfFile {
public:
  using Json = nlohmann::ordered_json;
  Json json = {{"asset", {{"version", "2.0"}, {"generator", "burnish"}}}};
  std::string bytes;  // of the binary chunk

  int append(const char* list, Json entry) {
    json[list].push_back(std::move(entry));
    return int(json[list].size()) - 1;
  }
  /// A bufferView; target: 34962 for vertices, 34963 for indices, 0 for pictures.
  int view(const void* data, std::size_t size, int target = 0) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    Json v{{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", size}};
    if (target) v["target"] = target;
    bytes.append(static_cast<const char*>(data), size);
    return append("bufferViews", std::move(v));
  }
  /// Floats, `width` a vertex.
  int vertices(const std::vector<float>& values, int width, bool bounds) {
    Json a{{"bufferView", view(values.data(), values.size() * sizeof(float), 34962)},
           {"componentType", 5126},
           {"count", values.size() / std::size_t(width)},
           {"type", width == 3 ? "VEC3" : "VEC2"}};
    for (int c = 0; c < width && bounds; ++c) {
      float low = values[std::size_t(c)], high = low;
      for (std::size_t i = std::size_t(c); i < values.size(); i += std::size_t(width))
        low = std::min(low, values[i]), high = std::max(high, values[i]);
      a["min"].push_back(low), a["max"].push_back(high);
    }
    return append("accessors", std::move(a));
  }
  /// Two bytes an index where that is enough.
  int indices(const std::vector<std::uint32_t>& list, std::size_t vertex_count) {
    const bool narrow = vertex_count < 65535;
    const std::vector<std::uint16_t> two(list.begin(), list.end());
    const int v = narrow ? view(two.data(), two.size() * 2, 34963) : view(list.data(), list.size() * 4, 34963);
    return append(
        "accessors",
        {{"bufferView", v}, {"componentType", narrow ? 5123 : 5125}, {"count", list.size()}, {"type", "SCALAR"}});
  }
  /// {"index": ...} of a picture; the same picture is stored once.
  Json texture(const Image& image, const std::string& name, const vec2<float>& tiles) {
    const std::string png = png_of(image);
    const auto [at, fresh] = known_.try_emplace(png, 0);
    if (fresh) {
      if (json.find("samplers") == json.end()) append("samplers", {{"wrapS", 10497}, {"wrapT", 10497}});
      const int source =
          append("images", {{"name", name}, {"mimeType", "image/png"}, {"bufferView", view(png.data(), png.size())}});
      at->second = append("textures", {{"sampler", 0}, {"source", source}});
    }
    Json t{{"index", at->second}};
    if (tiles.x != 1 || tiles.y != 1)  // glTF's v is 1 - v: only whole numbers of tiles would need no offset
      t["extensions"] = {{use("KHR_texture_transform"), {{"offset", {0, 1 - tiles.y}}, {"scale", {tiles.x, tiles.y}}}}};
    return t;
  }
  std::string use(const std::string& extension) {
    Json& used = json["extensionsUsed"];
    if (std::find(used.begin(), used.end(), extension) == used.end()) used.push_back(extension);
    return extension;
  }
  int material(const GltfMaterial& m) {
    Json pbr{{"baseColorFactor", {m.base_color.x, m.base_color.y, m.base_color.z, m.alpha}},
             {"metallicFactor", m.metalness},
             {"roughnessFactor", m.roughness}};
    const auto coded = [](Image image, auto code) {
      for (int c = 0; c < 3; ++c)
        for (int i = 0; i < image.width * image.height; ++i) image.plane(c)[i] = code(image.plane(c)[i]);
      return image;
    };
    if (m.base_color_map.width > 0)
      pbr["baseColorTexture"] = texture(coded(m.base_color_map, [](float x) { return to_srgb(std::max(x, 0.0f)); }),
                                        m.name + " base color", m.tiles);
    if (m.roughness_metalness_map.width > 0)
      pbr["metallicRoughnessTexture"] = texture(m.roughness_metalness_map, m.name + " roughness", m.tiles);
    Json j{{"name", m.name}, {"pbrMetallicRoughness", pbr}, {"doubleSided", true}};
    if (m.normal_map.width > 0)
      j["normalTexture"] =
          texture(coded(m.normal_map, [](float x) { return 0.5f + 0.5f * x; }), m.name + " normal", m.tiles);
    if (m.alpha < 1) j["alphaMode"] = "BLEND";
    if (m.clearcoat > 0)
      j["extensions"][use("KHR_materials_clearcoat")] = {{"clearcoatFactor", m.clearcoat},
                                                         {"clearcoatRoughnessFactor", m.clearcoat_roughness}};
    if (m.transmission > 0)
      j["extensions"][use("KHR_materials_transmission")] = {{"transmissionFactor", m.transmission}};
    if (m.ior != 1.5f) j["extensions"][use("KHR_materials_ior")] = {{"ior", m.ior}};
    const vec3<float>& c = m.specular_color;
    if (m.specular != 1 || c.x != 1 || c.y != 1 || c.z != 1)
      j["extensions"][use("KHR_materials_specular")] = {{"specularFactor", m.specular},
                                                        {"specularColorFactor", {c.x, c.y, c.z}}};
    return append("materials", std::move(j));
  }
  void write(const std::string& path) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    json["buffers"] = {{{"byteLength", bytes.size()}}};
    // Names come from files of all kinds: what is no UTF-8 in them is replaced.
    std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::uint64_t all = 28 + text.size() + bytes.size();
    if (all > 0xffffffffu) throw Error(path + ": " + std::to_string(all) + " bytes, a .glb holds less than 4 GiB");
    std::string file;
    const auto number = [&](std::uint64_t n) {
      for (int shift = 0; shift < 32; shift += 8) file += char(n >> shift & 255);
    };
    file += "glTF", number(2), number(all);
    number(text.size()), file += "JSON", file += text;
    number(bytes.size()), file += std::string("BIN\0", 4), file += bytes;
    write_text(path, file);
  }

private:
  std::map<std::string, int> known_;
};
}  // namespace detail

/// Materials, and of each part of a mesh the place of its own among them.
struct PartMaterials {
  std::vector<GltfMaterial> materials;
  std::vector<int> of_part;
};

/// A node a part, with the part's name; its origin is the middle of the part's box, so that a wheel turns about itself.
/// Normals are written where all of a part's corners have one, uvs
/// where all are finite. Parts without a triangle are left out. Error for a mesh without triangles, a part without a
/// material, a number that is not finite, and what cannot be written.
inline void write_gltf(const std::string& path, const Mesh& mesh, const PartMaterials& look,
                       const std::string& name = "vehicle") {
  using Json = detail::GltfFile::Json;
  if (mesh.triangles.empty()) throw Error(path + ": a mesh without triangles, expected at least one");
  if (look.of_part.size() != mesh.parts.size())
    throw Error(path + ": materials for " + std::to_string(look.of_part.size()) + " parts, expected " +
                std::to_string(mesh.parts.size()));
  std::vector<std::vector<int>> triangles(mesh.parts.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) triangles[std::size_t(mesh.part[t])].push_back(int(t));

  detail::GltfFile file;
  Json children = Json::array();
  file.json["scene"] = 0;
  file.json["scenes"] = {{{"nodes", {0}}}};
  file.json["nodes"] = {{{"name", name}, {"rotation", {0, -0.70710678f, 0, 0.70710678f}}}};  // +x to +Z
  std::map<int, int> written;                                                                // materials that are used
  std::vector<int> place(mesh.positions.size(), -1);
  for (std::size_t part = 0; part < mesh.parts.size(); ++part) {
    if (triangles[part].empty()) continue;
    const int material = look.of_part[part];
    if (material < 0 || material >= int(look.materials.size()))
      throw Error(path + ": part " + mesh.parts[part].name + " has material " + std::to_string(material) + " of " +
                  std::to_string(look.materials.size()));
    const auto [at, fresh] = written.try_emplace(material, 0);
    if (fresh) at->second = file.material(look.materials[std::size_t(material)]);

    std::vector<int> used;
    std::vector<std::uint32_t> indices;
    Box box;
    for (const int t : triangles[part])
      for (const int v : mesh.triangles[std::size_t(t)]) {
        int& to = place[std::size_t(v)];
        if (to < 0) to = int(used.size()), used.push_back(v), box.add(mesh.positions[std::size_t(v)]);
        indices.push_back(std::uint32_t(to));
      }
    const vec3<float> middle = box.center();
    std::vector<float> positions, normals, uvs;
    for (const int v : used) {
      const vec3<float> p = mesh.positions[std::size_t(v)], q = p - middle, n = mesh.normals[std::size_t(v)];
      const vec2<float> uv = mesh.uvs[std::size_t(v)];
      if (!detail::finite(p))
        throw Error(path + ": vertex " + std::to_string(v) + " of " + mesh.parts[part].name + " is not a number");
      positions.insert(positions.end(), {q.x, q.y, q.z});
      if (const float size = length(n); detail::finite(n) && size > 0.5f)
        normals.insert(normals.end(), {n.x / size, n.y / size, n.z / size});
      if (detail::finite(uv)) uvs.insert(uvs.end(), {uv.x, 1 - uv.y});
      place[std::size_t(v)] = -1;
    }
    Json attributes{{"POSITION", file.vertices(positions, 3, true)}};
    if (normals.size() == positions.size()) attributes["NORMAL"] = file.vertices(normals, 3, false);
    if (3 * uvs.size() == 2 * positions.size()) attributes["TEXCOORD_0"] = file.vertices(uvs, 2, false);
    const int indexed = file.indices(indices, used.size());
    const int shape = file.append(
        "meshes", {{"name", mesh.parts[part].name},
                   {"primitives", {{{"attributes", attributes}, {"indices", indexed}, {"material", at->second}}}}});
    children.push_back(file.append(
        "nodes", {{"name", mesh.parts[part].name}, {"mesh", shape}, {"translation", {middle.x, middle.y, middle.z}}}));
  }
  file.json["nodes"][0]["children"] = children;
  file.write(path);
}

/// What a mesh's file gave its parts: one for every different pair of colour and texture.
inline PartMaterials file_materials(const Mesh& mesh) {
  PartMaterials out;
  std::vector<const Part*> first;
  for (const Part& p : mesh.parts) {
    const auto same = [&](const Part* q) {
      return q->material_index == p.material_index && q->texture == p.texture && q->opacity == p.opacity &&
             q->base_color.x == p.base_color.x && q->base_color.y == p.base_color.y &&
             q->base_color.z == p.base_color.z;
    };
    const auto at = std::find_if(first.begin(), first.end(), same);
    out.of_part.push_back(int(at - first.begin()));
    if (at != first.end()) continue;
    first.push_back(&p);
    GltfMaterial m;
    m.name = p.material;
    m.base_color = min(max(p.base_color, vec3<float>(0)), vec3<float>(1));
    m.alpha = p.opacity;
    if (p.texture >= 0) m.base_color_map = mesh.images[std::size_t(p.texture)];
    out.materials.push_back(std::move(m));
  }
  return out;
}

}  // namespace burnish
