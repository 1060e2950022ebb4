// burnish/fit/vgg.h -- features of a network of VGG's kind: 3 x 3 convolutions, ReLU and pooling, and their way back
// SPDX-License-Identifier: Apache-2.0
//
// Simonyan and Zisserman 2015. Any number of layers; weights are handed over as tensors, torchvision's names are
// understood (io/safetensors.h and io/npy.h read them). The only file of fit/ that names Eigen: a convolution is a
// matrix product over the pixels' neighbourhoods, strip by strip, on all cores; the result does not depend on how many
// there are.
//
// Features of a part (fit/features.h): pixels outside the mask are given the part's mean colour, in part where the mask
// is a fraction, so that what lies behind the part changes nothing and the border is no edge of black; a layer's weight
// is the mask, averaged where the network pools. With the mask 1 everywhere the layers are the network's own.
#pragma once
#if defined(__GNUC__) && !defined(__clang__)  // g++ 12 takes the padding of AVX-512 intrinsics for uninitialised
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <Eigen/Core>
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif
#include <map>
#include <string>
#include <burnish/fit/features.h>
#include <burnish/scene/error.h>
#include <burnish/scene/tensor.h>

namespace burnish {

enum class Pooling { max, average };  ///< of 2 x 2, a last odd row or column is left out

class Vgg {
public:
  /// An image's values (display values, 0 to 1) less the mean, by the deviation: torchvision's for ImageNet.
  std::array<float, 3> mean{0.485f, 0.456f, 0.406f}, deviation{0.229f, 0.224f, 0.225f};

  Vgg() = default;
  /// From "features.0.weight" (outputs x inputs x 3 x 3) and "features.0.bias", "features.2.weight", ...: a convolution
  /// and its ReLU take two numbers, pooling takes one more. Anything may stand before the numbers; what is no such
  /// weight, such as a classifier's, is left out. Layers that are asked for are the first ReLU and the first behind
  /// each pooling (relu1_1, relu2_1, ... as in Gatys et al. 2016); the network is cut behind the last. Error, beginning
  /// with `named`, for weights that are none of such a network.
  explicit Vgg(const NamedTensors& weights, const std::string& named = "VGG", Pooling = Pooling::max);

  /// Behind what is there: a convolution (weight: outputs x inputs x 3 x 3) with its ReLU; layer: it is asked for.
  void convolution(const Tensor& weight, const Tensor& bias, bool layer, const std::string& named = "VGG");
  void pool(Pooling p) { steps.push_back({p, {}, {}, {}, 0, 0, false}); }
  int layers() const { return int(std::count_if(steps.begin(), steps.end(), [](const Step& s) { return s.layer; })); }
  /// Multiplications of a forward pass over an image of that size.
  double work(int width, int height) const;

  template <class T> struct Trace {
    FeatureMap<T> input;                 // the part over its mean, normalised
    std::vector<FeatureMap<T>> outputs;  // of every step, behind the ReLU
    std::vector<FeatureLayer<T>> layers;
    FeatureMap<T> d, d_before;
    double area = 0;
  };
  template <class T> void forward(const FeatureMap<T>& image, const Mask& mask, Trace<T>& t) const;
  template <class T> void backward(Trace<T>& t, const Mask& mask, const std::vector<FeatureMap<T>>& d_layers,
                                   FeatureMap<T>& d_image) const;

private:
  using Weights = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  struct Step {
    Pooling pooling{};
    Weights weight;  // outputs x (inputs, rows, columns); empty: a pooling
    Weights back;    // inputs x (outputs, rows, columns), turned by 180 degrees: the same convolution on the way back
    std::vector<float> bias;
    int inputs = 0, outputs = 0;
    bool layer = false;
  };
  std::vector<Step> steps;

