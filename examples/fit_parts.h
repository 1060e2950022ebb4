// examples/fit_parts.h -- the parts of a posed vehicle against a photo: seen, lit, fitted, drawn
// SPDX-License-Identifier: Apache-2.0
//
// Four stages, each a function of its own; fit_parts runs them all. Nothing is written but checkpoints, if wanted.
#pragma once
#include <memory>
#include "fitted.h"
#include "looks.h"
#include "progress.h"
#include "shot.h"
#include "watch.h"

namespace fitting {
using fitted::Fitted;
using looks::Vehicle, looks::Window;
using shot::Shot, shot::World;

/// Stages on the terminal: a bar while one runs, a line when it is done. Ctrl-C stops (catch_interrupt).
inline Watch on_terminal() {
  return [now = std::shared_ptr<Progress>(), stage = std::string()](const std::string& what, int done, int of,
                                                                    const std::string& note) mutable {
    if (!now || what != stage) now = std::make_shared<Progress>(what), stage = what;
    if (done < of) now->show(done, of, note);
    else now->finish(note), now.reset();
    return !interrupted;
  };
}

/// What the camera sees, in the window of the photo that the vehicle is in, made smaller if it has too many pixels.
struct Seen {
  Camera camera;
  Photo photo;
  GBuffer g;
  std::vector<Role> roles;  // of every surfel
  double iou = 0;           // of the model's silhouette and the photo's mask, in the whole photo
  std::string guess;        // a sentence on how the photo's labels were guessed, if they were
};
/// photo: all of it, and camera the one that took it. named: who they are, for Error where the vehicle is not seen.
Seen see(const Raycaster& scene, const Photo& photo, const Camera& camera, const parts::RolesOf& roles_of,
         const Settings& settings, const Watch& watch, const std::string& named = "camera");

/// The panorama as light, and what of it reaches the parts that are fitted.
struct Lit {
  float yaw = 0;  // degrees
  World world;
  Shot shot;
};
/// photo: all of it; its mean brightness tells how strong the light is.
Lit light(const Raycaster& scene, const Seen& seen, const Image& photo, const Image& panorama, const Settings& settings,
          const Watch& watch);

/// The three fits at their start, or where an earlier one left them.
struct Fits {
  FitState<CarPaint<float>> paint;
  FitState<Window<float>> window;
  FitState<Rubber<float>> rubber;

  /// Error for a frozen parameter that no material has.
  explicit Fits(const Settings& settings, const Vehicle& start = {looks::first_paint(), {}, {}})
      : paint(start.paint, Adam{.rate = settings.rate}),
        window(start.window, Adam{.rate = settings.rate}),
        rubber(start.rubber, Adam{.rate = settings.rate}) {
    for (const std::string& f : settings.freeze) {
      bool known = false;
      const auto look = [&](const std::string& name, auto&, Range) {
        known |= name == f || name.rfind(f + ".", 0) == 0;
      };
      for_each_parameter(start.paint, look), for_each_parameter(start.window, look),
          for_each_parameter(start.rubber, look);
      if (!known) throw Error("--freeze " + f + ": no material has such a parameter");
    }
  }
};
/// What was found of each part.
struct Materials {
  Fitted<CarPaint<float>> paint;
  Fitted<Window<float>> window;
  Fitted<Rubber<float>> rubber;
  Vehicle best() const { return {paint.state.best, window.state.best, rubber.state.best}; }
};
/// start: what the prior holds to.
Materials fit_materials(const Seen& seen, const Lit& lit, const Settings& settings, Fits fits, const MoreLoss& more,
                        const Watch& watch, const Vehicle& start = {looks::first_paint(), {}, {}});

/// Pictures of the vehicle over the photo's window, linear light.
std::vector<Image> draw(const Raycaster& scene, const Seen& seen, const Lit& lit, const parts::RolesOf& roles_of,
                        const std::vector<Vehicle>& vehicles, const Watch& watch);

/// All of it.
struct FittedParts {
  Seen seen;
  Lit lit;
  Materials materials;
  Image before, after;  // of the photo's window, linear light
};
/// photo: the whole one, display values, with mask and labels (if it has none, they are guessed by colour); camera took
/// it. roles_of: what each surfel of a G-buffer is, see vehicle_parts.h.
FittedParts fit_parts(const Raycaster& scene, const parts::RolesOf& roles_of, const Photo& photo, const Camera& camera,
                      const Image& panorama, const Settings& settings, const MoreLoss& more, const Watch& watch);

}  // namespace fitting
