// tests/io/gltf.cpp -- vehicles as .glb: read back, laid out as the format wants, and as bright as they were
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include "files.h"
#include "record.h"
#include <cstring>
#include <numbers>
#include <burnish/io/bake.h>
#include <burnish/io/mesh.h>
#include <burnish/nodes/car_paint.h>
#include <burnish/nodes/rubber.h>
#include <burnish/nodes/window_glass.h>

using namespace burnish;
using files::error_of;

namespace {
/// A box with a normal and a uv at every corner of its six faces.
void add_box(Mesh& m, const char* name, const char* material, int index, const vec3<float>& low,
             const vec3<float>& high) {
  const int part = int(m.parts.size());
  Part p;
  p.name = name, p.material = material, p.material_index = index;
  m.parts.push_back(p);
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      const vec3<float> n(axis == 0 ? side : 0, axis == 1 ? side : 0, axis == 2 ? side : 0), u(n.y, n.z, n.x),
          v = cross(n, u);
      const vec3<float> half = (high - low) * 0.5f, middle = (high + low) * 0.5f;
      const int first = int(m.positions.size());
      for (const auto& [a, b] : {std::pair{-1.0f, -1.0f}, {1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, 1.0f}})
        m.add(middle + (n + u * a + v * b) * half, n, {a, 0.25f * b});
      for (const auto& t : {std::array{0, 1, 2}, {0, 2, 3}})
        m.triangles.push_back({first + t[0], first + t[1], first + t[2]}), m.part.push_back(part);
    }
}
Mesh box_car() {
  Mesh m;
  add_box(m, "Body", "paint", 0, {-2, 0.3f, -0.8f}, {2, 1, 0.8f});
  add_box(m, "Window", "glass", 1, {-1, 1, -0.7f}, {0.5f, 1.4f, 0.7f});
  add_box(m, "Wheel FR", "tyre", 2, {1, 0, 0.7f}, {1.6f, 0.6f, 0.9f});
  add_box(m, "Wheel FL", "tyre", 2, {1, 0, -0.9f}, {1.6f, 0.6f, -0.7f});
  m.parts[0].base_color = {0.5f, 0.25f, 0.125f};
  m.parts[0].texture = 0;
  m.parts[1].opacity = 0.3f;
  Image checker(4, 2);
  for (int i = 0; i < 8; ++i) checker.set(i % 4, i / 4, {i % 2 ? 1.0f : 0.2f, 0.5f, float(i) / 8});
  m.images.push_back(checker);
  return m;
}
/// What the root node does, undone.
vec3<float> ahead(const vec3<float>& p) { return {p.z, p.y, -p.x}; }

struct Chunks {
  nlohmann::json json;
  std::string bytes;
};
/// Checks the container (specification, chapter 4) on the way.
Chunks chunks_of(const std::string& path) {
  const std::string file = read_text(path);
  const auto number = [&](std::size_t at) {
    std::uint32_t n = 0;
    for (int k = 3; k >= 0; --k) n = n << 8 | static_cast<unsigned char>(file.at(at + std::size_t(k)));
    return std::size_t(n);
  };
  REQUIRE(file.substr(0, 4) == "glTF");
  CHECK(number(4) == 2);
  CHECK(number(8) == file.size());
  const std::size_t json = number(12), at = 20 + json;
  CHECK(json % 4 == 0);
  CHECK(file.substr(16, 4) == "JSON");
  CHECK(number(at) % 4 == 0);
  CHECK(number(at) + at + 8 == file.size());
  CHECK(file.substr(at + 4, 4) == std::string("BIN\0", 4));
  return {nlohmann::json::parse(file.substr(20, json)), file.substr(at + 8)};
}

