// examples/edited.h -- what is changed of a vehicle, from a command line
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>
#include <burnish/io/joints.h>
#include <burnish/twin/edit.h>

namespace editing {
using namespace burnish;

struct Options {
  std::vector<std::string> open, hide;
  std::string joints;
  float spin = 0, steer = 0, over = 0;
  bool any() const { return !open.empty() || !hide.empty() || spin != 0 || steer != 0 || over != 0; }
};
inline void add_options(CLI::App& app, Options& o) {
  app.add_option("--open", o.open, "joint=degrees, as often as needed: front_left_door, bonnet, boot, ...; doors: all")
      ->take_all();
  app.add_option("--joints", o.joints,
                 "what opens and where, as 13_edit writes it; if not given, found from the shape");
  app.add_option("--spin", o.spin, "degrees that the wheels have rolled");
  app.add_option("--steer", o.steer, "degrees that the front wheels are turned to the left")
      ->check(CLI::Range(-60, 60));
  app.add_option("--hide", o.hide,
                 "as often as needed: a kind (body, window, wheel, light, other), a part, a material or a joint")
      ->take_all();
  app.add_option("--over", o.over, "degrees that it is turned over to its right: 90 on its side, 180 on its roof");
}
inline Edit edit_of(const Options& o, const std::vector<Joint>& joints) {
  Edit e;
  for (const std::string& text : o.open) {
    const std::size_t eq = text.find('=');
    float angle = 0;
    try {
      angle = eq == std::string::npos ? 60 : std::stof(text.substr(eq + 1));
    } catch (const std::exception&) {
      throw Error("--open " + text + ": expected joint=degrees");
    }
    const std::string name = text.substr(0, eq);
    if (name != "doors") e.open[name] = angle;
    else
      for (const Joint& j : joints)
        if (j.name.find("_door") != std::string::npos) e.open[j.name] = angle;
  }
  e.spin = o.spin, e.steer = o.steer, e.over = o.over;
  e.hidden.insert(o.hide.begin(), o.hide.end());
  return e;
}
/// Joints of the file, or found; what of the edit is not there is an Error that says what is.
inline EditedVehicle apply(const Mesh& mesh, const std::vector<PartKind>& kinds, const Options& o) {
  if (!o.any()) return {mesh, kinds, {}};
  std::vector<std::string> notes;
  const std::vector<Joint> joints = o.joints.empty() ? find_joints(mesh, kinds, &notes) : read_joints(o.joints);
  EditedVehicle v = edited(mesh, kinds, joints, edit_of(o, joints));
  if (!v.missing.empty()) {
    std::string have;
    for (const Joint& j : joints) have += (have.empty() ? "" : ", ") + j.name;
    throw Error("\"" + v.missing.front() + "\" is nothing of this vehicle; it has " +
                (have.empty() ? "no joint" : have) + (notes.empty() ? "" : " (" + notes.front() + ")"));
  }
  return v;
}

}  // namespace editing
