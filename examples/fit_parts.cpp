// examples/fit_parts.cpp -- the stages of fit_parts.h
// SPDX-License-Identifier: Apache-2.0
#include "fit_parts.h"
#include "fit_part.h"

namespace fitting {

Seen see(const Raycaster& scene, const Photo& photo, const Camera& camera, const parts::RolesOf& roles_of,
         const Settings& settings, const Watch& watch, const std::string& named) {
  watch("see", 0, 1, "");
  const GBuffer frame = scene.trace(camera);
  if (frame.size() == 0)
    throw Error(named + ": the vehicle is not in the picture; it stands at the origin, x ahead, y up, metres");
  const Mask seen_part = frame.frame("coverage");
  double shared = 0, either = 0;
  int x0 = frame.width, x1 = 0, y0 = frame.height, y1 = 0;
  for (int i = 0; i < frame.width * frame.height; ++i) {
    const float a = seen_part.values[std::size_t(i)], b = photo.vehicle.values[std::size_t(i)];
    shared += double(std::min(a, b)), either += double(std::max(a, b));
    if (a > 0 || b > 0.5f)
      x0 = std::min(x0, i % frame.width), x1 = std::max(x1, i % frame.width), y0 = std::min(y0, i / frame.width),
      y1 = std::max(y1, i / frame.width);
  }
  if (shared == 0)
    throw Error(named + ": the vehicle lies nowhere on the mask, expected it to be seen where the photo's is");
  const int margin = (x1 - x0) / 12 + 4;
  x0 = std::max(x0 - margin, 0), y0 = std::max(y0 - margin, 0);
  const int w = std::min(x1 + margin + 1, frame.width) - x0, h = std::min(y1 + margin + 1, frame.height) - y0;
  Seen seen;
  seen.iou = shared / either;
  seen.camera =
      camera.cropped(x0, y0, w, h).scaled(std::min(1.0f, std::sqrt(float(settings.pixels) / float(frame.size()))));
  seen.photo = photo.window(x0, y0, w, h, seen.camera);
  seen.g = scene.trace(seen.camera);
  seen.roles = roles_of(seen.g);
  if (seen.photo.label.empty()) {
    Mask paint(seen.camera.width, seen.camera.height);
    for (int i = 0; i < seen.g.size(); ++i)
      if (seen.roles[std::size_t(i)] == Role::paint) paint.values[std::size_t(seen.g.pixel[std::size_t(i)])] = 1;
    seen.guess = street::label_by_color(seen.photo, paint);
  }
  char note[96];
  std::snprintf(note, sizeof note, "%d pixels of the vehicle; it covers the mask with IoU %.3f", seen.g.size(),
                seen.iou);
  watch("see", 1, 1, note);
  return seen;
}

Lit light(const Raycaster& scene, const Seen& seen, const Image& photo, const Image& panorama, const Settings& settings,
          const Watch& watch) {
  watch("light", 0, 1, "");
  std::vector<int> wanted;
  std::vector<Role> roles;
  for (int i = 0; i < seen.g.size(); ++i)
    if (const Role r = seen.roles[std::size_t(i)]; r != Role::other) wanted.push_back(i), roles.push_back(r);
  Lit lit;
  lit.yaw = settings.yaw;
  if (lit.yaw == any_yaw) lit.yaw = best_yaw(settings, photo, panorama, seen.g, seen.roles, seen.photo);
  lit.world = world_of(settings, photo, panorama, lit.yaw);
  lit.shot = shot::gather(lit.world, scene, seen.g.picked(wanted), roles, Rings::Size::medium);
  auto& strength = lit.world.strength;
  if (settings.exposure <= 0) {
    const float up = white_point(lit.shot, lit.world, seen.photo);
    strength.sky *= up, strength.sun *= up;
  }
  char note[128];
  std::snprintf(note, sizeof note, "turned by %.0f degrees, %zu suns, strength %.2f %.2f %.2f, %.0f MB of tables",
                double(lit.yaw), lit.world.sky.suns.size(), double(strength.sky.x), double(strength.sky.y),
                double(strength.sky.z), double(lit.shot.light.bytes()) / 1e6);
  watch("light", 1, 1, note);
  return lit;
}

Materials fit_materials(const Seen& seen, const Lit& lit, const Settings& settings, Fits fits, const MoreLoss& more,
                        const Watch& watch, const Vehicle& start) {
  using looks::AtRunTime, looks::glazed;
  const auto part = [&](Role role, const auto& from, auto& state, const auto& look) {
    return fit_part(role, from, std::move(state), look, lit.shot, lit.world, seen.photo, settings, more, watch);
  };
  auto paint = part(Role::paint, start.paint, fits.paint, painted);
  auto window = part(Role::glass, start.window, fits.window, AtRunTime<decltype(glazed)>{&glazed});
  auto rubber = part(Role::rubber, start.rubber, fits.rubber, AtRunTime<decltype(painted)>{&painted});
  return {std::move(paint), std::move(window), std::move(rubber)};
}

std::vector<Image> draw(const Raycaster& scene, const Seen& seen, const Lit& lit, const parts::RolesOf& roles_of,
                        const std::vector<Vehicle>& vehicles, const Watch& watch) {
  watch("draw", 0, 1, "");
  const shot::Compositor compose(seen.photo.image, seen.camera, scene, lit.world, roles_of);
  std::vector<Image> out;
  for (const Vehicle& v : vehicles)
    out.push_back(compose([&](const Shot& s, const auto& others, Image& image) {
      render(s[Role::paint], shot::lit(painted, s, lit.world), v.paint, image);
      render(s[Role::glass], shot::lit(looks::glazed, s, lit.world), v.window, image);
      render(s[Role::rubber], shot::lit(painted, s, lit.world), v.rubber, image);
      render(s[Role::other], shot::lit(painted, s, lit.world), others, image);
    }));
  watch("draw", 1, 1, "the vehicle over the photo");
  return out;
}

FittedParts fit_parts(const Raycaster& scene, const parts::RolesOf& roles_of, const Photo& photo, const Camera& camera,
                      const Image& panorama, const Settings& settings, const MoreLoss& more, const Watch& watch) {
  FittedParts out{see(scene, photo, camera, roles_of, settings, watch), {}, {}, {}, {}};
  out.lit = light(scene, out.seen, photo.image, panorama, settings, watch);
  out.materials = fit_materials(out.seen, out.lit, settings, Fits(settings), more, watch);
  const Vehicle first{looks::first_paint(), {}, {}};
  auto pictures = draw(scene, out.seen, out.lit, roles_of, {first, out.materials.best()}, watch);
  out.before = std::move(pictures[0]), out.after = std::move(pictures[1]);
  return out;
}

}  // namespace fitting
