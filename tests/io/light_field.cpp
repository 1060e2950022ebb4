// tests/io/light_field.cpp -- light that varies along a street, read from a file
// SPDX-License-Identifier: Apache-2.0
#include <burnish/io/light_field.h>
#include <burnish_test.h>
#include <io/files.h>

using namespace burnish;

TEST_CASE("read_light_field: the nearest panorama to a place, beside the file", "[io][value]") {
  const files::Folder folder;
  folder.write("a.exr", "-"), folder.write("b.exr", "-");
  const std::string path = folder.write("field.json",
                                        R"({"lights": [{"at": [0, 5], "panorama": "a.exr"},
                                           {"at": [1, 25], "panorama": "b.exr", "yaw": 90}]})");
  const LightField<PanoramaFile> field = read_light_field(path);
  REQUIRE(field.lights.size() == 2);
  const PanoramaFile near = field.nearest({0, 0, -14}).light, far = field.nearest({0, 0, -16}).light;
  CHECK(std::filesystem::path(near.path).filename() == "a.exr");
  CHECK(std::filesystem::path(near.path).parent_path() == std::filesystem::path(path).parent_path());
  CHECK(near.yaw == 0);
  CHECK(std::filesystem::path(far.path).filename() == "b.exr");
  CHECK(far.yaw == Approx(1.5707963));
}
TEST_CASE("read_light_field: what is wrong is said with file and light", "[io][value]") {
  const files::Folder folder;
  folder.write("a.exr", "-");
  const auto says = [&](const std::string& text) {
    const std::string path = folder.write("f.json", text);
    return files::error_of([&] { read_light_field(path); });
  };
  const auto has = [](const std::string& text, const char* what) { return text.find(what) != std::string::npos; };
  CHECK(has(says("{"), "f.json: not JSON"));
  CHECK(has(says("{}"), "f.json: no list \"lights\""));
  CHECK(has(says(R"({"lights": []})"), "expected one panorama at least"));
  CHECK(has(says(R"({"lights": [{"at": [1, 2], "panorama": "a.exr"}, {"at": [1], "panorama": "a.exr"}]})"),
            "f.json, light 2: \"at\" has not two numbers"));
  CHECK(has(says(R"({"lights": [{"at": [1, 2], "panorama": "none.exr"}]})"), "none.exr: no such file"));
  CHECK(has(says(R"({"lights": [{"panorama": "a.exr"}]})"), "f.json, light 1: "));
  CHECK(has(says(R"({"lights": [7]})"), "f.json, light 1: "));
}
