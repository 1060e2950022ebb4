// examples/13_edit.cpp -- doors open, wheels turn, parts go, it lies on its roof, in another's paint and another light
// SPDX-License-Identifier: Apache-2.0
#include <burnish/io/report.h>
#include "command.h"
#include "dressed.h"
#include "insertion.h"

using namespace burnish;

namespace {
struct Item {
  std::string label;
  editing::Options edit;
  std::string environment = {}, materials = {};
  float heading = 0;  // degrees more
};
/// What can be shown of any vehicle.
std::vector<Item> gallery(const std::vector<Joint>& joints, const std::string& relight, const std::string& materials) {
  std::vector<Item> all{{"as it is", {}}};
  const auto has = [&](const std::string& what) {
    return std::any_of(joints.begin(), joints.end(), [&](const Joint& j) { return j.name.find(what) != j.name.npos; });
  };
  editing::Options e;
  if (has("_door")) e.open = {"doors=65"}, all.push_back({"--open doors=65", e});
  e = {};
  if (has("bonnet")) e.open.push_back("bonnet=50");
  if (has("boot")) e.open.push_back("boot=60");
  if (!e.open.empty())
    all.push_back({"--open " + e.open.front() + (e.open.size() > 1 ? " --open " + e.open[1] : ""), e});
  e = {};
  if (has("_wheel")) e.steer = 30, e.spin = 40, all.push_back({"--steer 30 --spin 40", e});
  e = {};
  e.hide = {"body"}, all.push_back({"--hide body", e});
  e = {};
  e.over = 180, all.push_back({"--over 180", e});
  all.push_back({"--heading 30", {}, {}, {}, 240});
  all.push_back({"--relight " + relight.substr(relight.rfind('/') + 1), {}, relight});
  if (!materials.empty()) all.push_back({"--materials " + materials, {}, {}, materials});
  return all;
}
}  // namespace

int main(int argc, char** argv) {
  insertion::Options o;
  o.width = 640, o.samples = 24, o.at = {0.2f, 7.2f};
  std::string output = "burnish-edit", relight = "/usr/share/blender/datafiles/studiolights/world/sunset.exr";
  int turntable = 0;
  CLI::App app{
      "Changes a vehicle and shows it: what opens and turns is found from its shape, and may be edited.\n\n"
      "  13_edit --twin burnish-twin --open front_left_door=70 --steer 20 --over 0 --output opened\n\n"
      "Without an edit: a sheet of what can be done with Sweet Home 3D's SUV."};
  insertion::add_options(app, o);
  app.add_option("--relight", relight, "another panorama, for the sheet")->capture_default_str();
  app.add_option("--turntable", turntable, "pictures all round, of the vehicle as it then is")
      ->check(CLI::Range(0, 720));
  app.add_option("-o,--output", output, "folder for pictures, joints.json and edited.glb")->capture_default_str();
  return command(app, argc, argv, [&] {
    Progress whole("");
    const bool all = turntable == 0 && !o.edit.any();  // the sheet of what can be done, another's materials last
    std::string materials;
    if (all) std::swap(materials, o.materials);
    insertion::Street street = insertion::read(o);
    const EditedVehicle last = editing::apply(street.mesh, street.kinds, o.edit);
    if (last.mesh.triangles.empty()) throw Error("nothing is left of the vehicle");
    check_writable(output);
    catch_interrupt();
    std::vector<std::string> notes;
    const std::vector<Joint> joints =
        o.edit.joints.empty() ? find_joints(street.mesh, street.kinds, &notes) : read_joints(o.edit.joints);
    write_joints(output + "/joints.json", joints);
    for (const Joint& j : joints)
      std::printf("%-18s %s%s\n", j.name.c_str(),
                  j.kind == Joint::wheel ? (j.steered ? "rolls, is steered" : "rolls") : "opens",
                  j.sure ? "" : ", its rear edge assumed");
    for (const std::string& n : notes) std::printf("  %s\n", n.c_str());
    std::vector<Item> items;
    if (all) items = gallery(joints, relight, materials);
    else if (turntable == 0) items = {{"as it is", {}}, {"edited", o.edit}};
    for (int k = 0; k < turntable; ++k)
      items.push_back(
          {std::to_string(360 * k / turntable) + " degrees", o.edit, {}, {}, 360.0f * float(k) / float(turntable)});
    const looks::Vehicle look = street.look;
    const LightField<PanoramaFile> lights = street.lights;
    Progress bar("draw");
    std::vector<Panel> panels;
    for (std::size_t k = 0; k < items.size() && !interrupted; ++k) {
      const Item& item = items[k];
      insertion::Options with = o;
      with.edit = item.edit, with.edit.joints = o.edit.joints;
      street.lights = lights;
      if (!item.environment.empty()) street.lights = {{{{}, {item.environment, o.yaw * 0.0174532925f}}}};
      insertion::light(street, o, street.place);
      street.look = look;
      if (!item.materials.empty()) insertion::read_materials(item.materials, street.look);
      Placement place = street.place;
      place.heading += item.heading * 0.0174532925f;
      const insertion::Shot shot = insertion::shoot(street, place, with.edit, with, [&](int done, int of) {
        bar.show(int(k) * 100 + 100 * done / of, 100 * int(items.size()), item.label);
      });
      panels.push_back({item.label, shot.composite});
      if (o.edit.any() && turntable == 0 && k + 1 == items.size()) insertion::write(output, shot);
      char name[32];
      std::snprintf(name, sizeof name, "/turn_%03zu.png", k);
      if (turntable > 0) write_png(output + name, shot.composite);
    }
    bar.finish(std::to_string(panels.size()) + " pictures");
    write_png(output + "/edits.png", sheet(panels, 2 + (panels.size() > 4)));
    const Raycaster scene(last.mesh);
    dressed::write(output + "/edited.glb", last.mesh, dressed::Dressed(scene, last.kinds, look), "edited vehicle");
    std::printf(
        "\nDone after %.1f s. %s/edits.png shows it; %s/joints.json may be edited and given back by --joints; "
        "%s/edited.glb opens in any glTF viewer.\n",
        whole.seconds(), output.c_str(), output.c_str(), output.c_str());
    return 0;
  });
}
