// examples/11_panorama.cpp -- a panorama of eight bits, or the fisheyes of a car, made light in HDR
// SPDX-License-Identifier: Apache-2.0
#include <burnish/io/fisheye.h>
#include <burnish/io/model.h>
#include <burnish/io/photo.h>
#include <burnish/io/report.h>
#include <burnish/street/expose.h>
#include <burnish/street/stitch.h>
#include "command.h"
#include "panorama_picture.h"
#include "progress.h"

namespace {
using namespace burnish;

struct Options {
  std::string panorama, truth, prediction, output = "burnish-panorama";
  std::vector<std::string> fisheyes, calibrations;
  int height = 512;
};
const std::string usual = "/usr/share/blender/datafiles/studiolights/world/city.exr";

Image stitched(const Options& o) {
  std::vector<LensPicture> pictures;
  std::vector<Lens> lenses;
  if (o.calibrations.empty()) throw Error("--calibration is missing: how do the lenses of --fisheye see?");
  for (const std::string& file : o.calibrations)
    for (Lens& l : read_lenses(file)) lenses.push_back(std::move(l));
  if (o.fisheyes.size() != lenses.size() && o.fisheyes.size() != 1)
    throw Error("--fisheye: " + std::to_string(o.fisheyes.size()) + " pictures for " + std::to_string(lenses.size()) +
                " lenses of --calibration, expected one each, or one frame that has all");
  for (std::size_t i = 0; i < lenses.size(); ++i) {
    const std::string& file = o.fisheyes[std::min(i, o.fisheyes.size() - 1)];
    Image image = read_photo(file);
    if (image.width != lenses[i].width || image.height != lenses[i].height)
      throw Error(file + ": " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                  ", its calibration is for " + std::to_string(lenses[i].width) + " x " +
                  std::to_string(lenses[i].height));
    pictures.push_back({lenses[i], std::move(image)});
  }
  StitchOptions how;
  how.height = o.height;
  return stitch(pictures, how).panorama;
}
/// The truth in the panorama's units: as bright where nothing is clipped.
Image aligned(const Image& truth, const Image& ldr) {
  Image t = resized(truth, ldr.width, ldr.height);
  std::vector<double> ratio;
  for (int y = 0; y < ldr.height; ++y)
    for (int x = 0; x < ldr.width; x += detail::row_step(ldr.height, y)) {
      const vec3<float> a = ldr.at(x, y), b = t.at(x, y);
      if (std::max({a.x, a.y, a.z}) < 0.9f && luminance(a) > 0.02f && luminance(b) > 0)
        ratio.push_back(double(luminance(a) / luminance(b)));
    }
  return panorama::times(t, ratio.empty() ? 1 : float(detail::median_of(ratio)));
}
float peak(const Image& p) { return *std::max_element(p.values.begin(), p.values.end()); }

int run(const Options& o) {
  Progress whole("");
  Image truth, ldr, prediction;
  std::string source = o.panorama;
  if (!o.truth.empty()) truth = without_flaws(read_photo(o.truth));
  if (!o.prediction.empty()) prediction = read_photo(o.prediction);
  if (!o.fisheyes.empty()) ldr = stitched(o), source = "fisheyes";
  else if (!o.panorama.empty()) ldr = read_photo(o.panorama);
  else {
    source = usual + ", clipped to eight bits";
    truth = without_flaws(read_photo(usual));
    ldr = photographed(truth, metered_exposure(truth, 0.12f));
  }
  // A file of floats may hold more than white: what a camera would have clipped is clipped.
  for (float& x : ldr.values) x = std::clamp(x, 0.0f, 1.0f);
  if (ldr.height > o.height) ldr = detail::resampled_panorama(ldr, o.height);
  std::printf("%s: %d x %d\n", source.c_str(), ldr.width, ldr.height);

  Progress finding("light");
  const HdrPanorama found = estimate_hdr(ldr);
  const Image light = prediction.width > 0 ? compose_hdr(ldr, prediction) : found.panorama;
  char note[200];
  const char* const kinds[] = {"the sun is seen", "a sky, no sun seen", "no sky found: left as it is"};
  std::snprintf(note, sizeof note, "%s", kinds[int(found.kind)]);
  finding.finish(note);
  const double azimuth = std::atan2(double(found.sun_direction.x), -double(found.sun_direction.z)) * 57.29578,
               elevation = std::asin(std::clamp(double(found.sun_direction.y), -1.0, 1.0)) * 57.29578;
  if (found.kind != SkyKind::none) {
    std::printf("  sun          azimuth %.1f (of -z, to +x), elevation %.1f degrees, +- %.1f%s\n", azimuth, elevation,
                found.sun_sigma * 57.29578, found.kind == SkyKind::sunny ? "" : ": a guess");
    std::printf(
        "  its strength irradiance %.3f %.3f %.3f (the photo's white is a radiance of 1), right to a factor %.1f\n",
        double(found.sun_irradiance.x), double(found.sun_irradiance.y), double(found.sun_irradiance.z),
        found.sun_factor);
    std::printf("  sky          %.0f %% of the upper half; turbidity %.1f, misfit %.2f of ln radiance\n",
                100 * found.mask.part, found.sky.sky.turbidity, found.sky.residual);
  }

  check_writable(o.output);
  write_exr(o.output + "/panorama.exr", light);
  nlohmann::ordered_json j;
  j["source"] = source, j["kind"] = kinds[int(found.kind)];
  j["sun"] = {{"direction", {found.sun_direction.x, found.sun_direction.y, found.sun_direction.z}},
              {"sigma_degrees", found.sun_sigma * 57.29578},
              {"irradiance", {found.sun_irradiance.x, found.sun_irradiance.y, found.sun_irradiance.z}},
              {"irradiance_factor", found.sun_factor}};
  j["sky"] = {{"part", found.mask.part}, {"turbidity", found.sky.sky.turbidity}, {"misfit", found.sky.residual}};
  write_text(o.output + "/light.json", j.dump(2) + "\n");

  Progress drawing("draw");
  const int wide = 480, high = 240;
  const auto panel = [&](const Image& p) { return resized(p, wide, high); };
  Image mask = panorama::shown_mask(panel(ldr), found.mask);
  if (found.kind != SkyKind::none)
    panorama::mark(mask, found.sun_direction,
                   found.kind == SkyKind::sunny ? vec3<float>(1, 0.8f, 0) : vec3<float>(0.6f));
  std::vector<Panel> panels{{"input, eight bits", panel(ldr)}, {"sky blue, clipped red, sun ringed", mask}};
  const char* const captions[] = {"result", "result, 3 stops less", "result, 6 stops less"};
  for (int i = 0; i < 3; ++i)
    panels.push_back({captions[i], panel(panorama::times(light, std::exp2(-3.0f * float(i))))});
  // The ball is seen from where most of its lit side shows.
  vec3<float> toward(-found.sun_direction.z, 0, found.sun_direction.x);
  toward = dot(toward, toward) > 1e-3f ? normalize(toward) : vec3<float>(0, 0, -1);
  const Image under_ldr = panorama::ball(ldr, wide, high, toward),
              under_hdr = panorama::ball(light, wide, high, toward);
  panels.push_back({"a grey ball under the input", under_ldr});
  panels.push_back({"under the result", under_hdr});
  if (truth.width > 0) {
    const Image t = aligned(truth, ldr);
    panels.push_back({"under the truth", panorama::ball(t, wide, high, toward)});
    panels.push_back({"the truth, 3 stops less", panel(panorama::times(t, 0.125f))});
    std::printf("  brightest    input %.1f, result %.1f, truth %.1f\n", double(peak(ldr)), double(peak(light)),
                double(peak(t)));
  }
  write_png(o.output + "/panorama.png", sheet(panels, 3));
  drawing.finish("pictures");
  std::printf(
      "\nDone after %.1f s. %s/panorama.exr is the light, %s/panorama.png shows it, %s/light.json tells of it.\n",
      whole.seconds(), o.output.c_str(), o.output.c_str(), o.output.c_str());
  return 0;
}
}  // namespace

