// burnish/twin/describe.h -- a vehicle as it is seen, from a photo or from a mesh, as one unit vector
// SPDX-License-Identifier: Apache-2.0
//
// Both kinds of picture land in one space and are compared by cosine. A vector holds the mask, the directions of the
// edges (the outline and what lies inside), both on grids that are stretched over the mask's box, and the shape of that
// box. So it does not depend on where and how large the vehicle is, little on its material and light (of an edge counts
// that it is there, not how strong it is; after Dalal and Triggs 2005), and by parts on what hides parts of it.
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
          if (k >= 0 && k < old && weight > 0) at.emplace_back(k, weight), low = std::min(low, k), high = std::max(high, k + 1);
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
  std::vector<float> cells(std::size_t(G::edge_numbers)), open(std::size_t(G::across * G::down)), all(open.size());
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

  std::vector<float> covered(std::size_t(G::mask_across * G::mask_down)), sure(covered.size()), total(covered.size());
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

  std::vector<float> shape(std::size_t(G::shapes));
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

namespace detail {
inline Sight sight_of(const Mask& vehicle, const Image& photo, const Rectangle& box) {
  return sight_of(
      vehicle, box, 3,
      [&](int c, int x, int y) {
        return std::sqrt(std::clamp(photo.plane(c)[std::size_t(y * photo.width + x)], 0.0f, 1.0f));
      },
      0.02f);
}
/// Its edges are where normal, depth or part change.
inline Sight sight_of(const GBuffer& seen) {
  const Mask mask = seen.frame("coverage");
  constexpr int planes = 7;
  std::array<Mask, planes> values;
  for (Mask& m : values) m = Mask(seen.width, seen.height);
  for (int i = 0; i < seen.size(); ++i) {
    const std::size_t p = std::size_t(seen.pixel[std::size_t(i)]), k = std::size_t(i);
    for (std::size_t c = 0; c < 3; ++c) values[c].values[p] = 0.5f * seen.plane[3 + c][k];
    const auto material = unsigned(seen.parts[std::size_t(seen.part[k])].material_index) * 2654435761u;
    for (std::size_t c = 0; c < 3; ++c) values[3 + c].values[p] = float((material >> (8 * c + 4)) & 255u) / 255.0f;
    values[6].values[p] = seen.plane[GBuffer::depth][k];
  }
  return sight_of(
      mask, rectangle_of(mask), planes, [&](int c, int x, int y) { return values[std::size_t(c)].at(x, y); }, 0.1f);
}
inline void check_photo(const Mask& vehicle, const Image& photo) {
  if (vehicle.width != photo.width || vehicle.height != photo.height)
    throw Error("mask of " + std::to_string(vehicle.width) + " x " + std::to_string(vehicle.height) + ", photo of " +
                std::to_string(photo.width) + " x " + std::to_string(photo.height) + ": they must agree");
}
}  // namespace detail

/// A vehicle in a photo: view_numbers floats of unit length. The mask has the photo's size. Error where it is empty or
/// of another size.
inline std::vector<float> describe(const Mask& vehicle, const Image& photo) {
  detail::check_photo(vehicle, photo);
  return detail::numbers_of(detail::sight_of(vehicle, photo, detail::rectangle_of(vehicle)), {}).numbers;
}

/// A vehicle as a G-buffer shows it.
inline std::vector<float> describe(const GBuffer& seen) {
  return detail::numbers_of(detail::sight_of(seen), {}).numbers;
}

/// One vehicle in a photo, described as if this or that part of it were hidden by something before it.
struct Guesses {
  std::vector<float> numbers, known;  // guesses x view_numbers: unit rows, and how far a number is known, 0 to 1
  int size() const { return int(numbers.size() / view_numbers); }
};

struct GuessOptions {
  std::vector<float> beside = {0.06f, 0.12f, 0.2f, 0.28f};  ///< hidden at the left or right, of the mask's width
  std::vector<float> above = {0.1f, 0.22f, 0.36f, 0.5f};    ///< at the top or the bottom, of its height
  std::vector<float> corners = {0.35f, 0.55f};              ///< of width and height, in a corner of the box
};

