// examples/09_twin.cpp -- one street photo and a library of CAD vehicles go in; the photo's vehicle comes out as a twin
// SPDX-License-Identifier: Apache-2.0
//
// The way of the data: the vehicle is cut out of the photo; the library's vehicles that look most like it are posed
// against it, and the best is kept; its parts are told apart, in the model and in the photo; their materials are
// fitted; model, materials, pictures and a page are written.
#include <burnish/io/camera.h>
#include <burnish/io/network.h>
#include <burnish/io/parts.h>
#include <burnish/twin/assign_parts.h>
#include <burnish/twin/part_labels.h>
#include <burnish/twin/photo_parts.h>
#include <burnish/twin/segment_at.h>
#include "command.h"
#include "fit_report.h"
#include "pattern.h"
#include "twin_find.h"
#include "twin_leave.h"

using namespace burnish;

namespace {
struct Options {
  std::string photo = "/usr/share/darknet/data/dog.jpg", mask, vehicle, parts, index, output = "burnish-twin";
  std::string environment = "/usr/share/blender/datafiles/studiolights/world/city.exr";
  std::vector<std::string> folders, detector;
  std::vector<float> point, box;
  float focal = 0;
  int candidates = 5, frames = 48, threads = 0;
  bool pattern = false;
  fitting::Settings fit;
};

/// Where the vehicle is, without a mask's file, and how that was found.
Mask cut_out(const Options& o, const Image& photo, std::string& how) {
  Progress bar("segment");
  if (o.box.empty() && !o.detector.empty()) {
    Network network(o.detector[0], o.detector[1]);
    if (const auto seen = vehicle_at(detect(network, photo), o.point[0], o.point[1])) {
      how = "cut out of the detector's box";
      const Segmented s = segment(photo, seen->box, for_detections());
      bar.finish(how);
      return s.mask;
    }
    std::printf("  the detector sees no vehicle at the point\n");
  }
  const Segmented s = o.box.size() == 4 ? segment(photo, PixelBox{o.box[0], o.box[1], o.box[2], o.box[3]})
                                        : segment(photo, vec2<float>(o.point[0], o.point[1]));
  char text[120];
  std::snprintf(text, sizeof text, "%.0f x %.0f pixels, %.0f %% certain", double(s.box.width()), double(s.box.height()),
                100 * double(s.certainty));
  bar.finish(text);
  how = std::string("cut out by ") + (o.box.empty() ? "the point" : "the box") + ": " + text;
  return s.mask;
}

int run(Options o) {
  if (o.threads > 0) set_threads(o.threads);
  const bool by_default = o.photo == Options().photo;
  if (by_default && o.mask.empty() && o.point.empty() && o.box.empty()) o.box = {468, 75, 690, 170};
  if (o.mask.empty() && o.point.empty() && o.box.empty())
    throw Error("where is the vehicle in " + o.photo + "? --point x,y or --box x0,y0,x1,y1 or --mask FILE is missing");
  if (!o.point.empty() && o.point.size() != 2) throw Error("--point: expected x,y");
  if (!o.box.empty() && o.box.size() != 4) throw Error("--box: expected x0,y0,x1,y1");
  if (o.index.empty()) o.index = o.output + "/library.safetensors";
  if (o.folders.empty() && o.vehicle.empty() && !std::filesystem::exists(o.index))
    o.folders = {"/usr/share/sweethome3d/furniture"};
  Progress whole("");
  std::vector<std::pair<std::string, double>> times;
  double last = 0;
  const auto lap = [&](const char* stage) {
    times.emplace_back(stage, whole.seconds() - last), last = whole.seconds();
  };

  const Image photo = read_photo(o.photo), panorama = read_photo(o.environment);
  std::vector<GivenKind> given;
  if (!o.parts.empty()) given = read_parts(o.parts);
  Mask mask;
  std::string how = "the mask " + o.mask;
  if (!o.mask.empty()) {
    mask = read_mask(o.mask, photo.width, photo.height);
    if (std::none_of(mask.values.begin(), mask.values.end(), [](float x) { return x > 0.5f; }))
      throw Error(o.mask + ": no pixel is white, expected the vehicle to be");
  }
  for (const std::string& f : o.folders)
    if (!std::filesystem::exists(f)) throw Error(f + ": no such folder, expected one with vehicle files");
  check_writable(o.output);
  catch_interrupt();
  lap("read");

  twin::Leavings leave(o.output, o.photo);
  if (o.mask.empty()) mask = cut_out(o, photo, how);
  write_png(o.output + "/mask.png", mask);
  lap("segment");

  std::vector<twin::Candidate> found;
  if (!o.vehicle.empty()) {
    found.push_back({o.vehicle, std::filesystem::path(o.vehicle).filename().string(), 0, nullptr, {}, {}});
  } else {
    const Library library = twin::open_library(o.index, o.folders);
    lap("library");
    if (interrupted) return 130;
    found = twin::retrieve(library, o.index, photo, mask, o.candidates);
    lap("retrieve");
  }
  MatchOptions matching;
  matching.fit_focal = o.focal <= 0;
  if (o.focal > 0) matching.focal = o.focal / float(photo.width);
  found = twin::pose_all(std::move(found), photo, mask, matching);
  const twin::Candidate& best = found.front();
  const PoseCandidate& pose = best.poses.front();
  const Raycaster& scene = *best.scene;
  const Camera camera = pose.pose.camera();
  write_camera(o.output + "/camera.json", camera);
  leave.found(found, photo, mask, how);
  lap("pose");
  if (interrupted) return 130;

  Progress parting("parts");
  AssignOptions assigning;
  assigning.given = given;
  const AssignedParts parts = assign_parts(scene, assigning);
  write_parts(o.output + "/parts.txt", scene.mesh(), parts);
  const GBuffer whole_view = scene.trace(camera);
  fitting::Photo target;
  target.image = photo;
  for (float& x : target.image.values) x = detail::to_srgb(std::clamp(x, 0.0f, 1.0f));
  target.vehicle = mask;
  target.label = photo_parts(photo, mask, whole_view, part_labels(whole_view, scene.mesh(), parts));
  const auto roles_of = [&](const GBuffer& g) { return parts::roles_of(g, scene.mesh(), parts); };
  parting.finish(leave.parts(scene, parts, photo, target.label));
  lap("parts");

  o.fit.checkpoints = o.output;
  o.fit.freeze.push_back("glass");  // of a pane one photo shows what lies behind it
  const fitting::MoreLoss pattern = o.pattern ? fitting::pattern(FilterBank{}, 1) : fitting::MoreLoss();
  const fitting::FittedParts fitted =
      fitting::fit_parts(scene, roles_of, target, camera, panorama, o.fit, pattern, fitting::on_terminal());
  report::write_materials(o.output, fitted.materials, fitted.seen);
  leave.fitted(fitted, o.fit);
  lap("fit");

  leave.model(scene, parts, fitted.materials.best());
  if (!interrupted && o.frames > 0) leave.turntable(scene, parts, fitted, o.frames);
  lap("draw");
  nlohmann::ordered_json twin;
  twin["vehicle"] = best.path, twin["photo"] = o.photo, twin["environment"] = o.environment;
  twin["yaw"] = fitted.lit.yaw, twin["iou"] = pose.iou, twin["belief"] = pose.belief;
  write_text(o.output + "/twin.json", twin.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  leave.page(times, whole.seconds());
  std::printf("\nDone after %.1f s. Open %s/index.html; %s/twin.glb is the model, in any glTF viewer.\n",
              whole.seconds(), o.output.c_str(), o.output.c_str());
  return 0;
}
}  // namespace

int main(int argc, char** argv) {
  Options o;
  CLI::App app{
      "Makes a digital twin of a vehicle in one street photo, out of a library of CAD vehicles.\n\n"
      "  09_twin --photo street.jpg --point 580,120 --library cars/ --environment city.exr --output twin\n\n"
      "Without arguments: a pickup in a street, among Sweet Home 3D's vehicles."};
  app.option_defaults()->take_last();
  app.add_option("--photo", o.photo, "any format OpenImageIO reads")->capture_default_str();
  app.add_option("--point", o.point, "x,y of a pixel inside the vehicle")->delimiter(',')->expected(2);
  app.add_option("--box", o.box, "x0,y0,x1,y1 around the vehicle, pixels")->delimiter(',')->expected(4);
  app.add_option("--mask", o.mask, "the vehicle in the photo: white, same size");
  app.add_option("--detector", o.detector,
                 "PLAN.cfg,WEIGHTS: a Darknet detector with COCO's classes, from --point to a box")
      ->delimiter(',')
      ->expected(2)
      ->take_all();
  app.add_option("--library", o.folders, "folders with vehicle files and zip archives")->take_all();
  app.add_option("--index", o.index, "of the library; if not given, library.safetensors in the output folder");
  app.add_option("--vehicle", o.vehicle, "this vehicle instead of a library's");
  app.add_option("--candidates", o.candidates, "how many of the library's vehicles are posed")
      ->check(CLI::Range(1, 50))
      ->capture_default_str();
  app.add_option("--focal", o.focal, "the photo's focal length in pixels; 0: not known, fitted as well")
      ->check(CLI::Range(0.0f, 1e6f))
      ->capture_default_str();
  app.add_option("--parts", o.parts, "what the materials are, as 07_assign_parts writes it");
  app.add_option("--environment", o.environment, "lat-long panorama, EXR or HDR")->capture_default_str();
  app.add_flag("--pattern", o.pattern, "compare the parts' patterns, too: masked Gram matrices of a filter bank");
  app.add_option("--frames", o.frames, "of the turntable; 0: none")->check(CLI::Range(0, 360))->capture_default_str();
  app.add_option("--threads", o.threads, "0: all cores")->check(CLI::Range(0, 1024))->capture_default_str();
  app.add_option("-o,--output", o.output, "folder for pictures and files")->capture_default_str();
  fitting::add_settings(app, o.fit);
  return command(app, argc, argv, [&] { return run(o); });
}
