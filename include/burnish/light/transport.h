// burnish/light/transport.h -- what reaches sixteen surfels, integrated against their lobes at many roughnesses at once
// SPDX-License-Identifier: Apache-2.0
//
// A lane is a surfel: all sixteen walk through the same half vectors in step, so nothing is added up across lanes.
#pragma once
#include <cstdint>
#include <span>
#include <burnish/ad/packet.h>
#include <burnish/light/irradiance.h>
#include <burnish/light/pyramid.h>
#include <burnish/light/rings.h>

namespace burnish {

/// The integrals over directions l of L D V nl times 1 - x(vh), x(vh), x(nl) (1 - x(vh)) and x(nl) x(vh), L the
/// radiance, x(c) = (1 - c)^5, V the height-correlated Smith visibility; each in RGB: twelve numbers a roughness, and
/// their slopes. And what blocked directions take from the irradiances.
class Transport {
public:
  using P = Packet<float, 16>;
  static constexpr int channels = 12, irradiances = IrradianceMap::channels;

  /// d_alpha2[k]: the slope of alpha^2 = roughness[k]^4 by whatever variable the slopes are wanted in.
  Transport(std::span<const double> roughness, std::span<const double> d_alpha2, Rings::Size size = Rings::Size::medium)
      : rings(size), knots(int(roughness.size())) {
    const int n = rings.rings();
    std::vector<double> w(n), dw(n);
    for (int k = 0; k < knots; ++k) {
      const double a2 = roughness[k] * roughness[k] * roughness[k] * roughness[k];
      rings.weights(a2, w.data(), dw.data());
      alpha2.push_back(float(a2));
      slope.push_back(float(d_alpha2[k]));
      weight.insert(weight.end(), w.begin(), w.end());
      d_weight.insert(d_weight.end(), dw.begin(), dw.end());
    }
    if (size != Rings::Size::dense) normalize_by(Transport(roughness, d_alpha2, Rings::Size::dense));
    // The hemisphere: Gauss rings in the cosine, so that a constant sky is exact for every k; even azimuths on each.
    for (int i = 0; i < hemisphere_rings; ++i) {
      const double c = 0.5 * (1 + gauss_node(i)), width = 0.5 * gauss_weight(i), sine = std::sqrt(1 - c * c);
      const int azimuths = std::max(6, int(hemisphere_azimuths * sine + 0.5));
      const double cell = width * 6.283185307179586 / azimuths, f = (1 - c) * (1 - c) * (1 - c) * (1 - c) * (1 - c);
      for (int a = 0; a < azimuths; ++a) {
        const double angle = 6.283185307179586 * (a + (i % 2 ? 0.5 : 0)) / azimuths;
        hemisphere.push_back({float(sine * std::cos(angle)),
                              float(sine * std::sin(angle)),
                              float(c),
                              float(1.6 / 12 * cell),
                              {float(cell * c), float(cell * c * f), float(cell * c * f * f)}});
      }
    }
  }

  /// What is kept of sixteen surfels between the steps.
  struct Block {
    vec3<P> normal, view, side, up;  // side: in the plane, towards the view; up = cross(normal, side)
    P nv, sv;                        // cosine and sine of the view
    explicit Block(const vec3<P>& n, const vec3<P>& v) : normal(n), view(v), nv(max(dot(n, v), 1e-4f)) {
      const vec3<P> t = v - n * dot(n, v), other = select(abs(n.x) < 0.6f, P(1.0f), P(0.0f)) * vec3<P>(1, 0, 0) +
                                                   select(abs(n.x) < 0.6f, P(0.0f), P(1.0f)) * vec3<P>(0, 1, 0);
      const vec3<P> o = other - n * dot(n, other);
      const P length2 = dot(t, t);
      const auto flat = length2 < 1e-10f;
      side = vec3<P>(select(flat, o.x, t.x), select(flat, o.y, t.y), select(flat, o.z, t.z));
      side = side * rsqrt(dot(side, side));
      up = cross(n, side);
      sv = sqrt(max(1.0f - nv * nv, 0.0f));
    }
  };

  /// Directions looked at: those of the rings, then those of the hemisphere.
  int directions() const { return rings.directions() + int(hemisphere.size()); }
  /// Direction i of every lane, world, and where it matters (above the horizon).
  vec3<P> direction(const Block& b, int i, unsigned* used) const {
    if (i >= rings.directions()) {
      const Sample& s = hemisphere[i - rings.directions()];
      *used = 0xffff;
      return b.side * P(s.x) + b.up * P(s.y) + b.normal * P(s.z);
    }
    const P hx = rings.half_x[i], hy = rings.half_y[i], hz = rings.half_z[i], vh = hx * b.sv + hz * b.nv;
    const P x = 2.0f * vh * hx - b.sv, y = 2.0f * vh * hy, z = 2.0f * vh * hz - b.nv;
    *used = 0;
    for (int k = 0; k < 16; ++k) *used |= unsigned(vh[k] > 0 && z[k] > 1e-7f) << k;
    return b.side * x + b.up * y + b.normal * z;
  }

