// tests/examples/dressed.cpp -- a vehicle in its fitted materials: what is exchanged in a texture, what glTF gets
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include "../../examples/dressed.h"
#include "record.h"

using namespace burnish;

namespace {
bool near(const vec3<float>& a, const vec3<float>& b, float by = 0.02f) { return length(a - b) < by; }
/// A square on the ground for every part, side by side; two show the texture: left half yellow, then its shadow, a red
/// lamp and black.
Mesh squares() {
  Mesh m;
  Image image(8, 1);
  for (int x = 0; x < 8; ++x)
    image.set(x, 0,
              x < 4   ? vec3<float>(0.6f, 0.5f, 0.05f)
              : x < 6 ? vec3<float>(0.3f, 0.25f, 0.025f)
              : x < 7 ? vec3<float>(0.6f, 0.02f, 0.01f)
                      : vec3<float>(0.004f));
  m.images.push_back(image);
  for (int p = 0; p < 5; ++p) {
    Part part;
    part.material = std::string("material ").append(std::to_string(p)), part.material_index = p,
    part.texture = p < 2 ? 0 : -1;
    part.base_color = p < 2 ? vec3<float>(1) : vec3<float>(0.3f, 0.3f, 0.4f);
    m.parts.push_back(part);
    const float x = float(p) - 2.5f;
    const int a = m.add({x, 0, 0}, {0, 1, 0}, {0, 0}), b = m.add({x, 0, 1}, {0, 1, 0}, {0, 1}),
              c = m.add({x + 1, 0, 1}, {0, 1, 0}, {1, 1}), d = m.add({x + 1, 0, 0}, {0, 1, 0}, {1, 0});
    for (const auto& t : {std::array{a, b, c}, {a, c, d}}) m.triangles.push_back(t), m.part.push_back(p);
  }
  return m;
}
}  // namespace

TEST_CASE("Recoloured: the paint goes with its shadows; lamps, chrome and black stay", "[examples][value]") {
  const vec3<float> yellow(0.6f, 0.5f, 0.05f), red(0.5f, 0.01f, 0.01f), chrome(0.9f, 0.9f, 0.9f), black(0.003f),
      blue(0.02f, 0.1f, 0.5f);
  std::vector<vec3<float>> seen;
  for (int i = 0; i < 100; ++i) {
    seen.push_back(yellow * (0.5f + 0.005f * float(i)));
    seen.push_back(black);
    if (i % 10 == 0) seen.push_back(red), seen.push_back(chrome);
  }
  const dressed::Recoloured paint(seen, 1);
  const float scale = paint(yellow, blue).z / blue.z;  // the main colour is one of the shades
  CHECK(scale > 0.95f);
  CHECK(scale < 1.4f);
  CHECK(near(paint(yellow, blue), blue * scale));
  CHECK(near(paint(yellow * 0.4f, blue), blue * (0.4f * scale), 0.03f));
  CHECK(near(paint(red, blue), red));
  CHECK(near(paint(chrome, blue), chrome));
  CHECK(near(paint(black, blue), black));
  // A tyre with a bright rim: of what is seen, the rubber is the dark one.
  std::vector<vec3<float>> wheel(50, vec3<float>(0.4f));
  wheel.insert(wheel.end(), 40, vec3<float>(0.01f));
  const dressed::Recoloured rubber(wheel, 0.12f);
  CHECK(near(rubber(vec3<float>(0.01f), vec3<float>(0.03f)), vec3<float>(0.03f), 0.003f));
  CHECK(near(rubber(vec3<float>(0.4f), vec3<float>(0.03f)), vec3<float>(0.4f)));
  // Nothing seen, nothing broken.
  CHECK(dressed::Recoloured({}, 1)(red, blue).x >= 0);
}

TEST_CASE("Dressed: each kind of part has its material, in pictures and in glTF", "[examples][agreement]") {
  const Raycaster scene(squares());
  looks::Vehicle fitted;
  fitted.paint.base_color = {0.02f, 0.1f, 0.5f}, fitted.paint.mottle.amount = 0;
  fitted.rubber.base_color = {0.05f, 0.05f, 0.05f};
  const std::vector<PartKind> kinds{PartKind::body, PartKind::other, PartKind::body, PartKind::window, PartKind::tyre};
  const dressed::Dressed look(scene, kinds, fitted);
  const auto at = [](float u) { return Surfel<float>{{}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0}, {u, 0.5f}, 0}; };
  CHECK(near(look(2, at(0)).base_color, fitted.paint.base_color));
  CHECK(look(2, at(0)).coat_weight == 1);
  CHECK(look(3, at(0)).transmission_weight == fitted.window.glass.transmission_weight);
  CHECK(near(look(4, at(0)).base_color, fitted.rubber.base_color));
  CHECK(near(look(1, at(0.25f)).base_color, {0.6f, 0.5f, 0.05f}));  // as the file has it
  const vec3<float> painted = look(0, at(0.25f)).base_color;
  CHECK(painted.z > 4 * painted.x);
  CHECK(near(look(0, at(0.6f)).base_color, painted * 0.5f));                // in the shadow
  CHECK(near(look(0, at(0.81f)).base_color, {0.6f, 0.02f, 0.01f}, 0.05f));  // the lamp

  const PartMaterials gltf = look.materials({.texels = 16});
  REQUIRE(gltf.of_part.size() == 5);
  const auto of = [&](std::size_t p) -> const GltfMaterial& { return gltf.materials[std::size_t(gltf.of_part[p])]; };
  for (std::size_t p = 0; p < 5; ++p) CHECK(of(p).name == scene.mesh().parts[p].material);
  CHECK(of(0).clearcoat == 1);
  CHECK(of(1).clearcoat == 0);
  CHECK(of(2).clearcoat == 1);
  CHECK(of(3).transmission > 0.5f);
  REQUIRE(of(0).base_color_map.width == 8);
  const float scale = painted.z / fitted.paint.base_color.z;
  CHECK(near(of(0).base_color_map.at(1, 0), of(2).base_color * scale));
  CHECK(near(of(0).base_color_map.at(6, 0), {0.6f, 0.02f, 0.01f}));
  CHECK(near(of(1).base_color_map.at(1, 0), {0.6f, 0.5f, 0.05f}));
}
