// tests/scene/camera.cpp -- projections there and back, and against calibrations worked out by hand
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include <burnish/scene/camera.h>

using namespace burnish;

namespace {
struct Foreign {  // a host's own vector
  float x, y, z;
};
}  // namespace

TEST_CASE("Camera: a ray through a pixel projects back to it", "[scene][agreement]") {
  Camera c = Camera::pinhole(700, 650, 310.5f, 250.25f, 640, 480);
  c.aim(Foreign{3, 1.5f, -4}, Foreign{0, 0.5f, 0}, Foreign{0.1f, 1, 0});
  for (float y : {0.5f, 117.25f, 479.5f}) {
    for (float x : {0.5f, 320.0f, 639.5f}) {
      const Ray r = c.ray(x, y);
      CHECK(length(r.direction) == Approx(1).epsilon(1e-5));
      const vec3<float> p = c.project(r.origin + r.direction * 7.0f);
      CHECK(p.x == Approx(x).margin(2e-3));
      CHECK(p.y == Approx(y).margin(2e-3));
      const vec3<float> q = c.project(c.position + c.toward(x, y) * 3.0f);
      CHECK(q.z == Approx(3).epsilon(1e-5));
    }
  }
}

TEST_CASE("Camera: the axes are right, down, forward and right-handed, and up is up", "[scene][value]") {
  const Camera c = Camera::look_at({0, 0, 10}, {0, 0, 0}, {0, 1, 0}, 60, 200, 100);
  CHECK(dot(cross(c.right, c.down), c.forward) == Approx(1));
  CHECK(c.project({1, 0, 0}).x > 100);  // the world's +x lies right of the middle when looking along -z
  CHECK(c.project({0, 1, 0}).y < 50);   // up is a smaller row
  CHECK(c.project({0, 0, 0}).z == Approx(10));
}

TEST_CASE("Camera: the field of view is what fits between the edges", "[scene][value]") {
  // At 60 degrees and depth 10 the half height is 10 tan 30 degrees.
  const float half = 10 * std::tan(0.5235987756f);
  const Camera v = Camera::look_at({0, 0, 10}, {0, 0, 0}, {0, 1, 0}, 60, 200, 100);
  CHECK(v.project({0, half, 0}).y == Approx(0).margin(1e-3));
  const Camera h = Camera::look_at({0, 0, 10}, {0, 0, 0}, {0, 1, 0}, 60, 200, 100, Fov::horizontal);
  CHECK(h.project({half, 0, 0}).x == Approx(200).margin(1e-3));
}

TEST_CASE("Camera: KITTI's matrix projects as P times the point does, half a pixel on", "[scene][agreement]") {
  const float p[12] = {721.5377f, 0, 609.5593f, 44.85728f, 0, 721.5377f, 172.854f, 0.2163791f, 0, 0, 1, 0.002745884f};
  const Camera c = Camera::kitti(p, 1242, 375);
  const double x = 2.5, y = 1.2, z = 14;  // KITTI's axes: right, down, forward
  const double w = z + p[11], u = (p[0] * x + p[2] * z + p[3]) / w, v = (p[5] * y + p[6] * z + p[7]) / w;
  const vec3<float> q = c.project({float(x), float(-y), float(-z)});
  CHECK(q.x == Approx(u + 0.5).margin(2e-3));
  CHECK(q.y == Approx(v + 0.5).margin(2e-3));
  CHECK(q.z == Approx(w));
}

TEST_CASE("Camera: scaled, every point moves with the pixels", "[scene][value]") {
  const Camera c = Camera::look_at({3, 2, 5}, {0, 0, 0}, {0, 1, 0}, 40, 320, 240), d = c.scaled(2.5f);
  CHECK(d.width == 800);
  const vec3<float> point(0.3f, 0.2f, -0.4f);
  CHECK(d.project(point).x == Approx(2.5f * c.project(point).x));
  CHECK(d.project(point).y == Approx(2.5f * c.project(point).y));
}
