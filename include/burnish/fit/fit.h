// burnish/fit/fit.h -- the loop: loss and gradient, a step, the best kept, an end when nothing is gained
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <burnish/fit/adam.h>
#include <burnish/fit/render.h>

namespace burnish {

/// All that a fit needs to go on: written to a file and read back, it continues to the same bits.
template <class M> struct FitState {
  M model, best;
  Adam adam;
  std::vector<double> losses;  ///< one a step; of the model before that step
  double best_loss = std::numeric_limits<double>::infinity();

  FitState() = default;
  explicit FitState(const M& start, const Adam& optimizer = {})
      : model(start), best(start), adam(optimizer) {}
  int step() const { return int(losses.size()); }
};

/// When to stop: after `steps`, or when the mean loss of the last `window` steps is less than `gain` (a part) below
/// that of the window before; window 0 never stops early.
struct Patience {
  int steps = 300, window = 50;
  double gain = 0.002;

  bool enough(const std::vector<double>& losses) const {
    const int n = int(losses.size());
    if (n >= steps) return true;
    if (window < 1 || n < 2 * window || n % window) return false;
    double now = 0, before = 0;
    for (int i = 0; i < window; ++i)
      now += losses[std::size_t(n - 1 - i)], before += losses[std::size_t(n - 1 - window - i)];
    return now > (1 - gain) * before;
  }
};

/// Steps from state until patience has had enough or `after(state)` gives false. objective(model, d) gives the loss and
/// writes its derivative into d; a loss or derivative that is no number is refused: Error names it. The best model seen
/// is state.best.
template <class M, class Objective, class After>
void fit(FitState<M>& state, Objective&& objective, const Patience& patience, After&& after) {
  M d = state.model;
  while (!patience.enough(state.losses)) {
    const double loss = objective(std::as_const(state.model), d);
    if (!std::isfinite(loss))
      throw Error(std::string("the loss is ") + (std::isnan(loss) ? "nan" : "infinite") + " at step " +
                  std::to_string(state.step() + 1));
    if (loss < state.best_loss) {
      state.best_loss = loss;
      state.best = state.model;
    }
    state.adam.step(state.model, d);
    state.losses.push_back(loss);
    if (!after(std::as_const(state))) return;
  }
}
template <class M, class Objective>
void fit(FitState<M>& state, Objective&& objective, const Patience& patience = {}) {
  fit(state, objective, patience, [](const auto&) { return true; });
}

/// The first surfel, in the order of g, that makes a derivative no number; for the message of a refused gradient.
/// Halves g until one is left; nothing where none is to blame.
template <class Look, class M>
std::optional<int> surfel_to_blame(const GBuffer& g, const Look& look, const M& model, const Image& d_image) {
  const auto bad = [&](const GBuffer& part) {
    try {
      Adam().check(backward(part, look, model, d_image));
      return false;
    } catch (const Error&) {
      return true;
    }
  };
  if (g.size() == 0 || !bad(g)) return {};
  int low = 0, high = g.size();
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    GBuffer half;
    half.width = g.width, half.height = g.height, half.parts = g.parts, half.camera = g.camera;
    half.resize(middle - low);
    for (int i = low; i < middle; ++i) {
      half.pixel[std::size_t(i - low)] = g.pixel[std::size_t(i)];
      half.part[std::size_t(i - low)] = g.part[std::size_t(i)];
      for (std::size_t k = 0; k < GBuffer::planes; ++k)
        half.plane[k][std::size_t(i - low)] = g.plane[k][std::size_t(i)];
    }
    // The place in the G-buffer stays that of g, for looks that read a table by it; padding repeats the last surfel.
    for (auto& p : half.plane) std::fill(p.begin() + half.size(), p.end(), p[std::size_t(half.size()) - 1]);
    (bad(half) ? high : low) = middle;
  }
  return low;
}

}  // namespace burnish
