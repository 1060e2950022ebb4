// examples/insertion.cpp -- the way of insertion.h from files to files
// SPDX-License-Identifier: Apache-2.0
#include "insertion.h"
#include <burnish/io/exr.h>
#include <burnish/io/kitti.h>
#include <burnish/io/parts.h>
#include <burnish/street/denoise.h>
#include <burnish/twin/assign_parts.h>
#include "dressed.h"

namespace insertion {

void add_options(CLI::App& app, Options& o) {
  app.option_defaults()->take_last();
  app.add_option("--twin", o.twin, "the folder that 09_twin wrote");
  app.add_option("--vehicle", o.vehicle, "a vehicle's file instead of the twin's");
  app.add_option("--materials", o.materials,
                 "another twin's folder: its paint, glass and rubber on this vehicle's parts");
  app.add_option("--plate", o.plate, "the street picture; if not given, what the panorama shows");
  app.add_option("--environment", o.environment, "lat-long panorama, EXR or HDR")->capture_default_str();
  app.add_option("--yaw", o.yaw, "degrees the panorama is turned about +y")->capture_default_str();
  app.add_option("--lights", o.lights,
                 "a file of panoramas with places on the plate's ground; the nearest to the vehicle lights it");
  app.add_flag("--six-lights", o.six_lights, "as much light from six directions alone, to compare with");
  app.add_option("--at", o.at, "metres to the right and ahead of the camera")
      ->delimiter(',')
      ->expected(2)
      ->capture_default_str();
  app.add_option("--pixel", o.pixel, "x,y of the plate where the vehicle stands, instead of --at")
      ->delimiter(',')
      ->expected(2);
  app.add_option("--heading", o.heading, "degrees: 0 drives away, 90 to the right, 180 towards the camera")
      ->capture_default_str();
  app.add_option("--kitti-label", o.label, "a label file: its box says where the vehicle stands, and how long it is");
  app.add_option("--kitti-line", o.line, "of that file, from 1; 0: the first object")->check(CLI::Range(0, 100000));
  app.add_option("--kitti-calib", o.calibration, "the plate's calibration: focal length and middle by its P2");
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
  editing::add_options(app, o.edit);
}

namespace {
/// The pixels that show ground within so many metres of a place; all, where these are few.
Mask about(const Camera& camera, const Placement& place, float reach) {
  Mask near(camera.width, camera.height);
  int count = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      vec3<float> foot;
      if (!on_ground(camera, float(x) + 0.5f, float(y) + 0.5f, foot)) continue;
      const bool in = std::hypot(foot.x - place.right, foot.z + place.ahead) < reach;
      near.at(x, y) = in, count += in;
    }
  return count > 500 ? near : Mask(camera.width, camera.height, 1);
}
/// By how many pixels a box may reach beyond the picture; at most its width, as counts for a label.
int beyond(const Camera& camera, const Box& box) {
  float most = 0;
  for (int k = 0; k < 8; ++k) {
    const vec3<float> p = camera.project({k & 1 ? box.high.x : box.low.x, k & 2 ? box.high.y : box.low.y,
                                          k & 4 ? box.high.z : box.low.z});
    if (p.z < 0.1f) return camera.width;
    most = std::max({most, -p.x, -p.y, p.x - float(camera.width), p.y - float(camera.height)});
  }
  return std::min(camera.width, int(std::ceil(most)) + 1);
}
}  // namespace

void light(Street& s, const Options& o, const Placement& place) {
  const PanoramaFile& nearest = s.lights.nearest({place.right, 0, -place.ahead}).light;
  if (nearest == s.lit) return;
  s.lit = nearest;
  s.sky = PanoramaSampler(read_photo(nearest.path), nearest.yaw);
  s.found = {};
  if (o.plate.empty()) {  // what the panorama itself shows
    s.plate = Image(o.width, o.height);
    for (int y = 0; y < o.height; ++y)
      for (int x = 0; x < o.width; ++x)
        s.plate.set(x, y, s.sky.radiance(s.camera.ray(float(x) + 0.5f, float(y) + 0.5f).direction));
  } else {
    s.found = plate_look(s.plate, about(s.camera, s.place, 4), s.camera, s.sky);
  }
  if (o.exposure > 0) s.found.exposure = vec3<float>(o.exposure);
  if (o.noise >= 0) s.found.noise = o.noise;
  if (o.blur >= 0) s.found.blur = o.blur;
  if (o.six_lights) s.sky = PanoramaSampler(six_lights_panorama(s.sky.irradiance({0, 1, 0})));
}

