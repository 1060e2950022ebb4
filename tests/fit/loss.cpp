// tests/fit/loss.cpp -- losses: values by hand, slopes against differences, what lies outside a mask
// SPDX-License-Identifier: Apache-2.0
//
// Pictures are multiples of 1/64 and steps are powers of two, so that every moved entry is exact in float.
#include <burnish/fit/loss.h>
#include <burnish_test.h>
#include <record.h>
#include <cstring>
#include <random>

using namespace burnish;

namespace {

/// Multiples of 1/64 between 0 and 1.
Image picture(int w, int h, unsigned seed) {
  Image image(w, h);
  std::mt19937 random(seed);
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < w * h; ++i) image.plane(c)[i] = float(random() % 65) / 64;
  return image;
}
/// 0, 1/4, 1/2, 3/4 and 1; every third pixel is out.
Mask fractions(int w, int h, unsigned seed) {
  Mask mask(w, h);
  std::mt19937 random(seed);
  for (std::size_t i = 0; i < std::size_t(w * h); ++i) mask.values[i] = i % 3 == 1 ? 0.0f : float(random() % 5) / 4;
  return mask;
}
bool same_bits(const Image& a, const Image& b) {
  return a.values.size() == b.values.size() &&
         std::memcmp(a.values.data(), b.values.data(), a.values.size() * sizeof(float)) == 0;
}
/// Every entry of d against central differences of loss(image) with step h; within a part of the largest slope.
template <class Loss>
void check_slopes(const char* name, Loss loss, Image image, const Image& d, float h, double within) {
  double largest = 0, worst = 0;
  for (const float x : d.values) largest = std::max(largest, std::fabs(double(x)));
  REQUIRE(largest > 0);
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < image.width * image.height; ++i) {
      float& x = image.plane(c)[i];
      const float before = x;
      x = before + h;
      const double up = loss(image);
      x = before - h;
      const double down = loss(image);
      x = before;
      const double error = std::fabs(double(d.plane(c)[i]) - (up - down) / (2 * double(h))) / largest;
      worst = std::isfinite(error) ? std::max(worst, error) : error;
    }
  record::claim(name, "gradient", "central differences, exact in float", within, worst, 3 * image.width * image.height);
}
const std::pair<int, int> sizes[] = {{1, 1}, {5, 3}, {16, 1}, {17, 1}, {37, 11}};

}  // namespace

TEST_CASE("masked_l1: two pixels by hand", "[fit][value]") {
  Image image(2, 1), photo(2, 1, {0.5f, 0.5f, 0.5f});
  image.set(0, 0, {0.75f, 0.5f, 0.0f});  // off by 1/4, 0, 1/2, in full
  image.set(1, 0, {1.5f, -0.5f, 1.0f});  // off by 1, 1, 1/2, by half
  Mask mask(2, 1, 1.0f);
  mask.at(1, 0) = 0.5f;
  const auto [loss, d] = masked_l1(image, photo, mask);
  CHECK(loss == Approx(2.0 / 4.5).epsilon(1e-7));  // (3/4 + 5/4) / (3 * 3/2)
  const vec3<float> first = d.at(0, 0), second = d.at(1, 0);
  CHECK(first.x == Approx(1 / 4.5));
  CHECK(first.y == 0);  // the kink, where the slope is given as 0
  CHECK(first.z == Approx(-1 / 4.5));
  CHECK(second.x == Approx(0.5 / 4.5));
  CHECK(second.y == Approx(-0.5 / 4.5));
  CHECK(second.z == Approx(0.5 / 4.5));
}
TEST_CASE("masked_l1: a picture off by a constant is off by its mean, under any mask", "[fit][value]") {
  for (const auto& [w, h] : sizes) {
    CAPTURE(w, h);
    const Image photo = picture(w, h, 1);
    Image image = photo;
    const float off[3] = {0.25f, -0.5f, 0.125f};
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < w * h; ++i) image.plane(c)[i] += off[c];
    Mask mask = fractions(w, h, 2);
    mask.values[0] = 0.75f;
    CHECK(masked_l1(image, photo, mask).first == Approx(0.875 / 3).epsilon(1e-7));
  }
}
TEST_CASE("masked_l1: slopes by the image are those of differences, off the kinks image = photo", "[fit][gradient]") {
  const Image image = picture(13, 7, 3), photo = picture(13, 7, 4);
  const Mask mask = fractions(13, 7, 5);
  Image d(13, 7);
  masked_l1(image, photo, mask, 0.7, d);
  const auto loss = [&](const Image& at) {
    Image ignored(13, 7);
    return masked_l1(at, photo, mask, 0.7, ignored);
  };
  // A step below 1/64 crosses no kink; at one, the central difference is 0, the slope given there.
  check_slopes("masked_l1", loss, image, d, 1.0f / 128, 1e-6);
}

