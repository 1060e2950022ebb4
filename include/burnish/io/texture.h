// burnish/io/texture.h -- the colour textures of a scene that Assimp has read: beside it, in its archive, or embedded
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <span>
#include <OpenImageIO/filesystem.h>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <burnish/io/photo.h>
#include <burnish/scene/clean.h>

namespace burnish::detail {

/// A picture file's bytes as linear RGB, alpha left out, no side longer than `longest`. Error when it is no picture.
inline Image decode_texture(const std::string& name, std::span<const std::uint8_t> bytes, int longest = 512) {
  OIIO::Filesystem::IOMemReader memory(const_cast<std::uint8_t*>(bytes.data()), bytes.size());
  OIIO::Filesystem::IOProxy* from = &memory;
  OIIO::ImageSpec how;
  how.attribute("oiio:UnassociatedAlpha", 1);
  how.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &from);
  const auto in = OIIO::ImageInput::open(name, &how, from);
  if (!in) {
    std::string why = OIIO::geterror();
    throw Error(why.substr(0, why.find('\n')));
  }
  const OIIO::ImageSpec spec = in->spec();
  const int w = spec.width, h = spec.height, n = spec.nchannels, rgb = n < 3 ? 0 : 1;
  std::vector<float> values(std::size_t(w) * h * n);
  if (w < 1 || h < 1 || !in->read_image(0, 0, 0, n, OIIO::TypeDesc::FLOAT, values.data())) throw Error(in->geterror());
  Image image(w, h);
  for (int i = 0; i < w * h; ++i) {
    for (int c = 0; c < 3; ++c) {
      const float v = values[std::size_t(i) * n + c * rgb];
      image.plane(c)[i] = !finite(v) ? 0 : spec.format.is_floating_point() ? v : from_srgb(v);
    }
  }
  const int side = std::max(w, h);
  if (side <= longest) return image;
  return resized(image, std::max(1, w * longest / side), std::max(1, h * longest / side));
}

/// Reads each texture once. One that cannot be read is reported in a line, and done without.
class Textures {
public:
  /// files: Assimp's, whole or an archive's; path: of the scene in it.
  Textures(const aiScene& scene, Assimp::IOSystem& files, const std::string& path, std::vector<Image>& images,
           MeshReport* report)
      : scene_(scene),
        files_(files),
        folder_(std::filesystem::path(path).parent_path()),
        images_(images),
        report_(report) {}

  /// The place among the images of a material's base colour or diffuse texture; -1 for none.
  int of(const aiMaterial& material) {
    aiString name;
    int uv = 0;
    for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
      if (material.GetTexture(type, 0, &name) != AI_SUCCESS || name.length == 0) continue;
      material.Get(AI_MATKEY_UVWSRC(type, 0), uv);
      const auto [known, fresh] = known_.try_emplace(name.C_Str(), -1);
      if (fresh && uv == 0) known->second = read(name.C_Str());
      return uv == 0 ? known->second : -1;
    }
    return -1;
  }

private:
  const aiScene& scene_;
  Assimp::IOSystem& files_;
  std::filesystem::path folder_;
  std::vector<Image>& images_;
  MeshReport* report_;
  std::map<std::string, int> known_;

  int read(const std::string& name) {
    try {
      images_.push_back(load(name));
      return int(images_.size()) - 1;
    } catch (const std::exception& e) {
      if (report_) report_->add("texture " + name + " cannot be read: " + e.what());
      return -1;
    }
  }
  Image load(const std::string& name) const {
    if (const aiTexture* t = scene_.GetEmbeddedTexture(name.c_str())) {
      const auto* bytes = reinterpret_cast<const std::uint8_t*>(t->pcData);
      if (t->mHeight == 0) return decode_texture(std::string("texture.") + t->achFormatHint, {bytes, t->mWidth});
      Image image(int(t->mWidth), int(t->mHeight));
      for (int i = 0; i < image.width * image.height; ++i) {
        const aiTexel& c = t->pcData[i];
        image.set(i % image.width, i / image.width,
                  {from_srgb(float(c.r) / 255), from_srgb(float(c.g) / 255), from_srgb(float(c.b) / 255)});
      }
      return image;
    }
    std::string plain = name;
    std::replace(plain.begin(), plain.end(), '\\', '/');
    const std::filesystem::path file = std::filesystem::path(plain), base = file.filename();
    // As named, or where exporters leave them.
    for (const auto& place :
         {folder_ / file, folder_ / base, folder_ / "textures" / base, folder_ / ".." / "textures" / base}) {
      const std::string at = place.lexically_normal().string();
      if (!files_.Exists(at.c_str())) continue;
      Assimp::IOStream* stream = files_.Open(at.c_str(), "rb");
      if (!stream) continue;
      std::vector<std::uint8_t> bytes(stream->FileSize());
      const bool whole = bytes.empty() || stream->Read(bytes.data(), 1, bytes.size()) == bytes.size();
      files_.Close(stream);
      if (!whole) throw Error("it breaks off");
      return decode_texture(at, bytes);
    }
    throw Error("no such file");
  }
};

}  // namespace burnish::detail
