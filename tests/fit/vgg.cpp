// tests/fit/vgg.cpp -- a network of VGG's kind: its names, one layer by hand, the way back, what it refuses
// SPDX-License-Identifier: Apache-2.0
//
// tests/reference/vgg.cpp compares it with PyTorch.
#include <burnish/fit/vgg.h>
#include "features.h"
using namespace burnish;
using namespace features_test;

namespace {
Tensor random_tensor(std::vector<std::size_t> shape, unsigned seed, float low, float high) {
  Tensor t{std::move(shape), {}};
  std::size_t n = 1;
  for (const std::size_t s : t.shape) n *= s;
  std::mt19937 random(seed);
  for (std::size_t i = 0; i < n; ++i) t.values.push_back(low + (high - low) * float(random() % 1025) / 1024);
  return t;
}
/// Convolutions by number, of so many channels each.
NamedTensors weights(std::initializer_list<std::pair<int, std::size_t>> convolutions,
                     const std::string& before = "features.") {
  NamedTensors w;
  std::size_t inputs = 3;
  for (const auto& [number, outputs] : convolutions) {
    const float a = std::sqrt(6 / (9 * float(inputs)));
    const std::string name = before + std::to_string(number);
    w.tensors[name + ".weight"] = random_tensor({outputs, inputs, 3, 3}, unsigned(number) + 1, -a, a);
    w.tensors[name + ".bias"] = random_tensor({outputs}, unsigned(number) + 100, -0.1f, 0.3f);
    inputs = outputs;
  }
  return w;
}
std::string refusal(const NamedTensors& w) {
  try {
    Vgg vgg(w, "net.npz");
  } catch (const Error& e) {
    return e.what();
  }
  return "accepted";
}
std::vector<int> channels_of_layers(const Vgg& vgg) {
  Vgg::Trace<float> t;
  vgg.forward(feature_map<float>(picture(16, 16, 1)), Mask(16, 16, 1), t);
  std::vector<int> out;
  for (const auto& l : t.layers) out.push_back(l.maps.channels);
  return out;
}
}  // namespace

