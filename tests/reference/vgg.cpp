// tests/reference/vgg.cpp -- a network of VGG's kind and the Gram loss under masks against PyTorch 1.13
// SPDX-License-Identifier: Apache-2.0
#include <burnish/fit/gram.h>
#include <burnish/fit/vgg.h>
#include <burnish_test.h>
#include "errors.h"
#include "inputs.h"
using namespace burnish;
using namespace reference;

namespace {
constexpr int width = 21, height = 14;
constexpr std::size_t channels[] = {3, 6, 7, 8, 9, 10};

/// As vgg.py has it, by torchvision's names.
NamedTensors random_weights() {
  NamedTensors w;
  constexpr const char* names[] = {"features.0", "features.2", "features.5", "features.7", "features.10"};
  for (std::size_t k = 0; k < 5; ++k) {
    const double a = std::sqrt(6 / (9 * double(channels[k])));
    Tensor weight{{channels[k + 1], channels[k], 3, 3}, {}}, bias{{channels[k + 1]}, {}};
    for (std::size_t i = 0; i < channels[k + 1] * channels[k] * 9; ++i)
      weight.values.push_back(float(between(30 + k, i, 0, -a, a)));
    for (std::size_t i = 0; i < channels[k + 1]; ++i) bias.values.push_back(float(between(30 + k, i, 1, -0.1, 0.3)));
    w.tensors[std::string(names[k]) + ".weight"] = weight;
    w.tensors[std::string(names[k]) + ".bias"] = bias;
  }
  return w;
}
Image picture(std::uint64_t stream) {
  Image image(width, height);
  for (std::uint64_t c = 0; c < 3; ++c)
    for (std::uint64_t i = 0; i < width * height; ++i) image.plane(int(c))[i] = float(between(stream, i, c, 0, 1));
  return image;
}
Mask mask(std::uint64_t stream) {
  Mask m(width, height);
  for (int i = 0; i < width * height; ++i) {
    const bool in = stream % 2 == 0 ? i % width >= width / 3 : i % width < 2 * width / 3;
    if (in) m.values[std::size_t(i)] = float(std::floor(uniform(stream, std::uint64_t(i), 0) * 5) / 4);
  }
  return m;
}
/// Of all numbers of a map against a row of planes; errors are relative to the largest of them.
template <class T> void compare(Errors& e, const FeatureMap<T>& ours, const Array& theirs) {
  REQUIRE(theirs.shape == std::vector{std::size_t(ours.channels), std::size_t(ours.height), std::size_t(ours.width)});
  double largest = 0;
  for (const double x : theirs.values) largest = std::max(largest, std::fabs(x));
  for (int c = 0; c < ours.channels; ++c)
    for (int y = 0; y < ours.height; ++y)
      for (int x = 0; x < ours.width; ++x)
        e.add(double(ours.plane(c)[y * ours.width + x]), theirs(c, y, x), largest);
}
template <class T> void agrees_with_torch(double tolerance) {
  for (const Pooling pooling : {Pooling::max, Pooling::average}) {
    const std::string name = pooling == Pooling::max ? "vgg_max" : "vgg_average";
    CAPTURE(name);
    const Vgg vgg(random_weights(), "random", pooling);
    REQUIRE(vgg.layers() == 3);
    Vgg::Trace<T> t;
    const Mask all(width, height, 1);
    vgg.forward(feature_map<T>(picture(36)), all, t);
    Errors value, slope;
    std::vector<FeatureMap<T>> d;
    for (std::size_t k = 0; k < 3; ++k) {
      const FeatureMap<T>& m = t.layers[k].maps;
      compare(value, m, load(name + "_layer" + std::to_string(k)));
      FeatureMap<T> by = m;
      for (int c = 0; c < m.channels; ++c)
        for (int i = 0; i < m.width * m.height; ++i)
          by.plane(c)[i] = T(between(40 + k, std::uint64_t(c * m.width * m.height + i), 0, -1, 1));
      d.push_back(by);
    }
    FeatureMap<T> d_image(3, width, height);
    vgg.backward(t, all, d, d_image);
    compare(slope, d_image, load(name + "_by_image"));
    value.claim("Vgg", "value", "PyTorch 1.13, all layers, of the largest", tolerance);
    slope.claim("Vgg", "gradient", "PyTorch 1.13 by the image, of the largest", tolerance);

    vgg.forward(feature_map<T>(picture(37)), mask(38), t);
    const std::vector<Gram> photo = grams(t.layers);
    vgg.forward(feature_map<T>(picture(36)), mask(39), t);
    Errors loss, gram_slope;
    loss.add(gram_loss(t.layers, photo, 1, d), load(name + "_gram_loss")(0));
    d_image.reset(3, width, height);
    vgg.backward(t, mask(39), d, d_image);
    compare(gram_slope, d_image, load(name + "_gram_by_image"));
    loss.claim("gram_loss", "value", "PyTorch 1.13, a Vgg under masks", tolerance);
    gram_slope.claim("gram_loss", "gradient", "PyTorch 1.13 by the image, of the largest", tolerance);
  }
}
}  // namespace

TEST_CASE("PyTorch: a network's layers, the Gram loss under masks, and both slopes by the image, in double",
          "[reference][agreement]") {
  agrees_with_torch<double>(1e-6);
}
TEST_CASE("PyTorch: the same in float", "[reference][agreement]") { agrees_with_torch<float>(2e-5); }