TEST_CASE("Statistics: a ramp's mean and variance", "[fit][value]") {
  for (const auto& [w, h] : sizes) {
    CAPTURE(w, h);
    const double n = w * h;
    Image image(w, h);
    for (int i = 0; i < w * h; ++i) {
      image.plane(0)[i] = float(i) / 64;
      image.plane(1)[i] = 1000 + float(i) / 64;  // the variance does not suffer from a large mean
      image.plane(2)[i] = 0.3f;
    }
    for (const float fraction : {1.0f, 0.25f}) {  // of the same weight everywhere
      const Statistics s(image, Mask(w, h, fraction));
      CHECK(s.area == Approx(n * double(fraction)));
      CHECK(s.mean[0] == Approx((n - 1) / 128).epsilon(1e-7));
      CHECK(s.mean[1] == Approx(1000 + (n - 1) / 128).epsilon(1e-9));
      CHECK(s.mean[2] == Approx(0.3f).epsilon(1e-7));
      CHECK(s.variance[0] == Approx((n * n - 1) / 12 / 4096).epsilon(1e-6));
      CHECK(s.variance[1] == Approx((n * n - 1) / 12 / 4096).epsilon(1e-6));
      CHECK(s.variance[2] == Approx(0).margin(1e-12));
    }
  }
}
TEST_CASE("Statistics: mask fractions are weights", "[fit][value]") {
  Image image(3, 1);
  image.set(0, 0, {0.25f, 2, 0}), image.set(1, 0, {1, -1, 0}), image.set(2, 0, {90, 90, 90});
  Mask mask(3, 1);
  mask.at(0, 0) = 0.75f, mask.at(1, 0) = 0.5f;
  const Statistics s(image, mask);  // two values a, b of weights p, q: (pa + qb) / (p + q) and pq (a - b)^2 / (p + q)^2
  CHECK(s.area == 1.25);
  CHECK(s.mean[0] == Approx((0.75 * 0.25 + 0.5) / 1.25));
  CHECK(s.mean[1] == Approx((0.75 * 2 - 0.5) / 1.25));
  CHECK(s.variance[0] == Approx(0.375 * 0.5625 / 1.5625));
  CHECK(s.variance[1] == Approx(0.375 * 9 / 1.5625));
  const Image wide = picture(37, 1, 24);
  for (int i = 0; i < 37; ++i) {  // one pixel alone
    Mask only(37, 1);
    only.at(i, 0) = 0.25f;
    const Statistics one(wide, only);
    CHECK(one.area == 0.25);
    CHECK(one.mean[2] == Approx(wide.plane(2)[i]).epsilon(1e-12));
  }
  const Statistics none(image, Mask(3, 1));
  CHECK(none.area == 0);
  CHECK(none.mean[0] == 0);
  CHECK(none.variance[2] == 0);
}

TEST_CASE("part_statistics: the sum over channels of the two differences", "[fit][value]") {
  const Image image = picture(19, 5, 6);
  const Mask mask = fractions(19, 5, 7);
  const Statistics own(image, mask);
  Statistics photo = own;
  CHECK(part_statistics(image, mask, photo).first == 0);
  photo.mean[0] += 0.25, photo.mean[2] -= 0.5, photo.variance[1] += 0.125, photo.variance[2] -= 0.0625;
  CHECK(part_statistics(image, mask, photo).first == Approx(0.9375).epsilon(1e-9));
}
TEST_CASE("part_statistics: slopes are those of differences, by the mean, by the variance and by both",
          "[fit][gradient]") {
  const Image image = picture(13, 7, 8);
  const Mask mask = fractions(13, 7, 9);
  const Statistics own(image, mask);
  const double sides[][2] = {{0.5, 0}, {0, 0.5}, {0.5, 0.5}, {-0.5, 0.5}, {0.5, -0.5}, {-0.5, -0.5}};
  for (const auto& [by_mean, by_variance] : sides) {
    CAPTURE(by_mean, by_variance);
    Statistics photo = own;
    for (std::size_t c = 0; c < 3; ++c) {
      // 0: the kink mean = mean or variance = variance. The slope there is given as 0, as it is of the loss below.
      photo.mean[c] += by_mean * double(c + 1), photo.variance[c] += by_variance;
    }
    const auto loss = [&](const Image& at) {
      if (by_mean != 0 && by_variance != 0) {
        Image ignored(13, 7);
        return part_statistics(at, mask, photo, 0.3, ignored);
      }
      const Statistics s(at, mask);
      double sum = 0;
      for (std::size_t c = 0; c < 3; ++c)
        sum += by_mean != 0 ? std::fabs(s.mean[c] - photo.mean[c]) : std::fabs(s.variance[c] - photo.variance[c]);
      return 0.3 * sum;
    };
    Image d(13, 7);
    part_statistics(image, mask, photo, 0.3, d);
    check_slopes("part_statistics", loss, image, d, 1.0f / 128, 1e-5);
  }
}

