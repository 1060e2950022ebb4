// tests/io/exr.cpp -- the G-buffer as a file of layers, read back by OpenImageIO
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include "../scene/shapes.h"
#include "files.h"
#include <burnish/io/exr.h>

using namespace burnish;

namespace {
/// Two hand-made surfels.
GBuffer two() {
  GBuffer g;
  g.width = 6, g.height = 5;
  g.camera = Camera::look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40, 6, 5);
  g.parts = {{.name = "door", .material = "paint", .base_color = {0.5f, 0.25f, 0.125f}},
             {.name = "pane", .material = "glass"}};
  g.resize(2);
  g.pixel = {8, 21};
  g.part = {1, 0};
  for (int k = 0; k < GBuffer::planes; ++k) {
    for (int i = 0; i < 2; ++i) g.plane[k][i] = float(k) + 0.5f * float(i) + 0.125f;
  }
  g.close();
  return g;
}
}  // namespace

TEST_CASE("G-buffer file: every layer is there by its customary name and keeps its bits", "[io][agreement]") {
  const files::Folder folder;
  const GBuffer g = two();
  write_exr(folder / "g.exr", g);
  const auto in = OIIO::ImageInput::open(folder / "g.exr");
  REQUIRE(in);
  const OIIO::ImageSpec spec = in->spec();
  REQUIRE(spec.width == 6);
  REQUIRE(spec.height == 5);
  CHECK(spec.format == OIIO::TypeDesc::FLOAT);
  CHECK(spec.get_string_attribute("burnish/part/1") == "pane / glass");
  CHECK(spec.get_string_attribute("burnish/camera").find("fx ") != std::string::npos);
  std::vector<float> values(6 * 5 * spec.nchannels);
  REQUIRE(in->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()));
  const auto at = [&](const char* name, int pixel) {
    const int c = spec.channelindex(name);
    INFO(name);
    REQUIRE(c >= 0);
    return values[std::size_t(pixel) * spec.nchannels + c];
  };
  struct Layer {
    const char* name;
    int plane;
  };
  for (const Layer& l : {Layer{"P.X", 0},
                         {"P.Y", 1},
                         {"P.Z", 2},
                         {"N.X", 3},
                         {"N.Y", 4},
                         {"N.Z", 5},
                         {"T.X", 6},
                         {"T.Y", 7},
                         {"T.Z", 8},
                         {"V.X", 9},
                         {"V.Y", 10},
                         {"V.Z", 11},
                         {"uv.U", 12},
                         {"uv.V", 13},
                         {"Ng.X", 15},
                         {"Ng.Y", 16},
                         {"Ng.Z", 17},
                         {"depth.Z", 18},
                         {"A", 19}}) {
    CHECK(at(l.name, 8) == g.plane[l.plane][0]);
    CHECK(at(l.name, 21) == g.plane[l.plane][1]);
    CHECK(at(l.name, 0) == (l.plane == GBuffer::depth ? 1e10f : 0.0f));
  }
  CHECK(at("part.ID", 8) == 1);
  CHECK(at("part.ID", 21) == 0);
  CHECK(at("part.ID", 0) == -1);
  CHECK(at("R", 21) > at("G", 21));
  CHECK(spec.nchannels == 23);
}
