// burnish/fit/features.h -- features of a part of an image: a bank of filters at several octaves, and its way back
// SPDX-License-Identifier: Apache-2.0
//
// Features answer two calls (the concept Features): forward(image, mask, trace) makes layers out of the pixels under
// the mask, and backward(trace, mask, d_layers, d_image) brings a derivative by the layers back to the image. A layer is
// maps of one size, and a weight for every position: how much it counts, 0 where it tells nothing of the part; values
// there mean nothing. What lies outside the mask (mask 0) is not read, changes nothing, and has no derivative.
//
// The FilterBank: a pyramid of octaves, each half as wide as the one before, by normalised convolution (Knutsson and
// Westin 1993): values and mask are blurred alike and divided, so that a part of one colour stays of one colour up to
// its border, and no filter sees what is behind. On every octave and channel: the value; and the sizes, by a smooth
// absolute value, of its first and second derivatives along 0, 45, 90 and 135 degrees (steerable: Freeman and Adelson
// 1991; a Gaussian's, as the pyramid is blurred by a binomial), where all 3 x 3 positions are inside (the weight is the
// least of theirs). Derivatives are by a step of their own octave.
#pragma once
#include <algorithm>
#include <array>
#include <concepts>
#include <vector>
#include <burnish/ad/packet.h>
#include <burnish/ad/parallel.h>
#include <burnish/scene/image.h>