  template <class T> static void convolve(const Weights& weight, const float* bias, const FeatureMap<T>& from,
                                          FeatureMap<T>& to);
  template <class T> static void pool(Pooling, const FeatureMap<T>& from, FeatureMap<T>& to);
  template <class T> static void pool_back(Pooling, const FeatureMap<T>& from, const FeatureMap<T>& d_to,
                                           FeatureMap<T>& d_from);
};

// ---- the network ----------------------------------------------------------------------------------------------------

inline void Vgg::convolution(const Tensor& weight, const Tensor& bias, bool layer, const std::string& named) {
  const auto& s = weight.shape;
  const std::size_t before = [&] {
    for (std::size_t k = steps.size(); k-- > 0;)
      if (steps[k].outputs) return std::size_t(steps[k].outputs);
    return std::size_t(3);
  }();
  if (s.size() != 4 || s[0] == 0 || s[1] != before || s[2] != 3 || s[3] != 3 || weight.size() != s[0] * s[1] * 9)
    throw Error(named + ": found a weight of another shape, expected outputs x " + std::to_string(before) + " x 3 x 3");
  if (bias.size() != s[0])
    throw Error(named + ": found a bias of " + std::to_string(bias.size()) + " numbers, expected " +
                std::to_string(s[0]));
  Step step{{}, Weights(s[0], s[1] * 9), Weights(s[1], s[0] * 9), bias.values, int(s[1]), int(s[0]), layer};
  for (std::size_t o = 0; o < s[0]; ++o)
    for (std::size_t i = 0; i < s[1]; ++i)
      for (std::size_t k = 0; k < 9; ++k) {
        const float w = weight.values[(o * s[1] + i) * 9 + k];
        step.weight(Eigen::Index(o), Eigen::Index(i * 9 + k)) = w;
        step.back(Eigen::Index(i), Eigen::Index(o * 9 + 8 - k)) = w;
      }
  steps.push_back(std::move(step));
}

inline Vgg::Vgg(const NamedTensors& weights, const std::string& named, Pooling pooling) {
  const std::string end = ".weight";
  std::map<int, std::string> numbered;  // what stands before ".weight"
  for (const auto& [name, t] : weights.tensors) {
    if (name.size() <= end.size() || name.compare(name.size() - end.size(), end.size(), end) != 0) continue;
    const std::string stem = name.substr(0, name.size() - end.size());
    const std::size_t dot = stem.rfind('.'), digits = dot == stem.npos ? 0 : dot + 1;
    const bool number = digits < stem.size() && stem.size() - digits < 5 &&
                        stem.find_first_not_of("0123456789", digits) == stem.npos;
    if (t.shape.size() == 1 && number)
      throw Error(named + ": " + name + " scales channels (batch normalisation), expected a network without it");
    if (t.shape.size() != 4 || !number) continue;
    if (!numbered.emplace(std::stoi(stem.substr(digits)), stem).second)
      throw Error(named + ": two convolutions have the number of " + name + ", expected one network");
  }
  if (numbered.empty()) throw Error(named + ": found no convolution, expected features.0.weight and so on");
  bool first = true;
  int next = 0;
  std::size_t last_layer = 0;
  for (const auto& [number, stem] : numbered) {
    if (number == next + 1 && next > 0) pool(pooling), first = true;
    else if (number != next)
      throw Error(named + ": " + stem + ".weight follows number " + std::to_string(next - 2) +
                  ", expected a convolution's number two (its ReLU) or three (pooling, too) above the last, from 0 on");
    const auto bias = weights.tensors.find(stem + ".bias");
    if (bias == weights.tensors.end()) throw Error(named + ": " + stem + ".bias is missing");
    convolution(weights.tensors.at(stem + end), bias->second, first, named + ": " + stem);
    if (first) last_layer = steps.size();
    first = false, next = number + 2;
  }
  steps.resize(last_layer);
}

inline double Vgg::work(int width, int height) const {
  double sum = 0;
  for (const Step& s : steps)
    if (s.outputs) sum += 9.0 * s.inputs * s.outputs * width * height;
    else width /= 2, height /= 2;
  return sum;
}

// ---- its layers -----------------------------------------------------------------------------------------------------

/// to = weight * neighbourhoods of from (beyond the border 0) + bias; without a bias nothing is added.
template <class T>
void Vgg::convolve(const Weights& weight, const float* bias, const FeatureMap<T>& from, FeatureMap<T>& to) {
  using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Out = Eigen::Map<Matrix, Eigen::Aligned64, Eigen::OuterStride<>>;
  const int w = from.width, h = from.height, inputs = from.channels;
  const Eigen::Index outputs = weight.rows(), size = Eigen::Index(w) * h;
  if (to.channels != outputs || to.width != w || to.height != h) to.reset(int(outputs), w, h);
  const auto of_type = [&]() -> decltype(auto) {
    if constexpr (std::is_same_v<T, float>) return (weight);
    else return Matrix(weight.template cast<T>());
  };
  const auto& by = of_type();
  // Strips of places: enough of them for many cores, and each as long as a product needs to be quick.
  const Eigen::Index strip = std::clamp<Eigen::Index>((size / 16 + 15) / 16 * 16, 64, 1024);
  parallel_for(int((size + strip - 1) / strip), [&](int k) {
    const Eigen::Index begin = k * strip, count = std::min(strip, size - begin);
    static thread_local Matrix columns;
    columns.resize(inputs * 9, count);
    for (int c = 0; c < inputs; ++c)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          T* const out = columns.data() + ((c * 3 + dy + 1) * 3 + dx + 1) * count;
          for (Eigen::Index i = 0; i < count;) {  // row by row of the picture
            const int x0 = int((begin + i) % w), y = int((begin + i) / w) + dy;
            const int n = int(std::min<Eigen::Index>(count - i, w - x0));
            const int first = std::clamp(-dx - x0, 0, n);
            const int last = y < 0 || y >= h ? first : std::clamp(w - dx - x0, first, n);
            T* const row = out + i;
            std::fill(row, row + first, T(0));
            if (last > first) {
              const T* const line = from.plane(c) + Eigen::Index(y) * w + x0 + dx;
              std::copy(line + first, line + last, row + first);
            }
            std::fill(row + last, row + n, T(0));
            i += n;
          }
        }
    Out out(to.values.data() + begin, outputs, count, Eigen::OuterStride<>(Eigen::Index(to.stride())));
    out.noalias() = by * columns;
    if (bias)
      for (Eigen::Index o = 0; o < outputs; ++o) out.row(o).array() += T(bias[o]);
  });
}

