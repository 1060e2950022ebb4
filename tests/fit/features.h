// tests/fit/features.h -- what holds for every kind of features (fit/features.h), and inputs for it
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/fit/gram.h>
#include <burnish/fit/loss.h>
#include <burnish_test.h>
#include <record.h>
#include <random>

namespace features_test {
using namespace burnish;

inline Image picture(int w, int h, unsigned seed) {
  Image image(w, h);
  std::mt19937 random(seed);
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < w * h; ++i) image.plane(c)[i] = float(random() % 1025) / 1024;
  return image;
}
/// 0, 1/4, 1/2, 3/4 and 1 in a disc that touches no border, 0 around it and in a hole.
inline Mask disc(int w, int h, unsigned seed, float radius = 0.42f) {
  Mask mask(w, h);
  std::mt19937 random(seed);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const float dx = (float(x) + 0.5f) / float(w) - 0.5f, dy = (float(y) + 0.5f) / float(h) - 0.5f;
      const float value = random() % 2 ? 1.0f : float(random() % 5) / 4;
      if (std::hypot(dx, dy) < radius && std::hypot(dx - 0.1f, dy) > 0.08f) mask.at(x, y) = value;
    }
  return mask;
}
/// Random numbers, a derivative by each layer; 0 where the weight is, as features want it.
template <class T> std::vector<FeatureMap<T>> random_slopes(const std::vector<FeatureLayer<T>>& layers, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<FeatureMap<T>> out;
  for (const auto& l : layers) {
    FeatureMap<T>& d = out.emplace_back(l.maps.channels, l.maps.width, l.maps.height);
    for (int c = 0; c < d.channels; ++c)
      for (int i = 0; i < d.width * d.height; ++i)
        d.plane(c)[i] = l.weight.values[std::size_t(i)] > 0 ? T(float(random() % 2049) / 1024 - 1) : T(0);
  }
  return out;
}
template <class T>
double product(const std::vector<FeatureLayer<T>>& layers, const std::vector<FeatureMap<T>>& by) {
  double sum = 0;
  for (std::size_t k = 0; k < layers.size(); ++k)
    for (int c = 0; c < by[k].channels; ++c)
      for (int i = 0; i < by[k].width * by[k].height; ++i)
        if (layers[k].weight.values[std::size_t(i)] > 0)
          sum += double(layers[k].maps.plane(c)[i]) * double(by[k].plane(c)[i]);
  return sum;
}

