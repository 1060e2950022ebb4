// burnish/fit/gram.h -- how far the pattern of a rendered part is from the photo's: Gram matrices of features
// SPDX-License-Identifier: Apache-2.0
//
// Gatys, Ecker and Bethge 2016, layer by layer and under masks: G = sum of w f f^T / sum of w over the positions of a
// layer, f the features there and w their weights (fit/features.h). So neither the size of a part's mask nor where it
// lies matters, and photo and rendering each have their own. Channels are measured in the photo's units (Gram::units),
// so that layers and networks of any scale count alike. Sums are the same for any number of threads.
#pragma once
#include <cmath>
#include <utility>
#include <burnish/fit/features.h>

namespace burnish {

/// The Gram matrix of a layer: channels x channels, row by row, symmetric.
struct Gram {
  int channels = 0;
  double area = 0;  ///< sum of the weights; where it is 0 the matrix is
  std::vector<double> entries;

  double operator()(int i, int j) const { return entries[std::size_t(i) * std::size_t(channels) + std::size_t(j)]; }
  /// What a channel is divided by: the root of its mean square and of a hundredth of the layer's mean of these, which
  /// keeps channels that the part hardly excites from counting.
  std::vector<double> units() const {
    std::vector<double> u;
    double mean = 0;
    for (int i = 0; i < channels; ++i) mean += (*this)(i, i) / channels;
    for (int i = 0; i < channels; ++i) u.push_back(std::sqrt((*this)(i, i) + 0.01 * mean + 1e-30));
    return u;
  }
};

namespace detail::grams {

/// Places that are summed in T before they are added in double; their maps stay near the processor.
inline constexpr std::size_t strip = 128;

/// The features of a strip (0 where their weight is) and the same times their weights, a multiple of 4 channels; the
/// room is the thread's.
template <class T> struct Strip {
  std::size_t channels, size;  // size: places, a multiple of 16
  const T *plain, *weighted;   // channel by channel, `strip` apart

  Strip(const FeatureLayer<T>& layer, std::size_t begin)
      : channels(padded(std::size_t(layer.maps.channels), 4)), size(std::min(strip, layer.maps.stride() - begin)) {
    using P = Packet<T, 8>;
    static thread_local std::vector<T, Aligned<T>> room;
    room.resize(2 * channels * strip);
    T *f = room.data(), *wf = f + channels * strip;
    plain = f, weighted = wf;
    const T* const w = layer.weight.plane(0) + begin;
    for (std::size_t c = 0; c < channels; ++c, f += strip, wf += strip)
      for (std::size_t i = 0; i < size; i += 8) {
        P weight = P::load(w + i), x(T(0));
        if (c < std::size_t(layer.maps.channels))
          x = select(weight > P(T(0)), P::load(layer.maps.plane(int(c)) + begin + i), x);
        x.store(f + i), (weight * x).store(wf + i);
      }
  }
};
template <class T> std::size_t strips(const FeatureLayer<T>& layer) {
  return (layer.maps.stride() + strip - 1) / strip;
}
template <class T> bool empty(const FeatureLayer<T>& layer, std::size_t begin) {
  const T* const w = layer.weight.plane(0);
  return std::all_of(w + begin, w + std::min(begin + strip, layer.weight.stride()), [](T x) { return x == 0; });
}
/// f(band's number, first place of a strip) for every strip that is not empty, in bands.
template <class T, class F> std::size_t each_strip(const FeatureLayer<T>& layer, F f) {
  const std::size_t count = strips(layer), bands = std::min<std::size_t>(count, 16);
  parallel_for(int(bands), [&](int b) {
    for (std::size_t s = count * std::size_t(b) / bands; s < count * std::size_t(b + 1) / bands; ++s)
      if (!empty(layer, s * strip)) f(std::size_t(b), s * strip);
  });
  return bands;
}

}  // namespace detail::grams

template <class T> Gram gram(const FeatureLayer<T>& layer) {
  using namespace detail::grams;
  using P = Packet<T, 8>;
  Gram g;
  g.channels = layer.maps.channels;
  const std::size_t n = std::size_t(g.channels);
  g.entries.assign(n * n, 0.0);
  for (std::size_t i = 0; i < layer.weight.stride(); ++i) g.area += double(layer.weight.values[i]);
  if (!(g.area > 0)) return g;
  std::vector<std::vector<double>> sums(16);
  const std::size_t bands = each_strip(layer, [&](std::size_t band, std::size_t begin) {
    const Strip<T> s(layer, begin);
    const std::size_t m = s.channels;
    auto& sum = sums[band];
    sum.resize(m * m);
    for (std::size_t i = 0; i < m; i += 4)
      for (std::size_t j = i; j < m; j += 4) {
        P block[4][4] = {};
        for (std::size_t k = 0; k < s.size; k += 8) {
          P b[4];
          for (std::size_t q = 0; q < 4; ++q) b[q] = P::load(s.plain + (j + q) * strip + k);
          for (std::size_t p = 0; p < 4; ++p) {
            const P a = P::load(s.weighted + (i + p) * strip + k);
            for (std::size_t q = 0; q < 4; ++q) block[p][q] = block[p][q] + a * b[q];
          }
        }
        for (std::size_t p = 0; p < 4; ++p)
          for (std::size_t q = 0; q < 4; ++q) sum[(i + p) * m + j + q] += double(block[p][q].sum());
      }
  });
  for (std::size_t b = 0; b < bands; ++b) {
    if (sums[b].empty()) continue;
    const std::size_t m = padded(n, 4);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) g.entries[i * n + j] += sums[b][std::min(i, j) * m + std::max(i, j)] / g.area;
  }
  return g;
}
template <class T> std::vector<Gram> grams(const std::vector<FeatureLayer<T>>& layers) {
  std::vector<Gram> out;
  for (const auto& l : layers) out.push_back(gram(l));
  return out;
}

