// burnish/nodes/image.h -- texture images: bilinear lookup, its slopes by uv, its adjoint into the texels
// SPDX-License-Identifier: Apache-2.0
//
// Row 0 lies at v = 0 and the centre of texel (i, j) at ((i + 0.5) / width, (j + 0.5) / height): v runs along the rows
// as they are stored. Whoever reads a file whose first row is its top, for uv with v upwards, stores its rows from the
// last. Edges: the lines through the texel centres, where the slopes jump.
#pragma once
#include <burnish/math/noise.h>

namespace burnish {

/// What lies outside [0, 1]: the constant `outside`; the texel at the border; the image again; the image mirrored.
enum class AddressMode { constant, clamp, periodic, mirror };

/// channels x height x width floats, plane after plane, row by row. Colours are linear.
struct TextureData {
  int width = 0, height = 0, channels = 0;
  std::vector<float> texels;
  AddressMode uaddressmode = AddressMode::periodic, vaddressmode = AddressMode::periodic;
  std::array<float, 4> outside{};  ///< MaterialX's `default`; an image without texels is this everywhere

  TextureData() = default;
  TextureData(int w, int h, int c, float value = 0)
      : width(w), height(h), channels(c), texels(std::size_t(w) * std::size_t(h) * std::size_t(c), value) {}
  float& at(int x, int y, int channel = 0) { return texels[index(x, y, channel)]; }
  float at(int x, int y, int channel = 0) const { return texels[index(x, y, channel)]; }

private:
  std::size_t index(int x, int y, int channel) const { return std::size_t((channel * height + y) * width + x); }
};
template <class T> using Texture = Resource<T, TextureData>;

namespace detail {

/// The two texels along one axis: where, how much of each, and the slopes of that by the coordinate.
template <class T> struct Taps { T at[2], weight[2], slope[2]; };
template <class T> Taps<T> taps(T u, int n, AddressMode mode) {
  const float last = float(n - 1);
  T x = u, rate = T(float(n));
  if (mode == AddressMode::periodic) x = u - floor(u);
  if (mode == AddressMode::mirror) {
    const T m = u - 2.0f * floor(u * 0.5f);
    const auto back = m > T(1.0f);
    x = select(back, 2.0f - m, m);
    rate = select(back, -rate, rate);
  }
  const T s = min(T(float(n + 1)), max(T(-2.0f), x * float(n) - 0.5f)), low = floor(s), high = low + 1.0f, f = s - low;
  Taps<T> t{{low, high}, {1.0f - f, f}, {-rate, rate}};
  if (mode == AddressMode::constant)
    for (int k = 0; k < 2; ++k) {
      const T in = select(t.at[k] >= T(0.0f) && t.at[k] <= T(last), T(1.0f), T(0.0f));
      t.weight[k] *= in;
      t.slope[k] *= in;
    }
  if (mode == AddressMode::periodic) {
    t.at[0] = select(low < T(0.0f), T(last), low);
    t.at[1] = select(high > T(last), T(0.0f), high);
  }
  for (T& i : t.at) i = min(max(i, T(0.0f)), T(last));  // a coordinate that is NaN reads inside, too, and gives NaN
  return t;
}

/// The four texels around a point and how they enter the value and its slopes.
template <class T> struct Footprint {
  int_t<T> texel[4];
  Taps<T> u, v;

  Footprint(const TextureData& image, const T* x)
      : u(taps(x[0], image.width, image.uaddressmode)), v(taps(x[1], image.height, image.vaddressmode)) {
    for (int k = 0; k < 4; ++k) texel[k] = to_int(v.at[k >> 1]) * image.width + to_int(u.at[k & 1]);
  }
  T value(int k) const { return u.weight[k & 1] * v.weight[k >> 1]; }
  T by_u(int k) const { return u.slope[k & 1] * v.weight[k >> 1]; }
  T by_v(int k) const { return u.weight[k & 1] * v.slope[k >> 1]; }
  T by_uv(int k) const { return u.slope[k & 1] * v.slope[k >> 1]; }

  /// A plane's value, slopes by u and v and the mixed second derivative; outside counts where texels are missing.
  void read(const float* plane, float outside, T* out) const {
    for (int i = 0; i < 4; ++i) out[i] = T(0.0f);
    for (int k = 0; k < 4; ++k) {
      const T t = gather<T>(plane, texel[k]) - outside;
      out[0] += value(k) * t;
      out[1] += by_u(k) * t;
      out[2] += by_v(k) * t;
      out[3] += by_uv(k) * t;
    }
    out[0] += outside;
  }
};
template <class T> void add_to_texels(Scatter& to, int_t<T> texel, int plane, T d) {
  if constexpr (Plain<T> || std::is_same_v<T, Lanes>) to.add(texel + plane, d);
  else
    for (int i = 0; i < T::size; ++i) to.add(int(texel[i]) + plane, d[i]);
}

}  // namespace detail

namespace op {

/// (u, v) -> Channels numbers of the image. A channel that the image lacks is its first.
template <int Channels> struct ImageRead {
  using Data = TextureData;
  static constexpr int inputs = 2, outputs = Channels;
  static constexpr bool active = true, back_reads_outputs = false;

  template <class T> static void value(const TextureData& image, const T* x, T* y) {
    if (image.texels.empty()) {
      for (int c = 0; c < Channels; ++c) y[c] = T(image.outside[std::size_t(c)]);
      return;
    }
    const detail::Footprint<T> at(image, x);
    for (int c = 0; c < Channels; ++c) {
      T out[4];
      at.read(image.texels.data() + plane(image, c), image.outside[std::size_t(c)], out);
      y[c] = out[0];
    }
  }
  template <class T>
  static void back(const TextureData& image, const T* x, const T*, const T* d_y, T* d_x, Scatter* scatter) {
    d_x[0] = d_x[1] = T(0.0f);
    if (image.texels.empty()) return;
    const detail::Footprint<T> at(image, x);
    for (int c = 0; c < Channels; ++c) {
      T out[4];
      at.read(image.texels.data() + plane(image, c), image.outside[std::size_t(c)], out);
      d_x[0] += d_y[c] * out[1];
      d_x[1] += d_y[c] * out[2];
      if (scatter)
        for (int k = 0; k < 4; ++k)
          detail::add_to_texels<T>(*scatter, at.texel[k], plane(image, c), d_y[c] * at.value(k));
    }
  }

private:
  static int plane(const TextureData& image, int c) {
    return (c < image.channels ? c : 0) * image.width * image.height;
  }
};

/// (u, v) -> (value, slope by u, slope by v) of the image's first channel.
struct ImageHeight {
  using Data = TextureData;
  static constexpr int inputs = 2, outputs = 3;
  static constexpr bool active = true, back_reads_outputs = false;

