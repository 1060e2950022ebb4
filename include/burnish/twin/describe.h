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
  static constexpr int edge_numbers = across * down * directions;
};
}  // namespace detail

/// The length of the vector that describes a view.
inline constexpr int view_numbers =
    detail::SightGrid::edge_numbers + detail::SightGrid::mask_across * detail::SightGrid::mask_down +
    detail::SightGrid::shapes;

namespace detail {

/// A rectangle of a picture, pixels; it may reach beyond it.
struct Frame {
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// Where the mask is, but for what is thinner than a thirtieth of it (aerials, stray pixels). Error for an empty mask.
inline Frame frame_of(const Mask& m) {
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
  Frame f;
  ends(columns, f.x0, f.x1), ends(rows, f.y0, f.y1);
  if (f.x1 - f.x0 < 2 || f.y1 - f.y0 < 2) throw Error("the mask is empty, expected a vehicle on it");
  return f;
}

/// A plane of a picture stretched from a window onto width x height pixels: bilinear when larger, a tent over all that
/// a pixel covers when smaller. Beyond the picture it is 0.
class Window {
public:
  Window(const Frame& f, int picture_width, int picture_height, int width, int height)
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

/// How the parts of a vector are weighted.
struct SightWeights {
  float outline = 1, inner = 0.7f;             // an edge's strength
  float edges = 1, mask = 0.35f, shape = 0.25f;  // of the vector's squared length
  float power = 0.5f;                          // of a cell's sum
};

/// A mask and any number of planes (values of the picture, scaled so that a step of 1 is an edge for sure), described.
template <class Value>
std::vector<float> describe_planes(const Mask& mask, const Frame& box, int planes, Value value, float knee,
                                   const SightWeights& weights = {}) {
  using G = SightGrid;
  constexpr int w = G::width, h = G::height;
  const float wide = box.x1 - box.x0, high = box.y1 - box.y0;
  constexpr float margin = 0.06f;  // of the box, on each side, so that the outline lies inside
  const Frame frame{box.x0 - margin * wide, box.y0 - margin * high, box.x1 + margin * wide, box.y1 + margin * high};
  const Window window(frame, mask.width, mask.height, w, h);
  const Floats seen = window([&](int x, int y) { return mask.at(x, y); });

  // Slopes inside the mask: of the planes the largest one, measured against what is around it.
  Floats gx(seen.size()), gy(seen.size()), strength(seen.size());
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
        // Sobel's: differences smoothed across
        const auto at = [&](int dx, int dy) { return v[std::size_t((y + dy) * w + x + dx)]; };
        const float dx = (at(1, -1) + 2 * at(1, 0) + at(1, 1) - at(-1, -1) - 2 * at(-1, 0) - at(-1, 1)) / 4,
                    dy = (at(-1, 1) + 2 * at(0, 1) + at(1, 1) - at(-1, -1) - 2 * at(0, -1) - at(1, -1)) / 4;
        const float s = std::hypot(dx, dy);
        if (s > strength[i]) strength[i] = s, gx[i] = dx, gy[i] = dy;
      }
  }
  const Floats around = boxed(strength, w, h, 10);

  std::vector<float> cells(std::size_t(G::edge_numbers));
  const auto add = [&](int x, int y, float dx, float dy, float much) {
    const float turn = std::atan2(dy, dx) / pi * float(G::directions);  // -directions .. directions
    const float place = turn - 0.5f + 2 * float(G::directions), lower = std::floor(place);
    const float cx = (float(x) + 0.5f) / float(w) * float(G::across) - 0.5f,
                cy = (float(y) + 0.5f) / float(h) * float(G::down) - 0.5f;
    const float x0 = std::floor(cx), y0 = std::floor(cy);
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) {
        const int column = int(x0) + i, row = int(y0) + j;
        if (column < 0 || column >= G::across || row < 0 || row >= G::down) continue;
        const float share = (i ? cx - x0 : 1 - cx + x0) * (j ? cy - y0 : 1 - cy + y0) * much;
        float* const cell = cells.data() + (row * G::across + column) * G::directions;
        cell[int(lower) % G::directions] += share * (1 - place + lower);
        cell[(int(lower) + 1) % G::directions] += share * (place - lower);
      }
  };
  for (int y = 1; y < h - 1; ++y)
    for (int x = 1; x < w - 1; ++x) {
      const std::size_t i = std::size_t(y * w + x);
      const auto at = [&](int dx, int dy) { return seen[std::size_t((y + dy) * w + x + dx)]; };
      const float dx = (at(1, -1) + 2 * at(1, 0) + at(1, 1) - at(-1, -1) - 2 * at(-1, 0) - at(-1, 1)) / 8,
                  dy = (at(-1, 1) + 2 * at(0, 1) + at(1, 1) - at(-1, -1) - 2 * at(0, -1) - at(1, -1)) / 8;
      const float s = std::hypot(dx, dy);
      if (s > 0.02f) add(x, y, dx, dy, weights.outline * s);
      if (strength[i] > 0) {
        const float m = strength[i] / (strength[i] + 1.5f * around[i] + knee);
        add(x, y, gx[i], gy[i], weights.inner * m * m);
      }
    }

