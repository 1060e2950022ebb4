// examples/street.cpp -- how street.h reads and what it takes as paint
// SPDX-License-Identifier: Apache-2.0
#include "street.h"
#include <burnish/io/camera.h>
#include <burnish/io/mesh.h>
#include <burnish/io/photo.h>
#include <burnish/math/color.h>

namespace street {

void add_options(CLI::App& app, Options& o) {
  app.option_defaults()->take_last();
  app.add_option("--photo", o.photo, "the photo: any format OpenImageIO reads");
  app.add_option("--mask", o.mask, "the vehicle in the photo: white, same size");
  app.add_option("--parts", o.parts,
                 "labels, same size: 1 paint, 2 glass, 3 rubber, 4 other, 0 not the vehicle; if not given, paint is "
                 "what has the colour of most");
  app.add_option(
      "--camera", o.camera,
      "JSON: width height fx fy cx cy position look_at up; the vehicle stands at the origin, x ahead, y up, metres");
  app.add_option("--vehicle", o.vehicle, "any format Assimp reads; archive.zip:inner/path for a file in a zip archive");
  app.add_option("--role", o.roles, "material=paint|glass|rubber|other, as often as needed; the rest is guessed")
      ->take_all();
  app.add_option("--environment", o.environment, "lat-long panorama, EXR or HDR");
  fitting::add_settings(app, o);
  app.add_option("--resume", o.resume, "go on from the states in this folder");
  app.add_option("--threads", o.threads, "0: all cores")->check(CLI::Range(0, 1024))->capture_default_str();
  app.add_option("-o,--output", o.output, "folder for pictures and files")->capture_default_str();
}

void complete(Options& o, const std::string& data) {
  if (o.photo == usual_photo) {
    if (o.mask.empty())
      o.mask = data + "/dog_pickup.mask.png", o.parts = o.parts.empty() ? data + "/dog_pickup.parts.png" : o.parts;
    if (o.camera.empty()) o.camera = data + "/dog_pickup.camera.json";
  }
  if (o.mask.empty()) throw Error("--mask is missing: which pixels of " + o.photo + " are the vehicle?");
  if (o.camera.empty()) throw Error("--camera is missing: how was " + o.photo + " taken?");
}

Mask both(Mask a, const Mask& b) {
  for (std::size_t i = 0; i < a.values.size(); ++i) a.values[i] *= b.values[i];
  return a;
}

Mask without_extremes(const Image& image, Mask mask) {
  const auto y = [&](std::size_t i) {
    return luminance(vec3<float>(image.plane(0)[i], image.plane(1)[i], image.plane(2)[i]));
  };
  std::vector<float> all;
  for (std::size_t i = 0; i < mask.values.size(); ++i)
    if (mask.values[i] > 0.5f) all.push_back(y(i));
  std::sort(all.begin(), all.end());
  for (std::size_t i = 0; i < mask.values.size() && !all.empty(); ++i)
    if (mask.values[i] > 0 && (y(i) < all[all.size() / 10] || y(i) > all[all.size() - 1 - all.size() / 10]))
      mask.values[i] = 0;
  return mask;
}

namespace {
/// The mask less what is not its paint, where nobody labelled panes, lamps, tyres and a roof of another colour. These
/// are grey as a rule; so where three tenths or more have a colour (CIE Lab chroma above 20), the paint is what has the
/// hue of most of that, to 40 degrees; else it is what is grey and as light as most, to 30 of lightness. where: the
/// pixels that hue and lightness are looked for in.
Mask of_one_color(const Image& image, Mask mask, const Mask& where) {
  struct Seen {
    float lightness, chroma;
    int hue;  // of 36
  };
  const auto seen = [&](std::size_t i) {
    const vec3<float> c(image.plane(0)[i], image.plane(1)[i], image.plane(2)[i]);
    const vec3<float> y = lab_from_rgb(linear_from_srgb(c));
    return Seen{y.x, std::hypot(y.y, y.z), int((std::atan2(y.z, y.y) / (2 * pi) + 1) * 36) % 36};
  };
  std::array<float, 36> hues{};
  std::array<int, 26> lightness{};  // in steps of 4
  int all = 0, colored = 0;
  for (std::size_t i = 0; i < mask.values.size(); ++i) {
    if (mask.values[i] <= 0.5f || where.values[i] <= 0.5f) continue;
    const Seen c = seen(i);
    ++all, colored += c.chroma > 20;
    if (c.chroma > 20) hues[std::size_t(c.hue)] += c.chroma;
    else ++lightness[std::size_t(std::clamp(c.lightness / 4, 0.0f, 25.0f))];
  }
  if (all == 0) return mask;
  const auto most = [](const auto& h) { return int(std::max_element(h.begin(), h.end()) - h.begin()); };
  const bool colorful = 10 * colored >= 3 * all;
  const int hue = most(hues), light = 4 * most(lightness) + 2;
  for (std::size_t i = 0; i < mask.values.size(); ++i) {
    if (mask.values[i] <= 0) continue;
    const Seen c = seen(i);
    const int apart = std::abs(c.hue - hue), turn = std::min(apart, 36 - apart);
    const bool paint =
        colorful ? c.chroma > 12 && turn <= 4 : c.chroma <= 20 && std::abs(c.lightness - float(light)) <= 30;
    if (!paint) mask.values[i] = 0;
  }
  return mask;
}
}  // namespace
std::string label_by_color(Photo& photo, const Mask& paint) {
  const Mask alike = of_one_color(photo.image, photo.vehicle, paint);
  int kept = 0, all = 0;
  for (std::size_t i = 0; i < std::size_t(alike.width) * std::size_t(alike.height); ++i) {
    const bool vehicle = photo.vehicle.values[i] > 0, one = alike.values[i] > 0;
    all += vehicle, kept += one;
    photo.label.push_back(int(one ? Role::paint : Role::other) + 1);
    if (!vehicle) photo.label.back() = 0;
  }
  return "no --parts: of " + std::to_string(all) + " pixels on the mask " + std::to_string(kept) +
         " have the colour of most and count as paint; glass and rubber are left as they are";
}

Inputs read(const Options& o) {
  Inputs in;
  for (const std::string& r : o.roles) in.roles.push_back(parts::parse_role(r));
  const Image photo = read_photo(o.photo);
  in.photo.image = Image(photo.width, photo.height);
  for (std::size_t i = 0; i < photo.values.size(); ++i)
    in.photo.image.values[i] = detail::to_srgb(std::clamp(photo.values[i], 0.0f, 1.0f));
  in.photo.vehicle = read_mask(o.mask, photo.width, photo.height);
  if (!o.parts.empty()) in.photo.label = read_labels(o.parts, photo.width, photo.height);
  const auto empty = [](const Mask& m) {
    return std::none_of(m.values.begin(), m.values.end(), [](float x) { return x > 0.5f; });
  };
  if (empty(in.photo.vehicle)) throw Error(o.mask + ": no pixel is white, expected the vehicle to be");
  if (empty(in.photo.of(Role::paint)))
    throw Error(o.parts + ": no pixel on the mask is labelled 1, expected the vehicle's paint to be");
  in.camera = read_camera(o.camera);
  if (in.camera.width != photo.width || in.camera.height != photo.height)
    throw Error(o.camera + ": camera " + std::to_string(in.camera.width) + " x " + std::to_string(in.camera.height) +
                ", photo " + std::to_string(photo.width) + " x " + std::to_string(photo.height) + ": they must agree");
  in.panorama = read_photo(o.environment);
  in.mesh = read_vehicle(o.vehicle, &in.report);
  return in;
}

}  // namespace street
