// burnish/light/samples.h -- where sixteen surfels look, and what they see there
// SPDX-License-Identifier: Apache-2.0
//
// A lane is a surfel: all sixteen walk through the same half vectors in step. Near a lobe's middle the rings look up
// the whole map; far from it, where they are wide, the dim rest of it, and the lamps (light/lamps.h) come in one by
// one. In between both fade, by tan(theta_h): .05 to .25.
#pragma once
#include <cstdint>
#include <burnish/ad/packet.h>
#include <burnish/light/lamps.h>
#include <burnish/light/pyramid.h>
#include <burnish/light/rings.h>

namespace burnish {

/// What shines, without its suns, prepared to be looked up.
struct Surroundings {
  Pyramid whole, rest;
  std::vector<Lamps::Lamp> lamps;
  explicit Surroundings(const EnvironmentLight& e) : Surroundings(e, Lamps(e)) {}

private:
  Surroundings(const EnvironmentLight& e, Lamps l) : whole(e), rest(l.rest), lamps(std::move(l.all)) {}
};

/// Directions: those of the rings, of the hemisphere (for what is blocked of the irradiance), and of the lamps.
struct Samples {
  using P = Packet<float, 16>;
  struct Even {  // of the hemisphere, in the local frame; weights for nl, nl x(nl), nl x(nl)^2
    float x, y, z, spread, weight[3];
  };
  Rings rings;
  std::vector<Even> hemisphere;

  explicit Samples(Rings::Size size) : rings(size) {
    for (const float z : rings.half_z) far.push_back(far_share(1 / (z * z) - 1));
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

  int first_lamp() const { return rings.directions() + int(hemisphere.size()); }
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
      const Even& s = hemisphere[i - rings.directions()];
      *used = 0xffff;
      return b.side * P(s.x) + b.up * P(s.y) + b.normal * P(s.z);
    }
    const P hx = rings.half_x[i], hy = rings.half_y[i], hz = rings.half_z[i], vh = hx * b.sv + hz * b.nv;
    const P x = 2.0f * vh * hx - b.sv, y = 2.0f * vh * hy, z = 2.0f * vh * hz - b.nv;
    *used = 0;
    for (int k = 0; k < 16; ++k) *used |= unsigned(vh[k] > 0 && z[k] > 1e-7f) << k;
    return b.side * x + b.up * y + b.normal * z;
  }
  /// What part of a light at half vectors of that tan^2 comes as lamps. Smooth and slow: the rings must resolve it.
  template <class T> static T far_share(T tangent2) {
    constexpr float begin = -2.9957323f, width = 1.6094379f;  // ln .05, ln (.25 / .05)
    return smoothstep(T(begin), T(begin + width), 0.5f * log(max(tangent2, 1e-12f)));
  }
  /// Light of ring sample i, 0 below the horizon. open[i]: bit k is set where direction i of lane k sees the
  /// environment (null: everywhere); the others see `occluded`.
  vec3<P> of_ring(const Surroundings& sky, const Block& b, int i, P vh, const std::uint16_t* open,
                  const vec3<float>& occluded) const {
    const auto of = [&](bool whole) { return radiance(sky, whole, b, i, rings.spread[i], vh, open, occluded); };
    return far[i] == 0 ? of(true) : far[i] == 1 ? of(false) : mix(of(true), of(false), P(far[i]));
  }
  /// Light of the hemisphere's sample i, nothing in its way.
  vec3<P> of_hemisphere(const Surroundings& sky, const Block& b, int i) const {
    return radiance(sky, true, b, rings.directions() + i, hemisphere[i].spread, 1.0f, nullptr, {});
  }

private:
  std::vector<float> far;

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

  /// Of sample i, averaged over its cell: `spread` is the variance of the filter of a cell that is met straight. slant:
  /// dot(v, h), for a cell of half vectors that v meets at a slant is so much narrower than it is long, along the plane
  /// of v and l. It is seen as one round spot of its area, but on the whole map as 1, 2 or 4 in a row if it is wider
  /// than .6 degrees.
  vec3<P> radiance(const Surroundings& sky, bool whole, const Block& b, int i, P spread, P slant,
                   const std::uint16_t* open, const vec3<float>& occluded) const {
    unsigned used;
    const vec3<P> d = direction(sky, b, i, &used);
    const unsigned seen = open ? used & open[i] : used;
    alignas(64) float red[16], green[16], blue[16];
    vec3<P> sum(P(0.0f), P(0.0f), P(0.0f));
    if (!whole || spread[0] < 1e-4f) {
      (whole ? sky.whole : sky.rest).fetch(d.x, d.y, d.z, spread * slant, seen, red, green, blue);
      sum = vec3<P>(P::load(red), P::load(green), P::load(blue));
    } else {
      const vec3<P> flat = b.view - d * dot(b.view, d);
      const vec3<P> along = flat * (sqrt(3.0f * spread) * rsqrt(max(dot(flat, flat), 1e-8f)));  // the cell's length
      const P spots = select(slant > 0.5f, P(1.0f), select(slant > 0.25f, P(2.0f), P(4.0f))), part = 1.0f / spots;
      const P variance = spread * select(slant > 0.5f, slant, part * part);
      for (int spot = 0; spot < 4; ++spot) {
        unsigned wanted = 0;
        for (int k = 0; k < 16; ++k) wanted |= unsigned(float(spot) < spots[k]) << k;
        if ((wanted &= seen) == 0) break;
        const vec3<P> q = d + along * ((float(spot) + 0.5f) * part - 0.5f);
        sky.whole.fetch(q.x, q.y, q.z, variance, wanted, red, green, blue);
        sum += vec3<P>(P::load(red), P::load(green), P::load(blue)) * part;
      }
    }
    if (const unsigned hidden = used & ~seen) {
      for (int k = 0; k < 16; ++k) {
        if (hidden >> k & 1) sum.x.v[k] = occluded.x, sum.y.v[k] = occluded.y, sum.z.v[k] = occluded.z;
      }
    }
    return sum;
  }
};

}  // namespace burnish
