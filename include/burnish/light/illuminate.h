// burnish/light/illuminate.h -- the environment's light on a G-buffer, gathered once, and what a surface makes of it
// SPDX-License-Identifier: Apache-2.0
//
// A surfel's normal and view stay what they are while its material is fitted; so all that the environment does to it is
// a table by roughness: twelve numbers (Transport) and their slopes at 12 roughnesses, cubic between them. Value and
// slope belong to one smooth function. 1.2 kB a surfel. Colours, weights and indices come in afterwards, exactly
// (shade/brdf.h, Moments).
//
// Against a converged quadrature, on eight real panoramas, each at eight roughnesses from .02 to 1 (bench_specular):
// the value's error is at most 1.4 % rms outdoors and 1.8 % indoors, and at most .5 % of the slopes have the wrong sign
// where |d ln V / dr| > .1. Where something is in the way a direction is open or not: 2.5 % of what is seen without it.
//
//   const EnvironmentLight sky(panorama, yaw);
//   const LightOf<float> light(sky, gbuffer, [&](int i, auto directions, auto out) { ... out[k] = 1 where blocked ...
//   }); illuminate(surface, gbuffer.at(i), light, List<Sun, float>{sky.suns}, LightStrength<float>{});
#pragma once
#include <span>
#include <burnish/ad/repeat.h>
#include <burnish/light/transport.h>
#include <burnish/shade/brdf.h>

namespace burnish {

/// How strongly sky and suns shine, as a factor by channel.
template <class T> struct LightStrength {
  vec3<T> sky = {1.0f, 1.0f, 1.0f}, sun = {1.0f, 1.0f, 1.0f};
  static constexpr auto parameters() {
    return std::tuple{Param{"sky", &LightStrength::sky, Range{0, 10}}, Param{"sun", &LightStrength::sun, Range{0, 10}}};
  }
};

struct IlluminationOptions {
  Rings::Size rings = Rings::Size::medium;
  /// Radiance from blocked directions, linear RGB: a rough grey of the scene. It is scaled with the sky.
  vec3<float> occluded = {};
};

class Illumination {
public:
  /// Nothing is in the way.
  struct Unblocked {};
  using Options = IlluminationOptions;
  static constexpr int knots = 12, sun_rays = 16;

  /// One black surfel.
  Illumination() : Illumination(EnvironmentLight(), None{}) {}
  /// surfels: size(), and at(i) with unit world vectors normal and view (a GBuffer; its padding is not gathered). All
  /// cores; the same bits for any number of them. Directions that are not blocked see the panorama, those below the
  /// horizon its lower half. blocked(i, directions, out), called from all threads at once, is given spans of vec3<float>
  /// and std::uint8_t: out[k], 0 before, becomes 1 where unit world direction k is blocked as seen from surfel i.
  template <class G, class Blocked = Unblocked>
  Illumination(const EnvironmentLight& environment, const G& surfels, const Blocked& blocked = {},
               const Options& options = {})
      : size_(surfels.size()), suns_(int(environment.suns.size())) {
    const int blocks = std::max(1, (size_ + 15) / 16);
    table_.resize(std::size_t(blocks) * table_block);
    irradiance_.resize(std::size_t(blocks) * irradiance_block);
    sun_.resize(std::size_t(blocks) * std::max(suns_, 1) * 16);
    if (size_ == 0) return;
    const Surroundings sky(environment);
    const IrradianceMap unblocked(environment);
    const Transport transport(roughnesses(), slopes(), options.rings);
    parallel_for(blocks, [&](int b) {
      vec3<P> n, v;
      for (int k = 0; k < 16; ++k) {
        const auto s = surfels.at(std::min(16 * b + k, size_ - 1));
        n.x.v[k] = s.normal.x, n.y.v[k] = s.normal.y, n.z.v[k] = s.normal.z;
        v.x.v[k] = s.view.x, v.y.v[k] = s.view.y, v.z.v[k] = s.view.z;
      }
      const Transport::Block block(n, v);
      std::vector<std::uint16_t> open;
      float* const sun = sun_.data() + std::size_t(b) * suns_ * 16;
      std::fill_n(sun, suns_ * 16, 1.0f);
      float* const e = irradiance_.data() + std::size_t(b) * irradiance_block;
      for (int k = 0; k < 16; ++k) {
        const auto of_normal = unblocked({n.x[k], n.y[k], n.z[k]});
        for (int c = 0; c < Transport::irradiances; ++c) e[16 * c + k] = of_normal[c];
      }
      if constexpr (!std::is_same_v<Blocked, Unblocked>) {
        open = look(transport, sky, block, b, environment.suns, blocked, sun);
        transport.block(sky, block, open.data(), options.occluded, e);
      }
      transport.gather(sky, block, open.empty() ? nullptr : open.data(), options.occluded,
                       table_.data() + std::size_t(b) * table_block);
    });
  }