namespace burnish {

/// Channels of one size, each a plane as an Image's: row by row, on a 64-byte boundary, padded to a multiple of 16.
template <class T> struct FeatureMap {
  int channels = 0, width = 0, height = 0;
  std::vector<T, Aligned<T>> values;

  FeatureMap() = default;
  FeatureMap(int c, int w, int h) : channels(c), width(w), height(h), values(std::size_t(c) * stride()) {}
  std::size_t stride() const { return padded(std::size_t(width) * std::size_t(height)); }
  T* plane(int c) { return values.data() + std::size_t(c) * stride(); }
  const T* plane(int c) const { return values.data() + std::size_t(c) * stride(); }
  bool like(const FeatureMap& m) const { return channels == m.channels && width == m.width && height == m.height; }
  /// Zeros of that size, in the room that is there.
  void reset(int c, int w, int h) {
    channels = c, width = w, height = h;
    values.assign(std::size_t(c) * stride(), T(0));
  }
};
template <class T = float> FeatureMap<T> feature_map(const Image& image) {
  FeatureMap<T> m(3, image.width, image.height);
  std::copy(image.values.begin(), image.values.end(), m.values.begin());
  return m;
}

/// Maps, and how much each position counts.
template <class T> struct FeatureLayer {
  FeatureMap<T> maps, weight;  // weight has one channel
};

template <class F, class T> concept Features =
    requires(const F& f, typename F::template Trace<T>& trace, const FeatureMap<T>& image, const Mask& mask,
             const std::vector<FeatureMap<T>>& d_layers, FeatureMap<T>& d_image) {
      f.forward(image, mask, trace);             // trace keeps its room from call to call
      { trace.layers } -> std::same_as<std::vector<FeatureLayer<T>>&>;
      f.backward(trace, mask, d_layers, d_image);  // adds to d_image; an empty map of d_layers is 0
    };

namespace detail::features {

/// f.operator()<P>(i) for all i of a range, P a packet or, at the end, a single number.
template <class T, class F> [[gnu::always_inline]] inline void each_place(std::size_t begin, std::size_t end, F f) {
  std::size_t i = begin;
  for (; i + 8 <= end; i += 8) f.template operator()<Packet<T, 8>>(i);
  for (; i < end; ++i) f.template operator()<T>(i);
}
template <class P, class T> [[gnu::always_inline]] inline P get(const T* from) {
  if constexpr (std::is_same_v<P, T>) return *from;
  else return P::load(from);
}
template <class P, class T> [[gnu::always_inline]] inline void put(const P& x, T* to) {
  if constexpr (std::is_same_v<P, T>) *to = x;
  else x.store(to);
}

/// First and second derivatives at a place, of its 3 x 3 neighbours.
template <class P> struct Jet {
  P x, y, xx, yy, xy;
};
template <class P, class T> [[gnu::always_inline]] inline Jet<P> jet(const T* v, std::size_t i, std::size_t w) {
  const auto at = [&](std::size_t k) { return get<P>(v + k); };
  const P left = at(i - 1), right = at(i + 1), up = at(i - w), down = at(i + w), twice = at(i) + at(i);
  const T half(0.5f), quarter(0.25f);
  return {(right - left) * P(half), (down - up) * P(half), left + right - twice, up + down - twice,
          (at(i - w - 1) + at(i + w + 1) - at(i - w + 1) - at(i + w - 1)) * P(quarter)};
}
/// The jet along 0, 45, 90 and 135 degrees: first derivatives, then second ones.
template <class P> [[gnu::always_inline]] inline std::array<P, 8> along(const Jet<P>& j) {
  const P r(0.70710678118654752), h(0.5f), mean = (j.xx + j.yy) * h;
  return {j.x, (j.x + j.y) * r, j.y, (j.y - j.x) * r, j.xx, mean + j.xy, j.yy, mean - j.xy};
}
template <class P> [[gnu::always_inline]] inline Jet<P> along_back(const std::array<P, 8>& d) {
  const P r(0.70710678118654752), h(0.5f), both = (d[5] + d[7]) * h;
  return {d[0] + (d[1] - d[3]) * r, d[2] + (d[1] + d[3]) * r, d[4] + both, d[6] + both, d[5] - d[7]};
}

/// Rows of a picture, so many at a time that they stay near the processor; the same ones for any number of threads.
template <class F> void each_rows(int height, F f) {
  constexpr int rows = 16;
  parallel_for((height + rows - 1) / rows, [&](int k) { f(k * rows, std::min(height, (k + 1) * rows)); });
}
inline constexpr std::array<float, 5> binomial{1 / 16.0f, 4 / 16.0f, 6 / 16.0f, 4 / 16.0f, 1 / 16.0f};

/// Every second position of every second row, blurred by the binomial of five; beyond the border is nothing.
template <class T> void shrink(const FeatureMap<T>& from, FeatureMap<T>& to) {
  const int w = from.width, h = from.height, half = (w + 1) / 2;
  if (to.channels != from.channels || to.width != half || to.height != (h + 1) / 2)
    to.reset(from.channels, half, (h + 1) / 2);
  each_rows(to.height, [&](int begin, int end) {
    std::vector<T> row(std::size_t(w) + 4);
    for (int c = 0; c < from.channels; ++c)
      for (int y = begin; y < end; ++y) {
        std::fill(row.begin(), row.end(), T(0));
        for (int k = 0; k < 5; ++k) {
          const int at = 2 * y + k - 2;
          if (at < 0 || at >= h) continue;
          const T* const line = from.plane(c) + std::size_t(at) * std::size_t(w);
          for (int x = 0; x < w; ++x) row[std::size_t(x + 2)] += T(binomial[std::size_t(k)]) * line[x];
        }
        T* const out = to.plane(c) + std::size_t(y) * std::size_t(half);
        for (int x = 0; x < half; ++x) {
          const T* const r = row.data() + 2 * x;
          out[x] = T(binomial[0]) * (r[0] + r[4]) + T(binomial[1]) * (r[1] + r[3]) + T(binomial[2]) * r[2];
        }
      }
  });
}
/// The adjoint of shrink, added to d_from.
template <class T> void shrink_back(const FeatureMap<T>& d_to, FeatureMap<T>& d_from) {
  const int w = d_from.width, half = d_to.width;
  each_rows(d_from.height, [&](int begin, int end) {
    std::vector<T> row(std::size_t(half) + 2);
    for (int c = 0; c < d_from.channels; ++c)
      for (int y = begin; y < end; ++y) {
        std::fill(row.begin(), row.end(), T(0));
        for (int j = std::max(0, (y - 1) / 2); j < d_to.height && 2 * j <= y + 2; ++j) {
          const int k = y - 2 * j + 2;
          if (k < 0 || k > 4) continue;
          const T* const line = d_to.plane(c) + std::size_t(j) * std::size_t(half);
          for (int x = 0; x < half; ++x) row[std::size_t(x + 1)] += T(binomial[std::size_t(k)]) * line[x];
        }
        T* const out = d_from.plane(c) + std::size_t(y) * std::size_t(w);
        for (int x = 0; x < w; ++x) {
          const T* const r = row.data() + x / 2;
          out[x] += x % 2 ? T(binomial[1]) * (r[1] + r[2]) : T(binomial[0]) * (r[0] + r[2]) + T(binomial[2]) * r[1];
        }
      }
  });
}

}  // namespace detail::features

struct FilterBank {
  int octaves = 4;     // at most: one of less than 3 x 3 positions has no derivatives
  float knee = 0.01f;  // the absolute value is sqrt(x^2 + knee^2) - knee; in units of the image

