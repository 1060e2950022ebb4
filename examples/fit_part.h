// examples/fit_part.h -- one part of a vehicle against the photo: steps from a start, what was found, and how sure
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/fit/loss.h>
#include <burnish/io/file.h>
#include <burnish/io/model.h>
#include "fitted.h"
#include "light.h"
#include "progress.h"
#include "watch.h"

namespace fitting {
using fitted::Fitted;

struct Weights {
  double aligned, statistics;
};
/// The paint lies on the paint; a wheel or a pane of another model does not lie on the photo's, so there the whole
/// part's mean and variance count more than its pixels, and the tenth that is brightest and the tenth that is darkest
/// do not.
constexpr Weights weights_of(Role r) { return r == Role::paint ? Weights{1, 0.1} : Weights{0.1, 1}; }

/// The mask of a role's part in the photo, as its statistics want it.
inline Mask measured(Role role, const Photo& photo) {
  const Mask mask = photo.of(role);
  return role == Role::paint ? mask : street::without_extremes(photo.image, mask);
}

/// start: what the prior holds to. state: where the fit goes on from. A part that lies nowhere on the photo's is fitted
/// by all but its pixels; one that either of them lacks is left as it is.
template <class M, class Look>
Fitted<M> fit_part(Role role, const M& start, FitState<M> state, const Look& look, const Shot& from, const World& world,
                   const Photo& photo, const Settings& settings, const MoreLoss& more, const Watch& watch) {
  const std::string name = parts::role_names[std::size_t(role)];
  const GBuffer& g = from[role];
  const Mask target = measured(role, photo), cover = g.frame("coverage"), overlap = both(photo.of(role), cover);
  const Statistics statistics(photo.image, target);
  const auto seen = lit(look, from, world);
  const int n = int(std::count_if(overlap.values.begin(), overlap.values.end(), [](float x) { return x > 0; }));
  const Progress clock(name);
  watch(name, 0, settings.steps, "");
  Fitted<M> out{std::move(state), {}, n, 0};
  if (g.size() == 0 || statistics.area == 0) {
    watch(name, settings.steps, settings.steps,
          g.size() == 0 ? "not seen in the model: left as it is" : "not in the photo: left as it is");
    return out;
  }
  Image image(photo.image.width, photo.image.height), d_image = image;
  Weights weights = weights_of(role);
  if (settings.weights) weights = {settings.weights->first, settings.weights->second};
  const Loss another = more ? more(role, photo, target, cover) : Loss();
  const auto save = [&](const FitState<M>& s) {
    if (!settings.checkpoints.empty())
      write_text(settings.checkpoints + "/" + name + ".state.json", to_json(s).dump() + "\n");
  };
  fit(
      out.state,
      [&](const M& model, M& d) {
        render(g, seen, model, image);
        std::fill(d_image.values.begin(), d_image.values.end(), 0.0f);
        double loss = masked_l1(image, photo.image, overlap, weights.aligned, d_image) +
                      part_statistics(image, cover, statistics, weights.statistics, d_image);
        if (another) loss += another(image, d_image);
        backward(g, seen, model, d_image, d);
        const double pull = hold_back(model, start, d, settings, float(settings.prior / weights_of(role).aligned));
        try {
          out.state.adam.check(d);
        } catch (const Error& e) {
          const auto place = surfel_to_blame(g, seen, model, d_image);
          if (!place) throw;
          const int p = g.pixel[std::size_t(*place)];
          throw Error(std::string(e.what()) + ", pixel (" + std::to_string(p % image.width) + ", " +
                      std::to_string(p / image.width) + ")");
        }
        return loss + pull;
      },
      Patience{.steps = settings.steps, .window = settings.patience},
      [&](const FitState<M>& s) {
        char note[64];
        std::snprintf(note, sizeof note, "loss %.4f", s.losses.back());
        if (s.step() % 50 == 0) save(s);
        return watch(name, std::min(s.step(), settings.steps - 1), settings.steps, note);
      });
  save(out.state);
  out.seconds = clock.seconds();
  out.deviation = fitted::deviations<M>(
      out.state.best, [&](const M& m) { return render(g, seen, m); }, photo.image, overlap,
      [&](const std::string& parameter) { return !settings.frozen(parameter); });
  char note[128];
  std::snprintf(note, sizeof note, "%d pixels, %d steps, loss %.4f -> %.4f", n, out.state.step(),
                out.state.losses.front(), out.state.best_loss);
  watch(name, settings.steps, settings.steps, note);
  return out;
}

}  // namespace fitting
