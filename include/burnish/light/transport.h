// burnish/light/transport.h -- what reaches sixteen surfels, integrated against their lobes at many roughnesses at once
// SPDX-License-Identifier: Apache-2.0
//
// A lane is a surfel: all sixteen walk through the same half vectors in step, so nothing is added up across lanes. Near
// a lobe's middle the rings look up the whole map; far from it, where they are wide, the dim rest of it, and the lamps
// (light/lamps.h) come in one by one. In between both fade, by tan(theta_h): .05 to .25.
#pragma once
#include <cstdint>
#include <span>
#include <burnish/ad/packet.h>
#include <burnish/light/irradiance.h>
#include <burnish/light/lamps.h>
#include <burnish/light/pyramid.h>
#include <burnish/light/rings.h>

namespace burnish {

/// What shines, without its suns, prepared to be looked up.
struct Surroundings {
  Pyramid whole, rest;
  std::vector<Lamp> lamps;
  explicit Surroundings(const EnvironmentLight& e) : Surroundings(e, Lamps(e)) {}

private:
  Surroundings(const EnvironmentLight& e, Lamps l) : whole(e), rest(l.rest), lamps(std::move(l.all)) {}
};

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
    for (const float z : rings.half_z) far.push_back(far_share(1 / (z * z) - 1));
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
                              float(1.0 / 3 * cell),
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

