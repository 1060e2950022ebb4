// tests/twin/segment.cpp -- vehicles of known masks are cut out of pictures made here
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include <record.h>
#include <burnish/twin/segment_at.h>

using namespace burnish;

namespace {
struct Scene {
  Image photo{240, 160};
  Mask mask{240, 160};
};
/// A car from its side before trees, on a road: shaded paint, dark windows, wheels with lighter rims, and a shadow below.
/// Everything is textured. Its place and size: 40 .. 200 by 50 .. 116, moved by dx.
Scene street(unsigned seed, const vec3<float>& paint, int dx = 0) {
  Scene s;
  std::mt19937 random(seed);
  std::normal_distribution<float> noise;
  const auto leaf = [](int x, int y) {
    return 0.5f + 0.5f * std::sin(0.9f * float(x)) * std::sin(1.1f * float(y) + 0.3f * float(x));
  };
  for (int j = 0; j < 160; ++j)
    for (int i = 0; i < 240; ++i) {
      const float x = float(i - dx) + 0.5f, y = float(j) + 0.5f;
      vec3<float> c =
          j < 84 ? vec3<float>(0.03f, 0.09f, 0.02f) * (0.4f + 1.2f * leaf(i, j)) : vec3<float>(0.2f, 0.2f, 0.21f);
      const bool body = x > 40 && x < 200 && y > 74 && y < 106 && !(x < 44 && y < 80) && !(x > 196 && y < 80);
      const float slope = (74 - y) / 24;  // of the greenhouse: narrower at the top
      const bool house = y > 50 && y <= 74 && x > 70 + 16 * slope && x < 176 - 12 * slope;
      const bool window = house && y > 55 && x > 75 + 16 * slope && x < 171 - 12 * slope && std::abs(x - 124) > 2;
      const float wheel = std::min(std::hypot(x - 74, y - 103), std::hypot(x - 168, y - 103));
      if (y > 106 && y < 119 && x > 46 && x < 208) c = vec3<float>(0.02f);
      if (body) c = paint * (1.2f - 0.02f * (y - 74));
      if (house) c = paint * 1.1f;
      if (window) c = vec3<float>(0.02f, 0.03f, 0.04f);
      if (wheel < 13) c = vec3<float>(0.012f);
      if (wheel < 8) c = vec3<float>(0.3f);
      s.mask.at(i, j) = body || house || wheel < 13;
      const float grain = 1 + 0.06f * noise(random);
      s.photo.set(i, j, max(c * grain, vec3<float>(0.0f)));
    }
  return s;
}
double overlap(const Mask& a, const Mask& b) {
  double both = 0, any = 0;
  for (int i = 0; i < a.width * a.height; ++i) {
    const bool x = a.values[std::size_t(i)] > 0.5f, y = b.values[std::size_t(i)] > 0.5f;
    both += x && y, any += x || y;
  }
  return any > 0 ? both / any : 0;
}
const vec3<float> paints[] = {{0.45f, 0.03f, 0.02f}, {0.7f, 0.7f, 0.72f}, {0.03f, 0.08f, 0.35f}};
}  // namespace

TEST_CASE("Segment: a car in a tight box is cut out, wheels in and shadow out", "[twin][value]") {
  // The outline is some 450 pixels long around 7,700: one pixel off all along it is an IoU of 0.94.
  record::Worst worst;
  for (int k = 0; k < 3; ++k) {
    const Scene s = street(unsigned(k), paints[k]);
    const Segmented found = segment(s.photo, {40, 50, 200, 116});
    INFO("paint " << k << ", certainty " << found.certainty);
    worst(1 - overlap(found.mask, s.mask));
    CHECK(found.certainty > 0.85f);
    CHECK(found.certainty <= 1);
    CHECK(found.mask.at(74, 113) > 0.5f);   // a tyre's lowest part
    CHECK(found.mask.at(121, 113) < 0.5f);  // the shadow between the wheels
    CHECK(found.mask.at(100, 64) > 0.5f);   // a window
    CHECK(iou(found.box, {40, 50, 200, 116}) > 0.9f);
  }
  record::claim("segment", "image", "the masks that cars were drawn with, in their boxes: 1 - IoU", 0.06, worst.value,
                3);
}

