// tests/nodes/image.cpp -- image lookup: values, wrapping, slopes by uv, its adjoint into the texels
// SPDX-License-Identifier: Apache-2.0
#include <burnish/nodes/image.h>
#include <nodes/patterns.h>

using namespace differences;

namespace {
constexpr AddressMode modes[] = {AddressMode::constant, AddressMode::clamp, AddressMode::periodic, AddressMode::mirror};

TextureData noisy(int width, int height, int channels, AddressMode mode) {
  TextureData image(width, height, channels);
  std::mt19937 random(15);
  for (float& t : image.texels) t = std::uniform_real_distribution<float>(-1, 1)(random);
  image.uaddressmode = image.vaddressmode = mode;
  image.outside = {0.25f, 0.5f, -0.5f, 1};
  return image;
}
/// A texel by its definition, for any whole (x, y).
double texel(const TextureData& image, int x, int y, int c) {
  const auto wrapped = [](int i, int n, AddressMode mode) {
    if (mode == AddressMode::periodic) return (i % n + n) % n;
    if (mode == AddressMode::clamp) return std::clamp(i, 0, n - 1);
    if (mode == AddressMode::mirror) {
      const int m = (i % (2 * n) + 2 * n) % (2 * n);
      return m < n ? m : 2 * n - 1 - m;
    }
    return i >= 0 && i < n ? i : -1;
  };
  const int i = wrapped(x, image.width, image.uaddressmode), j = wrapped(y, image.height, image.vaddressmode);
  return i < 0 || j < 0 ? double(image.outside[std::size_t(c)]) : double(image.at(i, j, c < image.channels ? c : 0));
}
double bilinear(const TextureData& image, double u, double v, int c) {
  const double x = u * image.width - 0.5, y = v * image.height - 0.5, fx = x - std::floor(x), fy = y - std::floor(y);
  const int i = int(std::floor(x)), j = int(std::floor(y));
  return (1 - fy) * ((1 - fx) * texel(image, i, j, c) + fx * texel(image, i + 1, j, c)) +
         fy * ((1 - fx) * texel(image, i, j + 1, c) + fx * texel(image, i + 1, j + 1, c));
}
template <class Op, class T> std::array<T, Op::outputs> read(const TextureData& image, T u, T v) {
  const T x[] = {u, v};
  std::array<T, Op::outputs> y;
  Op::value(image, x, y.data());
  return y;
}
/// Off the lines through texel centres, where slopes jump; borders and mirror axes are halfway between two.
bool off_centres(double u, int n) {
  const double x = u * n - 0.5;
  return std::fabs(x - std::round(x)) > 0.05;
}
}  // namespace