  /// Directions looked at: those of the rings, of the hemisphere, and of the lamps.
  int directions(const Surroundings& sky) const { return first_lamp() + int(sky.lamps.size()); }
  /// Direction i of every lane, world, and where it matters (above the horizon).
  vec3<P> direction(const Surroundings& sky, const Block& b, int i, unsigned* used) const {
    if (i >= first_lamp()) {
      const vec3<P> d(sky.lamps[i - first_lamp()].direction);
      const P nl = dot(d, b.normal);
      *used = 0;
      for (int k = 0; k < 16; ++k) *used |= unsigned(nl[k] > 1e-7f) << k;
      return d;
    }
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
  void gather(const Surroundings& sky, const Block& b, const std::uint16_t* open, const vec3<float>& occluded,
              float* table, bool normalized = true) const {
    std::fill_n(table, std::size_t(knots) * channels * 32, 0.0f);
    const int n = rings.directions(), lamps = int(sky.lamps.size());
    P part[batch][channels], nl[batch], x2[batch];
    for (int first = 0; first < n; first += batch) {
      const int count = std::min(batch, n - first);
      for (int j = 0; j < count; ++j) prepare(sky, b, first + j, open, occluded, part[j], nl[j]);
      for (int k = 0; k < knots; ++k) {
        const float *w = &weight[std::size_t(k) * rings.rings()], *dw = &d_weight[std::size_t(k) * rings.rings()];
        integrate(b, k, count, part, nl, table, [&](int j, P* d, P* change) {
          *d = w[rings.ring[first + j]], *change = dw[rings.ring[first + j]];
        });
      }
    }
    if (normalized && !albedo_ratio.empty()) normalize(b, table);
    for (int at = 0; at < lamps;) {
      int count = 0;
      for (; count < batch && at < lamps; ++at)
        count += prepare_lamp(sky, b, at, open, part[count], nl[count], x2[count]);
      for (int k = 0; k < knots; ++k) {
        const float a2 = alpha2[k];
        integrate(b, k, count, part, nl, table, [&](int j, P* d, P* change) {
          const P over = 1.0f / (a2 + x2[j]);
          *d = (a2 * inverse_pi) * over * over, *change = *d * (1 / a2 - 2.0f * over);
        });
      }
    }
  }
  /// irradiance: irradiances x 16, on entry those of the unblocked sky. Each is multiplied by what the hemisphere's
  /// directions find of it with and without the blocking: exact where nothing is blocked, and where everything is.
  void block(const Surroundings& sky, const Block& b, const std::uint16_t* open, const vec3<float>& occluded,
             float* irradiance) const {
    const int n = rings.directions();
    const auto whole = [](unsigned bits) { return bits == 0xffff; };
    if (std::all_of(open + n, open + first_lamp(), whole)) return;
    P seen[irradiances] = {}, all[irradiances] = {};
    for (int i = 0; i < int(hemisphere.size()); ++i) {
      const Sample& s = hemisphere[i];
      const vec3<P> without = radiance(sky, true, b, n + i, s.spread, 1.0f, nullptr, occluded);
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
  std::vector<float> alpha2, slope, weight, d_weight, far;
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

  int first_lamp() const { return rings.directions() + int(hemisphere.size()); }
  /// What part of a light at half vectors of that tan^2 comes as lamps. Smooth and slow: the rings must resolve it.
  template <class T> static T far_share(T tangent2) {
    constexpr float begin = -2.9957323f, width = 1.6094379f;  // ln .05, ln (.25 / .05)
    return smoothstep(T(begin), T(begin + width), 0.5f * log(max(tangent2, 1e-12f)));
  }
  /// Of sample i, averaged over its cell: `spread` is the variance of the cell's filter if it is round. slant: dot(v, h),
  /// for the cell of a half vector that v meets at a slant is so much narrower than it is long, along the plane of v and
  /// l. It is seen as one round spot of the same area, but on the whole map as 1, 2 or 4 in a row if it is wider than .6
  /// degrees.
  vec3<P> radiance(const Surroundings& sky, bool whole, const Block& b, int i, P spread, P slant,
                   const std::uint16_t* open, const vec3<float>& occluded) const {
    unsigned used;
    const vec3<P> d = direction(sky, b, i, &used), flat = b.view - d * dot(b.view, d);
    const unsigned seen = open ? used & open[i] : used;
    const bool round = !whole || spread[0] < 1e-4f;
    const P spots = round ? P(1.0f) : select(slant > 0.5f, P(1.0f), select(slant > 0.25f, P(2.0f), P(4.0f)));
    const P variance = spread * select(spots > 1.5f, 1.0f / (spots * spots), slant);
    const vec3<P> along = flat * (sqrt(3.0f * spread) * rsqrt(max(dot(flat, flat), 1e-8f)));  // the cell's length
    vec3<P> sum(P(0.0f), P(0.0f), P(0.0f));
    for (int spot = 0; spot < 4; ++spot) {
      unsigned wanted = 0;
      for (int k = 0; k < 16; ++k) wanted |= unsigned(float(spot) < spots[k]) << k;
      if ((wanted &= seen) == 0) break;
      const vec3<P> q = d + along * ((float(spot) + 0.5f) / spots - 0.5f);
      alignas(64) float r[16], g[16], c[16];
      (whole ? sky.whole : sky.rest).fetch(q.x, q.y, q.z, variance, wanted, r, g, c);
      sum += vec3<P>(P::load(r), P::load(g), P::load(c));
    }
    sum = sum * (1.0f / spots);
    if (const unsigned hidden = used & ~seen) {
      for (int k = 0; k < 16; ++k) {
        if (hidden >> k & 1) sum.x.v[k] = occluded.x, sum.y.v[k] = occluded.y, sum.z.v[k] = occluded.z;
      }
    }
    return sum;
  }
  /// Under an even sky the rings' sums depend on nv alone: for 64 of it and every knot, what they are short of (or
  /// above) the same sums on dense rings, as a factor for each of the four weights, with its slope. Exact then, and
  /// closer otherwise.
  void normalize_by(const Transport& dense) {
    const Surroundings even(EnvironmentLight(Image(32, 16, vec3<float>(1))));
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
  void prepare(const Surroundings& sky, const Block& b, int i, const std::uint16_t* open, const vec3<float>& occluded,
               P* part, P& nl) const {
    const float hz = rings.half_z[i];
    const P vh = min(max(rings.half_x[i] * b.sv + hz * b.nv, 0.0f), 1.0f), z = 2.0f * vh * hz - b.nv;
    const auto of = [&](bool whole) {
      return radiance(sky, whole, b, i, rings.spread[i], vh, open, occluded);  // 0 below the horizon
    };
    const vec3<P> light = far[i] == 0 ? of(true) : far[i] == 1 ? of(false) : mix(of(true), of(false), P(far[i]));
    nl = min(max(z, 1e-7f), 1.0f);
    spread(light, rings.share[i] * 4.0f / hz * vh * nl, vh, nl, part);
  }
  /// The same of a lamp, and the tan^2 of its half vector. False if it is below everyone's horizon.
  bool prepare_lamp(const Surroundings& sky, const Block& b, int i, const std::uint16_t* open, P* part, P& nl,
                    P& x2) const {
    unsigned seen;
    const vec3<P> d = direction(sky, b, first_lamp() + i, &seen);
    if (open) seen &= open[first_lamp() + i];
    if (seen == 0) return false;
    alignas(64) float shown[16];
    for (int k = 0; k < 16; ++k) shown[k] = float(seen >> k & 1);
    nl = min(max(dot(d, b.normal), 1e-7f), 1.0f);
    const vec3<P> sum = d + b.view, across = cross(b.normal, sum);
    const P size2 = max(dot(sum, sum), 1e-6f), over = rsqrt(size2), up = nl + b.nv, hz = min(up * over, 1.0f);
    const P vh = min(0.5f * size2 * over, 1.0f);
    x2 = dot(across, across) / (up * up);
    spread(vec3<P>(sky.lamps[i].power), P::load(shown) * far_share(x2) * nl / (hz * hz * hz * hz), vh, nl, part);
    return true;
  }
  /// Light times g and the four factors of the Fresnel terms.
  static void spread(const vec3<P>& light, P g, P vh, P nl, P* part) {
    const P fv = power5(1.0f - vh), fl = power5(1.0f - nl);
    const P with[4] = {g * (1.0f - fv), g * fv, g * fl * (1.0f - fv), g * fl * fv};
    for (int q = 0; q < 4; ++q) {
      part[3 * q] = with[q] * light.x, part[3 * q + 1] = with[q] * light.y, part[3 * q + 2] = with[q] * light.z;
    }
  }
  static P power5(P x) { return (x * x) * (x * x) * x; }

  /// Adds `count` samples to one knot: sums of weight V and of its slope. weigh(j, &weight, &its slope by alpha^2).
  template <class Weigh> void integrate(const Block& b, int k, int count, const P (*part)[channels], const P* nl,
                                        float* table, Weigh weigh) const {
    table += std::size_t(k) * channels * 32;
    const float a2 = alpha2[k], rest = 1 - a2;
    const P sv = sqrt(a2 + rest * b.nv * b.nv), dsv = (1.0f - b.nv * b.nv) / (2.0f * sv);
    P value[channels], change[channels];
    for (int c = 0; c < channels; ++c) value[c] = P::load(table + 32 * c), change[c] = P::load(table + 32 * c + 16);
    for (int j = 0; j < count; ++j) {
      P w, dw;
      weigh(j, &w, &dw);
      const P l = nl[j], sl = sqrt(a2 + rest * l * l), sum = l * sv + b.nv * sl, both = 1.0f / (sl * sum);
      const P v = 0.5f * both * sl, dsl = (1.0f - l * l) * 0.5f * both * sum;
      const P d_v = v * (l * dsv + b.nv * dsl) * (-1.0f * both * sl);
      const P weighted = w * v, d_weighted = (dw * v + w * d_v) * slope[k];
      for (int c = 0; c < channels; ++c) {
        value[c] += weighted * part[j][c];
        change[c] += d_weighted * part[j][c];
      }
    }
    for (int c = 0; c < channels; ++c) value[c].store(table + 32 * c), change[c].store(table + 32 * c + 16);
  }
};

}  // namespace burnish