  template <class T> static void value(const TextureData& image, const T* x, T* y) {
    y[0] = T(image.outside[0]), y[1] = y[2] = T(0.0f);
    if (image.texels.empty()) return;
    T out[4];
    detail::Footprint<T>(image, x).read(image.texels.data(), image.outside[0], out);
    for (int i = 0; i < 3; ++i) y[i] = out[i];
  }
  template <class T>
  static void back(const TextureData& image, const T* x, const T*, const T* d_y, T* d_x, Scatter* scatter) {
    d_x[0] = d_x[1] = T(0.0f);
    if (image.texels.empty()) return;
    const detail::Footprint<T> at(image, x);
    T out[4];
    at.read(image.texels.data(), image.outside[0], out);
    d_x[0] = d_y[0] * out[1] + d_y[2] * out[3];
    d_x[1] = d_y[0] * out[2] + d_y[1] * out[3];
    if (scatter)
      for (int k = 0; k < 4; ++k)
        detail::add_to_texels<T>(*scatter, at.texel[k], 0,
                                 d_y[0] * at.value(k) + d_y[1] * at.by_u(k) + d_y[2] * at.by_v(k));
  }
};

}  // namespace op

/// MaterialX's image, bilinear: the texels may be fitted, uv has slopes. operator() gives a colour.
template <class T> struct ImageNode {
  Texture<T> file;
  static constexpr auto parameters() { return std::tuple{Param{"file", &ImageNode::file, unit}}; }

  constexpr vec3<T> operator()(const vec2<T>& texcoord) const {
    const auto y = apply<op::ImageRead<3>>(file, texcoord.x, texcoord.y);
    return {y[0], y[1], y[2]};
  }
  constexpr T number(const vec2<T>& texcoord) const { return apply<op::ImageRead<1>>(file, texcoord.x, texcoord.y); }
  constexpr vec2<T> pair(const vec2<T>& texcoord) const {
    const auto y = apply<op::ImageRead<2>>(file, texcoord.x, texcoord.y);
    return {y[0], y[1]};
  }
  constexpr vec4<T> color4(const vec2<T>& texcoord) const {
    const auto y = apply<op::ImageRead<4>>(file, texcoord.x, texcoord.y);
    return {y[0], y[1], y[2], y[3]};
  }
  /// The first channel with its slopes by uv; these jump at the lines through texel centres, so a normal from them has
  /// facets.
  constexpr Height<T> height(const vec2<T>& texcoord) const {
    const auto y = apply<op::ImageHeight>(file, texcoord.x, texcoord.y);
    return {y[0], {y[1], y[2]}};
  }
};

}  // namespace burnish
