// examples/05_match_pose.cpp -- a vehicle and its mask in a photo go in; the camera that saw it comes out
// SPDX-License-Identifier: Apache-2.0
//
// The vehicle is looked at from all round; the views that cover the mask best are refined by the slopes of its
// silhouette (twin/match_pose.h). What it writes is the --camera of 04_fit_material.
#include <CLI/CLI.hpp>
#include <burnish/io/camera.h>
#include <burnish/io/mesh.h>
#include <burnish/io/report.h>
#include <burnish/twin/match_pose.h>
#include "progress.h"

using namespace burnish;

namespace {
struct Options {
  std::string photo, mask, vehicle, output = "burnish-pose";
  float focal = 0;
  int keep = 3, pixels = 192;
};

/// The photo with the model's outline drawn over it: green where both agree, red where only the model is, blue where
/// only the mask is.
Image overlay(const Image& photo, const Mask& mask, const Mask& model) {
  Image out = photo;
  for (int y = 0; y < photo.height; ++y)
    for (int x = 0; x < photo.width; ++x) {
      const float a = mask.at(x, y), b = model.at(x, y);
      const vec3<float> color(b * (1 - a), a * b, a * (1 - b));
      const float strength = 0.45f * std::max(a, b);
      out.set(x, y, photo.at(x, y) * (1 - strength) + color * strength);
    }
  return out;
}
/// Turns of less than half a turn, in degrees.
double degrees(float radians) { return double(std::remainder(radians, 2 * pi)) * 57.29577951308232; }

int run(const Options& o) {
  Progress whole("");
  const Image photo = read_photo(o.photo);
  const Mask mask = read_mask(o.mask, photo.width, photo.height);
  MeshReport report;
  Mesh mesh = read_vehicle(o.vehicle, &report);
  for (const std::string& line : report.lines) std::printf("  %s\n", line.c_str());
  const Raycaster scene(std::move(mesh));
  MatchOptions options;
  options.pixels = o.pixels;
  options.fit_focal = o.focal <= 0;
  if (o.focal > 0) options.focal = o.focal / float(photo.width);
  Progress matching("match");
  const auto found =
      match_pose(scene, mask, photo, options, o.keep, [&](int done, int of) { matching.show(done, of); });
  char note[160];
  std::snprintf(note, sizeof note, "%d views, the best %zu refined", options.azimuths * int(options.elevations.size()),
                found.size());
  matching.finish(note);

  check_writable(o.output);
  write_camera(o.output + "/camera.json", found[0].pose.camera());
  std::vector<Panel> panels;
  const int wide = 640, high = std::max(1, wide * photo.height / photo.width);
  panels.push_back({"photo", resized(photo, wide, high)});
  for (const PoseCandidate& m : found) {
    const Pose<float>&p = m.pose, &d = m.deviation;
    std::snprintf(note, sizeof note, "IoU %.3f, edges %.2f, tone %.2f, from %.0f degrees, %.1f m away", m.iou, m.agreement.edges, m.agreement.tone, degrees(p.azimuth),
                  double(p.distance));
    panels.push_back({note, resized(overlay(photo, mask, scene.trace(p.camera()).frame("coverage")), wide, high)});
    std::printf("edges %.3f tone %.3f score %.3f belief %.3f   ", m.agreement.edges, m.agreement.tone, m.score, m.belief);
    std::printf("IoU %.3f   azimuth %.1f +- %.1f   elevation %.1f +- %.1f   roll %.1f +- %.1f degrees   "
                "distance %.2f +- %.2f m   focal length %.0f%s\n",
                m.iou, degrees(p.azimuth), degrees(d.azimuth), degrees(p.elevation), degrees(d.elevation),
                degrees(p.roll), degrees(d.roll), double(p.distance), double(d.distance),
                double(p.focal) * photo.width, options.fit_focal ? " (fitted)" : "");
  }
  write_png(o.output + "/pose.png", sheet(panels, 2));
  std::printf("\nDone after %.1f s. %s/pose.png shows it (green: both, red: the model alone, blue: the mask alone); "
              "%s/camera.json is the first pose.\n",
              whole.seconds(), o.output.c_str(), o.output.c_str());
  return 0;
}
}  // namespace

int main(int argc, char** argv) {
  Options o;
  CLI::App app{"Finds the camera that saw a CAD vehicle where a photo's mask is.\n\n"
               "  05_match_pose --photo street.jpg --mask car.png --vehicle car.glb --output pose\n"
               "  04_fit_material --photo street.jpg --mask car.png --vehicle car.glb --camera pose/camera.json ..."};
  app.option_defaults()->take_last();
  app.add_option("--photo", o.photo, "the photo: any format OpenImageIO reads")->required();
  app.add_option("--mask", o.mask, "the vehicle in the photo: white, same size")->required();
  app.add_option("--vehicle", o.vehicle, "any format Assimp reads; archive.zip:inner/path for a file in a zip archive")
      ->required();
  app.add_option("--focal", o.focal, "the photo's focal length in pixels; 0: not known, fitted as well")
      ->check(CLI::Range(0.0f, 1e6f))
      ->capture_default_str();
  app.add_option("--keep", o.keep, "how many poses are shown, the best first")
      ->check(CLI::Range(1, 12))
      ->capture_default_str();
  app.add_option("--pixels", o.pixels, "the longer side of the mask that the last refinement works on")
      ->check(CLI::Range(64, 4096))
      ->capture_default_str();
  app.add_option("-o,--output", o.output, "folder for the camera and the picture")->capture_default_str();
  try {
    app.parse(argc, argv);
    return run(o);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    std::fprintf(stderr, "05_match_pose: %s\n", e.what());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "05_match_pose: %s\n", e.what());
  }
  return 2;
}