Street read(Options& o) {
  constexpr float degree = 0.0174532925f;
  if (o.threads > 0) set_threads(o.threads);
  if (o.twin.empty() && o.vehicle.empty())
    o.vehicle = "/usr/share/sweethome3d/furniture/Scopia.sh3f:scopia/suv/suv.obj";
  if (o.height == 0) o.height = o.width * 9 / 16;
  Street s;
  if (!o.plate.empty()) s.plate = read_photo(o.plate), o.width = s.plate.width, o.height = s.plate.height;
  KittiCamera kitti;
  if (!o.calibration.empty()) {
    kitti = kitti_camera(read_kitti_projection(o.calibration), o.width, o.height, o.above, o.pitch * degree,
                         o.roll * degree);
  } else {
    if (o.focal <= 0) o.focal = 0.9f * float(o.width);
    kitti.camera = street_camera(o.focal, 0.5f * float(o.width), 0.5f * float(o.height), o.width, o.height, o.above,
                                 o.pitch * degree, o.roll * degree);
  }
  s.camera = kitti.camera;
  if (!o.depth.empty()) {
    const Image d = read_photo(o.depth);
    if (d.width != o.width || d.height != o.height)
      throw Error(o.depth + ": " + std::to_string(d.width) + " x " + std::to_string(d.height) +
                  " pixels, the plate has " + std::to_string(o.width) + " x " + std::to_string(o.height) +
                  ": they must agree");
    s.depth = Mask(d.width, d.height);
    for (int y = 0; y < d.height; ++y)
      for (int x = 0; x < d.width; ++x) s.depth.at(x, y) = d.at(x, y).x > 0 ? d.at(x, y).x : 1e9f;
  }
  s.place = {o.at[0], o.at[1], o.heading * degree};
  if (o.pixel.size() == 2) {
    vec3<float> foot;
    if (!on_ground(s.camera, o.pixel[0], o.pixel[1], foot))
      throw Error("--pixel lies above the horizon, expected a place on the ground");
    s.place.right = foot.x, s.place.ahead = -foot.z;
  }
  AssignOptions assigning;
  std::string path = o.vehicle;
  if (!o.twin.empty()) {
    const nlohmann::ordered_json j = parse_json(o.twin + "/twin.json");
    if (!j.contains("vehicle") || !j["vehicle"].is_string())
      throw Error(o.twin + "/twin.json: no \"vehicle\", expected what 09_twin writes");
    if (path.empty()) path = j["vehicle"].get<std::string>(), assigning.given = read_parts(o.twin + "/parts.txt");
    read_materials(o.twin, s.look);
  }
  if (!o.materials.empty()) read_materials(o.materials, s.look);
  s.mesh = read_vehicle(path);
  s.kinds = assign_parts(Raycaster(s.mesh), assigning).kinds();
  if (!o.label.empty()) s.place = kitti_placement(read_kitti_label(o.label, o.line).box, bounds(s.mesh).size(), kitti);
  if (!o.lights.empty() && o.plate.empty()) throw Error("--lights needs --plate, the picture that they light");
  s.lights =
      o.lights.empty() ? LightField<PanoramaFile>{{{{}, {o.environment, o.yaw * degree}}}} : read_light_field(o.lights);
  light(s, o, s.place);
  return s;
}

Shot shoot(const Street& s, const Placement& place, const editing::Options& edit, const Options& o,
           const std::function<void(int, int)>& progress) {
  const EditedVehicle vehicle = editing::apply(s.mesh, s.kinds, edit);
  if (vehicle.mesh.triangles.empty()) throw Error("nothing is left of the vehicle");
  const Raycaster scene(placed(vehicle.mesh, place));
  const dressed::Dressed dress(scene, vehicle.kinds, s.look);
  const auto material = [&](const Surfel<float>& at, int part) { return dress(part, at); };
  PathOptions options;
  options.samples = o.preview ? 4 : o.samples;
  options.bounces = o.preview ? 2 : 4;
  const PathTracer tracer(scene, s.sky, material, Ground{place.height, o.wet}, options);
  Shot shot;
  shot.layers = render_layers(tracer, s.camera, s.depth, true, progress);
  if (!o.noisy) denoise(shot.layers, features(scene, material, s.camera), o.preview ? 4 : 6);
  match_look(shot.layers, s.found);
  shot.composite = composite(s.plate, shot.layers, s.found.exposure);

  const int w = s.camera.width, h = s.camera.height;
  shot.g = scene.trace(s.camera);
  shot.visible = Mask(w, h);
  for (int i = 0; i < shot.g.size(); ++i) {
    const std::size_t p = std::size_t(shot.g.pixel[std::size_t(i)]);
    if (s.depth.width == 0 || shot.g.plane[GBuffer::depth][std::size_t(i)] < s.depth.values[p])
      shot.visible.values[p] = shot.g.plane[GBuffer::coverage][std::size_t(i)];
  }
  const int margin = beyond(s.camera, bounds(scene.mesh()));
  const Mask all = scene.trace(s.camera.cropped(-margin, -margin, w + 2 * margin, h + 2 * margin), 1).frame("coverage");
  shot.seen = seen_vehicle(shot.visible, all, margin);
  shot.box = label_box(bounds(vehicle.mesh).size(), place, s.camera);
  return shot;
}

void write(const std::string& folder, const Shot& shot) {
  write_text(folder + "/label_kitti.txt", kitti_line("Car", shot.seen, shot.box));
  write_text(folder + "/label_coco.json", coco_file("composite.png", shot.visible, shot.seen).dump() + "\n");
  write_png(folder + "/composite.png", shot.composite);
  const std::pair<const char*, const Image*> pictures[] = {
      {"composite", &shot.composite},  {"object", &shot.layers.object},   {"kept", &shot.layers.kept},
      {"shadow", &shot.layers.shadow}, {"through", &shot.layers.through}, {"added", &shot.layers.added}};
  parallel_for(int(std::size(pictures)) + 2, [&](int k) {
    if (k == 0) write_exr(folder + "/gbuffer.exr", shot.g);
    else if (k == 1) write_png(folder + "/mask.png", shot.visible);
    else write_exr(folder + "/" + pictures[k - 2].first + ".exr", *pictures[k - 2].second);
  });
}

}  // namespace insertion