TEST_CASE("image: texel centres are met and between them lies the bilinear mean, in every mode", "[nodes][value]") {
  std::mt19937_64 random(16);
  for (const AddressMode mode : modes)
    for (const auto& [w, h] : {std::pair{5, 3}, {1, 1}, {8, 1}, {2, 7}}) {
      const TextureData image = noisy(w, h, 3, mode);
      CHECK(read<op::ImageRead<3>>(image, (w - 0.5) / w, 0.5 / h)[2] ==
            Approx(double(image.at(w - 1, 0, 2))).epsilon(1e-12));
      for (int i = 0; i < 300; ++i) {
        vec2<double> uv;
        move(random, uv);
        CAPTURE(int(mode), w, h, uv.x, uv.y);
        const auto y = read<op::ImageRead<4>>(image, uv.x, uv.y);
        for (int c = 0; c < 4; ++c)
          CHECK(y[std::size_t(c)] == Approx(bilinear(image, uv.x, uv.y, c)).epsilon(0).margin(1e-12));
        CHECK(double(read<op::ImageRead<1>>(image, float(uv.x), float(uv.y))[0]) ==
              Approx(y[0]).epsilon(0).margin(2e-5));
        CHECK(double(read<op::ImageRead<1>>(image, Packet<float, 16>(float(uv.x)),
                                            Packet<float, 16>(float(uv.y)))[0][i % 16]) ==
              Approx(y[0]).epsilon(0).margin(2e-5));
        CHECK(read<op::ImageRead<1>>(image, Packet<double, 8>(uv.x), Packet<double, 8>(uv.y))[0][i % 8] ==
              Approx(y[0]).margin(1e-14));
      }
    }
}
TEST_CASE("image: has no seam at the border when periodic or mirrored, and ends in `outside` when constant",
          "[nodes][limit]") {
  for (const AddressMode mode : {AddressMode::periodic, AddressMode::mirror}) {
    const TextureData image = noisy(5, 3, 1, mode);
    for (double v = -1.7; v < 2; v += 0.1)
      for (int n = -2; n <= 2; ++n) {
        const auto before = read<op::ImageHeight>(image, n - 1e-12, v),
                   after = read<op::ImageHeight>(image, n + 1e-12, v);
        CHECK(std::fabs(before[0] - after[0]) < 1e-10);
        if (mode == AddressMode::periodic) CHECK(std::fabs(before[1] - after[1]) < 1e-9);
        else CHECK(std::fabs(before[1]) + std::fabs(after[1]) < 1e-9);  // level at a mirror
      }
  }
  const TextureData image = noisy(5, 3, 3, AddressMode::constant);
  for (const auto& [u, v] : {std::pair{-0.2, 0.5}, {1.2, 0.5}, {0.5, 1.4}, {-7e8, 0.5}, {0.5, 9e9}}) {
    CHECK(read<op::ImageRead<3>>(image, u, v)[1] == 0.5);
    CHECK(read<op::ImageRead<3>>(image, float(u), float(v))[1] == 0.5f);
  }
  CHECK(read<op::ImageRead<3>>(TextureData(), 0.3, 0.4)[0] == 0);
  CHECK(std::isnan(read<op::ImageRead<3>>(image, Packet<float, 16>(std::nanf("")), Packet<float, 16>(0.5f))[0][3]));
}
TEST_CASE("image: right slopes by uv in every mode, of colours and of heights", "[nodes][gradient]") {
  for (const AddressMode mode : modes) {
    CAPTURE(int(mode));
    const TextureData image = noisy(5, 3, 3, mode);
    const auto off = [&](const auto& uv) { return off_centres(uv.x, 5) && off_centres(uv.y, 3); };
    const auto node = [&]<class T>(T) {
      ImageNode<T> n;
      if constexpr (std::is_same_v<T, float>) n.file = image;
      else n.file.data = &image;
      return n;
    };
    const Hard<std::tuple<vec2<double>>> wrap{
        "texel centres, borders, wrapped and far uv",
        {{{0, 0}}, {{1, 1}}, {{-1, 2}}, {{0.5, 0.5}}, {{0.1, 0.5}}, {{-1e-8, 1 + 1e-7}}},
        {{{1e6, -1e6}}, {{-7e8, 9e9}}}};  // differences see no single texel there
    holds("ImageNode, op::ImageRead, op::ImageHeight", Unrecorded{[&](const auto& uv) {
            const auto h = node(uv.x).height(uv);
            return std::array{mixture(node(uv.x)(uv)), node(uv.x).number(uv), mixture(h)};
          }},
          within(off, vec2<double>()), {.rounding = 1e-4, .step = 5e-3}, wrap);
    std::mt19937_64 random(17);
    for (int i = 0; i < 300; ++i) {
      vec2<double> uv;
      move(random, uv);
      const auto [y, du, dv] = differentiate([&](auto u, auto v) { return node(u).number(vec2{u, v}); }, uv.x, uv.y);
      const auto h = read<op::ImageHeight>(image, uv.x, uv.y);
      CHECK(h[0] == Approx(y).margin(1e-15));
      CHECK(h[1] == Approx(du).margin(1e-12));
      CHECK(h[2] == Approx(dv).margin(1e-12));
    }
  }
}
TEST_CASE("image: what goes back to the texels is the transpose of the lookup", "[nodes][gradient]") {
  // <lookup(texels), d> = <texels, scattered d>, for images whose outside is 0: then the lookup is linear in the
  // texels.
  const auto transposed = []<class Op, class T>(Op, T, AddressMode mode) {
    TextureData image = noisy(5, 3, 3, mode);
    image.outside = {};
    std::mt19937_64 random(18);
    double forth = 0, back = 0;
    for (int i = 0; i < 50; ++i) {
      vec2<double> uv;
      move(random, uv);
      T x[] = {T(uv.x), T(uv.y)}, y[Op::outputs], d_y[Op::outputs], d_x[2];
      if constexpr (!Plain<T>)
        for (int k = 0; k < T::size; ++k) x[0].v[k] += 0.03f * float(k), x[1].v[k] -= 0.02f * float(k);
      for (int c = 0; c < Op::outputs; ++c) d_y[c] = T(0.5f + float(c)) + x[0] * 0.3f;
      Scatter scatter;
      Op::value(image, x, y);
      Op::back(image, x, y, d_y, d_x, &scatter);
      for (int c = 0; c < Op::outputs; ++c) {
        const T both = y[c] * d_y[c];
        if constexpr (Plain<T>) forth += both;
        else
          for (int k = 0; k < T::size; ++k) forth += both[k];
      }
      for (const auto& e : scatter.entries)
        for (int k = 0; k < lanes; ++k) back += double(e.value[k]) * double(image.texels.at(std::size_t(e.index[k])));
    }
    CHECK(forth == Approx(back).epsilon(1e-4));
    CHECK(std::fabs(forth) > 0.1);
  };
  for (const AddressMode mode : modes) {
    CAPTURE(int(mode));
    transposed(op::ImageRead<3>{}, Lanes{}, mode);
    transposed(op::ImageRead<4>{}, 0.0, mode);
    transposed(op::ImageRead<1>{}, 0.0f, mode);
    transposed(op::ImageRead<3>{}, Packet<double, 8>{}, mode);
    transposed(op::ImageHeight{}, Lanes{}, mode);
    transposed(op::ImageHeight{}, 0.0, mode);
  }
}
TEST_CASE("image: texels are a parameter, in both recorded players", "[nodes][agreement]") {
  ImageNode<float> node;
  node.file = noisy(5, 3, 3, AddressMode::mirror);
  constexpr auto look = [](const auto& n, const auto& s) {
    const auto h = n.height(s.uv);
    return mixture(n(s.uv)) + 0.1f * h.slope.x * h.slope.y;
  };
  Planes<Spot> places(300);
  std::mt19937 random(19);
  for (int i = 0; i < 300; ++i) {
    Spot<float> at;
    randomize(at, random);
    places.set(i, at);
  }
  const auto [a, d_a] = sum_and_gradient<Player::compiled>(places, look, node);
  const auto [b, d_b] = sum_and_gradient<Player::replayed>(places, look, node);
  CHECK(a == Approx(b).epsilon(1e-5));
  double largest = 0;
  for (std::size_t i = 0; i < node.file.texels.size(); ++i) {
    CAPTURE(i);
    auto up = node, down = node;  // the look is quadratic in the texels: the central difference is exact
    up.file.texels[i] += 0.125f, down.file.texels[i] -= 0.125f;
    double by_difference = 0;
    for (int p = 0; p < 300; ++p)
      by_difference += (double(look(up, places.at(p))) - double(look(down, places.at(p)))) / 0.25;
    CHECK(double(d_a.file.texels[i]) == Approx(by_difference).epsilon(1e-3).margin(2e-3));
    CHECK(double(d_b.file.texels[i]) == Approx(by_difference).epsilon(1e-3).margin(2e-3));
    largest = std::max(largest, std::fabs(by_difference));
  }
  CHECK(largest > 1);
}
