// burnish/twin/edges.h -- what can be seen of a vehicle inside its outline: edges and dark parts, of a photo and a mesh
// SPDX-License-Identifier: Apache-2.0
//
// A photo and a CAD model share neither paint nor light. What they share is where things change (windows, wheels,
// lamps, creases, seams) and which parts are dark (tyres, panes, what faces the ground). So both become the same few
// small pictures: edge strength in four orientations, each edge weighed against those around it (as histograms of
// oriented gradients are: Dalal and Triggs 2005) and blurred, so that what is near counts; and a tone. The outline
// itself is left out: the mask knows it better.
#pragma once
#include <burnish/scene/gbuffer.h>
#include <burnish/twin/tones.h>

namespace burnish {

/// How a vehicle looks inside its outline.
struct Appearance {
  static constexpr int orientations = 4;  // of the gradient: along x, down right, along y, down left
  int width = 0, height = 0;
  std::array<Mask, orientations> edges;   // 0 .. 1
  Mask tone;                              // -1 dark .. 1 bright, 0 the paint's; 0 outside
  Mask inside;                            // 0 .. 1
};

namespace detail {

/// Gauss' bell; beyond the border nothing is.
inline Mask blurred(const Mask& m, float sigma) {
  if (!(sigma > 0.3f)) return m;
  const int reach = int(std::ceil(2.5f * sigma));
  std::vector<float> bell(std::size_t(reach) + 1);
  float sum = 0;
  for (int k = 0; k <= reach; ++k) {
    bell[std::size_t(k)] = std::exp(-0.5f * float(k * k) / (sigma * sigma));
    sum += (k ? 2 : 1) * bell[std::size_t(k)];
  }
  for (float& b : bell) b /= sum;
  const int w = m.width, h = m.height;
  Mask rows(w, h), out(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      float s = bell[0] * m.at(x, y);
      for (int k = 1; k <= reach; ++k)
        s += bell[std::size_t(k)] * ((x >= k ? m.at(x - k, y) : 0) + (x + k < w ? m.at(x + k, y) : 0));
      rows.at(x, y) = s;
    }
  for (int y = 0; y < h; ++y)
    for (int k = -reach; k <= reach; ++k) {
      if (y + k < 0 || y + k >= h) continue;
      const float b = bell[std::size_t(std::abs(k))];
      const float* const from = &rows.values[std::size_t(y + k) * std::size_t(w)];
      float* const to = &out.values[std::size_t(y) * std::size_t(w)];
      for (int x = 0; x < w; ++x) to[x] += b * from[x];
    }
  return out;
}

/// The gradient's share of each orientation: cos^2 of twice the angle between them where that is under an eighth turn,
/// else none; they sum to 1.
inline std::array<float, Appearance::orientations> share_of(float dx, float dy) {
  const float square = dx * dx + dy * dy;
  if (!(square > 0)) return {};
  const float c = (dx * dx - dy * dy) / square, s = 2 * dx * dy / square;  // of twice the angle
  const auto part = [](float x) { return x > 0 ? x * x : 0.0f; };
  return {part(c), part(s), part(-c), part(-s)};
}

/// Fills in edges from the gradients of several pictures, each capped at `cap`, where all around is inside.
inline void find_edges(Appearance& a, const std::vector<Mask>& pictures, float cap, float blur) {
  const int w = a.width, h = a.height;
  Mask strength(w, h), area(w, h), gx(w, h), gy(w, h);
  for (int y = 1; y + 1 < h; ++y)
    for (int x = 1; x + 1 < w; ++x) {
      bool amid = true;
      for (int k = 0; k < 9 && amid; ++k) amid = a.inside.at(x + k % 3 - 1, y + k / 3 - 1) > 0.5f;
      if (!amid) continue;
      area.at(x, y) = 1;
      float xx = 0, xy = 0, yy = 0;  // Di Zenzo's tensor of all pictures
      for (const Mask& p : pictures) {
        const float dx = 0.5f * (p.at(x + 1, y) - p.at(x - 1, y)), dy = 0.5f * (p.at(x, y + 1) - p.at(x, y - 1));
        xx += dx * dx, xy += dx * dy, yy += dy * dy;
      }
      const float split = std::sqrt((xx - yy) * (xx - yy) + 4 * xy * xy), most = 0.5f * (xx + yy + split);
      const float angle = 0.5f * std::atan2(2 * xy, xx - yy);
      strength.at(x, y) = std::min(std::sqrt(most), cap);
      gx.at(x, y) = std::cos(angle), gy.at(x, y) = std::sin(angle);
    }
  // Against the mean of the neighbourhood and of the whole.
  const float far = 0.08f * float(std::max(w, h));
  const Mask near_sum = blurred(strength, far), near_area = blurred(area, far);
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < std::size_t(w) * std::size_t(h); ++i)
    sum += double(strength.values[i]), count += double(area.values[i]);
  const float whole = count > 0 ? float(sum / count) : 0;
  for (Mask& m : a.edges) m = Mask(w, h);
  for (std::size_t i = 0; i < std::size_t(w) * std::size_t(h); ++i) {
    if (!(area.values[i] > 0) || !(strength.values[i] > 0)) continue;
    const float local = near_sum.values[i] / std::max(near_area.values[i], 1e-3f);
    const float s = strength.values[i] * strength.values[i];
    const float against = local + 0.5f * whole + 1e-4f;
    const float e = s / (s + against * against * 4);
    const auto share = share_of(gx.values[i], gy.values[i]);
    for (std::size_t k = 0; k < share.size(); ++k) a.edges[k].values[i] = e * share[k];
  }
  for (Mask& m : a.edges) m = blurred(m, blur);
}

}  // namespace detail

