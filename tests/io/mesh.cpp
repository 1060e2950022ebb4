// tests/io/mesh.cpp -- meshes from files and archives
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include "files.h"
#include <minizip/zip.h>
#include <burnish/io/mesh.h>

using namespace burnish;
using files::error_of;

namespace {
const char* const obj = R"(mtllib car.mtl
o body
v 0 0 0
v 4 0 0
v 4 1 0
v 0 1 0
v 4 0 2
v 0 0 2
usemtl paint
f 1 2 3 4
o window
usemtl glass
f 1 2 5 6
f 1 1 2
)";
const char* const mtl = "newmtl paint\nKd 0.5 0.25 0.125\nd 1\nnewmtl glass\nKd 0.1 0.1 0.1\nd 0.3\n";

void check(const Mesh& m) {
  REQUIRE(m.parts.size() == 2);
  CHECK(m.triangles.size() - m.part.size() == 0);
  const Part &body = m.parts[0].material == "paint" ? m.parts[0] : m.parts[1],
             &window = &body == &m.parts[0] ? m.parts[1] : m.parts[0];
  CHECK(body.name.find("body") != std::string::npos);
  CHECK(body.base_color.y == Approx(0.25));
  CHECK(body.opacity == 1);
  CHECK(window.material == "glass");
  CHECK(window.opacity == Approx(0.3));
  CHECK(bounds(m).size().x == Approx(4));
}
void zip(const std::string& path, std::initializer_list<std::pair<const char*, const char*>> entries) {
  const zipFile z = zipOpen64(path.c_str(), APPEND_STATUS_CREATE);
  for (const auto& [name, text] : entries) {
    zipOpenNewFileInZip64(z, name, nullptr, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED, Z_DEFAULT_COMPRESSION, 0);
    zipWriteInFileInZip(z, text, unsigned(std::strlen(text)));
    zipCloseFileInZip(z);
  }
  zipClose(z, nullptr);
}
}  // namespace

TEST_CASE("Mesh file: parts, names, colours and opacities are the file's", "[io][value]") {
  const files::Folder folder;
  folder.write("car.mtl", mtl);
  check(read_mesh(folder.write("car.obj", obj)));
}

TEST_CASE("Mesh file: from inside an archive, with its materials", "[io][agreement]") {
  const files::Folder folder;
  zip(folder / "cars.sh3f", {{"some/where/car.obj", obj}, {"some/where/car.mtl", mtl}, {"other.txt", "x"}});
  check(read_mesh((folder / "cars.sh3f") + ":some/where/car.obj"));
  CHECK(error_of([&] {
          read_mesh((folder / "cars.sh3f") + ":some/bus.obj");
        }).find("the archive has no file some/bus.obj") != std::string::npos);
  folder.write("fake.zip", "not a zip");
  CHECK(error_of([&] { read_mesh((folder / "fake.zip") + ":car.obj"); }).find("fake.zip: not a zip archive") !=
        std::string::npos);
}

TEST_CASE("Mesh file: nodes move, turn and mirror their meshes", "[io][value]") {
  // A glTF of one triangle in the plane z = 0, seen by two nodes: moved by (10, 0, 0), and mirrored in x.
  const files::Folder folder;
  const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  folder.write("t.bin", std::string(reinterpret_cast<const char*>(corners), sizeof corners));
  const Mesh m =
      read_mesh(folder.write("t.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
    "nodes": [{"name": "moved", "mesh": 0, "translation": [10, 0, 0]},
    {"name": "mirrored", "mesh": 0, "scale": [-1, 1, 1]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
    "min": [0, 0, 0], "max": [1, 1, 0]}],
    "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36}],
    "buffers": [{"uri": "t.bin", "byteLength": 36}]})"));
  REQUIRE(m.triangles.size() == 2);
  const int moved = m.parts[0].name.find("moved") != std::string::npos ? 0 : 1;
  float sum = 0;
  for (int v : m.triangles[moved]) sum += m.positions[v].x;
  CHECK(sum == Approx(31));
  for (int t = 0; t < 2; ++t) CHECK(m.cross_of(t).z > 0);  // counter-clockwise stays so, mirrored or not
  CHECK(!detail::finite(m.uvs[0]));
  CHECK(length(m.normals[0]) == 0);
}

TEST_CASE("Mesh file: a vehicle comes clean, and its report says what was mended", "[io][value]") {
  const files::Folder folder;
  folder.write("car.mtl", mtl);
  MeshReport report;
  const Mesh m = read_vehicle(folder.write("car.obj", obj), &report);
  CHECK(report.says("without area dropped"));
  CHECK(report.says("corners without a normal"));
  CHECK(report.says("without usable uvs"));
  CHECK(report.says("4 long in the file: metres"));
  CHECK(m.triangles.size() == 4);
  for (const auto& n : m.normals) CHECK(length(n) == Approx(1));
  for (const auto& uv : m.uvs) CHECK(detail::finite(uv));
}

