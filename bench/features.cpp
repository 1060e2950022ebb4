// bench/features.cpp -- what features of an image cost: the filter bank; convolutions against a plain matrix product
// SPDX-License-Identifier: Apache-2.0
//
//   bench_features [rounds]
//
// Random pictures and weights. Every row is the best of its rounds, the rows interleaved. One thread is timed in
// processor time, which strangers do not lengthen, all of them by the clock. The network is VGG16 up to relu4_1; its
// rate counts multiplications and additions of its convolutions alone. The matrix product is Eigen's of 256 x 2304 by
// 2304 x 1024, as many rows as a layer in the middle has channels; with several threads, one for each.
#include <burnish/fit/gram.h>
#include <burnish/fit/vgg.h>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <random>

using namespace burnish;

namespace {

/// Seconds: of this process's work if it has one thread, else of the clock on the wall.
double now() {
  if (threads() == 1) return double(std::clock()) / CLOCKS_PER_SEC;
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
struct Row {
  std::string name;
  std::function<void()> run;
  double operations = 0;  // multiplications and additions; 0: not counted
  double best = 1e9;
};
std::mt19937 generator(1);
float random_number() { return float(generator() % 65536) / 65536; }

NamedTensors vgg16() {
  NamedTensors w;
  std::size_t inputs = 3;
  constexpr std::pair<int, std::size_t> convolutions[] = {{0, 64},   {2, 64},   {5, 128},  {7, 128},
                                                          {10, 256}, {12, 256}, {14, 256}, {17, 512}};
  for (const auto& [number, outputs] : convolutions) {
    const std::string name = "features." + std::to_string(number);
    Tensor weight{{outputs, inputs, 3, 3}, std::vector<float>(outputs * inputs * 9)};
    const float a = std::sqrt(6 / (9 * float(inputs)));
    for (float& x : weight.values) x = a * (2 * random_number() - 1);
    w.tensors[name + ".weight"] = std::move(weight);
    w.tensors[name + ".bias"] = Tensor{{outputs}, std::vector<float>(outputs, 0.05f)};
    inputs = outputs;
  }
  return w;
}

void measure(int rounds, const std::string& title) {
  constexpr int size = 512, small = 224;
  Image photo(size, size), image(size, size), d(size, size);
  for (float& x : photo.values) x = random_number();
  for (float& x : image.values) x = random_number();
  const Mask mask(size, size, 1);
  const FilterBank bank;
  FilterBank::Trace<float> trace;
  const FeatureMap<float> map = feature_map<float>(image);
  bank.forward(map, mask, trace);
  const std::vector<Gram> theirs = grams(trace.layers);
  std::vector<FeatureMap<float>> slopes;
  bank.forward(feature_map<float>(photo), mask, trace);
  gram_loss(trace.layers, theirs, 1, slopes);
  FeatureMap<float> d_map(3, size, size);
  GramLoss<FilterBank> loss(bank, photo, mask);

  const Vgg vgg(vgg16());
  Vgg::Trace<float> network;
  const Mask small_mask(small, small, 1);
  const FeatureMap<float> input = feature_map<float>(cropped(image, 0, 0, small, small));
  vgg.forward(input, small_mask, network);
  std::vector<FeatureMap<float>> by;
  for (const auto& l : network.layers) by.push_back(l.maps);
  FeatureMap<float> d_input(3, small, small);

  using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Matrix a = Matrix::Random(256, 2304), b = Matrix::Random(2304, 1024);
  std::vector<Matrix> c(std::size_t(threads()), Matrix(256, 1024));

  std::vector<Row> rows;
  rows.push_back({"filter bank forward", [&] { bank.forward(map, mask, trace); }});
  rows.push_back({"filter bank backward", [&] { bank.backward(trace, mask, slopes, d_map); }});
  rows.push_back({"Gram loss and slope of its layers", [&] { gram_loss(trace.layers, theirs, 1, slopes); }});
  rows.push_back({"GramLoss, all of it", [&] { loss(image, mask, 1, d); }});
  const double work = 2 * vgg.work(small, small);
  rows.push_back({"VGG16 forward", [&] { vgg.forward(input, small_mask, network); }, work});
  rows.push_back({"VGG16 backward", [&] { vgg.backward(network, small_mask, by, d_input); }, work});
  rows.push_back({"Eigen's matrix product",
                  [&] { parallel_for(threads(), [&](int k) { c[std::size_t(k)].noalias() = a * b; }); },
                  2.0 * 256 * 2304 * 1024 * threads()});
  for (int r = 0; r < rounds; ++r)
    for (Row& row : rows) {
      const double start = now();
      row.run();
      row.best = std::min(row.best, now() - start);
    }
  const double plain = rows.back().operations / rows.back().best;
  std::printf("%s\n", title.c_str());
  for (const Row& row : rows) {
    std::printf("  %-36s %9.2f ms", row.name.c_str(), 1e3 * row.best);
    if (row.operations > 0)
      std::printf("  %7.1f GFLOP/s  %4.0f %% of the product", row.operations / row.best / 1e9,
                  100 * row.operations / row.best / plain);
    std::printf("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5, all = threads();
  std::printf("pictures of 512 x 512, networks on 224 x 224; the best of %d rounds\n", rounds);
  set_threads(1);
  measure(rounds, "one thread, processor time");
  set_threads(all);
  if (all > 1) measure(rounds, std::to_string(all) + " threads, by the clock");
}