// glTF's model as the specification's appendix B has it, in double: v and l about the normal z.
double schlick(double f0, double f90, double c) { return f0 + (f90 - f0) * std::pow(1 - c, 5); }
double specular_lobe(double roughness, const vec3<double>& v, const vec3<double>& l, const vec3<double>& h) {
  const double a2 = std::pow(roughness, 4), d = h.z * h.z * (a2 - 1) + 1;
  const double vl = l.z * std::sqrt(v.z * v.z * (1 - a2) + a2), vv = v.z * std::sqrt(l.z * l.z * (1 - a2) + a2);
  return a2 / (std::numbers::pi * d * d) * 0.5 / (vl + vv);
}
vec3<double> gltf(const GltfMaterial& m, const vec3<double>& v, const vec3<double>& l) {
  const vec3<double> h = normalize(v + l);
  const double vh = dot(v, h), shine = specular_lobe(double(m.roughness), v, l, h), n = double(m.ior);
  const double color[3] = {double(m.base_color.x), double(m.base_color.y), double(m.base_color.z)};
  const double tint[3] = {double(m.specular_color.x), double(m.specular_color.y), double(m.specular_color.z)};
  double f[3], out[3];
  for (int c = 0; c < 3; ++c)
    f[c] =
        schlick(double(m.specular) * std::min(1.0, std::pow((n - 1) / (n + 1), 2) * tint[c]), double(m.specular), vh);
  const double most = std::max({f[0], f[1], f[2]}), coat = double(m.clearcoat);
  for (int c = 0; c < 3; ++c) {
    const double dielectric = (1 - most) * color[c] / std::numbers::pi + f[c] * shine;
    const double metal = schlick(color[c], 1, vh) * shine;
    const double base = dielectric + (metal - dielectric) * double(m.metalness);
    out[c] = base * (1 - coat * schlick(0.04, 1, v.z)) +
             coat * schlick(0.04, 1, vh) * specular_lobe(double(m.clearcoat_roughness), v, l, h);
  }
  return {out[0], out[1], out[2]};
}
}  // namespace

TEST_CASE("glTF: read back by Assimp it is the same vehicle, part by part", "[io][agreement]") {
  const files::Folder folder;
  const Mesh m = box_car();
  const PartMaterials own = file_materials(m);
  REQUIRE(own.materials.size() == 3);  // both wheels have one
  write_gltf(folder / "car.glb", m, own);
  CHECK(folder.count() == 1);
  const Mesh back = read_mesh(folder / "car.glb");
  REQUIRE(back.triangles.size() == m.triangles.size());
  REQUIRE(back.parts.size() == m.parts.size());
  record::Worst place, normal, uv;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const Part &p = m.parts[std::size_t(m.part[t])], &q = back.parts[std::size_t(back.part[t])];
    CHECK(q.name == p.name);
    CHECK(q.material == p.material);
    CHECK(length(q.base_color - p.base_color) < 1e-6f);
    CHECK(q.opacity == Approx(p.opacity));
    CHECK((q.texture >= 0) == (p.texture >= 0));
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = std::size_t(m.triangles[t][k]), b = std::size_t(back.triangles[t][k]);
      place(double(length(ahead(back.positions[b]) - m.positions[a])));
      normal(double(length(ahead(back.normals[b]) - m.normals[a])));
      const vec2<float> d(back.uvs[b].x - m.uvs[a].x, back.uvs[b].y - m.uvs[a].y);
      uv(double(std::hypot(d.x, d.y)));
    }
  }
  const long corners = 3 * long(m.triangles.size());
  record::claim("glTF: positions, metres", "value", "read back by Assimp", 1e-6, place.value, corners);
  record::claim("glTF: normals", "value", "read back by Assimp", 1e-6, normal.value, corners);
  record::claim("glTF: uvs", "value", "read back by Assimp", 1e-6, uv.value, corners);
  REQUIRE(back.images.size() == 1);
  record::Worst color;
  for (std::size_t i = 0; i < 8; ++i)
    for (int c = 0; c < 3; ++c)
      color(std::abs(double(detail::to_srgb(back.images[0].plane(c)[i]) - detail::to_srgb(m.images[0].plane(c)[i]))));
  record::claim("glTF: textures, display values", "value", "read back by Assimp", 0.5 / 255 + 1e-6, color.value, 24);
}