TEST_CASE("Segment: from a point the car is found, too, and from a box some percent off", "[twin][value]") {
  const Scene s = street(5, paints[0], 12);
  const Segmented at = segment(s.photo, vec2<float>(130, 90));
  CHECK(overlap(at.mask, s.mask) > 0.9);
  CHECK(at.certainty > 0.4f);
  const Segmented off = segment(s.photo, {60, 56, 205, 112}, for_detections());
  CHECK(overlap(off.mask, s.mask) > 0.9);
}

TEST_CASE("Segment: the same bits on one thread and on several", "[twin][symmetry]") {
  const Scene s = street(6, paints[2]);
  set_threads(1);
  const Segmented one = segment(s.photo, vec2<float>(120, 90));
  set_threads(3);
  const Segmented three = segment(s.photo, vec2<float>(120, 90));
  set_threads(0);
  CHECK(one.mask.values == three.mask.values);
  CHECK(one.certainty == three.certainty);
}

TEST_CASE("Segment: boxes at the rim, of no size and around nothing do no harm", "[twin][limit]") {
  const Scene s = street(8, paints[1]);
  for (const PixelBox& box : {PixelBox{0, 0, 240, 160}, PixelBox{-50, -50, 20, 30}, PixelBox{230, 150, 400, 300},
                              PixelBox{5, 5, 5, 5}, PixelBox{100, 80, 104, 83}, PixelBox{300, 300, 400, 400}}) {
    const Segmented found = segment(s.photo, box);
    CHECK(found.mask.width == 240);
    for (const float v : found.mask.values) CHECK((v >= 0 && v <= 1.0001f));
  }
  const Image flat(60, 40, {0.2f, 0.2f, 0.2f});
  CHECK(segment(flat, {10, 10, 50, 30}).certainty <= 1);
  CHECK(segment(flat, vec2<float>(30, 20)).certainty <= 1);
}

TEST_CASE("Segment: a mask is cleaned to one piece without holes", "[twin][value]") {
  Mask m(40, 30);
  for (int y = 5; y < 20; ++y)
    for (int x = 5; x < 25; ++x) m.at(x, y) = 1;
  const Mask whole = m;
  m.at(12, 12) = m.at(13, 12) = 0;
  m.at(35, 25) = 1, m.at(36, 25) = 1;
  const Mask c = cleaned(m);
  CHECK(c.values == whole.values);
  const Mask crumb = cleaned(m, vec2<float>(35.5f, 25.5f));
  CHECK(std::count(crumb.values.begin(), crumb.values.end(), 1.0f) == 2);
  m.at(4, 10) = 0.3f;  // a soft edge
  CHECK(cleaned(m).at(4, 10) == 0.3f);
  CHECK(cleaned(Mask(8, 8)).values == Mask(8, 8).values);
}

TEST_CASE("Seen wheels: both are found where they are, in pictures without them none", "[twin][value]") {
  const Scene s = street(9, paints[0]);
  Mask grey(240, 160), vehicle(240, 160);
  for (int y = 0; y < 160; ++y)
    for (int x = 0; x < 240; ++x) {
      grey.at(x, y) = srgb_from_linear(luminance(s.photo.at(x, y)));
      vehicle.at(x, y) = s.mask.at(x, y) > 0.5f ? 1.0f : -1.0f;
    }
  std::vector<SeenWheel> wheels = seen_wheels(grey, vehicle, {40, 50, 200, 116});
  REQUIRE(wheels.size() == 2);
  if (wheels[0].x > wheels[1].x) std::swap(wheels[0], wheels[1]);
  for (int k = 0; k < 2; ++k) {
    CHECK(std::abs(wheels[std::size_t(k)].x - (k ? 168 : 74)) < 2.5f);
    CHECK(std::abs(wheels[std::size_t(k)].y - 103) < 2.5f);
    CHECK(std::abs(wheels[std::size_t(k)].ry - 13) < 2.5f);
  }
  CHECK(below_ground(wheels[0], wheels[1], 120, 130) > 10);
  CHECK(below_ground(wheels[1], wheels[0], 120, 100) < -10);
  CHECK(seen_wheels(Mask(240, 160, 0.3f), vehicle, {40, 50, 200, 116}).empty());
}
