// burnish/math/sh.h -- real spherical harmonics
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/math/vec.h>

namespace burnish {

namespace detail {
constexpr double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }
/// sqrt((2l + 1) / 4 pi (l - m)! / (l + m)!), and times sqrt(2) for m > 0.
constexpr float sh_norm(int l, int m) {
  const double k = (2 * l + 1) / (4 * 3.14159265358979324) * factorial(l - m) / factorial(l + m);
  return float(constant::sqrt(m > 0 ? 2 * k : k));
}
}  // namespace detail

/// How many harmonics the bands 0..order have.
constexpr int sh_count(int order) { return (order + 1) * (order + 1); }

/// The real harmonics of bands 0..Order at a unit direction, in the order l (l + 1) + m; orthonormal over the sphere,
/// in 1 / sqrt(sr). Signs without the Condon-Shortley phase, poles on z: band 1 is 0.4886 (y, z, x). They are
/// polynomials in the direction, given here for any vector without being normalised; the slopes are those of the
/// polynomials (Green 2003; the recurrences over l and m of the associated Legendre functions).
template <int Order, class T>
constexpr std::array<T, std::size_t(sh_count(Order))> spherical_harmonics(const vec3<T>& d) {
  static_assert(Order >= 0 && Order <= 8, "burnish: spherical_harmonics knows the bands 0 to 8");
  std::array<T, std::size_t(sh_count(Order))> y{};
  T c = T(1.0f), s = T(0.0f);  // sin^m(theta) cos(m phi), sin^m(theta) sin(m phi)
  float diagonal = 1;          // P(m, m) / sin^m(theta), without the phase
  for (int m = 0; m <= Order; ++m) {
    T below = T(0.0f), p = T(diagonal);
    for (int l = m; l <= Order; ++l) {
      const T k = p * detail::sh_norm(l, m);
      y[std::size_t(l * (l + 1) + m)] = k * c;
      if (m > 0) y[std::size_t(l * (l + 1) - m)] = k * s;
      const T next = d.z * p * (float(2 * l + 1) / float(l - m + 1)) - below * (float(l + m) / float(l - m + 1));
      below = p;
      p = next;
    }
    diagonal *= float(2 * m + 1);
    const T turned = c * d.x - s * d.y;
    s = c * d.y + s * d.x;
    c = turned;
  }
  return y;
}

/// sum of coefficients[i] harmonic[i] at a unit direction; a coefficient is a number or a vec3.
template <int Order, class T, class C>
constexpr C sh_sum(const std::array<C, std::size_t(sh_count(Order))>& coefficients, const vec3<T>& d) {
  const auto y = spherical_harmonics<Order>(d);
  C sum = coefficients[0] * y[0];
  for (std::size_t i = 1; i < y.size(); ++i) sum += coefficients[i] * y[i];
  return sum;
}

}  // namespace burnish