TEST_CASE("glTF: chunks, views, accessors and extensions are as the specification wants them", "[io][value]") {
  const files::Folder folder;
  const Mesh m = box_car();
  CarPaint<float> paint;
  paint.mottle = {0.05f, 0.3f}, paint.flakes = {0.004f, 0.1f, 0.7f};
  write_gltf(
      folder / "car.glb", m,
      {{bake("paint", paint, {.texels = 32}), bake("glass", WindowGlass<float>{}), bake("tyre", Rubber<float>{})},
       {0, 1, 2, 2}});
  const auto [j, bytes] = chunks_of(folder / "car.glb");
  CHECK(j["asset"]["version"] == "2.0");
  CHECK(j["asset"]["generator"] == "burnish");
  CHECK(j["buffers"][0]["byteLength"].get<std::size_t>() <= bytes.size());
  std::size_t end = 0;
  for (const auto& v : j["bufferViews"]) {
    const std::size_t from = v["byteOffset"], size = v["byteLength"];
    CHECK(from % 4 == 0);
    CHECK(from >= end);
    end = from + size;
  }
  CHECK(end <= bytes.size());
  const auto at = [&, &blob = bytes](std::size_t accessor, std::size_t k) {
    const auto& a = j["accessors"][accessor];
    const std::size_t from = j["bufferViews"][a["bufferView"].get<std::size_t>()]["byteOffset"];
    if (a["componentType"] == 5123) {
      std::uint16_t x;
      std::memcpy(&x, blob.data() + from + 2 * k, 2);
      return double(x);
    }
    float x;
    std::memcpy(&x, blob.data() + from + 4 * k, 4);
    return double(x);
  };
  int nodes = 0;
  for (const auto& mesh : j["meshes"]) {
    ++nodes;
    REQUIRE(mesh["primitives"].size() == 1);
    const auto& p = mesh["primitives"][0];
    const std::size_t position = p["attributes"]["POSITION"], normal = p["attributes"]["NORMAL"], index = p["indices"];
    const auto& a = j["accessors"][position];
    const std::size_t count = a["count"];
    for (std::size_t c = 0; c < 3; ++c) {
      double low = 1e9, high = -1e9;
      for (std::size_t i = 0; i < count; ++i)
        low = std::min(low, at(position, 3 * i + c)), high = std::max(high, at(position, 3 * i + c));
      CHECK(a["min"][c].get<double>() == low);
      CHECK(a["max"][c].get<double>() == high);
      CHECK(low == Approx(-high));  // the node's origin is the part's middle
    }
    for (std::size_t i = 0; i < count; ++i)
      CHECK(std::hypot(at(normal, 3 * i), at(normal, 3 * i + 1), at(normal, 3 * i + 2)) == Approx(1));
    for (std::size_t i = 0; i < j["accessors"][index]["count"].get<std::size_t>(); ++i)
      CHECK(at(index, i) < double(count));
    CHECK(j["bufferViews"][a["bufferView"].get<std::size_t>()]["target"] == 34962);
    CHECK(j["bufferViews"][j["accessors"][index]["bufferView"].get<std::size_t>()]["target"] == 34963);
  }
  CHECK(nodes == 4);
  CHECK(j["nodes"].size() == 5);
  CHECK(j["nodes"][0]["children"] == nlohmann::json({1, 2, 3, 4}));
  CHECK(j["nodes"][3]["name"] == "Wheel FR");
  REQUIRE(j["materials"].size() == 3);
  const auto& baked = j["materials"][0];
  CHECK(baked["pbrMetallicRoughness"].contains("baseColorTexture"));
  CHECK(baked.contains("normalTexture"));
  for (const auto& image : j["images"]) {
    const std::size_t from = j["bufferViews"][image["bufferView"].get<std::size_t>()]["byteOffset"];
    CHECK(bytes.substr(from, 4) == "\x89PNG");
  }
  std::vector<std::string> used = j["extensionsUsed"];
  std::sort(used.begin(), used.end());
  CHECK(used == std::vector<std::string>{"KHR_materials_clearcoat", "KHR_materials_ior", "KHR_materials_specular",
                                         "KHR_materials_transmission", "KHR_texture_transform"});
}

