// burnish/io/mesh.h -- vehicles in all formats that Assimp reads, also from inside a zip archive
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cctype>
#include <memory>
#include <set>
#include <string>
#include <vector>
#include <assimp/Importer.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <burnish/io/texture.h>
#include <burnish/io/zip.h>
#include <burnish/scene/vehicle.h>

namespace burnish {
namespace detail {
/// A zip archive as Assimp's file system. Names are looked up without regard to case, "./" and "\\".
class ZipFiles final : public Assimp::IOSystem {
public:
  explicit ZipFiles(const std::string& path) : zip_(path) {}

  const std::vector<std::string>& names() const { return zip_.names(); }
  bool Exists(const char* name) const override { return find(name) != nullptr; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    const std::string* found = find(name);
    if (!found || std::string(mode).find('w') != std::string::npos) return nullptr;
    try {
      const std::string file = zip_.read(*found);
      auto bytes = std::make_unique<std::uint8_t[]>(file.size() + 1);
      std::copy(file.begin(), file.end(), bytes.get());
      return new Assimp::MemoryIOStream(bytes.release(), file.size(), true);
    } catch (const Error&) {
      return nullptr;  // as Assimp wants it
    }
  }
  void Close(Assimp::IOStream* file) override { delete file; }

private:
  ZipArchive zip_;

  static std::string plain(std::string s) {
    for (char& c : s) c = c == '\\' ? '/' : char(std::tolower(static_cast<unsigned char>(c)));
    for (std::size_t i; (i = s.find("/./")) != s.npos;) s.erase(i, 2);
    return s.rfind("./", 0) == 0 ? s.substr(2) : s;
  }
  const std::string* find(const std::string& name) const {
    const std::string wanted = plain(name);
    const auto i = std::find_if(names().begin(), names().end(), [&](const std::string& n) { return plain(n) == wanted; });
    return i == names().end() ? nullptr : &*i;
  }
};

inline Part part_of(const aiScene& scene, const aiMesh& mesh, const aiNode& node, Textures& textures) {
  Part p;
  const aiMaterial& material = *scene.mMaterials[mesh.mMaterialIndex];
  p.material_index = int(mesh.mMaterialIndex);
  p.name = node.mName.length ? node.mName.C_Str() : mesh.mName.C_Str();
  if (mesh.mName.length && p.name != mesh.mName.C_Str()) p.name += std::string("/") + mesh.mName.C_Str();
  aiString name;
  if (material.Get(AI_MATKEY_NAME, name) == AI_SUCCESS && std::string(name.C_Str()) != AI_DEFAULT_MATERIAL_NAME)
    p.material = name.C_Str();
  aiColor4D color(0.8f, 0.8f, 0.8f, 1);
  if (material.Get(AI_MATKEY_BASE_COLOR, color) != AI_SUCCESS) material.Get(AI_MATKEY_COLOR_DIFFUSE, color);
  if (finite(color.r) && finite(color.g) && finite(color.b)) p.base_color = {color.r, color.g, color.b};
  float opacity = 1;
  material.Get(AI_MATKEY_OPACITY, opacity);
  p.opacity = std::clamp(std::min(opacity, color.a), 0.0f, 1.0f);
  const int texture = textures.of(material);
  if (mesh.HasTextureCoords(0)) p.texture = texture;
  // Some exporters write black beside a texture, meaning nothing by it.
  if (p.texture >= 0 && p.base_color.x + p.base_color.y + p.base_color.z == 0) p.base_color = {1, 1, 1};
  return p;
}

/// Adds a node's meshes and its children's, in the space of the file's root.
inline void flatten(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above, Textures& textures, Mesh& out) {
  const aiMatrix4x4 place = above * node.mTransformation;
  aiMatrix3x3 turn(place);
  const bool mirrored = turn.Determinant() < 0;
  turn.Inverse().Transpose();
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
    if (!mesh.HasPositions() || !mesh.HasFaces()) continue;
    const int base = int(out.positions.size()), part = int(out.parts.size());
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D p = place * mesh.mVertices[v];
      const aiVector3D n = mesh.HasNormals() ? turn * mesh.mNormals[v] : aiVector3D();
      out.add({p.x, p.y, p.z}, {n.x, n.y, n.z});
      if (mesh.HasTextureCoords(0)) out.uvs.back() = {mesh.mTextureCoords[0][v].x, mesh.mTextureCoords[0][v].y};
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      const int a = base + int(face.mIndices[0]), b = base + int(face.mIndices[1]), c = base + int(face.mIndices[2]);
      out.triangles.push_back(mirrored ? std::array{a, c, b} : std::array{a, b, c});
      out.part.push_back(part);
    }
    out.parts.push_back(part_of(scene, mesh, node, textures));
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) flatten(scene, *node.mChildren[i], place, textures, out);
}
}  // namespace detail

/// A mesh as the file has it: nodes flattened with their transforms, a part for every mesh of every node, polygons made
/// triangles, colour textures in Mesh::images (at most 512 texels a side). "archive.zip:inner/car.obj" reads from inside a
/// zip archive of any file name ending. Error when there is no such file, Assimp cannot read it, or it holds no triangle;
/// report (may be null) gets a line for every texture that cannot be read.
inline Mesh read_mesh(const std::string& path, MeshReport* report = nullptr) {
  namespace fs = std::filesystem;
  std::string archive, inner = path;
  if (!fs::exists(path)) {
    for (std::size_t colon = path.rfind(':'); colon != std::string::npos && colon > 0;
         colon = path.rfind(':', colon - 1)) {
      if (!fs::is_regular_file(path.substr(0, colon))) continue;
      archive = path.substr(0, colon), inner = path.substr(colon + 1);
      break;
    }
    if (archive.empty()) throw Error(path + ": no such file");
  } else if (fs::is_directory(path)) throw Error(path + ": a folder, expected a mesh file");
  Assimp::Importer importer;
  if (!archive.empty()) {
    auto files = std::make_unique<detail::ZipFiles>(archive);
    if (!files->Exists(inner.c_str())) throw Error(path + ": the archive has no file " + inner);
    importer.SetIOHandler(files.release());  // owned by the importer from here
  }
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile(inner, aiProcess_Triangulate | aiProcess_SortByPType);
  if (!scene || !scene->mRootNode) {
    std::string why = importer.GetErrorString();
    std::replace(why.begin(), why.end(), '\n', ' ');
    throw Error(path + ": not a mesh that can be read: " + why);
  }
  Mesh mesh;
  detail::Textures textures(*scene, *importer.GetIOHandler(), inner, mesh.images, report);
  detail::flatten(*scene, *scene->mRootNode, aiMatrix4x4(), textures, mesh);
  if (mesh.triangles.empty()) throw Error(path + ": no triangles, expected a mesh");
  return mesh;
}

/// A vehicle, read, cleaned and put into the normalised frame of scene/vehicle.h; report (may be null) gets a line for
/// every defect that was mended. Error also when nothing is left.
inline Mesh read_vehicle(const std::string& path, MeshReport* report = nullptr, const VehicleOptions& options = {}) {
  MeshReport found;
  Mesh mesh = read_mesh(path, &found);
  const MeshReport mended = clean_vehicle(mesh, options);
  found.lines.insert(found.lines.end(), mended.lines.begin(), mended.lines.end());
  if (mesh.triangles.empty()) throw Error(path + ": no triangle with an area, expected a mesh");
  if (report) *report = std::move(found);
  return mesh;
}

}  // namespace burnish
