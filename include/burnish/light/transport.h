// burnish/light/transport.h -- what reaches sixteen surfels, integrated against their lobes at many roughnesses at once
// SPDX-License-Identifier: Apache-2.0
//
// A lane is a surfel, so nothing is added up across lanes.
#pragma once
#include <span>
#include <burnish/light/irradiance.h>
#include <burnish/light/samples.h>

namespace burnish {

/// The integrals over directions l of L D V nl times 1 - x(vh), x(vh), x(nl) (1 - x(vh)) and x(nl) x(vh), L the
/// radiance, x(c) = (1 - c)^5, V the height-correlated Smith visibility; each in RGB: twelve numbers a roughness, and
/// their slopes. And what blocked directions take from the irradiances.
class Transport : public Samples {
public:
  static constexpr int channels = 12, irradiances = IrradianceMap::channels;

  /// d_alpha2[k]: the slope of alpha^2 = roughness[k]^4 by whatever variable the slopes are wanted in.
  Transport(std::span<const double> roughness, std::span<const double> d_alpha2, Rings::Size size = Rings::Size::medium)
      : Samples(size), knots(int(roughness.size())) {
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
      const Even& s = hemisphere[i];
      const vec3<P> without = of_hemisphere(sky, b, i);
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
  int knots;
  std::vector<float> alpha2, slope, weight, d_weight;
  std::vector<float> albedo_ratio;  // [knot][weight][value, slope][cosine]

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
    const vec3<P> light = of_ring(sky, b, i, vh, open, occluded);
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
