// burnish/street/fisheye.h -- lenses that see half the sphere and more: from a direction to a pixel and back
// SPDX-License-Identifier: Apache-2.0
//
// Camera frame of all lenses, as their sources have it: x right, y down, z along the axis. Pixels as in scene/camera.h:
// the first pixel's centre is (0.5, 0.5); the readers (io/fisheye.h) add the half that files leave out. Everything is
// smooth but on the axis behind the lens. What a lens cannot see still gives numbers; sees() tells.
#pragma once
#include <burnish/ad/model.h>
#include <burnish/math/vec.h>

namespace burnish {

namespace detail {
/// sqrt that has a slope at zero.
template <class T> constexpr T safe_length(const T& x, const T& y) { return sqrt(x * x + y * y + 1e-30f); }
}  // namespace detail

/// A lens that is the same all round its axis: the distance from the middle of the picture is a polynomial in the angle
/// theta from the axis, r = c1 theta + c2 theta^2 + ... + c9 theta^9, in units of fx and fy. With other numbers it is
/// Kannala and Brandt (2006), as OpenCV's fisheye has it: c = 1, 0, k1, 0, k2, 0, k3, 0, k4; fx, fy in pixels;
/// the polynomial of WoodScape (Yogamani et al. 2019): c1 .. c4 in pixels, fx = 1, fy the aspect ratio;
/// the equidistant lens: c1 = 1, fx = fy in pixels per radian; and Hugin's circular fisheye with its a, b, c.
template <class T> struct RadialFisheye {
  std::array<T, 9> c{T(1.0f)};
  T fx = 300.0f, fy = 300.0f, cx = 500.0f, cy = 500.0f;
  float widest = 1.6f;  ///< rad: r grows up to here, and here the picture ends

  static constexpr auto parameters() {
    return std::tuple{Param{"c", &RadialFisheye::c}, Param{"fx", &RadialFisheye::fx}, Param{"fy", &RadialFisheye::fy},
                      Param{"cx", &RadialFisheye::cx}, Param{"cy", &RadialFisheye::cy}, Fixed{&RadialFisheye::widest}};
  }
  /// The distance from the middle at an angle.
  constexpr T radius(const T& theta) const {
    T r = c[8];
    for (std::size_t i = 8; i-- > 0;) r = r * theta + c[i];
    return r * theta;
  }
  constexpr T slope(const T& theta) const {
    T r = c[8] * 9.0f;
    for (std::size_t i = 8; i-- > 0;) r = r * theta + c[i] * float(i + 1);
    return r;
  }
  /// A direction of any length but zero to a pixel.
  constexpr vec2<T> project(const vec3<T>& d) const {
    const T side = detail::safe_length(d.x, d.y), scale = radius(atan2(side, d.z)) / side;
    return {fx * scale * d.x + cx, fy * scale * d.y + cy};
  }
  /// A pixel to a unit direction: Newton's way from the equidistant lens, which converges where r grows.
  constexpr vec3<T> unproject(const vec2<T>& pixel) const {
    const T x = (pixel.x - cx) / fx, y = (pixel.y - cy) / fy, r = detail::safe_length(x, y);
    T theta = min(r / c[0], widest);
    for (int step = 0; step < 12; ++step) {
      // Held to where r grows: there it has one answer.
      theta = clamp(theta - (radius(theta) - r) / max(slope(theta), 1e-6f * c[0]), 0.0f, 1.02f * widest);
    }
    const T s = sin(theta) / r;
    return {x * s, y * s, cos(theta)};
  }
  template <class U> constexpr bool sees(const vec3<U>& d) const {
    return float(atan2(detail::safe_length(d.x, d.y), d.z)) <= widest;
  }
};

/// The unified model for central catadioptric and fisheye cameras with distortion (Mei and Rives 2007), as KITTI-360
/// has it: a point of the unit sphere is seen from xi behind its middle, distorted, and laid on pixels.
template <class T> struct MeiFisheye {
  T xi = 2.2f, k1 = 0.0f, k2 = 0.0f, p1 = 0.0f, p2 = 0.0f;
  T fx = 1300.0f, fy = 1300.0f, cx = 700.0f, cy = 700.0f;  ///< gamma1, gamma2, u0, v0
  float widest = 1.65f;  ///< rad, off the axis: where the picture ends; the model itself ends at cos = -1 / xi

  static constexpr auto parameters() {
    return std::tuple{Param{"xi", &MeiFisheye::xi}, Param{"k1", &MeiFisheye::k1}, Param{"k2", &MeiFisheye::k2},
                      Param{"p1", &MeiFisheye::p1}, Param{"p2", &MeiFisheye::p2}, Param{"fx", &MeiFisheye::fx},
                      Param{"fy", &MeiFisheye::fy}, Param{"cx", &MeiFisheye::cx}, Param{"cy", &MeiFisheye::cy},
                      Fixed{&MeiFisheye::widest}};
  }
  constexpr vec2<T> distorted(const vec2<T>& m) const {
    const T r2 = m.x * m.x + m.y * m.y, radial = 1.0f + r2 * (k1 + r2 * k2), xy = m.x * m.y;
    return {m.x * radial + 2.0f * p1 * xy + p2 * (r2 + 2.0f * m.x * m.x),
            m.y * radial + 2.0f * p2 * xy + p1 * (r2 + 2.0f * m.y * m.y)};
  }
  constexpr vec2<T> project(const vec3<T>& d) const {
    const vec3<T> u = normalize(d);
    const vec2<T> m = distorted({u.x / (u.z + xi), u.y / (u.z + xi)});
    return {fx * m.x + cx, fy * m.y + cy};
  }
  /// Newton's way on both coordinates of the distortion, then the sphere.
  constexpr vec3<T> unproject(const vec2<T>& pixel) const {
    const vec2<T> want((pixel.x - cx) / fx, (pixel.y - cy) / fy);
    vec2<T> m = want;
    // What a strong distortion pushed out is begun at where its cubic root lies, nearly.
    const T far = detail::safe_length(want.x, want.y);
    const T begin = far / (1.0f + 0.5f * far * far * max(k1 + far * far * k2, 0.0f));
    m = {want.x * begin / far, want.y * begin / far};
    for (int step = 0; step < 16; ++step) {
      const T r2 = m.x * m.x + m.y * m.y, radial = 1.0f + r2 * (k1 + r2 * k2), by = 2.0f * (k1 + 2.0f * r2 * k2);
      const T a = radial + by * m.x * m.x + 2.0f * p1 * m.y + 6.0f * p2 * m.x;
      const T b = by * m.x * m.y + 2.0f * p1 * m.x + 2.0f * p2 * m.y;
      const T e = radial + by * m.y * m.y + 2.0f * p2 * m.x + 6.0f * p1 * m.y;
      const vec2<T> at = distorted(m);
      const T x = at.x - want.x, y = at.y - want.y, det = a * e - b * b;
      m = {m.x - (e * x - b * y) / det, m.y - (a * y - b * x) / det};
    }
    const T r2 = m.x * m.x + m.y * m.y;
    const T eta = (xi + sqrt(max(1.0f + (1.0f - xi * xi) * r2, 1e-12f))) / (r2 + 1.0f);
    return {eta * m.x, eta * m.y, eta - xi};
  }
  template <class U> constexpr bool sees(const vec3<U>& d) const {
    const float z = float(d.z) / float(length(d));
    return float(atan2(detail::safe_length(d.x, d.y), d.z)) <= widest && (float(xi) <= 1 || z > -1 / float(xi));
  }
};

}  // namespace burnish
