// examples/15_scenes.cpp -- ten vehicles in ten streets: a contact sheet on a page, to be judged by eye
// SPDX-License-Identifier: Apache-2.0
#include <burnish/io/page.h>
#include <burnish/io/report.h>
#include "command.h"
#include "insertion.h"

using namespace burnish;

namespace {
struct Scene {
  const char *vehicle, *panorama;
  float yaw, right, ahead, heading;  // degrees, metres
  vec3<float> paint;
  float metal = 0.1f;
};
constexpr const char *suv = "Scopia.sh3f:scopia/suv/suv.obj",
                     *focus = "BlendSwap-CC-BY.sh3f:blendswap-cc-by/fordFocus/fordFocus.obj",
                     *smart = "Scopia.sh3f:scopia/smart-car/smart-car.obj", *van = "Scopia.sh3f:scopia/van/van.obj";
const Scene scenes[] = {{suv, "city", 0, 1.2f, 8, 150, {0.42f, 0.04f, 0.03f}},
                        {focus, "city", 150, -1.0f, 7.5f, 215, {0.62f, 0.63f, 0.64f}, 0.5f},
                        {van, "city", 80, 0.5f, 11, 150, {0.75f, 0.75f, 0.73f}},
                        {smart, "city", 255, -1.2f, 7, 30, {0.5f, 0.33f, 0.04f}},
                        {focus, "sunset", 0, 0.8f, 7, 140, {0.02f, 0.05f, 0.16f}, 0.4f},
                        {suv, "sunset", 20, -1.0f, 8, 215, {0.03f, 0.03f, 0.035f}, 0.3f},
                        {suv, "forest", 172, 0.6f, 8, 25, {0.05f, 0.12f, 0.08f}, 0.3f},
                        {focus, "sunrise", 20, 0.6f, 7, 210, {0.35f, 0.02f, 0.02f}, 0.3f},
                        {van, "sunrise", 200, -1.0f, 10, 145, {0.3f, 0.36f, 0.42f}},
                        {smart, "night", 90, 0.4f, 6, 150, {0.08f, 0.2f, 0.4f}}};
}  // namespace

int main(int argc, char** argv) {
  insertion::Options o;
  o.width = 960;
  std::string output = "burnish-scenes", vehicles = "/usr/share/sweethome3d/furniture/",
              panoramas = "/usr/share/blender/datafiles/studiolights/world/";
  CLI::App app{
      "Ten vehicles in ten streets, and a page with all of them.\n\n"
      "  15_scenes --samples 128 --output scenes\n\n"
      "Sweet Home 3D's vehicles in Blender's panoramas. Options of 12_insert hold for all ten."};
  insertion::add_options(app, o);
  app.add_option("--vehicles", vehicles, "folder of the vehicles' archives")->capture_default_str();
  app.add_option("--panoramas", panoramas, "folder of the panoramas")->capture_default_str();
  app.add_option("-o,--output", output, "folder for the pictures and the page")->capture_default_str();
  return command(app, argc, argv, [&] {
    Progress whole(""), bar("draw");
    std::vector<Panel> panels;
    Page page("Ten vehicles in ten streets");
    int k = 0;
    for (const Scene& s : scenes) {
      if (interrupted) break;
      insertion::Options with = o;
      with.vehicle = vehicles + s.vehicle, with.environment = panoramas + s.panorama + ".exr";
      with.yaw = s.yaw, with.at = {s.right, s.ahead}, with.heading = s.heading;
      insertion::Street street = insertion::read(with);
      if (k == 0) check_writable(output), catch_interrupt();
      street.look.paint.base_color = s.paint, street.look.paint.base_metalness = s.metal;
      const insertion::Shot shot = insertion::shoot(street, street.place, with.edit, with, [&](int done, int of) {
        bar.show(k * 100 + 100 * done / of, 100 * int(std::size(scenes)), s.panorama);
      });
      char name[32];
      std::snprintf(name, sizeof name, "/%02d_%s.png", ++k, s.panorama);
      write_png(output + name, shot.composite);
      panels.push_back({"", shot.composite});
      Image labelled = shot.composite;
      const auto edge = [&](float x0, float y0, float x1, float y1) {
        for (int y = std::max(0, int(y0)); y < std::min(labelled.height, int(y1)); ++y)
          for (int x = std::max(0, int(x0)); x < std::min(labelled.width, int(x1)); ++x)
            labelled.set(x, y, {0, 0.9f, 0.1f});
      };
      const SeenVehicle& v = shot.seen;
      edge(v.x0 - 1, v.y0 - 1, v.x1 + 1, v.y0 + 1), edge(v.x0 - 1, v.y1 - 1, v.x1 + 1, v.y1 + 1);
      edge(v.x0 - 1, v.y0 - 1, v.x0 + 1, v.y1 + 1), edge(v.x1 - 1, v.y0 - 1, v.x1 + 1, v.y1 + 1);
      page.heading(std::to_string(k) + ": " + s.panorama)
          .compare(street.plate, shot.composite, "The panorama's own picture; with the vehicle.")
          .picture(labelled, "Its box: " + kitti_line("Car", shot.seen, shot.box));
    }
    bar.finish(std::to_string(panels.size()) + " pictures of " + std::to_string(o.preview ? 4 : o.samples) +
               " paths a pixel");
    const Image all = sheet(panels, 2);
    write_png(output + "/sheet.png", all);
    page.heading("All").picture(all, "The contact sheet.");
    page.write(output + "/index.html");
    std::printf("\nDone after %.1f s. Open %s/index.html; %s/sheet.png is the contact sheet.\n", whole.seconds(),
                output.c_str(), output.c_str());
    return 0;
  });
}
