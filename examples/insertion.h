// examples/insertion.h -- a vehicle, a street picture and its light: read, traced, laid in, labelled, written
// SPDX-License-Identifier: Apache-2.0
//
// The vehicle stands on a level ground below the camera and is path-traced under a panorama; shadow and vehicle
// are laid into the picture (street/insert_layers.h, insert.h).
#pragma once
#include <functional>
#include <burnish/io/labels.h>
#include <burnish/io/light_field.h>
#include <burnish/io/mesh.h>
#include <burnish/io/model.h>
#include <burnish/street/insert.h>
#include "edited.h"
#include "looks.h"
#include "progress.h"

namespace insertion {
using namespace burnish;

struct Options {
  std::string twin, vehicle, materials, plate, depth, label, calibration, lights;
  std::string environment = "/usr/share/blender/datafiles/studiolights/world/city.exr";
  std::vector<float> at = {1.5f, 8}, pixel;
  float heading = 150, yaw = 0, focal = 0, above = 1.65f, pitch = 2, roll = 0, exposure = 0, wet = 0, noise = -1,
        blur = -1;
  int width = 1280, height = 0, samples = 64, threads = 0, line = 0;
  bool preview = false, noisy = false, six_lights = false;
  editing::Options edit;
};
void add_options(CLI::App& app, Options& o);

/// Everything but the vehicle's place and state.
struct Street {
  Mesh mesh;                    // as the file has it, in its own frame
  std::vector<PartKind> kinds;  // of its parts
  looks::Vehicle look{looks::first_paint(), {}, {}};
  Camera camera;
  Placement place;
  LightField<PanoramaFile> lights;  // one where there is but --environment
  PanoramaFile lit;                 // the one that sky is of
  PanoramaSampler sky;
  Image plate;
  Mask depth;  // of no size: nothing is nearer
  PlateLook found;
};

inline void read_materials(const std::string& folder, looks::Vehicle& look) {
  look.paint = read_model(folder + "/paint.json", look.paint);
  look.window = read_model(folder + "/glass.json", look.window);
  look.rubber = read_model(folder + "/rubber.json", look.rubber);
}
/// The light of the panorama that is nearest to a place, and what of the plate hangs on it. o: as read() completed it.
void light(Street& s, const Options& o, const Placement& place);
Street read(Options& o);

/// A picture with all that is true of it.
struct Shot {
  InsertLayers layers;
  Image composite;
  GBuffer g;
  Mask visible;
  SeenVehicle seen;
  LabelBox box;
};
/// progress(done, of) is told; between paths it may throw to end the work.
Shot shoot(const Street& s, const Placement& place, const editing::Options& edit, const Options& o,
           const std::function<void(int, int)>& progress);
/// The composite, its layers, mask, G-buffer and labels.
void write(const std::string& folder, const Shot& shot);

}  // namespace insertion