TEST_CASE("Mesh file: colour textures come from beside the file, an archive and the file itself", "[io][agreement]") {
  // A square whose texture is red, green over blue, white; the corner at (0, 0) is blue.
  const files::Folder folder;
  const char* const ppm = "P3\n2 2\n255\n255 0 0  0 255 0\n0 0 255  255 255 255\n";
  const char* const square = "mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                             "usemtl a\nf 1/1 2/2 3/3 4/4\n";
  const char* const textured = "newmtl a\nKd 1 0.5 1\nmap_Kd t.png\n";
  const auto check_colors = [](const Mesh& m) {
    REQUIRE(m.images.size() == 1);
    REQUIRE(m.parts.at(0).texture == 0);
    const auto color = [&](float u, float v) { return m.color(m.parts[0], {u, v}); };
    CHECK(length(color(0.25f, 0.25f) - vec3<float>(0, 0, 1)) < 1e-5f);
    CHECK(length(color(0.75f, 0.75f) - vec3<float>(0, 0.5f, 0)) < 1e-5f);  // times the material's colour
    CHECK(length(color(1.25f, -0.25f) - vec3<float>(1, 0, 0)) < 1e-5f);    // repeats
  };
  folder.write("t.ppm", ppm);
  OIIO::ImageBuf(folder / "t.ppm").write(folder / "t.png");
  folder.write("t.mtl", textured);
  check_colors(read_mesh(folder.write("t.obj", square)));

  const std::string png = read_text(folder / "t.png");
  const zipFile z = zipOpen64((folder / "t.zip").c_str(), APPEND_STATUS_CREATE);
  for (const auto& [name, text] : {std::pair<const char*, std::string>{"in/t.obj", square}, {"in/t.mtl", textured}, {"in/t.png", png}}) {
    zipOpenNewFileInZip64(z, name, nullptr, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED, Z_DEFAULT_COMPRESSION, 0);
    zipWriteInFileInZip(z, text.data(), unsigned(text.size()));
    zipCloseFileInZip(z);
  }
  zipClose(z, nullptr);
  check_colors(read_mesh((folder / "t.zip") + ":in/t.obj"));

  const float numbers[20] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 1, 1, 1, 1, 0, 0, 0};  // corners; uvs, v downwards
  const unsigned short corners[6] = {0, 1, 2, 0, 2, 3};
  std::string bytes(reinterpret_cast<const char*>(numbers), sizeof numbers);
  bytes.append(reinterpret_cast<const char*>(corners), sizeof corners).append(png);
  folder.write("t.bin", bytes);
  check_colors(read_mesh(folder.write("t.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2,
    "material": 0}]}], "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 1, 1],
    "baseColorTexture": {"index": 0}}}], "textures": [{"source": 0}],
    "images": [{"bufferView": 3, "mimeType": "image/png"}], "accessors": [
    {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
    {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
    {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}], "bufferViews": [
    {"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 32},
    {"buffer": 0, "byteOffset": 80, "byteLength": 12}, {"buffer": 0, "byteOffset": 92, "byteLength": )" +
                                                             std::to_string(png.size()) + R"(}],
    "buffers": [{"uri": "t.bin", "byteLength": )" + std::to_string(bytes.size()) + "}]}")));
}

TEST_CASE("Mesh file: a texture that cannot be read is reported and done without", "[io][limit]") {
  const files::Folder folder;
  for (const char* content : {"", "no picture"}) {
    folder.write("t.mtl", "newmtl a\nKd 0.5 0.5 0.5\nmap_Kd t.png\n");
    if (*content) folder.write("t.png", content);
    MeshReport report;
    const Mesh m = read_vehicle(folder.write("t.obj", "mtllib t.mtl\nv 0 0 0\nv 4 0 0\nv 4 1 0\nv 0 0 2\nvt 0 0\nvt 1 0\nvt 1 1\n"
                                                      "usemtl a\nf 1/1 2/2 3/3\nf 1/1 2/2 4/3\n"), &report);
    CHECK(report.says("texture t.png cannot be read: "));
    CHECK(m.parts[0].texture == -1);
    CHECK(m.color(m.parts[0], {0.5f, 0.5f}).x == 0.5f);
  }
}

TEST_CASE("Mesh file: what is wrong is said in one line", "[io][limit]") {
  const files::Folder folder;
  CHECK(error_of([&] { read_mesh(folder / "none.obj"); }) == (folder / "none.obj") + ": no such file");
  CHECK(error_of([&] { read_mesh(folder.path.string()); }).find("a folder, expected a mesh file") != std::string::npos);
  for (const char* name : {"text.obj", "text.glb", "text.unknown", "text.fbx"}) {
    const std::string path = folder.write(name, "nothing of the kind\n"), error = error_of([&] { read_mesh(path); });
    INFO(error);
    CHECK(error.find(path + ": ") == 0);
    CHECK(error.find('\n') == std::string::npos);
  }
  const std::string dots = folder.write("dots.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  CHECK(error_of([&] { read_vehicle(dots); }).find("no triangle with an area") != std::string::npos);
}