  /// table: knots x channels x {value, slope} x 16. open[i]: bit k is set where direction i of lane k sees the
  /// environment (null: everywhere); the others see `occluded`.
  void gather(const Pyramid& sky, const Block& b, const std::uint16_t* open, const vec3<float>& occluded, float* table,
              bool normalized = true) const {
    std::fill_n(table, std::size_t(knots) * channels * 32, 0.0f);
    const int n = rings.directions();
    for (int first = 0; first < n; first += batch) {
      const int count = std::min(batch, n - first);
      P part[batch][channels], nl[batch];
      for (int j = 0; j < count; ++j) prepare(sky, b, first + j, open, occluded, part[j], nl[j]);
      for (int k = 0; k < knots; ++k) integrate(b, k, first, count, part, nl, table + std::size_t(k) * channels * 32);
    }
    if (normalized && !albedo_ratio.empty()) normalize(b, table);
  }
  /// irradiance: irradiances x 16, on entry those of the unblocked sky. Each is multiplied by what the hemisphere's
  /// directions find of it with and without the blocking: exact where nothing is blocked, and where everything is.
  void block(const Pyramid& sky, const Block& b, const std::uint16_t* open, const vec3<float>& occluded,
             float* irradiance) const {
    const int n = rings.directions();
    const auto whole = [](unsigned bits) { return bits == 0xffff; };
    if (std::all_of(open + n, open + directions(), whole)) return;
    P seen[irradiances] = {}, all[irradiances] = {};
    for (int i = 0; i < int(hemisphere.size()); ++i) {
      const Sample& s = hemisphere[i];
      const vec3<P> without = radiance(sky, b, n + i, s.spread, nullptr, occluded);
      P l[3] = {without.x, without.y, without.z};
      for (int k = 0; k < 3; ++k) {
        for (int c = 0; c < 3; ++c) all[3 * k + c] += l[c] * s.weight[k];
      }
      const float hidden[3] = {occluded.x, occluded.y, occluded.z};
      for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < 16; ++k) l[c].v[k] = open[n + i] >> k & 1 ? l[c][k] : hidden[c];
        for (int k = 0; k < 3; ++k) seen[3 * k + c] += l[c] * s.weight[k];
      }
    }
    for (int c = 0; c < irradiances; ++c) {
      const P e = P::load(irradiance + 16 * c);
      select(all[c] > 0.0f, e * seen[c] / max(all[c], 1e-30f), seen[c]).store(irradiance + 16 * c);
    }
  }

