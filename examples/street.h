// examples/street.h -- a street photo and what belongs to it: read and checked before any work is done
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>
#include <burnish/io/mesh.h>
#include "settings.h"
#include "vehicle_parts.h"

namespace street {
using namespace burnish;
using parts::Role;

inline constexpr const char* usual_photo = "/usr/share/darknet/data/dog.jpg";

struct Options : fitting::Settings {
  std::string photo = usual_photo, mask, parts, camera;
  std::string vehicle = "/usr/share/sweethome3d/furniture/Scopia.sh3f:scopia/suv/suv.obj";
  std::string environment = "/usr/share/blender/datafiles/studiolights/world/city.exr";
  std::string output = "burnish-fit", resume;
  std::vector<std::string> roles;
  int threads = 0;
};

void add_options(CLI::App& app, Options& o);
/// Fills in what was not given. data: the folder with the masks and the camera of the default photo.
void complete(Options& o, const std::string& data);

Mask both(Mask a, const Mask& b);
/// The mask less the tenth of its pixels that is brightest and the tenth that is darkest.
Mask without_extremes(const Image& image, Mask mask);

struct Photo {
  Image image;             // as the camera developed it: sRGB values 0 to 1
  Mask vehicle;            // 0 to 1
  std::vector<int> label;  // of each pixel: 1 paint, 2 glass, 3 rubber, 4 other, 0 not the vehicle; empty: not known

  /// The window that the vehicle is in, made smaller by a factor.
  Photo window(int x, int y, int w, int h, const Camera& camera) const {
    Photo p{resized(cropped(image, x, y, w, h), camera.width, camera.height),
            resized(cropped(vehicle, x, y, w, h), camera.width, camera.height),
            {}};
    for (int i = 0; i < camera.width * camera.height && !label.empty(); ++i) {
      const int px = x + (i % camera.width * 2 + 1) * w / (2 * camera.width),
                py = y + (i / camera.width * 2 + 1) * h / (2 * camera.height);
      const bool inside = px >= 0 && px < image.width && py >= 0 && py < image.height;
      p.label.push_back(inside ? label[std::size_t(py) * std::size_t(image.width) + std::size_t(px)] : 0);
    }
    return p;
  }
  Mask of(Role role) const {
    if (label.empty()) return role == Role::paint ? vehicle : Mask(vehicle.width, vehicle.height);
    Mask m = vehicle;
    for (std::size_t i = 0; i < label.size(); ++i) m.values[i] *= label[i] == int(role) + 1 ? 1.0f : 0.0f;
    return m;
  }
};
/// Labels for a photo that has none: paint is what of_one_color leaves, the rest of the vehicle is other. paint: where
/// the model has its paint. Gives a sentence that says so.
std::string label_by_color(Photo& photo, const Mask& paint);
struct Inputs {
  Photo photo;
  Camera camera;
  Image panorama;
  Mesh mesh;
  MeshReport report;
  std::vector<GivenKind> roles;
};
/// Error for whatever is wrong with any of it.
Inputs read(const Options& o);

}  // namespace street
