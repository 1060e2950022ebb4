// burnish/twin/retrieve.h -- which models of a library a photo may show, also where something hides parts of it
// SPDX-License-Identifier: Apache-2.0
//
// What stands before a vehicle takes a piece out of its mask, and often of the mask's box, on which everything hangs.
// So the photo is described several times, each time as if another side, corner or strip were hidden; what is thought
// hidden counts nothing. All rows are searched by plain cosines of all guesses, the best of them are compared by known
// numbers alone, and the best guesses are moved a little until they fit best.
#pragma once
#include <burnish/twin/describe.h>
#include <burnish/twin/search.h>

namespace burnish {

/// What hides a vehicle, and where its box would be.
struct Guess {
  enum Kind { nothing, between, corner, side } kind = nothing;
  int which = 0;               // side: left, right, top, bottom; corner: + 1 the right ones, + 2 the lower ones
  float part = 0;              // of the mask's box: by how much the vehicle's is larger; of the corner: its share
  std::array<float, 4> moved{};  // left, right, top, bottom outwards, too, by shares of the mask's box
};

struct RetrieveOptions {
  std::vector<float> beside = {0.06f, 0.12f, 0.2f, 0.28f};  ///< hidden at the left or right, of the mask's width
  std::vector<float> above = {0.1f, 0.22f, 0.36f, 0.5f};    ///< at the top or the bottom, of its height
  std::vector<float> corners = {0.35f, 0.55f};              ///< of width and height, in a corner of the box
  int candidates = 600;                                     ///< rows that are compared by what is known
  float trust = 0.1f;                                       ///< against guesses that much is hidden: see known_cosines
  int refined = 20;                                         ///< models that the best guesses are moved for
  float step = 0.04f;                                       ///< by which they are moved
  float roll = 0.035f;                                      ///< rad, by which the photo is turned either way
};

namespace detail {

/// A photo and its mask, described by guesses.
class Guessed {
public:
  std::vector<Guess> guesses;
  std::vector<float> numbers, known;  // guesses x view_numbers: unit rows, and how far a number is known, 0 to 1

  explicit Guessed(const Cutout& of) : cutout(&of), box(of.box), plain(of.sight(of.box)) { enclose(); }
  void add(const Guess& g) {
    const Rectangle f = frame(g);
    const bool moved = g.kind == Guess::side || g.moved != std::array<float, 4>{};
    const Described d = numbers_of(moved ? cutout->sight(f) : plain, unknown(g, f));
    guesses.push_back(g);
    numbers.insert(numbers.end(), d.numbers.begin(), d.numbers.end());
    known.insert(known.end(), d.known.begin(), d.known.end());
  }

private:
  static constexpr int w = SightGrid::width, h = SightGrid::height;
  const Cutout* cutout;
  Rectangle box;
  Sight plain;
  std::vector<bool> enclosed;

  Rectangle frame(const Guess& g) const {
    std::array<float, 4> out = g.moved;
    if (g.kind == Guess::side) out[std::size_t(g.which)] += g.part;
    const float wide = box.x1 - box.x0, high = box.y1 - box.y0;
    return {box.x0 - out[0] * wide, box.y0 - out[2] * high, box.x1 + out[1] * wide, box.y1 + out[3] * high};
  }
  /// Between parts of the mask: left and right of it the mask goes on, or above and below.
  void enclose() {
    std::vector<int> top(w, h), bottom(w, -1), left(h, w), right(h, -1);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        if (plain.seen[std::size_t(y * w + x)] > 0.5f) {
          const std::size_t i = std::size_t(x), j = std::size_t(y);
          top[i] = std::min(top[i], y), bottom[i] = y, left[j] = std::min(left[j], x), right[j] = x;
        }
    enclosed.assign(std::size_t(w * h), false);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const std::size_t i = std::size_t(x), j = std::size_t(y);
        enclosed[std::size_t(y * w + x)] = plain.seen[std::size_t(y * w + x)] < 0.5f &&
                                           ((y > top[i] && y < bottom[i]) || (x > left[j] && x < right[j]));
      }
  }
  std::vector<bool> unknown(const Guess& g, const Rectangle& f) const {
    std::vector<bool> out(std::size_t(w * h));
    const float wide = f.x1 - f.x0, high = f.y1 - f.y0;
    for (int y = 0; y < h && g.kind != Guess::nothing; ++y)
      for (int x = 0; x < w; ++x) {
        // A place of the grid in pixels of the photo, then in shares of the mask's box.
        constexpr float m = SightGrid::margin;
        const float px = f.x0 + ((float(x) + 0.5f) / float(w) * (1 + 2 * m) - m) * wide,
                    py = f.y0 + ((float(y) + 0.5f) / float(h) * (1 + 2 * m) - m) * high;
        const float u = (px - box.x0) / (box.x1 - box.x0), v = (py - box.y0) / (box.y1 - box.y0);
        bool hidden;
        if (g.kind == Guess::side) hidden = (g.which == 0 ? u : g.which == 1 ? 1 - u : g.which == 2 ? v : 1 - v) < 0;
        else {
          const int i = std::clamp(int((u + m) / (1 + 2 * m) * float(w)), 0, w - 1),
                    j = std::clamp(int((v + m) / (1 + 2 * m) * float(h)), 0, h - 1);
          const std::size_t at = std::size_t(j * w + i);
          if (g.kind == Guess::between) hidden = enclosed[at];
          else
            hidden = (g.which & 1 ? 1 - u : u) < g.part && (g.which & 2 ? 1 - v : v) < g.part && plain.seen[at] < 0.5f;
        }
        // With what the border of it does to the edges near by.
        constexpr int r = 2;
        for (int j = std::max(0, y - r); hidden && j <= std::min(h - 1, y + r); ++j)
          for (int i = std::max(0, x - r); i <= std::min(w - 1, x + r); ++i) out[std::size_t(j * w + i)] = true;
      }
    return out;
  }
};

}  // namespace detail