TEST_CASE("glTF material: as bright as ours, under an even sky and under one that is not", "[io][agreement]") {
  std::vector<Surface<float>> surfaces;
  const Surfel<float> at{{}, {0, 0, 1}, {1, 0, 0}, {0, 0, 1}, {}, 0};
  for (const float metalness : {0.0f, 0.1f, 0.5f, 1.0f})
    for (const float ior : {1.5f, 1.7f}) {
      CarPaint<float> p;
      p.base_metalness = metalness, p.coat_ior = ior, p.specular_roughness = 0.5f, p.coat_roughness = 0.3f;
      for (const vec3<float>& c : {vec3<float>(0.6f, 0.1f, 0.05f), {0.8f, 0.8f, 0.8f}, {0.03f, 0.03f, 0.05f}})
        p.base_color = c, surfaces.push_back(p(at));
    }
  surfaces.push_back(Rubber<float>{}(at));
  record::Worst even, uneven;
  for (const Surface<float>& s : surfaces) {
    const GltfMaterial m = gltf_material("m", s);
    // Mean over views by their cosine; the uneven sky shines from one side of the normal.
    vec3<double> ours[2], theirs[2];
    constexpr int n = 16;
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < 4 * n * n; ++k) {
        const double cv = std::sqrt((i + 0.5) / n), cl = (k / (4 * n) + 0.5) / n,
                     turn = (k % (4 * n) + 0.5) / (2 * n) * std::numbers::pi;
        const vec3<double> v(std::sqrt(1 - cv * cv), 0, cv),
            l(std::sqrt(1 - cl * cl) * std::cos(turn), std::sqrt(1 - cl * cl) * std::sin(turn), cl);
        const vec3<double> a(brdf_cos(s, vec3<float>(0, 0, 1), vec3<float>(v), vec3<float>(l))),
            b = gltf(m, v, l) * l.z;
        const double sky = std::pow(0.5 + 0.4 * l.y + 0.3 * l.z, 2);
        ours[0] += a, theirs[0] += b, ours[1] += a * sky, theirs[1] += b * sky;
      }
    for (int k = 0; k < 2; ++k)
      for (const auto& [a, b] : {std::pair{ours[k].x, theirs[k].x}, {ours[k].y, theirs[k].y}, {ours[k].z, theirs[k].z}})
        (k ? uneven : even)(std::abs(b / a - 1));
  }
  const long count = 3 * long(surfaces.size());
  record::claim("gltf_material: reflectance under an even sky", "value",
                "glTF 2.0, appendix B, and shade/brdf.h, summed", 0.01, even.value, count);
  record::claim("gltf_material: reflectance under an uneven sky", "value",
                "glTF 2.0, appendix B, and shade/brdf.h, summed", 0.04, uneven.value, count);
}

TEST_CASE("glTF glass: lets through what ours does, and two thirds are covered for viewers without transmission",
          "[io][agreement]") {
  record::Worst worst;
  for (const vec3<float>& c : {vec3<float>(0.75f, 0.8f, 0.77f), {0.4f, 0.42f, 0.5f}, {0.08f, 0.07f, 0.06f}})
    for (const float weight : {0.5f, 0.95f, 1.0f}) {
      WindowGlass<float> glass;
      glass.transmission_color = c, glass.transmission_weight = weight;
      const Surface<float> s = glass(Surfel<float>{});
      const GltfMaterial m = gltf_material("glass", s);
      CHECK(m.alpha >= 0.64f);
      CHECK(m.alpha < 1);
      const double n = double(m.ior), f0 = std::pow((n - 1) / (n + 1), 2) * double(m.specular_color.x);
      const double covered = double(m.alpha) * double(m.transmission) * (1 - f0), past = 1 - double(m.alpha);
      const vec3<float> ours = transmittance(s, 1.0f);
      const double sum = 3 * past + covered * double(m.base_color.x + m.base_color.y + m.base_color.z);
      worst(std::abs(sum / double(ours.x + ours.y + ours.z) - 1));
      CHECK(double(m.alpha) * f0 == Approx(double(layers(s).base_f0.x)).epsilon(1e-3));  // both faces reflect
    }
  record::claim("glTF glass: what is let through, all channels", "value",
                "transmittance, KHR_materials_transmission by hand", 1e-3, worst.value, 9);
}