  static constexpr int directions = 8, per_channel = 1 + directions, channels = 3 * per_channel;

  /// What forward leaves for backward.
  template <class T> struct Trace {
    struct Octave {
      FeatureMap<T> sums, mask;  // mask * image and mask, blurred alike
      FeatureMap<T> values;      // their quotient; 0 where the mask is
      FeatureMap<T> d;           // by values, then by sums
    };
    std::vector<Octave> octaves;
    std::vector<FeatureLayer<T>> layers;
  };

  template <class T> void forward(const FeatureMap<T>& image, const Mask& mask, Trace<T>& t) const {
    using namespace detail::features;
    std::size_t count = 0;
    for (int n = std::min(image.width, image.height); int(count) < octaves && n >= 3; n = (n + 1) / 2) ++count;
    t.octaves.resize(count), t.layers.resize(count);
    for (std::size_t k = 0; k < t.octaves.size(); ++k) {
      auto& o = t.octaves[k];
      if (k > 0) shrink(t.octaves[k - 1].sums, o.sums), shrink(t.octaves[k - 1].mask, o.mask);
      else {
        o.sums.reset(3, image.width, image.height), o.mask.reset(1, image.width, image.height);
        for (std::size_t i = 0; i < o.mask.stride(); ++i)
          if ((o.mask.values[i] = T(mask.values[i])) > 0)
            for (int c = 0; c < 3; ++c) o.sums.plane(c)[i] = T(mask.values[i]) * image.plane(c)[i];
      }
      if (!o.values.like(o.sums)) o.values = o.sums;
      for (int c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < o.mask.stride(); ++i) {
          const T m = o.mask.values[i];
          o.values.plane(c)[i] = m > 0 ? o.sums.plane(c)[i] / m : T(0);
        }
      filter(o.values, o.mask, t.layers[k]);
    }
  }

