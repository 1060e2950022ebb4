// burnish/scene/camera.h -- the pinhole camera
// SPDX-License-Identifier: Apache-2.0
//
// World: metres, +Y up, right-handed. Camera: x right, y down, z forward (OpenCV's axes). Pixels: x right, y down,
// pixel (i, j) covers [i, i + 1) x [j, j + 1), so its centre is (i + 0.5, j + 0.5); a point (x, y, z) of the camera is
// seen at (fx x / z + cx, fy y / z + cy). Where calibrations put the centre of the first pixel at (0, 0), as OpenCV's
// and KITTI's do, half a pixel is added to their cx and cy.
#pragma once
#include <cmath>
#include <burnish/math/vec.h>

namespace burnish {

struct Ray {
  vec3<float> origin, direction;  // direction: unit
};
enum class Fov { vertical, horizontal };

struct Camera {
  int width = 0, height = 0;             // pixels
  float fx = 1, fy = 1, cx = 0, cy = 0;     // pixels
  vec3<float> position;                  // metres
  /// The camera's axes in the world: the rows of world -> camera.
  vec3<float> right{1, 0, 0}, down{0, -1, 0}, forward{0, 0, -1};

  /// Where the camera stands and what it looks at; up need not be perpendicular to the view, only not along it.
  void aim(const vec3<float>& eye, const vec3<float>& target, const vec3<float>& up = {0, 1, 0}) {
    position = eye;
    forward = normalize(target - eye);
    right = normalize(cross(forward, up));
    down = cross(forward, right);
  }
  /// fov: the full angle in degrees across the height or the width; square pixels, principal point in the middle.
  static Camera look_at(const vec3<float>& eye, const vec3<float>& target, const vec3<float>& up, float fov, int width,
                        int height, Fov across = Fov::vertical) {
    const int pixels = across == Fov::vertical ? height : width;
    const float f = 0.5f * float(pixels) / std::tan(fov * 0.00872664626f);  // half an angle in degrees to radians
    Camera c = pinhole(f, f, 0.5f * float(width), 0.5f * float(height), width, height);
    c.aim(eye, target, up);
    return c;
  }
  /// From pixel intrinsics, at the origin, looking along -z; aim() places it.
  static Camera pinhole(float fx, float fy, float cx, float cy, int width, int height) {
    Camera c;
    c.width = width, c.height = height, c.fx = fx, c.fy = fy, c.cx = cx, c.cy = cy;
    return c;
  }
  /// From KITTI's rectified 3 x 4 projection, row by row (the numbers after "P2:"), P = K (1 | t). KITTI's reference
  /// camera is turned into this world: a KITTI point (x, y, z) is the world point (x, -y, -z).
  static Camera kitti(const float (&p)[12], int width, int height) {
    Camera c = pinhole(p[0], p[5], p[2] + 0.5f, p[6] + 0.5f, width, height);
    const float z = p[11], x = (p[3] - p[2] * z) / p[0], y = (p[7] - p[6] * z) / p[5];
    c.position = {-x, y, z};
    return c;
  }
  /// A point of the world to pixel x, pixel y and depth (metres along the view axis, positive in front).
  vec3<float> project(const vec3<float>& point) const {
    const vec3<float> d = point - position;
    const float z = dot(d, forward);
    return {fx * dot(d, right) / z + cx, fy * dot(d, down) / z + cy, z};
  }
  /// Through the pixel place (x, y), of depth 1 along the view axis: at position + z * toward() lies depth z.
  vec3<float> toward(float x, float y) const { return forward + right * ((x - cx) / fx) + down * ((y - cy) / fy); }
  Ray ray(float x, float y) const { return {position, normalize(toward(x, y))}; }
  /// The window of w x h pixels whose first is (x, y); it may reach beyond the picture.
  Camera cropped(int x, int y, int w, int h) const {
    Camera c = *this;
    c.width = w, c.height = h, c.cx -= float(x), c.cy -= float(y);
    return c;
  }
  /// The same view on factor times as many pixels each way.
  Camera scaled(float factor) const {
    Camera c = *this;
    c.width = int(std::lround(float(width) * factor)), c.height = int(std::lround(float(height) * factor));
    const float sx = float(c.width) / float(width), sy = float(c.height) / float(height);
    c.fx *= sx, c.cx *= sx, c.fy *= sy, c.cy *= sy;
    return c;
  }
};

}  // namespace burnish