template <class T> void Vgg::pool(Pooling kind, const FeatureMap<T>& from, FeatureMap<T>& to) {
  const int w = from.width / 2, h = from.height / 2;
  if (to.channels != from.channels || to.width != w || to.height != h) to.reset(from.channels, w, h);
  parallel_for(from.channels, [&](int c) {
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const T* const a = from.plane(c) + std::ptrdiff_t(2 * y) * from.width + 2 * x;
        const T* const b = a + from.width;
        T& out = to.plane(c)[std::ptrdiff_t(y) * w + x];
        out = kind == Pooling::max ? std::max(std::max(a[0], a[1]), std::max(b[0], b[1]))
                                   : (a[0] + a[1] + b[0] + b[1]) / 4;
      }
  });
}
/// Of several largest the first, row by row, has the slope.
template <class T>
void Vgg::pool_back(Pooling kind, const FeatureMap<T>& from, const FeatureMap<T>& d_to, FeatureMap<T>& d_from) {
  d_from.reset(from.channels, from.width, from.height);
  parallel_for(from.channels, [&](int c) {
    for (int y = 0; y < d_to.height; ++y)
      for (int x = 0; x < d_to.width; ++x) {
        const std::ptrdiff_t at = std::ptrdiff_t(2 * y) * from.width + 2 * x;
        const std::ptrdiff_t places[4] = {at, at + 1, at + from.width, at + from.width + 1};
        const T* const v = from.plane(c);
        T* const d = d_from.plane(c);
        const T slope = d_to.plane(c)[std::ptrdiff_t(y) * d_to.width + x];
        if (kind == Pooling::average)
          for (const std::ptrdiff_t p : places) d[p] = slope / 4;
        else d[*std::max_element(places, places + 4, [&](auto p, auto q) { return v[p] < v[q]; })] = slope;
      }
  });
}

