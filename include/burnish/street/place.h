// burnish/street/place.h -- a vehicle put somewhere on a level ground, and a camera above it
// SPDX-License-Identifier: Apache-2.0
//
// World: metres, +Y up, the ground at y = 0; the camera stands above the origin and looks along -Z, +X to its right, as
// the panoramas of light/environment.h do.
#pragma once
#include <array>
#include <cmath>
#include <burnish/scene/camera.h>
#include <burnish/scene/mesh.h>

namespace burnish {

/// Where a vehicle stands: its middle on the ground, and where its front points.
struct Placement {
  float right = 0, ahead = 8;  ///< metres, as the camera sees it
  float heading = 0;           ///< rad: 0 points away from the camera, pi/2 to its right
  float height = 0;            ///< metres, of the ground there
  float scale = 1;

  /// A point of the vehicle's own frame (scene/vehicle.h) to the world.
  vec3<float> operator()(const vec3<float>& p) const {
    return turn(p * scale) + vec3<float>(right, height, -ahead);
  }
  vec3<float> turn(const vec3<float>& d) const {
    // The front, (1, 0, 0), goes to (s, 0, -c), the right side, (0, 0, 1), to (c, 0, s).
    const float s = std::sin(heading), c = std::cos(heading);
    return {s * d.x + c * d.z, d.y, -c * d.x + s * d.z};
  }
};
inline Mesh placed(Mesh mesh, const Placement& place) {
  for (vec3<float>& p : mesh.positions) p = place(p);
  for (vec3<float>& n : mesh.normals) n = place.turn(n);
  return mesh;
}

/// A camera that many metres above the ground, its axis turned down by pitch, turned clockwise by roll, rad.
inline Camera street_camera(float focal, float cx, float cy, int width, int height, float above, float pitch = 0,
                            float roll = 0) {
  Camera c = Camera::pinhole(focal, focal, cx, cy, width, height);
  const vec3<float> eye(0, above, 0), to(0, above - std::sin(pitch), -std::cos(pitch));
  c.aim(eye, to, {std::sin(roll), std::cos(roll), 0});
  return c;
}
/// Where a pixel's ray meets the ground; false above the horizon.
inline bool on_ground(const Camera& camera, float x, float y, vec3<float>& place) {
  const Ray ray = camera.ray(x, y);
  if (ray.direction.y > -1e-4f) return false;
  place = ray.origin + ray.direction * (-ray.origin.y / ray.direction.y);
  return true;
}

/// A box about a vehicle, as KITTI's labels have it: in the camera's frame, x right, y down, z ahead, metres.
struct LabelBox {
  float height = 0, width = 0, length = 0;
  vec3<float> bottom;      ///< the middle of its bottom face
  float rotation_y = 0;    ///< rad about y; 0: the front points along x
  float alpha = 0;         ///< rotation_y less the direction it is seen in
};
/// size: of the vehicle in its own frame, metres: x length, y height, z width. For a camera without roll; a pitch is
/// taken into the place, not into the angles, as KITTI's labels do.
inline LabelBox label_box(const vec3<float>& size, const Placement& place, const Camera& camera) {
  LabelBox b;
  b.height = size.y * place.scale, b.width = size.z * place.scale, b.length = size.x * place.scale;
  const vec3<float> d = place({0, 0, 0}) - camera.position;
  b.bottom = {dot(d, camera.right), dot(d, camera.down), dot(d, camera.forward)};
  const vec3<float> front = place.turn({1, 0, 0});
  const auto wrapped = [](float a) { return std::remainder(a, 6.2831853f); };
  b.rotation_y = wrapped(std::atan2(-dot(front, camera.forward), dot(front, camera.right)));
  b.alpha = wrapped(b.rotation_y - std::atan2(b.bottom.x, b.bottom.z));
  return b;
}

}  // namespace burnish
