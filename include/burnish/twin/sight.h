// burnish/twin/sight.h -- a picture of a vehicle on a grid over its box: mask and edges, and the numbers made of them
// SPDX-License-Identifier: Apache-2.0
//
// What describe.h is made of. The grid is stretched over the mask's box, so place and size are out of it. Of an edge
// counts that it is there, not how strong it is, so that material and light count little; edges are summed by direction
// in cells that overlap (after Dalal and Triggs 2005).
#pragma once
#include <array>
#include <numeric>
#include <span>
#include <burnish/scene/raycast.h>
#include <burnish/twin/pose.h>

namespace burnish {

namespace detail {
/// The grids that the numbers lie on, columns x rows, and the picture that they are taken from.
struct SightGrid {
  static constexpr int width = 128, height = 80;      // pixels of the picture that the box is stretched over
  static constexpr int across = 16, down = 10;        // cells of edges
  static constexpr int directions = 5;                // of edges, half a turn apart in all
  static constexpr int mask_across = 24, mask_down = 16;
  static constexpr int shapes = 16;                   // bumps over the box's width by height, in logarithms
  static constexpr float margin = 0.06f;              // of the box, on each side, so that the outline lies inside
  static constexpr int edge_numbers = across * down * directions;
};
}  // namespace detail

/// The length of the vector that describes a view.
inline constexpr int view_numbers =
    detail::SightGrid::edge_numbers + detail::SightGrid::mask_across * detail::SightGrid::mask_down +
    detail::SightGrid::shapes;

namespace detail {

/// A rectangle of a picture, pixels; it may reach beyond it.
struct Rectangle {
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// Where the mask is, but for what is thinner than a thirtieth of it (aerials, stray pixels). Error for an empty mask.
inline Rectangle rectangle_of(const Mask& m) {
  std::vector<float> columns(std::size_t(m.width)), rows(std::size_t(m.height));
  for (int y = 0; y < m.height; ++y)
    for (int x = 0; x < m.width; ++x) columns[std::size_t(x)] += m.at(x, y), rows[std::size_t(y)] += m.at(x, y);
  const auto ends = [](const std::vector<float>& sums, float& low, float& high) {
    const float least = std::max(*std::max_element(sums.begin(), sums.end()) / 30, 0.5f);
    int first = 0, last = int(sums.size());
    while (first < last && sums[std::size_t(first)] < least) ++first;
    while (last > first && sums[std::size_t(last - 1)] < least) --last;
    low = float(first), high = float(last);
  };
  Rectangle f;
  ends(columns, f.x0, f.x1), ends(rows, f.y0, f.y1);
  if (f.x1 - f.x0 < 2 || f.y1 - f.y0 < 2) throw Error("the mask is empty, expected a vehicle on it");
  return f;
}

/// A plane of a picture stretched from a window onto width x height pixels: bilinear when larger, a tent over all that
/// a pixel covers when smaller. Beyond the picture it is 0.
class Stretched {
public:
  Stretched(const Rectangle& f, int picture_width, int picture_height, int width, int height)
      : columns(f.x0, f.x1, picture_width, width), rows(f.y0, f.y1, picture_height, height) {}