/// The mean over layers of the mean over entries of |G - G'|, each entry in the photo's units; layers that are empty on
/// either side, or 0 in all of the photo's part, do not count, and without any it is 0. weight times the derivative goes into d_layers, as Features want
/// them: 0 where the weight is. Where two entries agree, or are no numbers, the slope is given as 0.
template <class T> double gram_loss(const std::vector<FeatureLayer<T>>& layers, const std::vector<Gram>& photo,
                                    double weight, std::vector<FeatureMap<T>>& d_layers) {
  using namespace detail::grams;
  using P = Packet<T, 8>;
  const std::vector<Gram> own = grams(layers);
  d_layers.resize(layers.size());
  const auto counts = [&](std::size_t k) {
    return k < photo.size() && own[k].area > 0 && std::any_of(photo[k].entries.begin(), photo[k].entries.end(),
                                                              [](double x) { return x != 0; });
  };
  int used = 0;
  for (std::size_t k = 0; k < layers.size(); ++k) used += counts(k);
  double loss = 0;
  for (std::size_t k = 0; k < layers.size(); ++k) {
    auto& d = d_layers[k];
    if (!counts(k)) {
      d = {};
      continue;
    }
    const auto& [maps, weights] = layers[k];
    const std::size_t n = std::size_t(maps.channels), m = padded(n, 4);
    const std::vector<double> u = photo[k].units();
    const double share = weight / (double(used) * double(n * n));
    std::vector<T> slope(m * m);  // of the loss by G, times 2 / area, as G is symmetric
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        const double scale = share / (u[i] * u[j]), e = own[k].entries[i * n + j] - photo[k].entries[i * n + j];
        loss += scale * std::fabs(e);
        slope[i * m + j] = T((e > 0 ? 2 : e < 0 ? -2 : 0) * scale / own[k].area);
      }
    if (d.like(maps)) std::fill(d.values.begin(), d.values.end(), T(0));
    else d.reset(maps.channels, maps.width, maps.height);
    each_strip(layers[k], [&](std::size_t, std::size_t begin) {
      const Strip<T> s(layers[k], begin);
      for (std::size_t i = 0; i < n; i += 4)
        for (std::size_t at = 0; at < s.size; at += 16) {
          P low[4] = {}, high[4] = {};
          for (std::size_t j = 0; j < n; ++j) {
            const T* const f = s.weighted + j * strip + at;
            const P f0 = P::load(f), f1 = P::load(f + 8);
            for (std::size_t p = 0; p < 4; ++p) {
              const P by(slope[(i + p) * m + j]);
              low[p] = low[p] + f0 * by, high[p] = high[p] + f1 * by;
            }
          }
          for (std::size_t p = 0; p < 4 && i + p < n; ++p) {
            T* const to = d.plane(int(i + p)) + begin + at;
            low[p].store(to), high[p].store(to + 8);
          }
        }
    });
  }
  return loss;
}