/// The k models that the photo may show, best first, each with the row of its view that is nearest. rows: of all models
/// (n x view_numbers), model m's first is first[m], first.back() is n. The mask has the photo's size and lacks what
/// hides the vehicle. Error as describe().
inline std::vector<NearestModel> retrieve(std::span<const float> rows, std::span<const int> first, const Mask& vehicle,
                                          const Image& photo, int k, const RetrieveOptions& options = {}) {
  using namespace detail;
  const Cutout cutout(vehicle, photo);
  Guessed guessed(cutout);
  guessed.add({Guess::nothing, 0, 0, {}});
  guessed.add({Guess::between, 0, 0, {}});
  for (const float part : options.corners)
    for (int which = 0; which < 4; ++which) guessed.add({Guess::corner, which, part, {}});
  for (int which = 0; which < 4; ++which)
    for (const float part : which < 2 ? options.beside : options.above) guessed.add({Guess::side, which, part, {}});

  std::vector<int> model_of(rows.size() / view_numbers);
  for (std::size_t m = 0; m + 1 < first.size(); ++m)
    std::fill(model_of.begin() + first[m], model_of.begin() + first[m + 1], int(m));
  std::vector<int> chosen;
  {
    std::vector<float> asked = guessed.numbers;
    for (std::size_t i = 0; i < asked.size(); ++i) asked[i] *= guessed.known[i];
    normalise_rows(asked, view_numbers);
    for (const Nearest& n : nearest(rows, view_numbers, asked, options.candidates)) chosen.push_back(n.row);
  }
  // Of the chosen rows the best by model, and by which guess.
  const auto compare = [&](const Guessed& guesses, std::span<const int> among) {
    std::vector<NearestModel> best;
    std::vector<int> guess;
    const std::vector<Known> found =
        known_cosines(rows, view_numbers, among, guesses.numbers, guesses.known, options.trust);
    std::vector<int> place(first.size(), -1);
    for (std::size_t i = 0; i < among.size(); ++i) {
      const int m = model_of[std::size_t(among[i])];
      int& at = place[std::size_t(m)];
      if (at < 0) at = int(best.size()), best.push_back({m, -1, -2}), guess.push_back(0);
      NearestModel& b = best[std::size_t(at)];
      if (found[i].cosine > b.cosine) b = {m, among[i], found[i].cosine}, guess[std::size_t(at)] = found[i].query;
    }
    std::vector<int> order(best.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return best[std::size_t(a)].cosine > best[std::size_t(b)].cosine; });
    std::pair<std::vector<NearestModel>, std::vector<int>> out;
    for (const int i : order) out.first.push_back(best[std::size_t(i)]), out.second.push_back(guess[std::size_t(i)]);
    return out;
  };
  auto [best, by] = compare(guessed, chosen);
  const std::size_t few = std::min(best.size(), std::size_t(std::max(options.refined, 0)));
  if (few > 0 && options.step > 0) {
    // Around the guesses of the best models, each once.
    std::vector<int> kept;
    for (std::size_t i = 0; i < few && kept.size() < 5; ++i)
      if (std::find(kept.begin(), kept.end(), by[i]) == kept.end()) kept.push_back(by[i]);
    std::erase_if(chosen, [&, &found = best](int row) {
      return std::none_of(found.begin(), found.begin() + std::ptrdiff_t(few),
                          [&](const auto& f) { return f.model == model_of[std::size_t(row)]; });
    });
    std::vector<NearestModel> finest(best.begin(), best.begin() + std::ptrdiff_t(few));
    for (const float roll : {0.0f, -options.roll, options.roll}) {
      if (roll != 0 && !(options.roll > 0)) break;
      const Cutout turned = cutout.turned(roll);
      Guessed finer(turned);
      for (const int g : kept)
        for (int move = -1; move < 8; ++move) {
          Guess moved = guessed.guesses[std::size_t(g)];
          if (move >= 0) moved.moved[std::size_t(move / 2)] += move % 2 ? options.step : -options.step;
          finer.add(moved);
        }
      for (const NearestModel& again : compare(finer, chosen).first)
        for (NearestModel& f : finest)
          if (f.model == again.model && again.cosine > f.cosine) f = again;
    }
    std::stable_sort(finest.begin(), finest.end(),
                     [](const NearestModel& x, const NearestModel& y) { return x.cosine > y.cosine; });
    std::copy(finest.begin(), finest.end(), best.begin());
  }
  best.resize(std::min(best.size(), std::size_t(std::max(k, 0))));
  return best;
}

}  // namespace burnish
