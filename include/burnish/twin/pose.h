// burnish/twin/pose.h -- where the photo's camera stood, seen from the vehicle, as numbers that can be fitted
// SPDX-License-Identifier: Apache-2.0
//
// The vehicle's frame: x ahead, y up, metres. Pixels as in scene/camera.h.
#pragma once
#include <burnish/ad/model.h>
#include <burnish/math/vec.h>
#include <burnish/scene/camera.h>

namespace burnish {

/// A camera that looks from a distance at a place of the vehicle, `center`. All is smooth but for elevation +-pi/2,
/// where azimuth and roll become one turn.
template <class T> struct Pose {
  T azimuth = 0.0f;    ///< rad: 0 sees the front, pi/2 the right side (+z), -pi/2 the left
  T elevation = 0.1f;  ///< rad above the horizon
  T roll = 0.0f;       ///< rad about the view axis; the picture's up turns to its right
  T distance = 8.0f;   ///< metres along the view axis to the plane in which the center lies
  T right = 0.0f;      ///< where the center is seen: tangents of the angles to the right of the axis
  T down = 0.0f;       ///< and below it
  T focal = 1.0f;      ///< in widths of the picture
  vec3<float> center = {0, 0.75f, 0};  ///< metres
  int width = 0, height = 0;           ///< of the picture, pixels; the principal point lies in its middle

  static constexpr auto parameters() {
    return std::tuple{Param{"azimuth", &Pose::azimuth, Range{-8, 8}},
                      Param{"elevation", &Pose::elevation, Range{-0.5f, 1.5f}},
                      Param{"roll", &Pose::roll, Range{-0.6f, 0.6f}},
                      Param{"distance", &Pose::distance, Range{1, 200}},
                      Param{"right", &Pose::right, Range{-2, 2}},
                      Param{"down", &Pose::down, Range{-2, 2}},
                      Param{"focal", &Pose::focal, Range{0.3f, 10}},
                      Fixed{&Pose::center},
                      Fixed{&Pose::width},
                      Fixed{&Pose::height}};
  }
  /// How far above the horizon the camera stands, seen from the center, rad: elevation is that of the view axis, which
  /// is another one where the vehicle lies above or below the picture's middle. For small rolls.
  constexpr T view_elevation() const { return elevation + atan2(down, T(1.0f)); }
  /// The camera's axes in the vehicle's frame.
  struct Axes {
    vec3<T> right, down, forward;
  };
  constexpr Axes axes() const {
    const T ca = cos(azimuth), sa = sin(azimuth), ce = cos(elevation), se = sin(elevation), cr = cos(roll),
            sr = sin(roll);
    const vec3<T> forward(-ce * ca, -se, -ce * sa), level(sa, T(0.0f), -ca), below = cross(forward, level);
    return {level * cr - below * sr, below * cr + level * sr, forward};
  }
  /// A point of the vehicle to pixel x, pixel y and depth (metres along the view axis). Its coordinates may be any
  /// numbers of which a T is made.
  template <class X = float> constexpr vec3<T> project(const vec3<X>& point) const {
    const Axes a = axes();
    const vec3<T> p(T(point.x - center.x), T(point.y - center.y), T(point.z - center.z));
    const T z = dot(p, a.forward) + distance, f = focal * float(width);
    return {f * (dot(p, a.right) + right * distance) / z + 0.5f * float(width),
            f * (dot(p, a.down) + down * distance) / z + 0.5f * float(height), z};
  }
  constexpr vec3<T> project(const vec3<float>& point) const { return project<float>(point); }
  Camera camera() const requires std::is_same_v<T, float> {
    const Axes a = axes();
    Camera c = Camera::pinhole(focal * float(width), focal * float(width), 0.5f * float(width), 0.5f * float(height),
                               width, height);
    c.right = a.right, c.down = a.down, c.forward = a.forward;
    c.position = center - a.forward * distance - a.right * (right * distance) - a.down * (down * distance);
    return c;
  }
  /// The same view of a picture of another size and the same shape.
  constexpr Pose resized(int w, int h) const {
    Pose p = *this;
    p.width = w, p.height = h;
    return p;
  }
};

}  // namespace burnish
