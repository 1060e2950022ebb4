// tests/scene/image.cpp -- planes, their padding, and pictures in another size
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include <cstdint>
#include <burnish/scene/image.h>

using namespace burnish;

TEST_CASE("Image: every plane begins on 64 bytes and is padded to packets", "[scene][value]") {
  Image image(7, 3, {0.25f, 0.5f, 1});
  for (int c = 0; c < 3; ++c) CHECK(reinterpret_cast<std::uintptr_t>(image.plane(c)) % 64 == 0);
  CHECK(image.stride() == 32);
  CHECK(image.plane(2)[20] == 1);
  CHECK(image.plane(2)[21] == 0);
  image.set(6, 2, {3, 4, 5});
  CHECK(image.at(6, 2).y == 4);
  CHECK(image.plane(1)[20] == 4);
}

TEST_CASE("Image: a ramp stays the same ramp in another size", "[scene][agreement]") {
  // Away from the border linear functions are kept, and the value at a centre follows from the ramp itself.
  Image image(64, 32);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64; ++x) image.set(x, y, {(float(x) + 0.5f) / 64, (float(y) + 0.5f) / 32, 1});
  }
  for (int w : {16, 50, 128}) {
    const Image out = resized(image, w, w / 2);
    REQUIRE(out.width == w);
    for (int y = w / 8; y < w / 2 - w / 8; ++y) {
      for (int x = w / 8; x < w - w / 8; ++x) {
        REQUIRE(out.at(x, y).x == Approx((float(x) + 0.5f) / float(w)).margin(2e-5));
        REQUIRE(out.at(x, y).y == Approx((float(y) + 0.5f) / float(w / 2)).margin(2e-5));
        REQUIRE(out.at(x, y).z == Approx(1));
      }
    }
  }
}

TEST_CASE("Mask: made smaller, fine stripes become their mean", "[scene][limit]") {
  Mask mask(64, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; x += 2) mask.at(x, y) = 1;
  }
  const Mask out = resized(mask, 8, 8);
  for (int x = 1; x < 7; ++x) CHECK(out.at(x, 4) == Approx(0.5).margin(1e-5));
}
