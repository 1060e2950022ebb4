// examples/10_segment.cpp -- a photo and a point in a vehicle, or a box around it, go in; the vehicle's mask comes out
// SPDX-License-Identifier: Apache-2.0
//
// The mask is that of 04_fit_material, 05_match_pose and 06_retrieve. A detector (io/network.h) is no need, but the surer
// way from a point to a box.
#include <burnish/io/network.h>
#include <burnish/io/photo.h>
#include <burnish/io/report.h>
#include <burnish/twin/segment_at.h>
#include "command.h"
#include "progress.h"

using namespace burnish;

namespace {
struct Options {
  std::string photo = "/usr/share/darknet/data/dog.jpg", mask, output = "burnish-mask";
  std::vector<float> point, box;
  std::vector<std::string> detector;
  int pixels = SegmentOptions().pixels;
};

/// The photo, dark where the mask is not, with its outline in red.
Image shown(const Image& photo, const Mask& mask) {
  Image out = photo;
  const int thick = std::max(1, photo.width / 500);
  const auto in = [&](int x, int y) {
    return mask.at(std::clamp(x, 0, photo.width - 1), std::clamp(y, 0, photo.height - 1)) > 0.5f;
  };
  for (int y = 0; y < photo.height; ++y)
    for (int x = 0; x < photo.width; ++x) {
      const bool rim = in(x, y) && (!in(x - thick, y) || !in(x + thick, y) || !in(x, y - thick) || !in(x, y + thick));
      if (rim) out.set(x, y, {1, 0, 0});
      else if (!in(x, y)) out.set(x, y, photo.at(x, y) * 0.3f);
    }
  return out;
}

Segmented find(const Options& o, const Image& photo, std::string& by) {
  SegmentOptions options;
  if (!o.box.empty()) {
    by = "the box";
    options.pixels = o.pixels;
    return segment(photo, PixelBox{o.box[0], o.box[1], o.box[2], o.box[3]}, options);
  }
  const vec2<float> place(o.point[0], o.point[1]);
  if (!o.detector.empty()) {
    Network yolo(o.detector[0], o.detector[1]);
    if (const auto found = vehicle_at(detect(yolo, photo), place.x, place.y)) {
      char text[80];
      std::snprintf(text, sizeof text, "the detector's box, score %.2f", double(found->score));
      by = text;
      options = for_detections();
      options.pixels = o.pixels;
      return segment(photo, found->box, options);
    }
    std::printf("  the detector sees no vehicle at the point\n");
  }
  by = "the point";
  options.pixels = o.pixels;
  return segment(photo, place, options);
}

int run(Options o) {
  Progress whole("");
  const Image photo = read_photo(o.photo);
  const auto in_photo = [&](float x, float y) {
    return x >= 0 && y >= 0 && x < float(photo.width) && y < float(photo.height);
  };
  if (o.point.empty() && o.box.empty() && o.mask.empty()) {
    if (o.photo != Options().photo)
      throw Error("where is the vehicle in " + o.photo +
                  "? --point x,y or --box x0,y0,x1,y1 or --mask FILE is missing");
    o.point = {580, 130};
  }
  if (!o.point.empty() && !in_photo(o.point[0], o.point[1]))
    throw Error("--point: not in the photo, expected less than " + detail::size_of(photo.width, photo.height));
  if (!o.box.empty() && !(o.box[2] - o.box[0] >= 8 && o.box[3] - o.box[1] >= 8 && in_photo(o.box[0], o.box[1]) &&
                          o.box[2] <= float(photo.width) && o.box[3] <= float(photo.height)))
    throw Error("--box: expected x0,y0,x1,y1 in the photo of " + detail::size_of(photo.width, photo.height) +
                ", 8 pixels or more each way");
  Progress work("segment");
  Segmented s;
  std::string by;
  if (!o.mask.empty()) {
    by = "the mask that was given, cleaned";
    std::optional<vec2<float>> place;
    if (!o.point.empty()) place = vec2<float>(o.point[0], o.point[1]);
    s.mask = cleaned(read_mask(o.mask, photo.width, photo.height), place);
    s.certainty = 1;
  } else {
    s = find(o, photo, by);
  }
  long area = 0;
  for (const float v : s.mask.values) area += v > 0.5f;
  if (area == 0)
    throw Error(o.mask.empty() ? o.photo + ": nothing stands out there, expected a vehicle"
                               : o.mask + ": empty, expected a vehicle");
  work.finish("by " + by);
  check_writable(o.output);
  write_png(o.output + "/mask.png", s.mask);
  write_png(o.output + "/segment.png", shown(photo, s.mask));
  std::printf("%ld pixels, %.1f %% of the photo", area, 100.0 * double(area) / (double(photo.width) * photo.height));
  if (o.mask.empty())
    std::printf("; certainty %.2f%s", double(s.certainty),
                s.certainty < 0.7f ? ": look at the picture, or give a box" : "");
  std::printf("\n\nDone after %.1f s. %s/segment.png shows it; %s/mask.png is the mask.\n", whole.seconds(),
              o.output.c_str(), o.output.c_str());
  return 0;
}
}  // namespace

int main(int argc, char** argv) {
  Options o;
  CLI::App app{
      "Cuts a vehicle out of a photo.\n\n"
      "  10_segment --photo street.jpg --point 320,240 --output mask\n"
      "  10_segment --photo street.jpg --box 80,120,560,330\n"
      "  10_segment --photo street.jpg --point 320,240 --detector yolo.cfg,yolo.weights\n\n"
      "Without arguments: the white pickup of darknet's dog.jpg."};
  app.option_defaults()->take_last();
  app.add_option("--photo", o.photo, "the photo: any format OpenImageIO reads")->capture_default_str();
  app.add_option("--point", o.point, "x,y: a place in the vehicle, in pixels")->delimiter(',')->expected(2)->take_all();
  app.add_option("--box", o.box, "x0,y0,x1,y1: a box around the vehicle")->delimiter(',')->expected(4)->take_all();
  app.add_option("--mask", o.mask, "a mask to be checked and cleaned: one piece (at --point), without holes");
  app.add_option("--detector", o.detector,
                 "PLAN.cfg,WEIGHTS: a Darknet detector with COCO's classes, to go from the point to a box")
      ->delimiter(',')
      ->expected(2)
      ->take_all();
  app.add_option("--pixels", o.pixels,
                 "the longer side of the vehicle's box, at most, in the picture that is worked on")
      ->check(CLI::Range(64, 2048))
      ->capture_default_str();
  app.add_option("-o,--output", o.output, "folder for the mask and the picture")->capture_default_str();
  return command(app, argc, argv, [&] { return run(o); });
}
