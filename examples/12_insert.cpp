// examples/12_insert.cpp -- a twin and a street picture go in; the street with it, and its labels, come out
// SPDX-License-Identifier: Apache-2.0
//
// The vehicle stands on a level ground below the camera and is path-traced under a panorama; shadow and vehicle
// are laid into the picture (street/insert_layers.h, insert.h).
#include <burnish/io/exr.h>
#include <burnish/io/labels.h>
#include <burnish/io/mesh.h>
#include <burnish/io/model.h>
#include <burnish/io/parts.h>
#include <burnish/street/denoise.h>
#include <burnish/street/insert.h>
#include <burnish/twin/assign_parts.h>
#include "command.h"
#include "dressed.h"
#include "progress.h"

using namespace burnish;

namespace {
struct Options {
  std::string twin, vehicle, plate, depth, output = "burnish-insert";
  std::string environment = "/usr/share/blender/datafiles/studiolights/world/city.exr";
  std::vector<float> at = {1.5f, 8}, pixel, tint;
  float heading = 150, yaw = 0, focal = 0, above = 1.65f, pitch = 2, roll = 0, exposure = 0, wet = 0, noise = -1,
        blur = -1;
  int width = 1280, height = 720, samples = 64, threads = 0;
  bool preview = false, noisy = false;
};
constexpr float degree = 0.0174532925f;

struct Inputs {
  Mesh mesh;
  AssignedParts parts;
  looks::Vehicle look{looks::first_paint(), {}, {}};
};
/// The folder that 09_twin left, or a vehicle's file with a paint of the example's own.
Inputs read_inputs(const Options& o) {
  Inputs in;
  std::string path = o.vehicle;
  AssignOptions assigning;
  if (!o.twin.empty()) {
    const nlohmann::ordered_json j = parse_json(o.twin + "/twin.json");
    if (!j.contains("vehicle") || !j["vehicle"].is_string())
      throw Error(o.twin + "/twin.json: no \"vehicle\", expected what 09_twin writes");
    if (path.empty()) path = j["vehicle"].get<std::string>();
    assigning.given = read_parts(o.twin + "/parts.txt");
    in.look.paint = read_model(o.twin + "/paint.json", in.look.paint);
    in.look.window = read_model(o.twin + "/glass.json", in.look.window);
    in.look.rubber = read_model(o.twin + "/rubber.json", in.look.rubber);
  }
  in.mesh = read_vehicle(path);
  in.parts = assign_parts(Raycaster(in.mesh), assigning);
  return in;
}

int run(Options o) {
  if (o.threads > 0) set_threads(o.threads);
  if (o.twin.empty() && o.vehicle.empty())
    o.vehicle = "/usr/share/sweethome3d/furniture/Scopia.sh3f:scopia/suv/suv.obj";
  Progress whole("");
  Progress reading("read");
  const Image panorama = read_photo(o.environment);
  Image plate;
  if (!o.plate.empty()) plate = read_photo(o.plate), o.width = plate.width, o.height = plate.height;
  if (o.focal <= 0) o.focal = 0.9f * float(o.width);
  const Camera camera = street_camera(o.focal, 0.5f * float(o.width), 0.5f * float(o.height), o.width, o.height,
                                      o.above, o.pitch * degree, o.roll * degree);
  Mask depth;
  if (!o.depth.empty()) {
    const Image d = read_photo(o.depth);
    if (d.width != o.width || d.height != o.height)
      throw Error(o.depth + ": " + std::to_string(d.width) + " x " + std::to_string(d.height) +
                  " pixels, the plate has " + std::to_string(o.width) + " x " + std::to_string(o.height) +
                  ": they must agree");
    depth = Mask(d.width, d.height);
    for (int y = 0; y < d.height; ++y)
      for (int x = 0; x < d.width; ++x) depth.at(x, y) = d.at(x, y).x > 0 ? d.at(x, y).x : 1e9f;
  }
  Placement place{o.at[0], o.at[1], o.heading * degree};
  if (o.pixel.size() == 2) {
    vec3<float> foot;
    if (!on_ground(camera, o.pixel[0], o.pixel[1], foot))
      throw Error("--pixel lies above the horizon, expected a place on the ground");
    place.right = foot.x, place.ahead = -foot.z;
  }
  Inputs in = read_inputs(o);
  const vec3<float> size = bounds(in.mesh).size();
  check_writable(o.output);
  catch_interrupt();
  reading.finish(std::to_string(in.mesh.triangles.size()) + " triangles");

  const PanoramaSampler sky(panorama, o.yaw * degree);
  if (plate.width == 0) {  // what the panorama itself shows
    plate = Image(o.width, o.height);
    for (int y = 0; y < o.height; ++y)
      for (int x = 0; x < o.width; ++x)
        plate.set(x, y, sky.radiance(camera.ray(float(x) + 0.5f, float(y) + 0.5f).direction));
  }
  const PlateLook found = plate_look(plate, Mask(o.width, o.height, 1), camera, sky);
  PlateLook look = o.plate.empty() ? PlateLook{} : found;
  if (o.exposure > 0) look.exposure = vec3<float>(o.exposure);
  if (o.noise >= 0) look.noise = o.noise;
  if (o.blur >= 0) look.blur = o.blur;
  std::printf("plate          exposure %.3f %.3f %.3f, noise %.4f, blur %.2f pixels\n", double(look.exposure.x),
              double(look.exposure.y), double(look.exposure.z), double(look.noise), double(look.blur));

  const Raycaster scene(placed(in.mesh, place));
  const dressed::Dressed dress(scene, in.parts.kinds(), in.look);
  const auto material = [&](const Surfel<float>& at, int part) { return dress(part, at); };
  PathOptions options;
  options.samples = o.preview ? 4 : o.samples;
  options.bounces = o.preview ? 2 : 4;
  Progress preparing("prepare");
  const PathTracer tracer(scene, sky, material, Ground{0, o.wet}, options);
  preparing.finish("");
  Progress tracing("trace");
  InsertLayers layers = render_layers(tracer, camera, depth, true, [&](int done, int of) { tracing.show(done, of); });
  tracing.finish(std::to_string(options.samples) + " paths a pixel");
  if (!o.noisy) {
    Progress cleaning("denoise");
    denoise(layers, features(scene, material, camera), o.preview ? 4 : 6);
    cleaning.finish("");
  }
  Progress writing("write");
  match_look(layers, look);
  const Image out = composite(plate, layers, look.exposure);
  // What is true.
  const GBuffer g = scene.trace(camera);
  Mask visible(o.width, o.height);
  for (int i = 0; i < g.size(); ++i) {
    const std::size_t p = std::size_t(g.pixel[std::size_t(i)]);
    if (depth.width == 0 || g.plane[GBuffer::depth][std::size_t(i)] < depth.values[p])
      visible.values[p] = g.plane[GBuffer::coverage][std::size_t(i)];
  }
  const int margin = o.width;
  const Mask all =
      scene.trace(camera.cropped(-margin, -margin, o.width + 2 * margin, o.height + 2 * margin), 1).frame("coverage");
  const SeenVehicle seen = seen_vehicle(visible, all, margin);
  if (seen.area == 0) std::printf("  the vehicle is not in the picture\n");
  write_text(o.output + "/label_kitti.txt", kitti_line("Car", seen, label_box(size, place, camera)));
  write_text(o.output + "/label_coco.json", coco_file("composite.png", visible, seen).dump() + "\n");
  const std::pair<const char*, const Image*> pictures[] = {{"composite", &out},
                                                           {"object", &layers.object},
                                                           {"kept", &layers.kept},
                                                           {"shadow", &layers.shadow},
                                                           {"through", &layers.through},
                                                           {"added", &layers.added}};
  write_png(o.output + "/composite.png", out);
  parallel_for(int(std::size(pictures)) + 2, [&](int k) {
    if (k == 0) write_exr(o.output + "/gbuffer.exr", g);
    else if (k == 1) write_png(o.output + "/mask.png", visible);
    else write_exr(o.output + "/" + pictures[k - 2].first + ".exr", *pictures[k - 2].second);
  });

  writing.finish("");
  std::printf(
      "\nDone after %.1f s. %s/composite.png is the street with the vehicle; mask, boxes and layers lie beside it.\n",
      whole.seconds(), o.output.c_str());
  return 0;
}
}  // namespace