/// The way back against central differences in double, at every value of the image: a random sum of all layers.
template <class F> void goes_back(const char* name, const F& f, int w, int h, double within) {
  CAPTURE(w, h);
  typename F::template Trace<double> t;
  FeatureMap<double> image = feature_map<double>(picture(w, h, 1)), d(3, w, h);
  const Mask mask = disc(w, h, 2);
  f.forward(image, mask, t);
  const auto by = random_slopes(t.layers, 3);
  f.backward(t, mask, by, d);
  double largest = 0, worst = 0;
  for (const double x : d.values) largest = std::max(largest, std::fabs(x));
  REQUIRE(largest > 0);
  constexpr double step = 2e-6;
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < w * h; ++i) {
      double& x = image.plane(c)[i];
      const double before = x;
      x = before + step, f.forward(image, mask, t);
      const double up = product(t.layers, by);
      x = before - step, f.forward(image, mask, t);
      const double down = product(t.layers, by);
      x = before;
      const double error = std::fabs(d.plane(c)[i] - (up - down) / (2 * step)) / largest;
      worst = std::isfinite(error) ? std::max(worst, error) : error;
      if (mask.values[std::size_t(i)] == 0) CHECK(d.plane(c)[i] == 0);
    }
  record::claim(name, "gradient", "central differences in double by the image, of the largest", within, worst,
                3 * w * h);
}
/// Float against double, of the largest value of each layer.
template <class F> void is_one_in_float(const char* name, const F& f, double within) {
  typename F::template Trace<float> a;
  typename F::template Trace<double> b;
  const Image image = picture(61, 43, 4);
  const Mask mask = disc(61, 43, 5);
  f.forward(feature_map<float>(image), mask, a), f.forward(feature_map<double>(image), mask, b);
  REQUIRE(a.layers.size() == b.layers.size());
  const auto slopes = random_slopes(a.layers, 6);
  const auto slopes_in_double = random_slopes(b.layers, 6);
  FeatureMap<float> d(3, 61, 43);
  FeatureMap<double> d_in_double(3, 61, 43);
  f.backward(a, mask, slopes, d), f.backward(b, mask, slopes_in_double, d_in_double);
  long points = 0;
  double worst = 0;
  const auto compare = [&](const FeatureMap<float>& x, const FeatureMap<double>& y) {
    double largest = 1e-30;
    for (const double v : y.values) largest = std::max(largest, std::fabs(v));
    for (std::size_t i = 0; i < y.values.size(); ++i)
      worst = std::max(worst, std::fabs(double(x.values[i]) - y.values[i]) / largest), ++points;
  };
  for (std::size_t k = 0; k < a.layers.size(); ++k) {
    for (int c = 0; c < a.layers[k].maps.channels; ++c)
      for (std::size_t i = 0; i < a.layers[k].weight.stride(); ++i)
        if (!(a.layers[k].weight.values[i] > 0)) a.layers[k].maps.plane(c)[i] = 0, b.layers[k].maps.plane(c)[i] = 0;
    compare(a.layers[k].maps, b.layers[k].maps);
  }
  compare(d, d_in_double);
  record::claim(name, "agreement", "float against double: layers and slopes, of the largest", within, worst, points);
}
/// What is outside the mask changes no bit of any layer that counts, nor of a slope, whatever it is.
template <class F> void sees_nothing_outside(const F& f) {
  const Image clean = picture(40, 29, 7);
  const Mask mask = disc(40, 29, 8);
  Image image = clean;
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 40 * 29; ++i)
      if (mask.values[std::size_t(i)] == 0) image.plane(c)[i] = i % 3 ? 7.5f : std::nanf("");
  typename F::template Trace<float> a, b;
  f.forward(feature_map<float>(clean), mask, a), f.forward(feature_map<float>(image), mask, b);
  const auto by = random_slopes(a.layers, 9);
  FeatureMap<float> d(3, 40, 29), d_clean(3, 40, 29);
  f.backward(a, mask, by, d_clean), f.backward(b, mask, by, d);
  CHECK(d.values == d_clean.values);
  long counted = 0, different = 0;
  for (std::size_t k = 0; k < a.layers.size(); ++k) {
    const auto &la = a.layers[k], &lb = b.layers[k];
    CHECK(la.weight.values == lb.weight.values);
    for (int c = 0; c < la.maps.channels; ++c)
      for (std::size_t i = 0; i < la.weight.stride(); ++i)
        if (la.weight.values[i] > 0) ++counted, different += la.maps.plane(c)[i] != lb.maps.plane(c)[i];
  }
  CHECK(counted > 100);
  CHECK(different == 0);
}
/// The same bits on one thread and on three.
template <class F> void is_one_on_all_threads(const F& f) {
  const Image image = picture(70, 50, 10), photo = picture(70, 50, 11);
  const Mask mask = disc(70, 50, 12);
  const int before = threads();
  Image d[2];
  double loss[2];
  for (int k = 0; k < 2; ++k) {
    set_threads(k ? 3 : 1);
    GramLoss<F> gram(f, photo, mask);
    d[k] = Image(70, 50);
    loss[k] = gram(image, mask, 1, d[k]);
  }
  set_threads(before);
  CHECK(loss[0] == loss[1]);
  CHECK(d[0].values == d[1].values);
}

}  // namespace features_test