  /// d_layers must be 0 where the weight is.
  template <class T> void backward(Trace<T>& t, const Mask& mask, const std::vector<FeatureMap<T>>& d_layers,
                                   FeatureMap<T>& d_image) const {
    using namespace detail::features;
    for (std::size_t k = t.octaves.size(); k-- > 0;) {
      auto& o = t.octaves[k];
      o.d.reset(3, o.sums.width, o.sums.height);
      if (!d_layers[k].values.empty()) filter_back(o.values, d_layers[k], o.d);
      for (int c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < o.mask.stride(); ++i) {
          const T m = o.mask.values[i];
          o.d.plane(c)[i] = m > 0 ? o.d.plane(c)[i] / m : T(0);
        }
      if (k + 1 < t.octaves.size()) shrink_back(t.octaves[k + 1].d, o.d);
    }
    for (int c = 0; c < 3 && !t.octaves.empty(); ++c)
      for (std::size_t i = 0; i < d_image.stride(); ++i)
        if (mask.values[i] > 0) d_image.plane(c)[i] += T(mask.values[i]) * t.octaves[0].d.plane(c)[i];
  }

private:
  template <class T>
  void filter(const FeatureMap<T>& values, const FeatureMap<T>& mask, FeatureLayer<T>& layer) const {
    using namespace detail::features;
    const int width = values.width, height = values.height;
    const auto w = std::size_t(width);
    if (layer.maps.channels != channels || layer.maps.width != width || layer.maps.height != height)
      layer.maps.reset(channels, width, height), layer.weight.reset(1, width, height);
    const T k = T(knee), k2 = k * k;
    each_rows(height, [&](int begin, int end) {
      for (int y = std::max(begin, 1); y < std::min(end, height - 1); ++y) {
        const std::size_t first = std::size_t(y) * w + 1, last = first + w - 2;
        const T* const m = mask.plane(0);
        T* const weight = layer.weight.plane(0);
        each_place<T>(first, last, [&]<class P>(std::size_t i) {
          P least = get<P>(m + i);
          for (const std::size_t j : {i - w - 1, i - w, i - w + 1, i - 1, i + 1, i + w - 1, i + w, i + w + 1})
            least = min(least, get<P>(m + j));
          put(least, weight + i);
        });
        for (int c = 0; c < 3; ++c) {
          const T* const v = values.plane(c);
          T* const to = layer.maps.plane(c * per_channel);
          const std::size_t stride = layer.maps.stride();
          each_place<T>(first, last, [&]<class P>(std::size_t i) {
            put(get<P>(v + i), to + i);
            const std::array<P, directions> s = along(jet<P>(v, i, w));
            for (std::size_t n = 0; n < directions; ++n)
              put(sqrt(s[n] * s[n] + P(k2)) - P(k), to + (n + 1) * stride + i);
          });
        }
      }
    });
  }
  /// Adds to d_values.
  template <class T>
  void filter_back(const FeatureMap<T>& values, const FeatureMap<T>& d, FeatureMap<T>& d_values) const {
    using namespace detail::features;
    const int width = values.width, height = values.height;
    const std::size_t w = std::size_t(width), stride = d.stride();
    const T k2 = T(knee) * T(knee);
    each_rows(height, [&](int begin, int end) {
      // The derivatives by the jets of these rows and of one more on either side, with a border of zeros; then every
      // place gathers from its neighbours.
      const std::size_t pitch = w + 2, size = std::size_t(end - begin + 2) * pitch;
      std::vector<T> buffer(5 * size);
      std::array<T*, 5> j{};
      for (std::size_t n = 0; n < 5; ++n) j[n] = buffer.data() + n * size;
      const auto row = [&](int y) { return std::size_t(y - begin + 1) * pitch + 1; };
      for (int c = 0; c < 3; ++c) {
        const T* const v = values.plane(c);
        const T* const from = d.plane(c * per_channel);
        for (int y = std::max(begin - 1, 1); y < std::min(end + 1, height - 1); ++y) {
          const std::size_t line = std::size_t(y) * w, to = row(y);
          each_place<T>(1, w - 1, [&]<class P>(std::size_t x) {
            const std::size_t i = line + x;
            std::array<P, directions> s = along(jet<P>(v, i, w));
            for (std::size_t n = 0; n < directions; ++n)
              s[n] = get<P>(from + (n + 1) * stride + i) * s[n] / sqrt(s[n] * s[n] + P(k2));
            const Jet<P> back = along_back(s);
            put(back.x, j[0] + to + x), put(back.y, j[1] + to + x), put(back.xx, j[2] + to + x);
            put(back.yy, j[3] + to + x), put(back.xy, j[4] + to + x);
          });
        }
        for (int y = begin; y < end; ++y) {
          const std::size_t line = std::size_t(y) * w, at = row(y);
          T* const out = d_values.plane(c) + line;
          each_place<T>(0, w, [&]<class P>(std::size_t x) {
            const std::size_t i = at + x;
            const auto of = [&](std::size_t n, std::size_t k) { return get<P>(j[n] + k); };
            const P first = of(0, i - 1) - of(0, i + 1) + of(1, i - pitch) - of(1, i + pitch),
                    second = of(2, i - 1) + of(2, i + 1) + of(3, i - pitch) + of(3, i + pitch),
                    twice = of(2, i) + of(3, i),
                    mixed = of(4, i - pitch - 1) + of(4, i + pitch + 1) - of(4, i - pitch + 1) - of(4, i + pitch - 1);
            const P sum = get<P>(from + line + x) + first * P(T(0.5f)) + second - twice - twice + mixed * P(T(0.25f));
            put(get<P>(out + x) + sum, out + x);
          });
        }
      }
    });
  }
};

}  // namespace burnish
