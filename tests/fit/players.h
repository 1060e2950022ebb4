// tests/fit/players.h -- holds every player of a look against a tape in double, pixel by pixel
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/ad/check.h>
#include <burnish/ad/dual.h>
#include <burnish/fit/render.h>
#include <burnish_test.h>
#include <cstring>

namespace players {
using namespace burnish;

/// n surfels of a bent patch, every other pixel of one row.
inline GBuffer patch(int n) {
  GBuffer g;
  g.width = 2 * n + 2, g.height = 1;
  g.resize(n);
  std::mt19937 random(3);
  const auto number = [&] { return std::uniform_real_distribution<float>(-1, 1)(random); };
  for (int i = 0; i < n; ++i) {
    const std::size_t k = std::size_t(i);
    g.pixel[k] = 2 * i + i % 2;
    const auto put = [&](std::size_t first, const vec3<float>& v) {
      g.plane[first][k] = v.x, g.plane[first + 1][k] = v.y, g.plane[first + 2][k] = v.z;
    };
    const vec3<float> normal = normalize(vec3<float>{0.6f * number(), 0.6f * number(), 1.0f});
    put(0, {number(), number(), number()});
    put(3, normal);
    put(6, normalize(cross(vec3<float>{0, 1, 0}, normal)));
    put(9, normalize(normal + vec3<float>{0.4f * number(), 0.4f * number(), 0.2f}));
    g.plane[12][k] = number(), g.plane[13][k] = number();
  }
  g.close();
  return g;
}
/// An arbitrary adjoint for every pixel, those not in g among them.
inline Image adjoint(const GBuffer& g) {
  Image d(g.width, g.height);
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < g.width * g.height; ++i) d.plane(c)[i] = 0.2f + 0.1f * float((i * 7 + c * 3) % 11);
  return d;
}
/// f(number, its like in every other) on all numbers of a model, texels among them.
template <class F, class M, class... N> void numbers(F f, M& a, N&... b) {
  each([&]<class X>(X& x, auto&... y) {
    if constexpr (Plain<std::remove_cv_t<X>>) f(x, y...);
    else
      for (std::size_t i = 0; i < x.texels.size(); ++i) f(x.texels[i], y.texels[i]...);
  }, a, b...);
}
template <class M> bool same_bits(const M& a, const M& b) {
  bool same = true;
  numbers([&](float x, float y) { same = same && std::memcmp(&x, &y, sizeof x) == 0; }, a, b);
  return same;
}

/// The derivatives of sum over pixels of dot(look, d_image): by numbers from a tape in double at each pixel, by texels
/// from differences (fourth order). `size` is the same sum of magnitudes: what rounding is measured by.
struct Truth {
  std::vector<double> slope, size;
};
template <class Look, class M, class... Data>
Truth truth(const GBuffer& g, const Image& d_image, const Look& look, const M& model, const Data&... data) {
  const auto weighed = [&]<class N>(const N& m, int i) {
    using S = detail::scalar_in_t<N>;
    const auto c = look(m, lift<S>(g.at(i)), detail::lift_data<S>(data)...);
    const int p = g.pixel[std::size_t(i)];
    return S(d_image.plane(0)[p]) * c.x + S(d_image.plane(1)[p]) * c.y + S(d_image.plane(2)[p]) * c.z;
  };
  Truth t;
  int count = 0;
  numbers([&](float) { ++count; }, model);
  t.slope.resize(std::size_t(count)), t.size = t.slope;
  const auto model64 = lift<double>(model);
  for (int i = 0; i < g.size(); ++i) {
    const auto [y, d] = differentiate([&](const auto& m) { return weighed(m, i); }, model64);
    std::size_t k = 0;
    each([&]<class X, class Y>(const X& slope, const Y& at) {
      if constexpr (Plain<X>) t.slope[k] += slope, t.size[k++] += std::fabs(slope);
      else k += (*at).texels.size();
    }, d, model);
  }
  M moved = model;
  std::size_t k = 0;
  each([&]<class X>(X& x) {
    if constexpr (Plain<X>) ++k;
    else
      for (float& texel : x.texels) {
        const float before = texel, h = 0.0625f;
        const auto central = [&](int i, float step) {
          texel = before + step;
          const double up = weighed(lift<double>(moved), i), above = double(texel);
          texel = before - step;
          return (up - weighed(lift<double>(moved), i)) / (above - double(texel));
        };
        for (int i = 0; i < g.size(); ++i) {
          const double y = (4 * central(i, h / 2) - central(i, h)) / 3;
          t.slope[k] += y, t.size[k] += std::fabs(y);
        }
        texel = before;
        ++k;
      }
  }, moved);
  return t;
}
template <class M> void check(const M& d, const Truth& t, double within) {
  std::size_t k = 0;
  numbers([&](float x) {
    CAPTURE(k);
    CHECK(double(x) == Approx(t.slope[k]).epsilon(0).margin(within * t.size[k] + 1e-7));
    ++k;
  }, d);
}
/// Compiled (unless the look captures) and replayed, with 1, 2 and 3 threads.
template <bool Compiled = true, class Look, class M, class... Data>
void agree(const GBuffer& g, double within, const Look& look, const M& model, const Data&... data) {
  const Image d_image = adjoint(g);
  const Truth t = truth(g, d_image, look, model, data...);
  const auto w = with(look, data...);
  const int before = threads();
  M replayed{}, compiled{};
  for (const int n : {1, 2, 3}) {
    set_threads(n);
    CAPTURE(n);
    const M again = backward<Player::replayed>(g, w, model, d_image);
    if (n == 1) replayed = again;
    CHECK(same_bits(again, replayed));
    if constexpr (Compiled) {
      const M once_more = backward<Player::compiled>(g, w, model, d_image);
      if (n == 1) compiled = once_more;
      CHECK(same_bits(once_more, compiled));
    }
  }
  set_threads(before);
  {
    INFO("replayed");
    check(replayed, t, within);
  }
  if constexpr (Compiled) {
    INFO("compiled");
    check(compiled, t, within);
  }
}

}  // namespace players