// ---- all of it ------------------------------------------------------------------------------------------------------

template <class T> void Vgg::forward(const FeatureMap<T>& image, const Mask& mask, Trace<T>& t) const {
  const std::size_t size = std::size_t(image.width) * std::size_t(image.height);
  if (!t.input.like(image)) t.input.reset(3, image.width, image.height);
  t.area = 0;
  for (std::size_t i = 0; i < size; ++i) t.area += double(mask.values[i]);
  for (int c = 0; c < 3; ++c) {
    double sum = 0;
    for (std::size_t i = 0; i < size; ++i)
      if (mask.values[i] > 0) sum += double(mask.values[i]) * double(image.plane(c)[i]);
    const T middle = t.area > 0 ? T(sum / t.area) : T(0);
    for (std::size_t i = 0; i < size; ++i) {
      const T m = T(mask.values[i]), x = m > 0 ? m * image.plane(c)[i] + (1 - m) * middle : middle;
      t.input.plane(c)[i] = (x - T(mean[std::size_t(c)])) / T(deviation[std::size_t(c)]);
    }
  }
  FeatureMap<T> weight(1, image.width, image.height), smaller;
  for (std::size_t i = 0; i < size; ++i) weight.values[i] = T(mask.values[i]);
  t.outputs.resize(steps.size()), t.layers.resize(std::size_t(layers()));
  const FeatureMap<T>* from = &t.input;
  std::size_t layer = 0;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const Step& s = steps[k];
    FeatureMap<T>& to = t.outputs[k];
    if (!s.outputs) {
      pool(s.pooling, *from, to);
      pool(Pooling::average, weight, smaller), std::swap(weight, smaller);
    } else {
      convolve(s.weight, s.bias.data(), *from, to);
      for (int c = 0; c < to.channels; ++c)
        for (std::size_t i = 0; i < std::size_t(to.width) * std::size_t(to.height); ++i)
          to.plane(c)[i] = std::max(to.plane(c)[i], T(0));
      if (s.layer) t.layers[layer].maps = to, t.layers[layer++].weight = weight;
    }
    from = &to;
  }
}

template <class T> void Vgg::backward(Trace<T>& t, const Mask& mask, const std::vector<FeatureMap<T>>& d_layers,
                                      FeatureMap<T>& d_image) const {
  std::size_t layer = std::size_t(layers());
  t.d = {};  // nothing yet
  for (std::size_t k = steps.size(); k-- > 0;) {
    const Step& s = steps[k];
    const FeatureMap<T>& from = k ? t.outputs[k - 1] : t.input;
    if (s.layer) {
      const FeatureMap<T>& d = d_layers[--layer];
      if (t.d.values.empty()) t.d = d;
      else if (!d.values.empty())
        for (std::size_t i = 0; i < d.values.size(); ++i) t.d.values[i] += d.values[i];
    }
    if (t.d.values.empty()) continue;
    if (!s.outputs) pool_back(s.pooling, from, t.d, t.d_before);
    else {
      for (std::size_t i = 0; i < t.d.values.size(); ++i)
        if (!(t.outputs[k].values[i] > 0)) t.d.values[i] = 0;  // of the ReLU; at 0 the slope is 0
      convolve<T>(s.back, nullptr, t.d, t.d_before);
    }
    std::swap(t.d, t.d_before);
  }
  if (t.d.values.empty() || !(t.area > 0)) return;
  const std::size_t size = std::size_t(t.input.width) * std::size_t(t.input.height);
  for (int c = 0; c < 3; ++c) {
    const T by = 1 / T(deviation[std::size_t(c)]);
    double around = 0;  // the derivative by the mean
    for (std::size_t i = 0; i < size; ++i) around += (1 - double(mask.values[i])) * double(t.d.plane(c)[i]);
    const T all = T(around / t.area);
    for (std::size_t i = 0; i < size; ++i)
      if (mask.values[i] > 0) d_image.plane(c)[i] += T(mask.values[i]) * (t.d.plane(c)[i] + all) * by;
  }
}

}  // namespace burnish