TEST_CASE("Vgg: one convolution by hand, its border of zeros, its bias and its ReLU", "[fit][value]") {
  Vgg vgg;
  vgg.mean = {0, 0, 0}, vgg.deviation = {1, 1, 1};
  Tensor weight{{1, 3, 3, 3}, std::vector<float>(27)};
  for (std::size_t k = 0; k < 9; ++k) weight.values[9 + k] = float(k) - 3;  // of green: -3 .. 5, row by row
  vgg.convolution(weight, Tensor{{1}, {0.5f}}, true);
  FeatureMap<double> image(3, 2, 2);
  image.plane(1)[0] = 1, image.plane(1)[1] = 2, image.plane(1)[2] = 4, image.plane(1)[3] = 8;
  Vgg::Trace<double> t;
  vgg.forward(image, Mask(2, 2, 1), t);
  REQUIRE(t.layers.size() == 1);
  const double* const out = t.layers[0].maps.plane(0);
  CHECK(out[0] == 1 * 1 + 2 * 2 + 4 * 4 + 8 * 5 + 0.5);
  CHECK(out[1] == 1 * 0 + 2 * 1 + 4 * 3 + 8 * 4 + 0.5);
  CHECK(out[2] == 1 * -2 + 2 * -1 + 4 * 1 + 8 * 2 + 0.5);
  CHECK(out[3] == std::max(0.0, 1 * -3 + 2 * -2 + 4 * 0 + 8 * 1 + 0.5));
}
TEST_CASE("Vgg: torchvision's names tell where it pools, and which layers are asked for", "[fit][value]") {
  // VGG16 is 0, 2, 5, 7, 10, 12, 14, 17, 19, 21, 24, ...; numbers are sorted as numbers, not as words.
  const Vgg vgg(weights({{0, 4}, {2, 5}, {5, 6}, {7, 7}, {10, 8}, {12, 9}, {14, 10}}));
  CHECK(channels_of_layers(vgg) == std::vector{4, 6, 8});
  CHECK(vgg.work(16, 12) == 9.0 * (192 * (3 * 4 + 4 * 5) + 48 * (5 * 6 + 6 * 7) + 12 * 7 * 8));
  CHECK(channels_of_layers(Vgg(weights({{0, 4}, {2, 5}, {5, 6}}, ""))) == std::vector{4, 6});
  CHECK(channels_of_layers(Vgg(weights({{0, 4}}, "module.vgg19.features."))) == std::vector{4});
  NamedTensors whole = weights({{0, 4}, {3, 5}});
  whole.tensors["classifier.0.weight"] = random_tensor({4, 20}, 1, -1, 1);
  whole.tensors["classifier.0.bias"] = random_tensor({4}, 1, -1, 1);
  CHECK(channels_of_layers(Vgg(whole)) == std::vector{4, 5});
}
TEST_CASE("Vgg: weights that are none of such a network are refused in one line", "[fit][limit]") {
  CHECK(refusal(NamedTensors{}) == "net.npz: found no convolution, expected features.0.weight and so on");
  CHECK(refusal(weights({{0, 4}, {4, 5}})).find("net.npz: features.4.weight follows number 0, expected") == 0);
  CHECK(refusal(weights({{1, 4}})).find("net.npz: features.1.weight") == 0);
  NamedTensors w = weights({{0, 4}, {2, 5}});
  w.tensors.erase("features.2.bias");
  CHECK(refusal(w) == "net.npz: features.2.bias is missing");
  w.tensors["features.2.bias"] = random_tensor({4}, 1, 0, 1);
  CHECK(refusal(w) == "net.npz: features.2: found a bias of 4 numbers, expected 5");
  w = weights({{0, 4}, {2, 5}});
  w.tensors["features.2.weight"] = random_tensor({5, 3, 3, 3}, 1, 0, 1);
  CHECK(refusal(w) == "net.npz: features.2: found a weight of another shape, expected outputs x 4 x 3 x 3");
  w = weights({{0, 4}, {3, 5}});
  w.tensors["features.1.weight"] = random_tensor({4}, 1, 0, 1);
  CHECK(refusal(w).find("batch normalisation") != std::string::npos);
  w = weights({{0, 4}});
  w.tensors["other.0.weight"] = random_tensor({5, 3, 3, 3}, 1, 0, 1);
  CHECK(refusal(w).find("net.npz: two convolutions have the number of") == 0);
}
TEST_CASE("Vgg: its slopes by the image are those of differences, through either pooling", "[fit][gradient]") {
  for (const Pooling p : {Pooling::max, Pooling::average})
    goes_back("Vgg", Vgg(weights({{0, 4}, {2, 5}, {5, 6}, {7, 4}, {10, 5}}), "random", p), 18, 15, 1e-6);
}
TEST_CASE("Vgg: float gives what double gives", "[fit][agreement]") {
  is_one_in_float("Vgg", Vgg(weights({{0, 4}, {2, 5}, {5, 6}}), "random", Pooling::average), 2e-5);
}
TEST_CASE("Vgg: what lies outside the mask is neither read nor touched", "[fit][limit]") {
  sees_nothing_outside(Vgg(weights({{0, 4}, {2, 5}, {5, 6}, {8, 7}})));
}
TEST_CASE("Vgg: a part of one colour is of one colour behind the first layers, whatever lies around", "[fit][value]") {
  Vgg::Trace<double> t;
  FeatureMap<double> image(3, 32, 24);
  const Mask mask = disc(32, 24, 2, 0.3f);
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 32 * 24; ++i) image.plane(c)[i] = mask.values[std::size_t(i)] > 0 ? 0.2 + 0.1 * c : i % 2;
  Vgg(weights({{0, 4}, {2, 5}, {5, 6}})).forward(image, mask, t);
  for (const auto& l : t.layers)
    for (int c = 0; c < l.maps.channels; ++c) {
      double low = 1e9, high = -1e9;
      for (std::size_t i = 0; i < l.weight.stride(); ++i)
        if (l.weight.values[i] > 0)
          low = std::min(low, l.maps.plane(c)[i]), high = std::max(high, l.maps.plane(c)[i]);
      CHECK(high - low == Approx(0).margin(1e-9));
    }
}
TEST_CASE("Vgg: the same bits for any number of threads", "[fit][agreement]") {
  is_one_on_all_threads(Vgg(weights({{0, 8}, {2, 8}, {5, 16}})));
}