private:
  static constexpr int batch = 16;
  struct Sample {
    float x, y, z, spread, weight[3];
  };
  Rings rings;
  int knots;
  std::vector<float> alpha2, slope, weight, d_weight;
  std::vector<float> albedo_ratio;  // [knot][weight][value, slope][cosine]
  std::vector<Sample> hemisphere;

  static constexpr int hemisphere_rings = 8;
  static constexpr double hemisphere_azimuths = 24;
  static constexpr double gauss_node(int i) {  // Gauss-Legendre, 8 nodes
    constexpr double x[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
    return i < 4 ? -x[3 - i] : x[i - 4];
  }
  static constexpr double gauss_weight(int i) {
    constexpr double w[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
    return i < 4 ? w[3 - i] : w[i - 4];
  }

  vec3<P> radiance(const Pyramid& sky, const Block& b, int i, P variance, const std::uint16_t* open,
                   const vec3<float>& occluded) const {
    unsigned used;
    const vec3<P> d = direction(b, i, &used);
    const unsigned seen = open ? used & open[i] : used;
    alignas(64) float r[16], g[16], c[16];
    sky.fetch(d.x, d.y, d.z, variance, seen, r, g, c);
    if (const unsigned hidden = used & ~seen) {
      for (int k = 0; k < 16; ++k) {
        if (hidden >> k & 1) r[k] = occluded.x, g[k] = occluded.y, c[k] = occluded.z;
      }
    }
    return {P::load(r), P::load(g), P::load(c)};
  }
  /// Under an even sky the rings' sums depend on nv alone: for 64 of it and every knot, what they are short of (or
  /// above) the same sums on dense rings, as a factor for each of the four weights, with its slope. Exact then, and
  /// closer otherwise.
  void normalize_by(const Transport& dense) {
    const Pyramid even(EnvironmentLight(Image(32, 16, vec3<float>(1))));
    albedo_ratio.resize(std::size_t(knots) * 8 * cosines);
    const std::size_t size = std::size_t(knots) * channels * 32;
    std::vector<std::vector<float>> own(cosines / 16, std::vector<float>(size)), truth = own;
    parallel_for(cosines / 16 * 2, [&](int i) {
      vec3<P> n(P(0.0f), P(0.0f), P(1.0f)), v = n;
      for (int k = 0; k < 16; ++k) {
        const float c = cosine_of(i / 2 * 16 + k);
        v.x.v[k] = std::sqrt(std::max(0.0f, 1 - c * c)), v.z.v[k] = c;
      }
      if (i % 2) gather(even, Block(n, v), nullptr, {}, own[i / 2].data(), false);
      else dense.gather(even, Block(n, v), nullptr, {}, truth[i / 2].data());
    });
    for (int k = 0; k < knots; ++k) {
      for (int q = 0; q < 4; ++q) {
        for (int i = 0; i < cosines; ++i) {
          const std::size_t at = (std::size_t(k) * channels + 3 * q) * 32 + i % 16;
          const float a = own[i / 16][at], da = own[i / 16][at + 16], b = truth[i / 16][at],
                      db = truth[i / 16][at + 16];
          float* to = &albedo_ratio[(std::size_t(k) * 4 + q) * 2 * cosines + i];
          const bool sure = a > 1e-6f && b < 2 * a && a < 2 * b;  // else there is nothing to compare
          to[0] = sure ? b / a : 1;
          to[cosines] = sure ? (db - b / a * da) / a : 0;
        }
      }
    }
  }
  static constexpr int cosines = 64;
  static float cosine_of(int i) { return std::max(float(i * i) / ((cosines - 1) * (cosines - 1)), 1e-4f); }
  void normalize(const Block& b, float* table) const {
    const P x = sqrt(b.nv) * float(cosines - 1);
    const P::I at = to_int(min(x, float(cosines - 2)));
    const P u = x - to_real<P>(at);
    for (int k = 0; k < knots * 4; ++k) {
      const auto read = [&](int what) {
        const float* from = albedo_ratio.data() + std::size_t(2 * k + what) * cosines;
        const P low = burnish::gather<P>(from, at);
        return low + (burnish::gather<P>(from + 1, at) - low) * u;
      };
      const P ratio = read(0), d_ratio = read(1);
      for (int c = 0; c < 3; ++c) {
        float* y = table + (std::size_t(k) * 3 + c) * 32;
        const P value = P::load(y), slope_of = P::load(y + 16);
        (value * ratio).store(y);
        (slope_of * ratio + value * d_ratio).store(y + 16);
      }
    }
  }
  /// Sample i: radiance times all that does not depend on the roughness; zero where the sample is below the horizon.
  void prepare(const Pyramid& sky, const Block& b, int i, const std::uint16_t* open, const vec3<float>& occluded,
               P* part, P& nl) const {
    const float hz = rings.half_z[i];
    const P vh = min(max(rings.half_x[i] * b.sv + hz * b.nv, 0.0f), 1.0f), z = 2.0f * vh * hz - b.nv;
    const vec3<P> light = radiance(sky, b, i, rings.spread[i] * vh, open, occluded);  // 0 below the horizon
    nl = min(max(z, 1e-7f), 1.0f);
    const P g = rings.share[i] * 4.0f / hz * vh * nl, fv = power5(1.0f - vh), fl = power5(1.0f - nl);
    const P with[4] = {g * (1.0f - fv), g * fv, g * fl * (1.0f - fv), g * fl * fv};
    for (int q = 0; q < 4; ++q) {
      part[3 * q] = with[q] * light.x, part[3 * q + 1] = with[q] * light.y, part[3 * q + 2] = with[q] * light.z;
    }
  }
  static P power5(P x) { return (x * x) * (x * x) * x; }

  /// Adds `count` samples to one knot: sums of weight V and of its slope.
  void integrate(const Block& b, int k, int first, int count, const P (*part)[channels], const P* nl,
                 float* table) const {
    const float a2 = alpha2[k], rest = 1 - a2;
    const P sv = sqrt(a2 + rest * b.nv * b.nv), dsv = (1.0f - b.nv * b.nv) / (2.0f * sv);
    const float *w = &weight[std::size_t(k) * rings.rings()], *dw = &d_weight[std::size_t(k) * rings.rings()];
    P value[channels], change[channels];
    for (int c = 0; c < channels; ++c) value[c] = P::load(table + 32 * c), change[c] = P::load(table + 32 * c + 16);
    for (int j = 0; j < count; ++j) {
      const int ring = rings.ring[first + j];
      const P l = nl[j], sl = sqrt(a2 + rest * l * l), sum = l * sv + b.nv * sl, both = 1.0f / (sl * sum);
      const P v = 0.5f * both * sl, dsl = (1.0f - l * l) * 0.5f * both * sum;
      const P d_v = v * (l * dsv + b.nv * dsl) * (-1.0f * both * sl);
      const P weighted = w[ring] * v, d_weighted = (dw[ring] * v + w[ring] * d_v) * slope[k];
      for (int c = 0; c < channels; ++c) {
        value[c] += weighted * part[j][c];
        change[c] += d_weighted * part[j][c];
      }
    }
    for (int c = 0; c < channels; ++c) value[c].store(table + 32 * c), change[c].store(table + 32 * c + 16);
  }
};

}  // namespace burnish