int main(int argc, char** argv) {
  Options o;
  CLI::App app{
      "Makes HDR light of a panorama of eight bits: the sky found, the sun put back. No network is asked.\n\n"
      "  11_panorama --panorama street.jpg --output light\n"
      "  11_panorama --fisheye left.png right.png --calibration image_02.yaml image_03.yaml --output light\n\n"
      "Without arguments: a panorama of blender-data, clipped by itself, so that the truth is known."};
  app.option_defaults()->take_last();
  app.add_option("--panorama", o.panorama, "lat-long, level, twice as wide as high; any format OpenImageIO reads");
  app.add_option("--fisheye", o.fisheyes, "pictures of fisheyes, one for each lens, or one frame with all")->take_all();
  app.add_option("--calibration", o.calibrations, "of the lenses: KITTI-360, OpenCV, WoodScape or Hugin files")
      ->take_all();
  app.add_option("--prediction", o.prediction, "a network's HDR panorama: its sky is laid in instead of the estimate");
  app.add_option("--truth", o.truth, "the same panorama in HDR, to be shown beside");
  app.add_option("--height", o.height, "of the result, rows at most")
      ->check(CLI::Range(64, 8192))
      ->capture_default_str();
  app.add_option("-o,--output", o.output, "folder for the pictures and files")->capture_default_str();
  return command(app, argc, argv, [&] { return run(o); });
}