TEST_CASE("Baked tile: repeats without a seam, and its mean is the model's", "[io][value]") {
  CarPaint<float> paint;
  paint.mottle = {0.05f, 0.4f};
  paint.base_metalness = 0, paint.coat_weight = 0;
  const GltfMaterial m = bake("paint", paint, {.texels = 96});
  REQUIRE(m.base_color_map.width == 96);
  CHECK(m.roughness_metalness_map.width == 0);
  CHECK(m.normal_map.width == 0);
  const float* red = m.base_color_map.plane(0);
  double mean = 0, squares = 0, inside = 0, across = 0;
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      const double value = double(red[y * 96 + x]);
      mean += value / (96 * 96), squares += value * value / (96 * 96);
      (x == 95 ? across : inside) =
          std::max(x == 95 ? across : inside, std::abs(value - double(red[y * 96 + (x + 1) % 96])));
      (y == 95 ? across : inside) =
          std::max(y == 95 ? across : inside, std::abs(value - double(red[(y + 1) % 96 * 96 + x])));
    }
  CHECK(across < 1.2 * inside);
  // The model's mean and contrast all through space, by other places.
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(-50, 50);
  double wide = 0, wide_squares = 0;
  for (int i = 0; i < 40000; ++i) {
    Surfel<float> at;
    at.position = {place(random), place(random), place(random)};
    const double value = double(paint(at).base_color.x);
    wide += value / 40000, wide_squares += value * value / 40000;
  }
  Surface<float> even = paint(Surfel<float>{});
  even.base_color = paint.base_color * float(wide / double(paint.base_color.x));
  const double ratio = double(m.base_color.x) / double(gltf_material("even", even).base_color.x);
  record::claim("bake: mean base colour of a mottled paint", "value", "the model at 40,000 places", 0.02,
                std::abs(mean * ratio - 1), 40000);
  const auto contrast = [](double first, double second) { return std::sqrt(second - first * first) / first; };
  record::claim("bake: contrast of a mottled paint", "value", "the model at 40,000 places", 0.1,
                std::abs(contrast(mean, squares) / contrast(wide, wide_squares) - 1), 40000);
}

TEST_CASE("glTF: what is wrong is said in one line, and nothing is left", "[io][limit]") {
  const files::Folder folder;
  const Mesh m = box_car();
  const PartMaterials own = file_materials(m);
  const std::string path = folder / "car.glb";
  const auto write = [&](const Mesh& mesh, const std::vector<int>& of) { write_gltf(path, mesh, {own.materials, of}); };
  CHECK(error_of([&] { write({}, {}); }) == path + ": a mesh without triangles, expected at least one");
  CHECK(error_of([&] { write(m, {0, 1}); }) == path + ": materials for 2 parts, expected 4");
  CHECK(error_of([&] { write(m, {0, 1, 2, 3}); }) == path + ": part Wheel FL has material 3 of 3");
  Mesh broken = m;
  broken.positions[5].y = std::numeric_limits<float>::quiet_NaN();
  CHECK(error_of([&] { write(broken, own.of_part); }) == path + ": vertex 5 of Body is not a number");
  CHECK(folder.count() == 0);
  const std::string nowhere = folder / "none/car.glb";
  CHECK(error_of([&] { write_gltf(nowhere, m, own); }).find(nowhere + ": cannot be written") == 0);
  // Names of any bytes, and normals and uvs that some corners lack, still make a file that can be read.
  Mesh odd = m;
  odd.parts[0].name = "caf\xe9 \"x\"", odd.parts[1].name.clear();
  odd.normals[0] = {}, odd.uvs[30] = {std::numeric_limits<float>::quiet_NaN(), 0};
  write(odd, own.of_part);
  const Mesh back = read_mesh(path);
  CHECK(back.triangles.size() == m.triangles.size());
  CHECK(length(back.normals[0]) == 0);
}