  int size() const { return size_; }
  int suns() const { return suns_; }
  std::size_t bytes() const { return (table_.size() + irradiance_.size() + sun_.size()) * sizeof(float); }

  /// The first `count` of the twelve numbers of surfel `index` (rounded to a whole one, kept inside) at a roughness.
  template <class T> void table(const T& index, const T& roughness, int count, T* y) const {
    const Between<T> at(*this, index, roughness);
    const T u = at.u, w = 1.0f - u, h0 = (1.0f + 2.0f * u) * w * w, g0 = u * w * w, h1 = u * u * (3.0f - 2.0f * u),
            g1 = -u * u * w;
    for (int c = 0; c < count; ++c) y[c] = h0 * at(c, 0) + g0 * at(c, 1) + h1 * at(c, 2) + g1 * at(c, 3);
  }
  /// Their slopes by roughness, times d_y, added up; 0 outside [min_roughness, 1].
  template <class T> T table_slope(const T& index, const T& roughness, int count, const T* d_y) const {
    const Between<T> at(*this, index, roughness);
    const T u = at.u, h = 6.0f * u * (1.0f - u), g0 = 1.0f + u * (3.0f * u - 4.0f), g1 = u * (3.0f * u - 2.0f);
    T sum = 0.0f;
    for (int c = 0; c < count; ++c) sum += d_y[c] * (h * (at(c, 2) - at(c, 0)) + g0 * at(c, 1) + g1 * at(c, 3));
    return select(roughness >= min_roughness && roughness <= 1.0f, sum * at.du, T(0.0f));
  }
  /// E0, E5, E10, each rgb.
  template <class T> void irradiance(const T& index, T* y) const {
    const int_t<T> i = inside(index), first = (i >> 4) * int(irradiance_block) + (i & 15);
    for (int c = 0; c < Transport::irradiances; ++c) y[c] = gather<T>(irradiance_.data() + 16 * c, first);
  }
  /// The part of that sun that a surfel sees, 0 to 1.
  template <class T> T sun_visibility(const T& index, const T& sun) const {
    const int_t<T> i = inside(index), s = to_int(min(max(sun + 0.5f, 0.0f), float(std::max(suns_ - 1, 0))));
    return gather<T>(sun_.data(), (i >> 4) * (16 * suns_) + s * 16 + (i & 15));
  }

private:
  using P = Transport::P;
  struct None {
    struct Nothing {
      vec3<float> normal, view;
    };
    int size() const { return 0; }
    Nothing at(int) const { return {}; }
  };
  static constexpr std::size_t knot_block = Transport::channels * 32, table_block = knots * knot_block,
                               irradiance_block = Transport::irradiances * 16;
  int size_ = 0, suns_ = 0;
  Floats table_;       // [block of 16 surfels][knot][channel][value, slope][lane]
  Floats irradiance_;  // [block][channel][lane]
  Floats sun_;         // [block][sun][lane]

  // Even in roughness^(1/4): on real panoramas .04 % rms between the knots; even in the logarithm leaves .07 %.
  static constexpr double first_place = 0.37606030930863935, step = (1 - first_place) / (knots - 1);  // 0.02^(1/4)
  static std::array<double, knots> roughnesses() {
    std::array<double, knots> r;
    for (int k = 0; k < knots; ++k) r[k] = std::pow(first_place + k * step, 4);
    return r;
  }
  /// Of roughness^4 by the knot's number.
  static std::array<double, knots> slopes() {
    std::array<double, knots> d;
    for (int k = 0; k < knots; ++k) d[k] = 16 * std::pow(first_place + k * step, 15) * step;
    return d;
  }