  template <class Value> Floats operator()(Value value) const {
    const int w = int(columns.size()), h = int(rows.size()), top = rows.low, bottom = rows.high;
    std::vector<float> lines(std::size_t(std::max(0, bottom - top)) * std::size_t(w));
    for (int y = top; y < bottom; ++y)
      for (int x = 0; x < w; ++x) {
        float sum = 0;
        for (const auto& [i, weight] : columns.taps[std::size_t(x)]) sum += weight * value(i, y);
        lines[std::size_t(y - top) * std::size_t(w) + std::size_t(x)] = sum;
      }
    Floats out(std::size_t(w) * std::size_t(h));
    for (int y = 0; y < h; ++y)
      for (const auto& [j, weight] : rows.taps[std::size_t(y)])
        for (int x = 0; x < w; ++x)
          out[std::size_t(y * w + x)] += weight * lines[std::size_t(j - top) * std::size_t(w) + std::size_t(x)];
    return out;
  }

private:
  struct Taps {
    std::vector<std::vector<std::pair<int, float>>> taps;
    int low, high = 0;
    Taps(float from, float to, int old, int n) : taps(std::size_t(n)), low(old) {
      const float step = (to - from) / float(n), reach = std::max(step, 1.0f);
      for (int i = 0; i < n; ++i) {
        const float center = from + (float(i) + 0.5f) * step - 0.5f;
        float sum = 0;
        auto& at = taps[std::size_t(i)];
        for (int k = int(std::ceil(center - reach)); k <= int(std::floor(center + reach)); ++k) {
          const float weight = std::max(0.0f, 1 - std::abs(float(k) - center) / reach);
          sum += weight;
          if (k < 0 || k >= old || !(weight > 0)) continue;
          at.emplace_back(k, weight);
          low = std::min(low, k), high = std::max(high, k + 1);
        }
        for (auto& tap : at) tap.second /= sum;
      }
      if (high == 0) low = 0;
    }
    std::size_t size() const { return taps.size(); }
  };
  Taps columns, rows;
};

/// A mean over (2 r + 1)^2 pixels, edge pixels over what there is.
inline Floats boxed(const Floats& a, int w, int h, int r) {
  Floats lines(a.size()), out(a.size());
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      float sum = 0;
      const int from = std::max(0, x - r), to = std::min(w - 1, x + r);
      for (int k = from; k <= to; ++k) sum += a[std::size_t(y * w + k)];
      lines[std::size_t(y * w + x)] = sum / float(to - from + 1);
    }
  for (int y = 0; y < h; ++y) {
    const int from = std::max(0, y - r), to = std::min(h - 1, y + r);
    for (int k = from; k <= to; ++k)
      for (int x = 0; x < w; ++x) out[std::size_t(y * w + x)] += lines[std::size_t(k * w + x)] / float(to - from + 1);
  }
  return out;
}

/// A view on the grid's picture: the mask, and the edges inside it as strength (0 to 1) and direction of the slope.
struct Sight {
  Floats seen, strength, angle;
  float ratio = 1;  // the box's width by its height
};

/// A mask and any number of planes (values of the picture) stretched from a box. knee: a slope that is no edge.
template <class Value> Sight sight_of(const Mask& mask, const Rectangle& box, int planes, Value value, float knee) {
  using G = SightGrid;
  constexpr int w = G::width, h = G::height;
  const float wide = box.x1 - box.x0, high = box.y1 - box.y0;
  const Rectangle frame{box.x0 - G::margin * wide, box.y0 - G::margin * high, box.x1 + G::margin * wide,
                    box.y1 + G::margin * high};
  const Stretched window(frame, mask.width, mask.height, w, h);
  Sight out;
  out.ratio = wide / high;
  out.seen = window([&](int x, int y) { return mask.at(x, y); });
  const Floats& seen = out.seen;
  out.strength = Floats(seen.size()), out.angle = Floats(seen.size());
  Floats strength(seen.size());
  std::vector<bool> amid(seen.size());
  for (int y = 2; y < h - 2; ++y)
    for (int x = 2; x < w - 2; ++x) {
      bool all = true;
      for (int j = -2; j <= 2 && all; ++j)
        for (int i = -2; i <= 2 && all; ++i) all = seen[std::size_t((y + j) * w + x + i)] > 0.9f;
      amid[std::size_t(y * w + x)] = all;
    }
  for (int c = 0; c < planes; ++c) {
    Floats v = window([&](int x, int y) { return mask.at(x, y) > 0 ? mask.at(x, y) * value(c, x, y) : 0.0f; });
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = seen[i] > 1e-3f ? v[i] / seen[i] : 0;
    for (int y = 1; y < h - 1; ++y)
      for (int x = 1; x < w - 1; ++x) {
        const std::size_t i = std::size_t(y * w + x);
        if (!amid[i]) continue;
        const auto at = [&](int dx, int dy) { return v[std::size_t((y + dy) * w + x + dx)]; };
        const float dx = (at(1, -1) + 2 * at(1, 0) + at(1, 1) - at(-1, -1) - 2 * at(-1, 0) - at(-1, 1)) / 4,
                    dy = (at(-1, 1) + 2 * at(0, 1) + at(1, 1) - at(-1, -1) - 2 * at(0, -1) - at(1, -1)) / 4;
        const float s = std::hypot(dx, dy);
        if (s > strength[i]) strength[i] = s, out.angle[i] = std::atan2(dy, dx);
      }
  }
  const Floats around = boxed(strength, w, h, 10);
  for (std::size_t i = 0; i < strength.size(); ++i) {
    const float m = strength[i] / (strength[i] + 1.5f * around[i] + knee);
    out.strength[i] = strength[i] > 0 ? m * m : 0;
  }
  return out;
}

/// How the parts of a vector are weighted.
struct SightWeights {
  float outline = 1, inner = 0.7f;               // an edge's strength
  float edges = 1, mask = 0.35f, shape = 0.25f;  // of the vector's squared length
  float power = 0.5f;                            // of a cell's sum
  float empty = 0.4f;                            // how sure it is that nothing is where the mask is empty
};

/// Numbers of a view and how far each is known, 0 to 1.
struct Described {
  std::vector<float> numbers, known;
};

/// unknown: the grid's picture where something may hide the vehicle; empty: nowhere.
inline Described numbers_of(const Sight& sight, const std::vector<bool>& unknown, const SightWeights& weights = {}) {
  using G = SightGrid;
  constexpr int w = G::width, h = G::height;
  const Floats& seen = sight.seen;
  std::vector<float> cells(std::size_t{G::edge_numbers}), open(std::size_t{G::across * G::down}), all(open.size());
  const auto spread = [&](int x, int y, auto add) {
    const float cx = (float(x) + 0.5f) / float(w) * float(G::across) - 0.5f,
                cy = (float(y) + 0.5f) / float(h) * float(G::down) - 0.5f;
    const float x0 = std::floor(cx), y0 = std::floor(cy);
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) {
        const int column = int(x0) + i, row = int(y0) + j;
        if (column >= 0 && column < G::across && row >= 0 && row < G::down)
          add(std::size_t(row * G::across + column), (i ? cx - x0 : 1 - cx + x0) * (j ? cy - y0 : 1 - cy + y0));
      }
  };
  const auto add_edge = [&](int x, int y, float angle, float much) {
    const float place = angle / pi * float(G::directions) - 0.5f + 2 * float(G::directions), lower = std::floor(place);
    spread(x, y, [&](std::size_t cell, float share) {
      float* const to = cells.data() + cell * G::directions;
      to[int(lower) % G::directions] += share * much * (1 - place + lower);
      to[(int(lower) + 1) % G::directions] += share * much * (place - lower);
    });
  };
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const std::size_t i = std::size_t(y * w + x);
      const bool hidden = !unknown.empty() && unknown[i];
      if (!unknown.empty()) spread(x, y, [&](std::size_t cell, float share) {
        all[cell] += share;
        if (!hidden) open[cell] += share;
      });
      if (hidden || x == 0 || y == 0 || x == w - 1 || y == h - 1) continue;
      const auto at = [&](int dx, int dy) { return seen[std::size_t((y + dy) * w + x + dx)]; };
      const float dx = (at(1, -1) + 2 * at(1, 0) + at(1, 1) - at(-1, -1) - 2 * at(-1, 0) - at(-1, 1)) / 8,
                  dy = (at(-1, 1) + 2 * at(0, 1) + at(1, 1) - at(-1, -1) - 2 * at(0, -1) - at(1, -1)) / 8;
      const float s = std::hypot(dx, dy);
      if (s > 0.02f) add_edge(x, y, std::atan2(dy, dx), weights.outline * s);
      if (sight.strength[i] > 0) add_edge(x, y, sight.angle[i], weights.inner * sight.strength[i]);
    }