/// 1 where the mask is whole (above 0.99) in all of the square that reaches `radius` pixels to every side, else 0.
/// Pixels at a part's border are mixed with what is behind, in a photo otherwise than in a picture of one sample a pixel.
inline Mask eroded(const Mask& mask, int radius) {
  Mask across(mask.width, mask.height), out = across;
  const auto all = [&](const Mask& from, int x, int y, int dx, int dy) {
    for (int k = -radius; k <= radius; ++k) {
      const int i = x + k * dx, j = y + k * dy;
      if (i < 0 || j < 0 || i >= mask.width || j >= mask.height || !(from.at(i, j) > 0.99f)) return 0.0f;
    }
    return 1.0f;
  };
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) across.at(x, y) = all(mask, x, y, 1, 0);
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) out.at(x, y) = all(across, x, y, 0, 1);
  return out;
}

/// A part of a photo, kept as Gram matrices; then pictures of the part against it. F: Features.
template <class F, class T = float> requires Features<F, T> class GramLoss {
public:
  GramLoss(F f, const Image& photo, const Mask& mask) : features(std::move(f)) {
    const Window w(mask);
    if (w.empty()) return;
    features.forward(w.of(photo), cropped(mask, w.x, w.y, w.width, w.height), trace);
    target = grams(trace.layers);
  }
  const std::vector<Gram>& photo() const { return target; }

  /// weight times the loss of image under mask; adds weight times its derivative to d_image, where the mask is not 0.
  double operator()(const Image& image, const Mask& mask, double weight, Image& d_image) {
    const Window w(mask);
    if (w.empty() || target.empty()) return 0;
    const Mask inside = cropped(mask, w.x, w.y, w.width, w.height);
    features.forward(w.of(image), inside, trace);
    const double loss = gram_loss(trace.layers, target, weight, d_layers);
    d.reset(3, w.width, w.height);
    features.backward(trace, inside, d_layers, d);
    w.add(d, inside, d_image);
    return loss;
  }

private:
  /// The part and a border, for what filters spread.
  struct Window {
    static constexpr int border = 8;
    int x = 0, y = 0, width = 0, height = 0;

    explicit Window(const Mask& mask) {
      int x0 = mask.width, x1 = -1, y0 = mask.height, y1 = -1;
      for (int j = 0; j < mask.height; ++j)
        for (int i = 0; i < mask.width; ++i)
          if (mask.at(i, j) > 0) x0 = std::min(x0, i), x1 = std::max(x1, i), y0 = std::min(y0, j), y1 = std::max(y1, j);
      if (x1 < 0) return;
      x = x0 - border, y = y0 - border, width = x1 - x0 + 1 + 2 * border, height = y1 - y0 + 1 + 2 * border;
    }
    bool empty() const { return width == 0; }
    FeatureMap<T> of(const Image& image) const { return feature_map<T>(cropped(image, x, y, width, height)); }
    void add(const FeatureMap<T>& from, const Mask& inside, Image& to) const {
      for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i)
          if (inside.at(i, j) > 0)
            for (int c = 0; c < 3; ++c)
              to.plane(c)[std::size_t(y + j) * std::size_t(to.width) + std::size_t(x + i)] +=
                  float(from.plane(c)[std::size_t(j) * std::size_t(width) + std::size_t(i)]);
    }
  };
  F features;
  typename F::template Trace<T> trace;
  std::vector<Gram> target;
  std::vector<FeatureMap<T>> d_layers;
  FeatureMap<T> d;
};

}  // namespace burnish
