// burnish/twin/stretch.h -- a pose of a mesh that is made longer and higher than it is
// SPDX-License-Identifier: Apache-2.0
//
// A library has no model of every car, and the next best one is not as long or as high against its width. Fitted as it
// is, it is turned until its outline is as wide as the photo's; fitted with its proportions free, its heading is right.
#pragma once
#include <burnish/scene/mesh.h>
#include <burnish/twin/pose.h>

namespace burnish {

template <class T> struct StretchedPose {
  Pose<T> pose;
  T longer = 0.0f;  ///< logarithm of the factor along x
  T higher = 0.0f;  ///< and along y; on y = 0 all stays

  static constexpr auto parameters() {
    return std::tuple{Param{"pose", &StretchedPose::pose}, Param{"longer", &StretchedPose::longer, Range{-0.5f, 0.5f}},
                      Param{"higher", &StretchedPose::higher, Range{-0.5f, 0.5f}}};
  }
  /// A point of the mesh as it is, to pixel x, pixel y and depth.
  constexpr vec3<T> project(const vec3<float>& point) const {
    return pose.project(vec3<T>(point.x * exp(longer), point.y * exp(higher), T(point.z)));
  }
  vec3<float> factors() const requires std::is_same_v<T, float> { return {std::exp(longer), std::exp(higher), 1}; }
};

/// A camera that sees a mesh stretched by factors, in the frame of the mesh as it is: its rays are those of no pinhole
/// there, but straight.
struct StretchedCamera {
  Camera camera;
  vec3<float> factors{1, 1, 1};
  int width = camera.width, height = camera.height;
  vec3<float> position = camera.position / factors;

  Ray ray(float x, float y) const { return {position, normalize(camera.toward(x, y) / factors)}; }
  vec3<float> project(const vec3<float>& point) const { return camera.project(point * factors); }
};

/// The mesh longer, higher and wider by factors; normals stay perpendicular.
inline Mesh stretched(Mesh mesh, const vec3<float>& factors) {
  for (auto& p : mesh.positions) p = p * factors;
  for (auto& n : mesh.normals)
    if (dot(n, n) > 0) n = normalize(n / factors);
  return mesh;
}

}  // namespace burnish
