// tests/fit/gram.cpp -- the Gram loss: entries by hand, masks of any size, slopes against differences
// SPDX-License-Identifier: Apache-2.0
#include "features.h"
using namespace burnish;
using namespace features_test;

namespace {
FeatureLayer<double> layer(int channels, int w, int h, unsigned seed) {
  FeatureLayer<double> l{FeatureMap<double>(channels, w, h), FeatureMap<double>(1, w, h)};
  std::mt19937 random(seed);
  for (int i = 0; i < w * h; ++i) {
    l.weight.values[std::size_t(i)] = i % 4 == 1 ? 0 : double(random() % 5) / 4;
    for (int c = 0; c < channels; ++c) l.maps.plane(c)[i] = double(random() % 2001) / 1000 - 1;
  }
  return l;
}
/// As gram.h says it, entry by entry.
std::vector<double> plain(const FeatureLayer<double>& l) {
  const int n = l.maps.channels;
  std::vector<double> g(std::size_t(n * n));
  double area = 0;
  for (int p = 0; p < l.maps.width * l.maps.height; ++p) {
    const double w = l.weight.values[std::size_t(p)];
    area += w;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) g[std::size_t(i * n + j)] += w * l.maps.plane(i)[p] * l.maps.plane(j)[p];
  }
  for (double& x : g) x /= area;
  return g;
}
/// The part of a picture that repeats to the right.
Image tiled(const Image& tile, int times) {
  Image out(tile.width * times, tile.height);
  for (int y = 0; y < tile.height; ++y)
    for (int x = 0; x < out.width; ++x) out.set(x, y, tile.at(x % tile.width, y));
  return out;
}
}  // namespace

