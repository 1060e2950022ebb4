// burnish/twin/fingerprint.h -- whether two meshes are the same vehicle, however their files are ordered
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>
#include <burnish/scene/mesh.h>

namespace burnish {

/// Numbers of the surface of a mesh in the normalised frame (scene/vehicle.h), all in units of its length, so that its
/// scale does not count: width and height, the root of the area, the area's mean height, and roots of its central
/// moments of order 2, 4 and 6 along each axis, of order 2 + 2 by pairs. They do not change with the order of vertices,
/// triangles and parts, with their number where flat faces are divided, nor when front and rear or left and right are
/// exchanged.
inline std::vector<float> fingerprint(const Mesh& mesh) {
  const Box box = bounds(mesh);
  const double length = std::max(double(box.size().x), 1e-30);
  std::array<double, 3> mean{};
  double area = 0;
  const auto each_triangle = [&](auto use) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      std::array<std::array<double, 3>, 3> p;
      for (std::size_t k = 0; k < 3; ++k) {
        const vec3<float> v = (mesh.positions[std::size_t(mesh.triangles[t][k])] - box.center()) / float(length);
        p[k] = {v.x, v.y, v.z};
      }
      const vec3<float> c = mesh.cross_of(int(t));
      use(p, 0.5 * std::sqrt(double(dot(c, c))) / (length * length));
    }
  };
  each_triangle([&](const auto& p, double a) {
    area += a;
    for (std::size_t k = 0; k < 3; ++k) mean[k] += a * (p[0][k] + p[1][k] + p[2][k]) / 3;
  });
  if (!(area > 0)) return {};
  for (double& m : mean) m /= area;
  std::array<double, 12> moments{};
  // Dunavant 1985, degree 6: twelve points of a triangle at which a polynomial of that degree sums to its integral.
  constexpr double w[3] = {0.116786275726379, 0.050844906370207, 0.082851075618374};
  constexpr double b[3][3] = {{0.501426509658179, 0.249286745170910, 0.249286745170910},
                              {0.873821971016996, 0.063089014491502, 0.063089014491502},
                              {0.053145049844817, 0.310352451033784, 0.636502499121399}};
  constexpr std::size_t turns[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  each_triangle([&](const auto& p, double a) {
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t turn = 0; turn < (i < 2 ? 3u : 6u); ++turn) {
        std::array<double, 3> x{};
        for (std::size_t k = 0; k < 3; ++k) {
          for (std::size_t c = 0; c < 3; ++c) x[k] += b[i][turns[turn][c]] * p[c][k];
          x[k] = (x[k] - mean[k]) * (x[k] - mean[k]);
        }
        const double share = w[i] * a / area;
        for (std::size_t k = 0; k < 3; ++k) {
          moments[k] += share * x[k], moments[3 + k] += share * x[k] * x[k],
              moments[6 + k] += share * x[k] * x[k] * x[k];
          moments[9 + k] += share * x[k] * x[(k + 1) % 3];
        }
      }
  });
  std::vector<float> out{float(double(box.size().z) / length), float(double(box.size().y) / length),
                         float(std::sqrt(area)), float(mean[1])};
  for (std::size_t k = 0; k < 12; ++k)
    out.push_back(float(std::pow(moments[k], k < 3 ? 0.5 : k < 6 || k >= 9 ? 0.25 : 1.0 / 6)));
  return out;
}

/// The most that two prints of one shape differ by, in lengths of the vehicle: files are rounded, 1 mm in 4 m.
inline constexpr float same_shape_within = 2.5e-4f;
inline bool same_shape(const std::vector<float>& a, const std::vector<float>& b) {
  if (a.empty() || a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!(std::abs(a[i] - b[i]) <= same_shape_within)) return false;
  return true;
}

}  // namespace burnish