/// The mask lacks what hides the vehicle. The first guess: nothing does; the second: what lies between parts of the
/// mask does; then one side or one corner of its box.
inline Guesses describe_guesses(const Mask& vehicle, const Image& photo, const GuessOptions& options = {}) {
  using namespace detail;
  using G = SightGrid;
  check_photo(vehicle, photo);
  constexpr int w = G::width, h = G::height;
  const Rectangle box = rectangle_of(vehicle);
  Guesses out;
  const auto add = [&](const Sight& sight, const std::vector<bool>& unknown) {
    const Described d = numbers_of(sight, unknown);
    out.numbers.insert(out.numbers.end(), d.numbers.begin(), d.numbers.end());
    out.known.insert(out.known.end(), d.known.begin(), d.known.end());
  };
  const Sight plain = sight_of(vehicle, photo, box);
  add(plain, std::vector<bool>(std::size_t(w * h)));
  const auto grown = [&](const std::vector<bool>& a, int r) {
    std::vector<bool> b(a.size());
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        for (int j = std::max(0, y - r); j <= std::min(h - 1, y + r) && a[std::size_t(y * w + x)]; ++j)
          for (int i = std::max(0, x - r); i <= std::min(w - 1, x + r); ++i) b[std::size_t(j * w + i)] = true;
    return b;
  };
  // Between parts: left and right of it the mask goes on, or above and below.
  std::vector<bool> between(std::size_t(w * h));
  std::vector<int> first_row(w, h), last_row(w, -1), first_column(h, w), last_column(h, -1);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      if (plain.seen[std::size_t(y * w + x)] > 0.5f) {
        const std::size_t i = std::size_t(x), j = std::size_t(y);
        first_row[i] = std::min(first_row[i], y), last_row[i] = std::max(last_row[i], y);
        first_column[j] = std::min(first_column[j], x), last_column[j] = std::max(last_column[j], x);
      }
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const std::size_t i = std::size_t(x), j = std::size_t(y);
      between[std::size_t(y * w + x)] =
          plain.seen[std::size_t(y * w + x)] < 0.5f && ((y > first_row[i] && y < last_row[i]) ||
                                                        (x > first_column[j] && x < last_column[j]));
    }
  add(plain, grown(between, 2));
  // A corner of the box, where nothing is seen.
  for (const float part : options.corners)
    for (int corner = 0; corner < 4; ++corner) {
      std::vector<bool> unknown(std::size_t(w * h));
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
          const float u = (float(x) + 0.5f) / float(w), v = (float(y) + 0.5f) / float(h);
          unknown[std::size_t(y * w + x)] = (corner & 1 ? 1 - u : u) < part && (corner & 2 ? 1 - v : v) < part &&
                                            plain.seen[std::size_t(y * w + x)] < 0.5f;
        }
      add(plain, grown(unknown, 2));
    }
  // A side: the box goes on behind it.
  for (int side = 0; side < 4; ++side)
    for (const float part : side < 2 ? options.beside : options.above) {
      Rectangle f = box;
      const float wide = box.x1 - box.x0, high = box.y1 - box.y0;
      (side == 0 ? f.x0 : side == 1 ? f.x1 : side == 2 ? f.y0 : f.y1) +=
          (side % 2 ? 1.0f : -1.0f) * part * (side < 2 ? wide : high);
      // The strip's share of the grid's picture.
      const float share = (G::margin + part / (1 + part)) / (1 + 2 * G::margin);
      std::vector<bool> unknown(std::size_t(w * h));
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
          const float u = (float(x) + 0.5f) / float(w), v = (float(y) + 0.5f) / float(h);
          unknown[std::size_t(y * w + x)] = (side == 0 ? u : side == 1 ? 1 - u : side == 2 ? v : 1 - v) < share;
        }
      add(sight_of(vehicle, photo, f), grown(unknown, 2));
    }
  return out;
}

struct ViewOptions {
  int azimuths = 36;                                     ///< all round, both sides
  std::vector<float> elevations = {0.03f, 0.16f, 0.35f};  ///< rad
  float distance = 2.5f;                                 ///< of the camera, in diagonals of the vehicle's box
  int pixels = 160;                                      ///< the longer side of the picture, filled by the vehicle
};
/// Views of one model.
struct DescribedViews {
  std::vector<float> rows;                // size() x view_numbers
  std::vector<float> azimuth, elevation;  // rad, as in Pose
  int size() const { return int(azimuth.size()); }
  std::span<const float> row(int i) const { return {rows.data() + std::size_t(i) * view_numbers, view_numbers}; }
};

/// The camera of one of those views: the vehicle's box fills the picture.
inline Camera view_camera(const Box& box, float azimuth, float elevation, const ViewOptions& options = {}) {
  Pose<float> pose;
  pose.azimuth = azimuth, pose.elevation = elevation, pose.center = box.center();
  pose.distance = options.distance * length(box.size());
  pose.width = pose.height = options.pixels, pose.focal = 1;
  float x0 = 1e9f, y0 = 1e9f, x1 = -1e9f, y1 = -1e9f;
  for (int k = 0; k < 8; ++k) {
    const vec3<float> p = pose.project(vec3<float>(k & 1 ? box.low.x : box.high.x, k & 2 ? box.low.y : box.high.y,
                                                   k & 4 ? box.low.z : box.high.z));
    x0 = std::min(x0, p.x), x1 = std::max(x1, p.x), y0 = std::min(y0, p.y), y1 = std::max(y1, p.y);
  }
  const float scale = float(options.pixels - 2) / std::max(x1 - x0, y1 - y0);
  Camera c = pose.camera();
  c.fx *= scale, c.fy *= scale;
  c.width = int(std::ceil((x1 - x0) * scale)) + 2, c.height = int(std::ceil((y1 - y0) * scale)) + 2;
  c.cx = 0.5f * float(c.width) - (0.5f * (x0 + x1) - pose.project(pose.center).x) * scale;
  c.cy = 0.5f * float(c.height) - (0.5f * (y0 + y1) - pose.project(pose.center).y) * scale;
  return c;
}

/// A model from all round.
inline DescribedViews describe_views(const Raycaster& scene, const ViewOptions& options = {}) {
  DescribedViews out;
  for (const float elevation : options.elevations)
    for (int k = 0; k < options.azimuths; ++k)
      out.azimuth.push_back(2 * pi * float(k) / float(options.azimuths)), out.elevation.push_back(elevation);
  out.rows.resize(std::size_t(out.size()) * view_numbers);
  const Box box = bounds(scene.mesh());
  parallel_for(out.size(), [&](int i) {
    const std::size_t k = std::size_t(i);
    const std::vector<float> row = describe(scene.trace(view_camera(box, out.azimuth[k], out.elevation[k], options), 1));
    std::copy(row.begin(), row.end(), out.rows.begin() + std::ptrdiff_t(k * view_numbers));
  });
  return out;
}

}  // namespace burnish
