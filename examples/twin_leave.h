// examples/twin_leave.h -- what a twin leaves behind: the model with its materials, pictures, a turntable, a page
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/io/page.h>
#include <burnish/twin/assign_parts.h>
#include "dressed.h"
#include "fit_report.h"
#include "turntable.h"
#include "twin_find.h"

namespace twin {

class Leavings {
public:
  Leavings(std::string folder, const std::string& photo)
      : folder_(std::move(folder)),
        page_("A twin of a vehicle in " + std::filesystem::path(photo).filename().string()) {}

  void found(const std::vector<Candidate>& all, const Image& photo, const Mask& mask, const std::string& how) {
    const Candidate& best = all.front();
    const PoseCandidate& p = best.poses.front();
    Image marked = photo;
    for (int y = 0; y < photo.height; ++y)
      for (int x = 0; x < photo.width; ++x) marked.set(x, y, photo.at(x, y) * (0.3f + 0.7f * mask.at(x, y)));
    write_png(folder_ + "/photo.png", marked);
    page_.heading("The photo").picture(marked, "The vehicle, " + how + ".");
    const Image sheet = contact_sheet(all, photo, mask);
    write_png(folder_ + "/candidates.png", sheet);
    page_.heading("The model");
    page_.text(
        "The library's vehicles that look most like it, each posed against the photo; the first is kept. Cosine: of "
        "the vehicle's best view with the photo's mask and edges. Score: of what the pose covers of the mask, and of "
        "edges and dark parts.");
    page_.picture(sheet, best.name + " is what the twin is made of.");
    const Image posed =
        around(overlay(photo, mask, best.scene->trace(p.pose.camera()).frame("coverage")), mask, 0.2f, 960);
    write_png(folder_ + "/pose.png", posed);
    page_.heading("The pose")
        .picture(posed, "Green: mask and model agree; red: the model alone; blue: the mask alone.");
    const auto number = [](const char* format, double x) {
      char text[48];
      std::snprintf(text, sizeof text, format, x);
      return std::string(text);
    };
    constexpr double degree = 57.29577951308232;
    std::vector<Page::Number> numbers{
        {"share of the mask, by the union", number("IoU %.3f", p.iou), ""},
        {"seen from (0 front, 90 right)", number("%.1f degrees", std::remainder(double(p.pose.azimuth) * degree, 360)),
         number("+- %.1f", double(p.deviation.azimuth) * degree)},
        {"from above", number("%.1f degrees", double(p.pose.elevation) * degree),
         number("+- %.1f", double(p.deviation.elevation) * degree)},
        {"distance", number("%.2f m", double(p.pose.distance)), number("+- %.2f", double(p.deviation.distance))},
        {"belief in this heading", number("%.0f %%", 100 * p.belief), p.belief < 0.8 ? "not sure" : ""}};
    page_.numbers(numbers);
    page_.text("+- is how far stretches of the outline pull the pose apart. That the model may be another car than the "
               "photo's is not in it: then the angles may be off by some degrees.");
    for (const std::string& line : best.report.lines) page_.text("The file: " + line);
  }

  /// Gives a line on what was told apart. labels: of the photo's pixels.
  std::string parts(const Raycaster& scene, const AssignedParts& parts, const Image& photo,
                    const std::vector<int>& labels) {
    constexpr int wide = 480, high = 300;
    std::vector<Panel> panels;
    for (const float azimuth : {0.6f, 2.5f}) {
      const GBuffer g = scene.trace(framed(bounds(scene.mesh()), azimuth, 0.25f, wide, high).camera());
      const auto color = [&](int i) {
        return kind_colors[std::size_t(parts.parts[std::size_t(g.part[std::size_t(i)])].kind)];
      };
      panels.push_back({azimuth < 1 ? "body red, windows blue, wheels purple, lights yellow" : "from behind",
                        drawn(g, color, {1, 1, 1})});
    }
    const Image kinds = sheet(panels, 2);
    write_png(folder_ + "/parts.png", kinds);
    Mask any(photo.width, photo.height);
    for (std::size_t i = 0; i < labels.size(); ++i) any.values[i] = labels[i] != 0 ? 1.0f : 0.0f;
    const Image seen = around(labelled(photo, labels), any, 0.15f, 960);
    write_png(folder_ + "/photo_parts.png", seen);
    std::array<double, part_kinds> share{};
    std::vector<std::vector<std::string>> rows{{"material", "part", "taken as", "confidence", "seen", "because"}};
    for (std::size_t p = 0; p < parts.parts.size(); ++p) {
      const PartGuess& g = parts.parts[p];
      share[std::size_t(g.kind)] += double(g.share);
      char sure[16], area[16];
      std::snprintf(sure, sizeof sure, "%.0f %%", 100 * double(g.confidence));
      std::snprintf(area, sizeof area, "%.1f %%", 100 * double(g.share));
      const Part& part = scene.mesh().parts[p];
      if (g.share > 0.0005f)
        rows.push_back({part.material, part.name, std::string(name_of(g.kind)), sure, area, g.reason});
    }
    page_.heading("The parts")
        .picture(kinds, "What the materials were taken for. parts.txt can be edited and given back.");
    page_.picture(seen, "The photo's own pixels, by the model's parts and their colours.").table(rows);
    for (const std::string& n : parts.notes) page_.text(n);
    char text[160];
    std::snprintf(text, sizeof text, "body %.0f %%, windows %.0f %%, wheels %.0f %%, lights %.0f %% of what is seen",
                  100 * share[0], 100 * share[1], 100 * (share[2] + share[3] + share[4]), 100 * share[5]);
    return text;
  }

