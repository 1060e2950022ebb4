// burnish/street/lens.h -- a fisheye lens in its place on a rig
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>
#include <variant>
#include <burnish/street/fisheye.h>

namespace burnish {

/// One lens of a rig, and the picture that it makes or is a part of.
struct Lens {
  std::string name;
  std::variant<RadialFisheye<double>, MeiFisheye<double>> model;
  int width = 0, height = 0;  ///< of the whole picture, pixels
  /// The camera's x (right), y (down) and z (axis) in the rig's frame, the world of light/environment.h: +Y up, -Z
  /// ahead. Files that say nothing look ahead.
  std::array<vec3<double>, 3> axes{{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};

  vec3<double> to_rig(const vec3<double>& d) const { return axes[0] * d.x + axes[1] * d.y + axes[2] * d.z; }
  vec3<double> to_camera(const vec3<double>& d) const { return {dot(axes[0], d), dot(axes[1], d), dot(axes[2], d)}; }
  bool sees(const vec3<double>& d) const {
    return std::visit([&](const auto& m) { return m.sees(to_camera(d)); }, model);
  }
  vec2<double> project(const vec3<double>& d) const {
    return std::visit([&](const auto& m) { return m.project(to_camera(d)); }, model);
  }
  vec3<double> unproject(const vec2<double>& pixel) const {
    return std::visit([&](const auto& m) { return to_rig(m.unproject(pixel)); }, model);
  }
};

}  // namespace burnish