  template <class T> [[gnu::always_inline]] int_t<T> inside(const T& index) const {
    return to_int(min(max(index + 0.5f, 0.0f), float(std::max(size_ - 1, 0)) + 0.5f));
  }
  /// The two knots beside a roughness, u = 0 at the lower and 1 at the upper.
  template <class T> struct Between {
    T u, du;  // and its slope by roughness
    const float* lower = nullptr;
    int_t<T> offset{};
    bool straight = false;  // sixteen neighbours between the same two knots: loads instead of gathers

    Between(const Illumination& l, const T& index, const T& roughness) : lower(l.table_.data()) {
      const T r = min(max(roughness, min_roughness), 1.0f), t = sqrt(sqrt(r)),
              place = (t - float(first_place)) * float(1 / step);
      const int_t<T> i = l.inside(index), k = to_int(min(max(place, 0.0f), float(knots - 2)));
      u = place - to_real<T>(k);
      du = t * float(0.25 / step) / r;
      if constexpr (std::is_same_v<T, P>) {
        constexpr std::array<int, 16> lane = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
        const int_t<T> apart = (i - (i[0] & ~15) - detail::bits<int_t<T>>(lane)) | (k - k[0]);
        std::uint64_t bits[8], any = 0;
        __builtin_memcpy(bits, &apart, sizeof bits);
        for (const std::uint64_t b : bits) any |= b;
        straight = any == 0;
        if (straight) lower += std::size_t(i[0] >> 4) * table_block + std::size_t(k[0]) * knot_block;
      }
      if (!straight) offset = (i >> 4) * int(table_block) + k * int(knot_block) + (i & 15);
    }
    /// Channel c: 0 the lower value, 1 its slope, 2 the upper value, 3 its slope.
    T operator()(int c, int what) const {
      const float* from = lower + (what >> 1) * knot_block + c * 32 + (what & 1) * 16;
      if constexpr (std::is_same_v<T, P>)
        if (straight) return T::load(from);
      return gather<T>(from, offset);
    }
  };