  void fitted(const fitting::FittedParts& f, const fitting::Settings& settings) {
    report::write_pictures(folder_, f.seen, f.before, f.after);
    page_.heading("The materials");
    page_.compare(report::panel(shot::linear(f.seen.photo.image)), report::panel(f.after),
                  "The photo; the twin over it.");
    page_.picture(folder_ + "/fit.png", "Photo, first paint, fitted materials, and what is left where both overlap.");
    const report::Rows rows = report::numbers(f.materials, settings);
    report::print(rows);
    page_.table(rows);
    page_.text(
        "+- is a standard deviation: how much a number could change and the picture still fit as well, given the "
        "light. How strong the light was one photo does not tell.");
  }

  /// twin.glb: the body with the fitted paint, windows with the glass, tyres with the rubber; the rest as in the file.
  void model(const Raycaster& scene, const AssignedParts& parts, const looks::Vehicle& v) {
    dressed::write(folder_ + "/twin.glb", scene.mesh(), dressed::Dressed(scene, parts.kinds(), v), "twin");
  }

  void turntable(const Raycaster& scene, const AssignedParts& parts, const fitting::FittedParts& f, int frames) {
    Progress bar("turntable");
    const looks::Vehicle v = f.materials.best();
    const dressed::Dressed look(scene, parts.kinds(), v);
    std::vector<std::string> jpegs;
    Image first;
    World world = f.lit.world;
    expose(world);
    turntable::turn(scene, world.sky, world.strength, world.occluded, look, looks::developed, {.frames = frames},
                    [&](int i, const Image& picture) {
                      if (i == frames / 12) first = picture;
                      jpegs.push_back(jpeg_of(picture));
                      bar.show(i + 1, frames);
                      return !interrupted;
                    });
    bar.finish(std::to_string(jpegs.size()) + " pictures");
    if (first.width > 0) write_png(folder_ + "/twin.png", first);
    page_.heading("All round").turntable(jpegs, "The twin under the light it was fitted in. Drag it.");
  }

  void page(const std::vector<std::pair<std::string, double>>& times, double seconds) {
    page_.heading("Files");
    page_.download(folder_ + "/twin.glb", "the model with its materials, for any glTF viewer");
    page_.download(folder_ + "/paint.json", "the paint");
    page_.download(folder_ + "/glass.json", "the panes");
    page_.download(folder_ + "/rubber.json", "the tyres");
    page_.download(folder_ + "/camera.json", "the camera, as the other programs read it");
    page_.download(folder_ + "/parts.txt", "what the parts are, to be edited");
    char text[64];
    std::snprintf(text, sizeof text, "%.1f s on %d threads.", seconds, threads());
    page_.heading("Time").times(times).text(text);
    page_.write(folder_ + "/index.html");
  }

private:
  using World = shot::World;
  std::string folder_;
  Page page_;

  /// A photographer's exposure: what is white and lies level is nearly so. The photo may have been overexposed.
  static void expose(World& world) {
    const vec3<float> up(0, 1, 0);
    const auto e = IrradianceMap(world.sky)(up);
    vec3<float> light = vec3<float>(e[0], e[1], e[2]) * world.strength.sky;
    for (const Sun<float>& s : world.sky.suns)
      light += s.power * (std::max(0.0f, dot(up, s.direction))) * world.strength.sun;
    const float k = 0.8f * pi / std::max(luminance(light), 1e-6f);
    world.strength.sky *= k, world.strength.sun *= k;
  }
};

}  // namespace twin
