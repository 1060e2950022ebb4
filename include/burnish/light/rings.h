// burnish/light/rings.h -- fixed half vectors on which every GGX roughness is integrated at once
// SPDX-License-Identifier: Apache-2.0
//
// Half vectors lie on rings of constant x = tan(theta_h), plus the normal itself. A ring's weight is what its hat
// function in ln x gathers of the GGX distribution: a second difference of F(x) = 1/2 ln(1 + x^2 / alpha^2), in closed
// form with its slope by roughness. The directions do not depend on the roughness, so one gather of radiance serves
// every roughness, and the slope by it is exact.
#pragma once
#include <cmath>
#include <vector>
#include <burnish/scene/image.h>

namespace burnish {

class Rings {
public:
  /// 183, 321 or 607 directions; dense, 13,000, is there to measure the others by.
  enum class Size { small, medium, large, dense };

  /// Samples padded to a multiple of 16 with ones of share 0. The local frame: z the normal, x the part of the view in
  /// the plane. ring[i]: 0 for the normal itself, k + 1 for ring k.
  Floats half_x, half_y, half_z;
  Floats share;   // 1 / samples of the ring
  Floats spread;  // times dot(v, h): the variance of the radiance's filter, rad^2
  std::vector<int> ring;

  explicit Rings(Size size = Size::medium) {
    struct Zone {
      double end, ratio;
      int azimuths;
    };
    struct Layout {
      double first, last;
      Zone zone[3];
    };
    constexpr Layout layouts[4] = {{1e-3, 7, {{0.01, 2, 6}, {0.1, 1.8, 8}, {1e9, 1.6, 14}}},
                                   {1e-3, 7, {{0.01, 2, 8}, {0.06, 1.6, 12}, {1e9, 1.45, 18}}},
                                   {5e-4, 8, {{0.01, 1.6, 10}, {0.06, 1.4, 16}, {1e9, 1.3, 24}}},
                                   {1e-3, 40, {{0.1, 1.2, 32}, {0.3, 1.1, 64}, {1e9, 1.05, 128}}}};
    const Layout& l = layouts[int(size)];
    std::vector<int> azimuths;
    for (double x = l.first;;) {
      const Zone& z = x < l.zone[0].end ? l.zone[0] : x < l.zone[1].end ? l.zone[1] : l.zone[2];
      tangent.push_back(x);
      azimuths.push_back(z.azimuths);
      if (x >= l.last) break;
      x *= z.ratio;
    }
    const int n = int(tangent.size());
    add(0, 0, 1, pi_ * tangent[0] * tangent[0] / 4, 0);
    for (int k = 0; k < n; ++k) {
      const double x = tangent[k], z = 1 / std::sqrt(1 + x * x);
      const double low = std::log(tangent[std::max(k - 1, 0)]), high = std::log(tangent[std::min(k + 1, n - 1)]);
      const double width = (high - low) / (k == 0 || k == n - 1 ? 1 : 2),
                   cell = 2 * pi_ / azimuths[k] * x * x * width * z * z * z;
      for (int i = 0; i < azimuths[k]; ++i)
        add(x, 2 * pi_ * (i + (k % 2 ? 0.5 : 0)) / azimuths[k], azimuths[k], cell, k + 1);
    }
    directions_ = int(ring.size());
    while (ring.size() % 16) add(0, 0, 0, 1, 0);
  }

  int directions() const { return directions_; }
  int padded_directions() const { return int(ring.size()); }
  int rings() const { return int(tangent.size()) + 1; }

  /// The integral of D(h) dot(n, h) over half vectors, shared out to the rings, and its slope by alpha^2. The weights
  /// sum to 1.
  void weights(double alpha2, double* w, double* dw) const {
    const int n = int(tangent.size());
    const double y = tangent[0] * tangent[0] / alpha2, u = y / (1 + y), du = -u / ((1 + y) * alpha2);
    // Within the first ring the hat is linear in x^2; the series keeps what cancels when the lobe is far wider.
    const bool narrow = y < 1e-3;
    const double inner = narrow ? y / 2 - y * y * (2.0 / 3) : (std::log1p(y) - u) / y;
    const double d_inner = -y / alpha2 * (narrow ? 0.5 - y * (4.0 / 3) : (u * u / y - inner) / y);
    w[0] = u - inner, dw[0] = du - d_inner;
    double before = w[0], d_before = dw[0];
    for (int k = 0; k < n; ++k) {
      double slope = 1, d_slope = 0;
      if (k + 1 < n) {
        const double a = tangent[k] * tangent[k], b = tangent[k + 1] * tangent[k + 1],
                     d = 0.5 / std::log(tangent[k + 1] / tangent[k]);
        slope = d * (std::log1p(b / alpha2) - std::log1p(a / alpha2));
        d_slope = -d / alpha2 * (b / (alpha2 + b) - a / (alpha2 + a));
      }
      w[k + 1] = slope - before, dw[k + 1] = d_slope - d_before;
      before = slope, d_before = d_slope;
    }
  }

private:
  static constexpr double pi_ = 3.141592653589793;
  std::vector<double> tangent;
  int directions_ = 0;

  void add(double x, double azimuth, int azimuths, double cell, int which) {
    const double z = 1 / std::sqrt(1 + x * x);
    half_x.push_back(float(x * z * std::cos(azimuth)));
    half_y.push_back(float(x * z * std::sin(azimuth)));
    half_z.push_back(float(z));
    share.push_back(azimuths ? 1 / float(azimuths) : 0);
    spread.push_back(
        float(1.6 * 4 / 12 * cell));  // a cell of half vectors is 4 dot(v, h) cells of directions; 1.6 measured
    ring.push_back(which);
  }
};

}  // namespace burnish