/// The appearance of the photo's vehicle. blur: pixels.
inline Appearance appearance_of(const Image& photo, const Mask& vehicle, float blur) {
  Appearance a;
  const int w = a.width = photo.width, h = a.height = photo.height;
  a.inside = vehicle;
  std::vector<Mask> pictures(3, Mask(w, h));
  Mask light(w, h);
  std::vector<float> sorted;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const vec3<float> c = photo.at(x, y);
      const float rgb[3] = {c.x, c.y, c.z};
      for (std::size_t k = 0; k < 3; ++k) pictures[k].at(x, y) = std::cbrt(std::max(rgb[k], 0.0f));
      light.at(x, y) = std::cbrt(std::max(0.3f * c.x + 0.5f * c.y + 0.2f * c.z, 0.0f));
      if (vehicle.at(x, y) > 0.5f) sorted.push_back(light.at(x, y));
    }
  detail::find_edges(a, pictures, 1, blur);
  a.tone = Mask(w, h);
  if (sorted.empty()) return a;
  std::sort(sorted.begin(), sorted.end());
  const auto rank = [&](float v) {
    return float(std::lower_bound(sorted.begin(), sorted.end(), v) - sorted.begin()) / float(sorted.size());
  };
  for (std::size_t i = 0; i < std::size_t(w) * std::size_t(h); ++i)
    if (vehicle.values[i] > 0.5f) a.tone.values[i] = 2 * rank(light.values[i]) - 1;
  return a;
}
/// The appearance that a mesh's G-buffer leads one to expect: what faces the sky brighter, what faces the ground dark.
inline Appearance appearance_of(const GBuffer& g, const Tones& tones, float blur) {
  Appearance a;
  const int w = a.width = g.width, h = a.height = g.height;
  a.inside = Mask(w, h), a.tone = Mask(w, h);
  std::vector<Mask> pictures(5, Mask(w, h));
  for (int i = 0; i < g.size(); ++i) {
    const std::size_t p = std::size_t(g.pixel[std::size_t(i)]);
    const float t = tones.at(g, i);
    const vec3<float> n(g.plane[3][std::size_t(i)], g.plane[4][std::size_t(i)], g.plane[5][std::size_t(i)]);
    a.inside.values[p] = 1;
    a.tone.values[p] = n.y < -0.4f ? -0.8f : t < -0.3f ? t + 0.3f * std::max(n.y, 0.0f) : t + 0.4f * n.y;
    pictures[0].values[p] = 0.7f * t;
    pictures[1].values[p] = 0.35f * n.x, pictures[2].values[p] = 0.35f * n.y, pictures[3].values[p] = 0.35f * n.z;
    pictures[4].values[p] = 0.8f * g.plane[GBuffer::depth][std::size_t(i)];
  }
  detail::find_edges(a, pictures, 0.25f, blur);
  return a;
}

namespace detail {
/// Of two lists of numbers with weights.
struct Correlation {
  double w = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  void add(double weight, double u, double v) {
    w += weight, x += weight * u, y += weight * v;
    xx += weight * u * u, xy += weight * u * v, yy += weight * v * v;
  }
  /// -1 .. 1; 0 where one does not vary.
  double value() const {
    const double vx = w * xx - x * x, vy = w * yy - y * y;
    return vx > 1e-9 * w * xx && vy > 1e-9 * w * yy ? (w * xy - x * y) / std::sqrt(vx * vy) : 0;
  }
};
}  // namespace detail

/// How well two appearances of one size agree, -1 .. 1 each.
struct Agreement {
  double edges = 0;  // over what either covers: correlation of the oriented edges
  double tone = 0;   // over what both cover: correlation of the tones
};
inline Agreement agreement(const Appearance& a, const Appearance& b) {
  detail::Correlation edges, tone;
  for (std::size_t i = 0; i < std::size_t(a.width) * std::size_t(a.height); ++i) {
    const float either = std::max(a.inside.values[i], b.inside.values[i]);
    if (!(either > 0.5f)) continue;
    for (std::size_t k = 0; k < a.edges.size(); ++k)
      edges.add(1, double(a.edges[k].values[i]), double(b.edges[k].values[i]));
    if (a.inside.values[i] > 0.5f && b.inside.values[i] > 0.5f)
      tone.add(1, double(a.tone.values[i]), double(b.tone.values[i]));
  }
  return {edges.value(), tone.value()};
}

}  // namespace burnish