  /// Which directions of a block are open, a bit a lane; and the part of each sun that is.
  template <class Blocked>
  std::vector<std::uint16_t> look(const Transport& transport, const Surroundings& sky, const Transport::Block& block,
                                  int b, const std::vector<Sun<float>>& suns, const Blocked& blocked,
                                  float* sun) const {
    std::vector<std::uint16_t> open(transport.directions(sky), 0xffff);
    std::vector<vec3<P>> directions(open.size());
    std::vector<unsigned> used(open.size());
    for (int d = 0; d < int(open.size()); ++d) directions[d] = transport.direction(sky, block, d, &used[d]);
    std::vector<vec3<float>> rays;
    std::vector<std::uint8_t> out;
    for (int k = 0; k < 16 && 16 * b + k < size_; ++k) {
      rays.clear();
      for (std::size_t d = 0; d < open.size(); ++d) {
        if (used[d] >> k & 1) rays.emplace_back(directions[d].x[k], directions[d].y[k], directions[d].z[k]);
      }
      const std::size_t sky_rays = rays.size();
      for (const Sun<float>& s : suns) {
        for (int i = 0; i < sun_rays; ++i) rays.push_back(sun_ray(s, i, sun_rays));
      }
      out.assign(rays.size(), 0);
      blocked(16 * b + k, std::span<const vec3<float>>(rays), std::span<std::uint8_t>(out));
      std::size_t at = 0;
      for (std::size_t d = 0; d < open.size(); ++d) {
        if (used[d] >> k & 1 && out[at++]) open[d] = std::uint16_t(open[d] & ~(1u << k));
      }
      for (std::size_t s = 0; s < suns.size(); ++s) {
        int seen = 0;
        for (int i = 0; i < sun_rays; ++i) seen += !out[sky_rays + s * sun_rays + i];
        sun[16 * s + k] = float(seen) / sun_rays;
      }
    }
    return open;
  }
};

template <class T> using LightOf = Resource<T, Illumination>;

/// (surfel index, roughness) -> the first N of the twelve numbers.
template <int N> struct LightTable {
  using Data = Illumination;
  static constexpr int inputs = 2, outputs = N;
  static constexpr bool back_reads_outputs = false;
  template <class T> static void value(const Illumination& light, const T* x, T* y) { light.table(x[0], x[1], N, y); }
  template <class T> static void back(const Illumination& light, const T* x, const T*, const T* d_y, T* d_x, Scatter*) {
    d_x[0] = T(0.0f);
    d_x[1] = light.table_slope(x[0], x[1], N, d_y);
  }
};
/// surfel index -> E0, E5, E10.
struct LightIrradiance {
  using Data = Illumination;
  static constexpr int inputs = 1, outputs = Transport::irradiances;
  static constexpr bool active = false;
  template <class T> static void value(const Illumination& light, const T* x, T* y) { light.irradiance(x[0], y); }
  template <class T> static void back(const Illumination&, const T*, const T*, const T*, T* d_x, Scatter*) {
    d_x[0] = T(0.0f);
  }
};
/// (surfel index, place of the sun in its list) -> the part of it that is seen.
struct SunVisibility {
  using Data = Illumination;
  static constexpr int inputs = 2, outputs = 1;
  static constexpr bool active = false;
  template <class T> static void value(const Illumination& light, const T* x, T* y) {
    y[0] = light.sun_visibility(x[0], x[1]);
  }
  template <class T> static void back(const Illumination&, const T*, const T*, const T*, T* d_x, Scatter*) {
    d_x[0] = d_x[1] = T(0.0f);
  }
};

/// All integrals that a surface of these layers needs of the sky (suns apart) at a surfel.
template <class T> constexpr Moments<T> moments(const LightOf<T>& light, const same<T>& index, const Layers<T>& s) {
  const auto coat = apply<LightTable<6>>(light, index, s.coat_roughness);
  const auto base = apply<LightTable<12>>(light, index, s.base_roughness);
  const auto e = apply<LightIrradiance>(light, index);
  const auto rgb = [](const auto& from, int k) {
    return vec3<T>(from[std::size_t(3 * k)], from[std::size_t(3 * k + 1)], from[std::size_t(3 * k + 2)]);
  };
  return {rgb(coat, 0), rgb(coat, 1), rgb(base, 0), rgb(base, 1), rgb(base, 2),
          rgb(base, 3), rgb(e, 0),    rgb(e, 1),    rgb(e, 2)};
}

/// Radiance that a sun, nothing in its way, leaves towards v: brdf_cos_with, its densities averaged over the sun.
/// n, c: normals of base and coat; all unit and in one frame.
template <class T> constexpr vec3<T> sunlit(const Layers<T>& s, const vec3<same<T>>& n, const vec3<same<T>>& c,
                                            const vec3<same<T>>& v, const Sun<T>& sun) {
  const vec3<T>& l = sun.direction;
  const vec3<T> sum = v + l, h = sum * rsqrt(max(dot(sum, sum), 1e-12f));
  return brdf_cos_with(s, Cosines<T>{dot(n, l), dot(n, v), dot(c, l), dot(c, v), dot(v, h)},
                       ggx_d_spot(n, v, l, s.base_roughness, sun.variance),
                       ggx_d_spot(c, v, l, s.coat_roughness, sun.variance)) *
         sun.power;
}

/// Reflected radiance towards the viewer, linear RGB: sky and suns, coat and base. at: a Surfel (normal, tangent, view,
/// index) of the G-buffer that the light was gathered for. The sky sees the surfel's own normal; only the suns see the
/// surface's geometry normals, and base_diffuse_roughness. So the sky's slope by a normal is 0, and that is all of its
/// error: a degree of turn truly changes a mirroring dielectric by 50 to 60 % at roughness .05, 23 % at .1, 10 % at .2,
/// 3 to 4 % at .5 and 1.8 % at 1 (rms over views and panoramas, measured by bench_specular).
template <class T, class At> constexpr vec3<T> illuminate(const Surface<T>& s, const At& at, const LightOf<T>& light,
                                                          const List<Sun, T>& suns, const LightStrength<T>& strength) {
  const Layers<T> a = layers(s);
  const vec3<T> normal(at.normal), tangent(at.tangent), view(at.view);
  const T index(at.index);
  const vec3<T> n = from_tangent_frame(s.geometry_normal, normal, tangent);
  const vec3<T> c = from_tangent_frame(s.geometry_coat_normal, normal, tangent);
  const vec3<T> sky = reflected(a, dot(normal, view), moments(light, index, a));
  const vec3<T> sun = repeat(suns, [&](const Sun<T>& one) {
    return sunlit(a, n, c, view, one) * apply<SunVisibility>(light, index, one.index);
  });
  return sky * strength.sky + sun * strength.sun;
}

}  // namespace burnish
