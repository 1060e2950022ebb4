// burnish/twin/describe.h -- a vehicle as it is seen, from a photo or from a mesh, as one unit vector
// SPDX-License-Identifier: Apache-2.0
//
// Both kinds of picture land in one space and are compared by cosine. A vector holds the edges' directions (the outline
// and what lies inside), the mask, and the shape of the mask's box.
#pragma once
#include <span>
#include <burnish/scene/raycast.h>
#include <burnish/twin/pose.h>
#include <burnish/twin/sight.h>

namespace burnish {

namespace detail {
inline Sight sight_of(const Mask& vehicle, const Image& photo, const Frame& box) {
  return sight_of(
      vehicle, box, 3,
      [&](int c, int x, int y) {
        return std::sqrt(std::clamp(photo.plane(c)[std::size_t(y * photo.width + x)], 0.0f, 1.0f));
      },
      0.02f);
}
/// Its edges are where normal, depth or part change.
inline Sight sight_of(const GBuffer& seen) {
  const Mask mask = seen.frame("coverage");
  constexpr int planes = 7;
  std::array<Mask, planes> values;
  for (Mask& m : values) m = Mask(seen.width, seen.height);
  for (int i = 0; i < seen.size(); ++i) {
    const std::size_t p = std::size_t(seen.pixel[std::size_t(i)]), k = std::size_t(i);
    for (std::size_t c = 0; c < 3; ++c) values[c].values[p] = 0.5f * seen.plane[3 + c][k];
    const auto material = unsigned(seen.parts[std::size_t(seen.part[k])].material_index) * 2654435761u;
    for (std::size_t c = 0; c < 3; ++c) values[3 + c].values[p] = float((material >> (8 * c + 4)) & 255u) / 255.0f;
    values[6].values[p] = seen.plane[GBuffer::depth][k];
  }
  return sight_of(
      mask, frame_of(mask), planes, [&](int c, int x, int y) { return values[std::size_t(c)].at(x, y); }, 0.1f);
}
inline void check_photo(const Mask& vehicle, const Image& photo) {
  if (vehicle.width != photo.width || vehicle.height != photo.height)
    throw Error("mask of " + std::to_string(vehicle.width) + " x " + std::to_string(vehicle.height) + ", photo of " +
                std::to_string(photo.width) + " x " + std::to_string(photo.height) + ": they must agree");
}
}  // namespace detail

/// A vehicle in a photo: view_numbers floats of unit length. The mask has the photo's size. Error where it is empty or
/// of another size.
inline std::vector<float> describe(const Mask& vehicle, const Image& photo) {
  detail::check_photo(vehicle, photo);
  return detail::numbers_of(detail::sight_of(vehicle, photo, detail::frame_of(vehicle)), {}).numbers;
}

/// A vehicle as a G-buffer shows it.
inline std::vector<float> describe(const GBuffer& seen) {
  return detail::numbers_of(detail::sight_of(seen), {}).numbers;
}

struct ViewOptions {
  int azimuths = 36;                                     ///< all round, both sides
  std::vector<float> elevations = {0.03f, 0.16f, 0.35f};  ///< rad
  float distance = 2.5f;                                 ///< of the camera, in diagonals of the vehicle's box
  int pixels = 160;                                      ///< the longer side of the picture, filled by the vehicle
};
/// Views of one model.
struct DescribedViews {
  std::vector<float> rows;                // size() x view_numbers
  std::vector<float> azimuth, elevation;  // rad, as in Pose
  int size() const { return int(azimuth.size()); }
  std::span<const float> row(int i) const { return {rows.data() + std::size_t(i) * view_numbers, view_numbers}; }
};

/// The camera of one of those views: the vehicle's box fills the picture.
inline Camera view_camera(const Box& box, float azimuth, float elevation, const ViewOptions& options = {}) {
  Pose<float> pose;
  pose.azimuth = azimuth, pose.elevation = elevation, pose.center = box.center();
  pose.distance = options.distance * length(box.size());
  pose.width = pose.height = options.pixels, pose.focal = 1;
  float x0 = 1e9f, y0 = 1e9f, x1 = -1e9f, y1 = -1e9f;
  for (int k = 0; k < 8; ++k) {
    const vec3<float> p = pose.project(
        {k & 1 ? box.low.x : box.high.x, k & 2 ? box.low.y : box.high.y, k & 4 ? box.low.z : box.high.z});
    x0 = std::min(x0, p.x), x1 = std::max(x1, p.x), y0 = std::min(y0, p.y), y1 = std::max(y1, p.y);
  }
  const float scale = float(options.pixels - 2) / std::max(x1 - x0, y1 - y0);
  Camera c = pose.camera();
  c.fx *= scale, c.fy *= scale;
  c.width = int(std::ceil((x1 - x0) * scale)) + 2, c.height = int(std::ceil((y1 - y0) * scale)) + 2;
  c.cx = 0.5f * float(c.width) - (0.5f * (x0 + x1) - pose.project(pose.center).x) * scale;
  c.cy = 0.5f * float(c.height) - (0.5f * (y0 + y1) - pose.project(pose.center).y) * scale;
  return c;
}

/// A model from all round.
inline DescribedViews describe_views(const Raycaster& scene, const ViewOptions& options = {}) {
  DescribedViews out;
  for (const float elevation : options.elevations)
    for (int k = 0; k < options.azimuths; ++k)
      out.azimuth.push_back(2 * pi * float(k) / float(options.azimuths)), out.elevation.push_back(elevation);
  out.rows.resize(std::size_t(out.size()) * view_numbers);
  const Box box = bounds(scene.mesh());
  parallel_for(out.size(), [&](int i) {
    const std::size_t k = std::size_t(i);
    const std::vector<float> row = describe(scene.trace(view_camera(box, out.azimuth[k], out.elevation[k], options), 1));
    std::copy(row.begin(), row.end(), out.rows.begin() + std::ptrdiff_t(k * view_numbers));
  });
  return out;
}

}  // namespace burnish