  Described out;
  const auto append = [&](const std::vector<float>& part, const std::vector<float>& known, float weight) {
    double sum = 0;
    for (const float v : part) sum += double(v) * double(v);
    const float scale = sum > 0 ? float(std::sqrt(double(weight) / sum)) : 0.0f;
    for (const float v : part) out.numbers.push_back(v * scale);
    out.known.insert(out.known.end(), known.begin(), known.end());
  };
  for (float& c : cells) c = std::pow(c, weights.power);
  std::vector<float> known(cells.size(), 1.0f);
  for (std::size_t i = 0; i < known.size() && !unknown.empty(); ++i)
    known[i] = open[i / G::directions] / all[i / G::directions];
  append(cells, known, weights.edges);

  std::vector<float> covered(std::size_t{G::mask_across * G::mask_down}), sure(covered.size()), total(covered.size());
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const std::size_t i = std::size_t(y * w + x),
                        to = std::size_t(y * G::mask_down / h * G::mask_across + x * G::mask_across / w);
      covered[to] += 2 * seen[i] - 1, total[to] += 1;
      const bool hidden = !unknown.empty() && unknown[i];
      sure[to] += hidden ? 0 : seen[i] + (1 - seen[i]) * weights.empty;
    }
  for (std::size_t i = 0; i < covered.size(); ++i) covered[i] /= total[i], sure[i] /= total[i];
  append(covered, sure, weights.mask);

  std::vector<float> shape(std::size_t{G::shapes});
  const float ratio = std::log2(sight.ratio);
  for (int i = 0; i < G::shapes; ++i) {
    const float off = (ratio - (-0.75f + 3.0f * float(i) / float(G::shapes - 1))) / 0.2f;
    shape[std::size_t(i)] = std::exp(-0.5f * off * off);
  }
  append(shape, std::vector<float>(shape.size(), 1.0f), weights.shape);

  double sum = 0;
  for (const float v : out.numbers) sum += double(v) * double(v);
  for (float& v : out.numbers) v = float(double(v) / std::sqrt(sum));
  return out;
}

}  // namespace detail

}  // namespace burnish