TEST_CASE("losses: they add to what is there, each by its weight", "[fit][value]") {
  const Image image = picture(21, 4, 10), photo = picture(21, 4, 11);
  const Mask mask = fractions(21, 4, 12), part = fractions(21, 4, 13);
  const Statistics theirs(photo, part);
  const auto [l1, d_l1] = masked_l1(image, photo, mask);
  const auto [statistics, d_statistics] = part_statistics(image, part, theirs);
  Image d(21, 4, {1, 2, 3});
  CHECK(masked_l1(image, photo, mask, 0.5, d) == Approx(0.5 * l1).epsilon(1e-12));
  CHECK(part_statistics(image, part, theirs, 0.25, d) == Approx(0.25 * statistics).epsilon(1e-12));
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 84; ++i)
      CHECK(d.plane(c)[i] ==
            Approx(float(c + 1) + 0.5f * d_l1.plane(c)[i] + 0.25f * d_statistics.plane(c)[i]).epsilon(1e-6));
}
TEST_CASE("losses: an empty mask gives 0 and touches nothing", "[fit][limit]") {
  const Image image = picture(9, 2, 14), photo = picture(9, 2, 15);
  const Mask none(9, 2), all(9, 2, 1);
  const Image before(9, 2, {1, 2, 3});
  Image d = before;
  CHECK(masked_l1(image, photo, none, 1, d) == 0);
  CHECK(part_statistics(image, none, Statistics(photo, all), 1, d) == 0);
  CHECK(part_statistics(image, all, Statistics(photo, none), 1, d) == 0);
  CHECK(same_bits(d, before));
  CHECK(masked_l1(Image(), Image(), Mask()).first == 0);
}
TEST_CASE("losses: what lies outside the mask is neither read nor touched", "[fit][limit]") {
  for (const auto& [w, h] : sizes) {
    CAPTURE(w, h);
    Image image = picture(w, h, 16), photo = picture(w, h, 17), d(w, h);
    Mask mask = fractions(w, h, 18);
    const Image clean_image = image, clean_photo = photo;
    mask.values[0] = 1;
    Image clean_d(w, h);
    const Statistics clean(clean_photo, mask);
    const double l1 = masked_l1(clean_image, clean_photo, mask, 1, clean_d),
                 part = part_statistics(clean_image, mask, clean, 1, clean_d);
    const float odd[] = {std::nanf(""), std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                         -0.0f};
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < w * h; ++i)
        if (mask.values[std::size_t(i)] == 0)
          image.plane(c)[i] = odd[i % 4], photo.plane(c)[i] = odd[(i + c) % 4],
          clean_d.plane(c)[i] = d.plane(c)[i] = odd[(i + 3) % 4];
    const Statistics s(photo, mask);
    CHECK(s.mean == clean.mean);
    CHECK(s.variance == clean.variance);
    CHECK(masked_l1(image, photo, mask, 1, d) == l1);
    CHECK(part_statistics(image, mask, s, 1, d) == part);
    CHECK(same_bits(d, clean_d));
  }
}
TEST_CASE("losses: a number that is none inside the mask shows in the loss, and in no other pixel's slope",
          "[fit][limit]") {
  const Mask mask(20, 3, 1);
  const Image photo = picture(20, 3, 19);
  const Statistics theirs(photo, mask);
  for (const float odd : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
    CAPTURE(odd);
    Image image = picture(20, 3, 20), d(20, 3);
    image.plane(1)[33] = odd;
    CHECK_FALSE(std::isfinite(masked_l1(image, photo, mask, 1, d)));
    CHECK_FALSE(std::isfinite(part_statistics(image, mask, theirs, 1, d)));
    d.plane(1)[33] = 0;
    for (const float x : d.values) CHECK(std::isfinite(x));
  }
}
