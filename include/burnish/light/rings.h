// burnish/light/rings.h -- fixed half vectors on which every GGX roughness is integrated at once
// SPDX-License-Identifier: Apache-2.0
//
// Half vectors lie on rings of constant x = tan(theta_h), plus the normal itself. In ln x a GGX lobe of any roughness
// is the same bump, D(h) dot(n, h) dh = 2 y / (1 + y)^2 d ln x with y = x^2 / alpha^2, analytic and fading on both
// sides: the plain trapezoidal rule over the rings is all but exact, in closed form with its slope by roughness. The
// directions do not depend on the roughness, so one gather of radiance serves every roughness, and the slope is exact.
#pragma once
#include <cmath>
#include <vector>
#include <burnish/scene/image.h>

namespace burnish {

class Rings {
public:
  /// 162, 302 or 578 directions, gathered in .6, 1 and 1.8 of the time; dense, 2,900, is there to measure them by.
  /// Worst rms error of six hard panoramas, outdoors and indoors: small 2.0 and 3.3 %, medium 1.4 and 2.8 %, large 1.6
  /// (a forest at roughness .02; else 1.3) and 1.4 %.
  enum class Size { small, medium, large, dense };

  /// Samples padded to a multiple of 16 with ones of share 0. The local frame: z the normal, x the part of the view in
  /// the plane. ring[i]: 0 for the normal itself, k + 1 for ring k.
  Floats half_x, half_y, half_z;
  Floats share;   // 1 / samples of the ring
  Floats spread;  // times dot(v, h): the variance of the radiance's filter, rad^2
  std::vector<int> ring;

  explicit Rings(Size size = Size::medium) {
    struct Layout {
      double inner, outer, last;  // distances in ln x, and the largest x
    };
    constexpr Layout layouts[4] = {{0.72, 0.54, 6}, {0.55, 0.4, 8}, {0.35, 0.3, 8}, {0.15, 0.15, 30}};
    const Layout& l = layouts[int(size)];
    inner = l.inner;
    // Rings lie at whole numbers of a coordinate that ln x is a smooth function of: the trapezoidal rule wants it so.
    // step: d ln x by it. Half-way from the inner to the outer distance at x = .03; one Runge-Kutta step a ring.
    const auto step_at = [&](double log_x) {
      return l.outer + (l.inner - l.outer) / (1 + std::exp(2 * (log_x - std::log(0.03))));
    };
    for (double at = std::log(1e-3); at < std::log(l.last);) {
      const double a = step_at(at), b = step_at(at + a / 2), c = step_at(at + b / 2), d = step_at(at + c);
      tangent.push_back(std::exp(at));
      step.push_back(a);
      at += (a + 2 * b + 2 * c + d) / 6;
    }
    const int n = int(tangent.size());
    add(0, 0, 1, pi_ * tangent[0] * tangent[0] / 4, 0);
    for (int k = 0; k < n; ++k) {
      const double x = tangent[k], z = 1 / std::sqrt(1 + x * x);
      const int azimuths = int(2 * pi_ / step[k] + 0.5);  // as far from each other as the rings are
      const double cell = 2 * pi_ / azimuths * step[k] * x * x * z * z * z;
      for (int i = 0; i < azimuths; ++i)
        add(x, 2 * pi_ * (i + (k % 2 ? 0.5 : 0)) / azimuths, azimuths, cell, k + 1);
    }
    directions_ = int(ring.size());
    while (ring.size() % 16) add(0, 0, 0, 1, 0);
  }

  int directions() const { return directions_; }
  int padded_directions() const { return int(ring.size()); }
  int rings() const { return int(tangent.size()) + 1; }

  /// The integral of D(h) dot(n, h) over half vectors, shared out to the rings, and its slope by alpha^2. The weights
  /// sum to 1 (to 3e-4) less what lies beyond the last ring, alpha^2 / (alpha^2 + last^2) at most.
  void weights(double alpha2, double* w, double* dw) const {
    w[0] = dw[0] = 0;
    for (int k = -inner_rings; k < rings() - 1; ++k) {
      // What rings further in would have, the normal gets.
      const double x = k < 0 ? tangent[0] * std::exp(k * inner) : tangent[k], y = x * x / alpha2, over = 1 / (1 + y);
      const double here = (k < 0 ? inner : step[k]) * 2 * y * over * over, d_here = here * (y - 1) * over / alpha2;
      if (k < 0) w[0] += here, dw[0] += d_here;
      else w[k + 1] = here, dw[k + 1] = d_here;
    }
  }

private:
  static constexpr double pi_ = 3.141592653589793;
  static constexpr int inner_rings = 80;
  double inner = 0;
  std::vector<double> tangent, step;
  int directions_ = 0;

  void add(double x, double azimuth, int azimuths, double cell, int which) {
    const double z = 1 / std::sqrt(1 + x * x);
    half_x.push_back(float(x * z * std::cos(azimuth)));
    half_y.push_back(float(x * z * std::sin(azimuth)));
    half_z.push_back(float(z));
    share.push_back(azimuths ? 1 / float(azimuths) : 0);
    // A cell of half vectors is 4 dot(v, h) cells of directions. Of a cell's area a third: between the filters' gaps
    // and their reach; a quarter to a half measure alike.
    spread.push_back(float(4.0 / 3 * cell));
    ring.push_back(which);
  }
};

}  // namespace burnish
