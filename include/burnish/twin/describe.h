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
inline void check_photo(const Mask& vehicle, const Image& photo) {
  if (vehicle.width != photo.width || vehicle.height != photo.height)
    throw Error("mask of " + std::to_string(vehicle.width) + " x " + std::to_string(vehicle.height) + ", photo of " +
                std::to_string(photo.width) + " x " + std::to_string(photo.height) + ": they must agree");
}
/// A photo cut to the vehicle with some room about it, no larger than the grid needs, its values made even to the eye.
struct Cutout {
  Mask mask;
  Image image;
  Rectangle box;

  Cutout() = default;
  Cutout(const Mask& vehicle, const Image& photo) {
    check_photo(vehicle, photo);
    const Rectangle f = rectangle_of(vehicle);
    const int x0 = std::max(0, int(f.x0) - 4), y0 = std::max(0, int(f.y0) - 4),
              w = std::min(vehicle.width, int(f.x1) + 4) - x0, h = std::min(vehicle.height, int(f.y1) + 4) - y0;
    mask = cropped(vehicle, x0, y0, w, h), image = cropped(photo, x0, y0, w, h);
    const float much =
        std::max(1.0f, std::min(float(w) / (1.5f * SightGrid::width), float(h) / (1.5f * SightGrid::height)));
    const int small_w = int(std::lround(float(w) / much)), small_h = int(std::lround(float(h) / much));
    if (much > 1) mask = resized(mask, small_w, small_h), image = resized(image, small_w, small_h);
    const float sx = float(mask.width) / float(w), sy = float(mask.height) / float(h);
    box = {(f.x0 - float(x0)) * sx, (f.y0 - float(y0)) * sy, (f.x1 - float(x0)) * sx, (f.y1 - float(y0)) * sy};
    for (float& v : image.values) v = std::sqrt(std::clamp(v, 0.0f, 1.0f));
  }
  /// The same turned by an angle (rad) about its middle, with the box of the turned mask.
  Cutout turned(float angle) const {
    if (angle == 0) return *this;
    const float c = std::cos(angle), s = std::sin(angle), w = float(mask.width), h = float(mask.height);
    const int more = int(std::ceil(0.5f * std::abs(s) * std::max(w, h))) + 1;
    Cutout out;
    out.mask = Mask(mask.width + 2 * more, mask.height + 2 * more), out.image = Image(out.mask.width, out.mask.height);
    for (int y = 0; y < out.mask.height; ++y)
      for (int x = 0; x < out.mask.width; ++x) {
        const float u = float(x - more) + 0.5f - 0.5f * w, v = float(y - more) + 0.5f - 0.5f * h;
        const float px = c * u - s * v + 0.5f * w - 0.5f, py = s * u + c * v + 0.5f * h - 0.5f;
        const int i = int(std::floor(px)), j = int(std::floor(py));
        const float a = px - float(i), b = py - float(j);
        vec3<float> color;
        for (int k = 0; k < 4; ++k) {
          const float part = (k & 1 ? a : 1 - a) * (k & 2 ? b : 1 - b);
          const int x1 = i + (k & 1), y1 = j + (k >> 1);
          if (x1 >= 0 && x1 < mask.width && y1 >= 0 && y1 < mask.height) out.mask.at(x, y) += part * mask.at(x1, y1);
          color = color + image.at(std::clamp(x1, 0, mask.width - 1), std::clamp(y1, 0, mask.height - 1)) * part;
        }
        out.image.set(x, y, color);
      }
    out.box = rectangle_of(out.mask);
    return out;
  }
  Sight sight(const Rectangle& at) const {
    return sight_of(
        mask, at, 3, [&](int c, int x, int y) { return image.plane(c)[std::size_t(y * image.width + x)]; }, 0.02f);
  }
};
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
      mask, rectangle_of(mask), planes, [&](int c, int x, int y) { return values[std::size_t(c)].at(x, y); }, 0.1f);
}
}  // namespace detail

/// A vehicle in a photo: view_numbers floats of unit length. The mask has the photo's size. Error where it is empty or
/// of another size.
inline std::vector<float> describe(const Mask& vehicle, const Image& photo) {
  const detail::Cutout cutout(vehicle, photo);
  return detail::numbers_of(cutout.sight(cutout.box), {}).numbers;
}

/// A vehicle as a G-buffer shows it.
inline std::vector<float> describe(const GBuffer& seen) {
  return detail::numbers_of(detail::sight_of(seen), {}).numbers;
}

struct ViewOptions {
  int azimuths = 48;                                           ///< all round, both sides
  std::vector<float> elevations = {0.02f, 0.14f, 0.26f, 0.4f};  ///< rad
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

/// A model from all round. Error where a view shows nothing of it.
inline DescribedViews describe_views(const Raycaster& scene, const ViewOptions& options = {}) {
  DescribedViews out;
  for (const float elevation : options.elevations)
    for (int k = 0; k < options.azimuths; ++k)
      out.azimuth.push_back(2 * pi * float(k) / float(options.azimuths)), out.elevation.push_back(elevation);
  out.rows.resize(std::size_t(out.size()) * view_numbers);
  const Box box = bounds(scene.mesh());
  parallel_for(out.size(), [&](int i) {
    const std::size_t k = std::size_t(i);
    const Camera camera = view_camera(box, out.azimuth[k], out.elevation[k], options);
    const std::vector<float> row = describe(scene.trace(camera, 1));
    std::copy(row.begin(), row.end(), out.rows.begin() + std::ptrdiff_t(k * view_numbers));
  });
  return out;
}

}  // namespace burnish