  std::vector<float> out;
  out.reserve(std::size_t(view_numbers));
  const auto append = [&](std::vector<float> part, float weight) {
    double sum = 0;
    for (const float v : part) sum += double(v) * double(v);
    const float scale = sum > 0 ? float(std::sqrt(double(weight) / sum)) : 0.0f;
    for (const float v : part) out.push_back(v * scale);
  };
  for (float& c : cells) c = std::pow(c, weights.power);
  append(std::move(cells), weights.edges);

  std::vector<float> covered(std::size_t(G::mask_across * G::mask_down));
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      covered[std::size_t(y * G::mask_down / h * G::mask_across + x * G::mask_across / w)] +=
          seen[std::size_t(y * w + x)] * float(G::mask_across * G::mask_down) / float(w * h);
  for (float& c : covered) c = 2 * c - 1;
  append(std::move(covered), weights.mask);

  std::vector<float> shape(std::size_t(G::shapes));
  const float ratio = std::log2(wide / high);  // 0.7 to 4 wide by high
  for (int i = 0; i < G::shapes; ++i) {
    const float off = (ratio - (-0.75f + 3.0f * float(i) / float(G::shapes - 1))) / 0.2f;
    shape[std::size_t(i)] = std::exp(-0.5f * off * off);
  }
  append(std::move(shape), weights.shape);

  double sum = 0;
  for (const float v : out) sum += double(v) * double(v);
  for (float& v : out) v = float(double(v) / std::sqrt(sum));
  return out;
}

}  // namespace detail

/// A vehicle in a photo: view_numbers floats of unit length. The mask has the photo's size. Error where it is empty or
/// of another size.
inline std::vector<float> describe(const Mask& vehicle, const Image& photo) {
  if (vehicle.width != photo.width || vehicle.height != photo.height)
    throw Error("mask of " + std::to_string(vehicle.width) + " x " + std::to_string(vehicle.height) + ", photo of " +
                std::to_string(photo.width) + " x " + std::to_string(photo.height) + ": they must agree");
  return detail::describe_planes(
      vehicle, detail::frame_of(vehicle), 3,
      [&](int c, int x, int y) {
        return std::sqrt(std::clamp(photo.plane(c)[std::size_t(y) * std::size_t(photo.width) + std::size_t(x)], 0.0f, 1.0f));
      },
      0.02f);
}

/// A vehicle as a G-buffer shows it: its edges are where normal, depth or part change.
inline std::vector<float> describe(const GBuffer& seen) {
  const Mask mask = seen.frame("coverage");
  constexpr int planes = 7;
  std::array<Mask, planes> values;
  for (Mask& m : values) m = Mask(seen.width, seen.height);
  for (int i = 0; i < seen.size(); ++i) {
    const std::size_t p = std::size_t(seen.pixel[std::size_t(i)]);
    const std::size_t k = std::size_t(i);
    for (std::size_t c = 0; c < 3; ++c) values[c].values[p] = 0.5f * seen.plane[3 + c][k];
    const auto material = unsigned(seen.parts[std::size_t(seen.part[k])].material_index) * 2654435761u;
    for (std::size_t c = 0; c < 3; ++c) values[3 + c].values[p] = float((material >> (8 * c + 4)) & 255u) / 255.0f;
    values[6].values[p] = seen.plane[GBuffer::depth][k];
  }
  return detail::describe_planes(
      mask, detail::frame_of(mask), planes,
      [&](int c, int x, int y) { return values[std::size_t(c)].at(x, y); }, 0.1f);
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
    const vec3<float> p = pose.project(
        {k & 1 ? box.low.x : box.high.x, k & 2 ? box.low.y : box.high.y, k & 4 ? box.low.z : box.high.z});
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
