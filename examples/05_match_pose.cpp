// examples/05_match_pose.cpp -- vehicles and a photo with a mask go in; the camera that saw the likeliest one comes out
// SPDX-License-Identifier: Apache-2.0
//
// Every vehicle is looked at from all round; the views that look most like the photo, by the mask, by edges and by dark
// parts, are refined by the slopes of its silhouette and of its edges (twin/match_pose.h). What it writes is the
// --camera of 04_fit_material.
#include <burnish/io/mesh.h>
#include <burnish/io/poses.h>
#include <burnish/io/report.h>
#include "command.h"
#include "pictures.h"
#include "progress.h"

using namespace burnish;

namespace {
struct Options {
  std::string photo, mask, output = "burnish-pose";
  std::vector<std::string> vehicles;
  float focal = 0;
  int keep = 3, pixels = 192;
  bool mask_only = false;
};

/// Turns of less than half a turn, in degrees.
double degrees(float radians) { return double(std::remainder(radians, 2 * pi)) * 57.29577951308232; }

/// How sure the heading is, in words.
std::string heading(const std::vector<PoseCandidate>& poses) {
  char text[160];
  if (poses.size() < 2 || poses[0].sure())
    std::snprintf(text, sizeof text, "sure of the heading (%.0f %%)", 100 * poses[0].belief);
  else
    std::snprintf(text, sizeof text, "not sure of the heading (%.0f %%): the next is %.0f degrees (%.0f %%)",
                  100 * poses[0].belief, degrees(poses[1].pose.azimuth), 100 * poses[1].belief);
  return text;
}

int run(const Options& o) {
  Progress whole("");
  const Image photo = read_photo(o.photo);
  const Mask mask = read_mask(o.mask, photo.width, photo.height);
  std::vector<Raycaster> scenes;
  for (const std::string& vehicle : o.vehicles) {
    MeshReport report;
    scenes.emplace_back(read_vehicle(vehicle, &report));
    if (o.vehicles.size() > 1) std::printf("%s\n", vehicle.c_str());
    for (const std::string& line : report.lines) std::printf("  %s\n", line.c_str());
  }
  MatchOptions options;
  options.pixels = o.pixels;
  options.fit_focal = o.focal <= 0;
  if (o.focal > 0) options.focal = o.focal / float(photo.width);
  Progress matching("match");
  const auto found = match_models(
      int(scenes.size()), [&](int k) -> const Raycaster& { return scenes[std::size_t(k)]; }, mask,
      o.mask_only ? Image() : photo, options, o.keep, [&](int done, int of) { matching.show(done, of); });
  char note[240];
  std::snprintf(note, sizeof note, "%zu vehicle%s, %d views each by the mask%s", scenes.size(),
                scenes.size() == 1 ? "" : "s", options.azimuths * int(options.elevations.size()),
                o.mask_only ? " alone" : ", edges and dark parts");
  matching.finish(note);

  check_writable(o.output);
  const PoseCandidate& best = found[0].poses[0];
  write_camera(o.output + "/camera.json", best.pose.camera());
  std::vector<Panel> panels;
  std::vector<NamedPose> all;
  const int wide = 640, high = std::max(1, wide * photo.height / photo.width);
  panels.push_back({"photo", resized(photo, wide, high)});
  for (const MatchedModel& m : found) {
    const std::string& name = o.vehicles[std::size_t(m.model)];
    if (found.size() > 1) std::printf("%s: score %.2f\n", name.c_str(), m.poses[0].score);
    for (const PoseCandidate& c : m.poses) {
      all.push_back({name, c});
      const Pose<float>&p = c.pose, &d = c.deviation;
      std::printf("IoU %.3f   azimuth %.1f +- %.1f   elevation %.1f +- %.1f   roll %.1f +- %.1f degrees   "
                  "distance %.2f +- %.2f m   focal length %.0f%s",
                  c.iou, degrees(p.azimuth), degrees(d.azimuth), degrees(p.elevation), degrees(d.elevation),
                  degrees(p.roll), degrees(d.roll), double(p.distance), double(d.distance),
                  double(p.focal) * photo.width, options.fit_focal ? " (fitted)" : "");
      if (o.mask_only) std::printf("   belief %.2f\n", c.belief);
      else std::printf("   edges %.2f   tone %.2f   belief %.2f\n", c.agreement.edges, c.agreement.tone, c.belief);
      if (int(panels.size()) > std::max(o.keep, 3)) continue;
      const Mask seen = scenes[std::size_t(m.model)].trace(p.camera()).frame("coverage");
      std::snprintf(note, sizeof note, "%sIoU %.3f, from %.0f degrees, belief %.2f",
                    found.size() > 1 ? (std::filesystem::path(name).filename().string() + ": ").c_str() : "", c.iou,
                    degrees(p.azimuth), c.belief);
      panels.push_back({note, resized(overlay(photo, mask, seen), wide, high)});
    }
  }
  write_poses(o.output + "/poses.json", all);
  write_png(o.output + "/pose.png", sheet(panels, 2));
  std::printf("\n%s%s; %s\n", found.size() > 1 ? "likeliest: " : "",
              o.vehicles[std::size_t(found[0].model)].c_str(), heading(found[0].poses).c_str());
  std::printf("Done after %.1f s. %s/pose.png shows it (green: both, red: the model alone, blue: the mask alone); "
              "%s/camera.json is the first pose, %s/poses.json are all.\n",
              whole.seconds(), o.output.c_str(), o.output.c_str(), o.output.c_str());
  return 0;
}
}  // namespace

int main(int argc, char** argv) {
  Options o;
  CLI::App app{"Finds the camera that saw a CAD vehicle where a photo's mask is; of several, the likeliest.\n\n"
               "  05_match_pose --photo street.jpg --mask car.png --vehicle car.glb --output pose\n"
               "  04_fit_material --photo street.jpg --mask car.png --vehicle car.glb --camera pose/camera.json ..."};
  app.option_defaults()->take_last();
  app.add_option("--photo", o.photo, "the photo: any format OpenImageIO reads")->required();
  app.add_option("--mask", o.mask, "the vehicle in the photo: white, same size")->required();
  app.add_option("--vehicle", o.vehicles,
                 "any format Assimp reads; archive.zip:inner/path for a file in a zip archive; given several times, "
                 "all are tried")
      ->take_all()
      ->required();
  app.add_option("--focal", o.focal, "the photo's focal length in pixels; 0: not known, fitted as well")
      ->check(CLI::Range(0.0f, 1e6f))
      ->capture_default_str();
  app.add_flag("--mask-only", o.mask_only, "leave out the photo's edges and dark parts");
  app.add_option("--keep", o.keep, "how many poses of each vehicle are shown, the best first")
      ->check(CLI::Range(1, 12))
      ->capture_default_str();
  app.add_option("--pixels", o.pixels, "the longer side of the vehicle's window that the last refinement works on")
      ->check(CLI::Range(64, 4096))
      ->capture_default_str();
  app.add_option("-o,--output", o.output, "folder for the camera and the picture")->capture_default_str();
  return command(app, argc, argv, [&] { return run(o); });
}