TEST_CASE("gram: two channels at two places by hand", "[fit][value]") {
  FeatureLayer<double> l{FeatureMap<double>(2, 2, 1), FeatureMap<double>(1, 2, 1)};
  l.maps.plane(0)[0] = 2, l.maps.plane(1)[0] = 3, l.maps.plane(0)[1] = -1, l.maps.plane(1)[1] = 5;
  l.weight.values[0] = 1, l.weight.values[1] = 0.5;
  const Gram g = gram(l);
  CHECK(g.area == 1.5);
  CHECK(g(0, 0) == Approx((4 + 0.5) / 1.5));
  CHECK(g(0, 1) == Approx((6 - 2.5) / 1.5));
  CHECK(g(1, 0) == g(0, 1));
  CHECK(g(1, 1) == Approx((9 + 12.5) / 1.5));
}
TEST_CASE("gram: any number of channels and places, against sums of one entry at a time", "[fit][agreement]") {
  double worst = 0;
  long points = 0;
  for (const auto& [n, w, h] : {std::tuple{1, 1, 1}, {3, 7, 5}, {27, 40, 9}, {5, 129, 3}, {33, 61, 47}}) {
    const auto l = layer(n, w, h, unsigned(n));
    const Gram g = gram(l);
    if (g.area == 0) continue;
    const auto expected = plain(l);
    for (std::size_t i = 0; i < expected.size(); ++i, ++points)
      worst = std::max(worst, std::fabs(g.entries[i] - expected[i]));
  }
  record::claim("gram", "value", "one entry at a time, features of -1 to 1", 1e-12, worst, points);
}
TEST_CASE("gram: a mask twice as wide over the same pattern, or of half the weight, has the same matrices",
          "[fit][value]") {
  const Image tile = picture(64, 32, 1);
  FilterBank::Trace<double> once, twice, half;
  const FilterBank bank{.octaves = 1};
  // The part is its inner rows and columns; over two tiles, twice the same places.
  Mask one(128, 32), two(128, 32), faint(128, 32);
  for (int y = 8; y < 24; ++y)
    for (int x = 8; x < 56; ++x)
      one.at(x, y) = two.at(x, y) = two.at(x + 64, y) = 1, faint.at(x, y) = 0.5f;
  const auto image = feature_map<double>(tiled(tile, 2));
  bank.forward(image, one, once), bank.forward(image, two, twice), bank.forward(image, faint, half);
  const Gram a = gram(once.layers[0]), b = gram(twice.layers[0]), c = gram(half.layers[0]);
  CHECK(b.area == Approx(2 * a.area));
  for (std::size_t i = 0; i < a.entries.size(); ++i) {
    CHECK(b.entries[i] == Approx(a.entries[i]).epsilon(1e-12));
    CHECK(c.entries[i] == Approx(a.entries[i]).epsilon(1e-12));
  }
}
TEST_CASE("gram_loss: the mean of the entries' differences in the photo's units", "[fit][value]") {
  const std::vector<FeatureLayer<double>> ours{layer(3, 9, 7, 2), layer(2, 5, 4, 3)};
  const std::vector<Gram> photo = grams(std::vector<FeatureLayer<double>>{layer(3, 8, 8, 4), layer(2, 3, 9, 5)});
  double expected = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    const auto g = plain(ours[k]);
    const int n = photo[k].channels;
    double mean = 0;
    for (int i = 0; i < n; ++i) mean += photo[k](i, i) / n;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        expected += std::fabs(g[std::size_t(i * n + j)] - photo[k](i, j)) /
                    std::sqrt((photo[k](i, i) + 0.01 * mean) * (photo[k](j, j) + 0.01 * mean)) / (2 * n * n);
  }
  std::vector<FeatureMap<double>> d;
  CHECK(gram_loss(ours, photo, 1, d) == Approx(expected).epsilon(1e-12));
  CHECK(gram_loss(ours, photo, 0.25, d) == Approx(0.25 * expected).epsilon(1e-12));
  CHECK(gram_loss(ours, grams(ours), 1, d) == 0);
  for (const auto& m : d)
    for (const double x : m.values) CHECK(x == 0);
}
TEST_CASE("gram_loss: a layer that is 0 in the photo's part has no units and does not count", "[fit][limit]") {
  std::vector<FeatureLayer<double>> ours{layer(3, 9, 7, 2), layer(2, 5, 4, 3)}, theirs{layer(3, 8, 8, 4), ours[1]};
  std::vector<FeatureMap<double>> d;
  const double alone = gram_loss(std::vector{ours[0]}, grams(std::vector{theirs[0]}), 1, d);
  std::fill(theirs[1].maps.values.begin(), theirs[1].maps.values.end(), 0.0);
  CHECK(gram_loss(ours, grams(theirs), 1, d) == alone);
  CHECK(d[1].values.empty());
}
TEST_CASE("gram_loss: its slopes by the features are those of differences", "[fit][gradient]") {
  std::vector<FeatureLayer<double>> ours{layer(5, 13, 11, 6), layer(3, 6, 5, 7)};
  const std::vector<Gram> photo = grams(std::vector<FeatureLayer<double>>{layer(5, 8, 8, 8), layer(3, 3, 9, 9)});
  std::vector<FeatureMap<double>> d, ignored;
  gram_loss(ours, photo, 0.7, d);
  double largest = 0, worst = 0;
  long points = 0;
  for (const auto& m : d)
    for (const double x : m.values) largest = std::max(largest, std::fabs(x));
  for (std::size_t k = 0; k < 2; ++k)
    for (int c = 0; c < ours[k].maps.channels; ++c)
      for (int i = 0; i < ours[k].maps.width * ours[k].maps.height; ++i, ++points) {
        double& x = ours[k].maps.plane(c)[i];
        const double before = x;
        x = before + 1e-6;
        const double up = gram_loss(ours, photo, 0.7, ignored);
        x = before - 1e-6;
        const double down = gram_loss(ours, photo, 0.7, ignored);
        x = before;
        worst = std::max(worst, std::fabs(d[k].plane(c)[i] - (up - down) / 2e-6) / largest);
        if (ours[k].weight.values[std::size_t(i)] == 0) CHECK(d[k].plane(c)[i] == 0);
      }
  record::claim("gram_loss", "gradient", "central differences in double by the features, of the largest", 1e-6, worst,
                points);
}
TEST_CASE("GramLoss: its slopes by the image are those of differences, and 0 outside the mask", "[fit][gradient]") {
  const Image photo = picture(31, 26, 10);
  Image image = picture(35, 24, 11), d(35, 24), ignored(35, 24);
  const Mask mask = disc(35, 24, 12);
  GramLoss<FilterBank, double> loss(FilterBank(), photo, disc(31, 26, 13));
  loss(image, mask, 0.6, d);
  double largest = 0, worst = 0;
  for (const float x : d.values) largest = std::max(largest, std::fabs(double(x)));
  REQUIRE(largest > 0);
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 35 * 24; ++i) {
      float& x = image.plane(c)[i];
      const float before = x, h = 1.0f / 8192;  // multiples of 1/1024 are moved exactly
      x = before + h;
      const double up = loss(image, mask, 0.6, ignored);
      x = before - h;
      const double down = loss(image, mask, 0.6, ignored);
      x = before;
      worst = std::max(worst, std::fabs(double(d.plane(c)[i]) - (up - down) / (2 * double(h))) / largest);
      if (mask.values[std::size_t(i)] == 0) CHECK(d.plane(c)[i] == 0);
    }
  record::claim("GramLoss", "gradient", "central differences in double by the image, of the largest", 1e-4, worst,
                3 * 35 * 24);
}
TEST_CASE("GramLoss: a picture moved under its mask is nearly at 0, a flat one of its colour is not", "[fit][value]") {
  const Image photo = picture(64, 64, 14);
  const Mask mask = disc(64, 64, 15, 0.3f);
  GramLoss<FilterBank> loss(FilterBank{.octaves = 2}, photo, mask);
  const auto of = [&](const Image& image, const Mask& m) {
    Image d(image.width, image.height);
    return loss(image, m, 1, d);
  };
  CHECK(of(photo, mask) == 0);
  CHECK(of(cropped(photo, -17, -5, 96, 80), cropped(mask, -17, -5, 96, 80)) == Approx(0).margin(1e-6));
  const Statistics s(photo, mask);
  const Image flat(64, 64, {float(s.mean[0]), float(s.mean[1]), float(s.mean[2])});
  CHECK(of(flat, mask) > 0.3);
}
TEST_CASE("GramLoss: it adds to what is there, by its weight, and an empty part gives 0", "[fit][limit]") {
  const Image photo = picture(30, 30, 16), image = picture(30, 30, 17);
  const Mask mask = disc(30, 30, 18), none(30, 30);
  GramLoss<FilterBank> loss(FilterBank(), photo, mask);
  Image d(30, 30), sum(30, 30, {1, 2, 3}), untouched(30, 30, {1, 2, 3});
  const double value = loss(image, mask, 1, d);
  CHECK(loss(image, mask, 0.5, sum) == Approx(0.5 * value));
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 900; ++i) CHECK(sum.plane(c)[i] == Approx(float(c + 1) + 0.5f * d.plane(c)[i]).margin(1e-6));
  Image same = untouched;
  CHECK(loss(image, none, 1, same) == 0);
  GramLoss<FilterBank> empty(FilterBank(), photo, none);
  CHECK(empty(image, mask, 1, same) == 0);
  CHECK(same.values == untouched.values);
}
TEST_CASE("GramLoss: what lies outside either mask changes no bit of loss or slope", "[fit][limit]") {
  Image photo = picture(40, 32, 19), image = picture(40, 32, 20), d(40, 32), d_clean(40, 32);
  const Mask theirs = disc(40, 32, 21), ours = disc(40, 32, 22, 0.35f);
  GramLoss<FilterBank> clean(FilterBank(), photo, theirs);
  const double value = clean(image, ours, 1, d_clean);
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 40 * 32; ++i) {
      if (theirs.values[std::size_t(i)] == 0) photo.plane(c)[i] = i % 2 ? std::nanf("") : 1e9f;
      if (ours.values[std::size_t(i)] == 0) image.plane(c)[i] = i % 2 ? -3 : std::nanf("");
    }
  GramLoss<FilterBank> odd(FilterBank(), photo, theirs);
  CHECK(odd(image, ours, 1, d) == value);
  CHECK(d.values == d_clean.values);
}
TEST_CASE("eroded: what is whole, and all around it, is left, as 1", "[fit][value]") {
  Mask mask(12, 9);
  for (int y = 1; y < 9; ++y)
    for (int x = 2; x < 11; ++x) mask.at(x, y) = 1;
  mask.at(10, 4) = 0.5f;
  for (const int r : {0, 1, 2}) {
    const Mask m = eroded(mask, r);
    for (int y = 0; y < 9; ++y)
      for (int x = 0; x < 12; ++x) {
        const bool box = x >= 2 + r && x < 11 - r && y >= 1 + r && y < 9 - r;  // beyond the picture is nothing
        const bool hole = std::abs(x - 10) <= r && std::abs(y - 4) <= r;
        CAPTURE(r, x, y);
        CHECK(m.at(x, y) == (box && !hole ? 1 : 0));
      }
  }
}