int main(int argc, char** argv) {
  Options o;
  CLI::App app{
      "Puts a vehicle into a street picture: shadow, reflections, labels.\n\n"
      "  12_insert --twin burnish-twin --plate street.png --environment light.exr --focal 721 --at 1.5,9\n\n"
      "Without arguments: Sweet Home 3D's SUV in the city of Blender's panorama."};
  app.option_defaults()->take_last();
  app.add_option("--twin", o.twin, "the folder that 09_twin wrote");
  app.add_option("--vehicle", o.vehicle, "a vehicle's file instead of the twin's");
  app.add_option("--plate", o.plate, "the street picture; if not given, what the panorama shows");
  app.add_option("--environment", o.environment, "lat-long panorama, EXR or HDR")->capture_default_str();
  app.add_option("--yaw", o.yaw, "degrees the panorama is turned about +y")->capture_default_str();
  app.add_option("--at", o.at, "metres to the right and ahead of the camera")
      ->delimiter(',')
      ->expected(2)
      ->capture_default_str();
  app.add_option("--pixel", o.pixel, "x,y of the plate where the vehicle stands, instead of --at")
      ->delimiter(',')
      ->expected(2);
  app.add_option("--heading", o.heading, "degrees: 0 drives away, 90 to the right, 180 towards the camera")
      ->capture_default_str();
  app.add_option("--focal", o.focal, "of the plate, pixels; 0: 0.9 of its width")->check(CLI::Range(0.0f, 1e6f));
  app.add_option("--above", o.above, "metres of the camera above the ground")
      ->check(CLI::Range(0.05f, 200.0f))
      ->capture_default_str();
  app.add_option("--pitch", o.pitch, "degrees that the camera looks down")->capture_default_str();
  app.add_option("--roll", o.roll, "degrees that it is turned")->capture_default_str();
  app.add_option("--depth", o.depth,
                 "metres along the camera's axis (EXR, first channel): what is nearer hides the vehicle");
  app.add_option("--exposure", o.exposure, "plate by radiance; 0: found from the ground")->capture_default_str();
  app.add_option("--wet", o.wet, "0 dry to 1, the ground mirrors as water does")
      ->check(CLI::Range(0.0f, 1.0f))
      ->capture_default_str();
  app.add_option("--noise", o.noise, "of the plate, display values; -1: measured");
  app.add_option("--blur", o.blur, "of the plate, pixels; -1: measured");
  app.add_option("--size", o.width, "of the picture without a plate: its width; 16 : 9")->check(CLI::Range(64, 8192));
  app.add_option("--samples", o.samples, "paths a pixel")->check(CLI::Range(1, 65536))->capture_default_str();
  app.add_flag("--preview", o.preview, "4 paths a pixel and fewer bounces");
  app.add_flag("--noisy", o.noisy, "leave the noise of few paths in");
  app.add_option("--threads", o.threads, "0: all cores")->check(CLI::Range(0, 1024))->capture_default_str();
  app.add_option("-o,--output", o.output, "folder for pictures and labels")->capture_default_str();
  return command(app, argc, argv, [&] {
    if (app.count("--size")) o.height = o.width * 9 / 16;
    return run(o);
  });
}
