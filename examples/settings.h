// examples/settings.h -- how the materials of a vehicle are fitted to a photo: the numbers, and their arguments
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fitting {

inline constexpr float any_yaw = 1000;
struct Settings {
  std::vector<std::string> freeze = {"tint",
                                     "coat_ior",
                                     "mottle.size",
                                     "flakes.size",
                                     "flakes.resolved",
                                     "glass.base_color",
                                     "glass.specular_roughness",
                                     "glass.specular_ior",
                                     "specular_ior"};
  float yaw = any_yaw, exposure = 0, rate = 0.02f, prior = 0.02f;
  int steps = 300, patience = 50, pixels = 40000;
  /// Of the pixels where part lies on part, and of the whole parts' means and variances; if not given, as in fit_part.h.
  std::optional<std::pair<double, double>> weights;
  std::string checkpoints;  // a folder that states are written to every 50 steps; none when empty

  /// Whether a parameter, or what it is a member of, is frozen.
  bool frozen(const std::string& parameter) const {
    return std::any_of(freeze.begin(), freeze.end(),
                       [&](const auto& f) { return parameter == f || parameter.rfind(f + ".", 0) == 0; });
  }
};

inline void add_settings(CLI::App& app, Settings& s) {
  app.add_option("--yaw", s.yaw, "degrees the panorama is turned about +y; if not given, the best of eight");
  app.add_option("--exposure", s.exposure, "strength of the light; 0: found from the photo's brightness")
      ->capture_default_str();
  app.add_option("--pixels", s.pixels, "of the vehicle, at most: a larger photo is made smaller")
      ->check(CLI::Range(100, 100000000))
      ->capture_default_str();
  app.add_option("--steps", s.steps, "at most")->check(CLI::Range(1, 100000))->capture_default_str();
  app.add_option("--patience", s.patience, "a fit ends when so many steps gain nothing; 0: never")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  app.add_option("--rate", s.rate, "of Adam, in parts of every parameter's range")
      ->check(CLI::Range(1e-6f, 1.0f))
      ->capture_default_str();
  app.add_option("--prior", s.prior, "how strongly what the photo does not tell is held where it began")
      ->check(CLI::Range(0.0f, 10.0f))
      ->capture_default_str();
  app.add_option("--freeze", s.freeze, "parameters that stay as they are")
      ->take_all()
      ->delimiter(',')
      ->capture_default_str();
}

}  // namespace fitting
