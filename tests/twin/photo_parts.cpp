// tests/twin/photo_parts.cpp -- a photo whose panes and tyres lie beside the model's
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include <burnish/twin/photo_parts.h>
#include "record.h"

using namespace burnish;

namespace {
/// A car from the side, moved and with windows of another height: the label at a place in units of its length.
int label_at(float x, float y, float pane_top, float shift) {
  x -= shift;
  const bool upper =
      x > 0.25f && x < 0.75f && y > 0.25f && y<0.42f, lower = x> 0.02f && x < 0.98f && y > 0.1f && y <= 0.25f;
  for (const float w : {0.2f, 0.8f}) {
    const float r = std::hypot(x - w, y - 0.09f);
    if (r < 0.04f) return 4;
    if (r < 0.085f) return 3;
  }
  if (upper && y > 0.26f && y < pane_top && x > 0.3f && x < 0.7f && std::abs(x - 0.5f) > 0.015f) return 2;
  return upper || lower ? 1 : 0;
}
float noise(int i) {  // -1 to 1, by integers alone
  unsigned h = unsigned(i) * 2654435761u;
  h ^= h >> 15, h *= 2246822519u, h ^= h >> 13;
  return float(h & 0xffff) / 32767.5f - 1;
}
}  // namespace

TEST_CASE("photo_parts: labels follow the photo where the model lies beside it", "[twin][value]") {
  constexpr int w = 240, h = 120;
  struct Paint {
    const char* name;
    vec3<float> color;
  };
  for (const Paint& paint : {Paint{"red", {0.35f, 0.03f, 0.03f}}, Paint{"white", {0.75f, 0.75f, 0.74f}},
                             Paint{"blue", {0.03f, 0.08f, 0.3f}}}) {
    Image photo(w, h, {0.2f, 0.2f, 0.18f});
    Mask vehicle(w, h);
    GBuffer g;
    g.width = w, g.height = h;
    std::vector<int> truth(std::size_t(w) * h), model;
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const float u = (float(x) - 20) / 200, v = (110 - float(y)) / 200;
        const int t = label_at(u, v, 0.38f, 0), i = y * w + x;
        truth[std::size_t(i)] = t;
        if (t == 0) continue;
        vehicle.at(x, y) = 1;
        const float shade = v > 0.25f || v < 0.15f ? 0.8f : 1;
        const vec3<float> c = t == 1   ? paint.color * shade
                              : t == 2 ? vec3<float>(0.06f, 0.08f, 0.09f)
                              : t == 3 ? vec3<float>(0.015f, 0.015f, 0.015f)
                                       : vec3<float>(0.3f, 0.3f, 0.32f);
        photo.set(x, y, c * (1 + 0.15f * noise(i)));
      }
    std::vector<int> pixels;
    for (int i = 0; i < w * h; ++i)
      if (const int t = label_at((float(i % w) - 20) / 200, (110 - float(i / w)) / 200, 0.36f, 0.03f); t > 0)
        pixels.push_back(i), model.push_back(t);
    g.resize(int(pixels.size()));
    g.pixel = pixels;
    const std::vector<int> found = photo_parts(photo, vehicle, g, model);
    std::vector<int> projected(truth.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) projected[std::size_t(pixels[i])] = model[i];
    int before = 0, after = 0, all = 0, outside = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      outside += truth[i] == 0 && found[i] != 0;
      if (truth[i] == 0) continue;
      ++all, before += projected[i] != truth[i], after += found[i] != truth[i];
    }
    INFO(paint.name << ": " << before << " wrong before, " << after << " after, of " << all);
    CHECK(outside == 0);
    CHECK(after < before / 3);
    record::claim("photo_parts: labels wrong, of all", "value", "the labels that the photo was drawn by", 0.04,
                  double(after) / all, all);
  }
}

TEST_CASE("photo_parts: nothing on the mask gives nothing, and sizes must agree", "[twin][limit]") {
  GBuffer g;
  g.width = 8, g.height = 6;
  const std::vector<int> none = photo_parts(Image(8, 6), Mask(8, 6), g, {});
  CHECK(std::count(none.begin(), none.end(), 0) == 48);
  CHECK_THROWS_AS(photo_parts(Image(8, 7), Mask(8, 6), g, {}), Error);
  // A mask where no model is: all is something, nothing fails.
  const std::vector<int> blind = photo_parts(Image(8, 6, {0.5f, 0.5f, 0.5f}), Mask(8, 6, 1), g, {});
  CHECK(std::count_if(blind.begin(), blind.end(), [](int l) { return l >= 1 && l <= 4; }) == 48);
}

TEST_CASE("MainColor: the hue of most, or among greys the lightness of most", "[twin][value]") {
  std::vector<vec3<float>> lab(60, {40, 0, 50});
  lab.insert(lab.end(), 100, {20, 1, 1});
  const MainColor yellow(lab);
  CHECK(yellow.colorful);
  CHECK(yellow.like({70, 5, 60}));
  CHECK(!yellow.like({40, 50, 0}));
  CHECK(!yellow.like({40, 1, 2}));
  lab.assign(100, {90, 1, 1});
  lab.insert(lab.end(), 20, {40, 0, 50});
  const MainColor white(lab);
  CHECK(!white.colorful);
  CHECK(white.like({80, 2, 0}));
  CHECK(!white.like({40, 2, 0}));
}
