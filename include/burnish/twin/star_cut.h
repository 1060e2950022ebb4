// burnish/twin/star_cut.h -- the star-shaped piece of a picture that suits given odds and the picture's edges best
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>
#include <burnish/scene/image.h>
#include <burnish/twin/box.h>
#include <burnish/twin/cut.h>
#include <burnish/twin/superpixels.h>

namespace burnish {

/// Minimum cuts of one picture: inside, odds (logarithms, a pixel) are gained; the outline costs 25 exp(-beta d^2) a pixel
/// with the colour difference d, beta from the mean of d^2 as in GrabCut (Rother et al. 2004). What is in pulls in what
/// comes next on its way to the middle of the box (star shapes: Veksler 2008). Outside the box nothing is in.
class StarCut {
public:
  static constexpr int step = 6;  // superpixels are about this wide

  StarCut(const Image& picture, const PixelBox& box_in_it)
      : w(picture.width),
        h(picture.height),
        image(picture),
        box(box_in_it),
        pieces(superpixels(picture, step)),
        heart(0.5f * (box.x0 + box.x1), 0.5f * (box.y0 + box.y1)) {
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < w * h; ++i) image.plane(c)[i] = srgb_from_linear(image.plane(c)[i]);
    double contrast = 0;
    long pairs = 0;
    each_pair([&](int p, int q) { contrast += double(difference(p, q)), ++pairs; });
    beta = float(0.5 * double(pairs) / std::max(contrast, 1e-9));
    center.resize(std::size_t(pieces.count));
    std::vector<float> area(center.size(), 0);
    for (int p = 0; p < w * h; ++p) {
      const std::size_t k = std::size_t(pieces.label[std::size_t(p)]);
      center[k] = center[k] + place(p), area[k] += 1;
    }
    for (std::size_t k = 0; k < center.size(); ++k) center[k] = center[k] * (1 / area[k]);
  }

  /// By superpixels: height x width, 1 in and 0 out. keep, a pixel or -1, is in.
  std::vector<char> by_pieces(const Mask& odds, int keep) const {
    std::vector<float> gain(std::size_t(pieces.count), 0);
    for (int p = 0; p < w * h; ++p) {
      const vec2<float> at = place(p);
      if (box.contains(at.x, at.y)) gain[std::size_t(label(p))] += odds.values[std::size_t(p)];
    }
    for (std::size_t k = 0; k < gain.size(); ++k)
      if (!box.contains(center[k].x, center[k].y)) gain[k] = -1e6f;
    if (keep >= 0) gain[std::size_t(label(keep))] = 1e6f;
    MinimumCut graph(pieces.count);
    for (int k = 0; k < pieces.count; ++k) graph.node(k, 0, gain[std::size_t(k)]);
    std::map<std::pair<int, int>, float> edges;
    each_pair([&](int p, int q) {
      if (label(p) != label(q)) edges[std::minmax(label(p), label(q))] += weight(p, q);
    });
    for (const auto& [pair, cost] : edges) graph.edge(pair.first, pair.second, cost);
    for (int k = 0; k < pieces.count; ++k)
      if (const int next = inwards(center[std::size_t(k)], [&](int p) { return label(p); }); next >= 0)
        graph.follow(k, next);
    const std::vector<bool> in = graph.solve();
    std::vector<char> out;
    for (int p = 0; p < w * h; ++p) {
      const vec2<float> at = place(p);
      out.push_back(in[std::size_t(label(p))] && box.contains(at.x, at.y));
    }
    return out;
  }

  /// By pixels, those that are in `open`; the others stay as they are in `now`.
  std::vector<char> by_pixels(const Mask& odds, std::vector<char> now, const std::vector<char>& open) const {
    std::vector<int> node(open.size(), -1);
    int nodes = 0;
    for (int p = 0; p < w * h; ++p) {
      const vec2<float> at = place(p);
      if (open[std::size_t(p)] && box.contains(at.x, at.y)) node[std::size_t(p)] = nodes++;
    }
    MinimumCut graph(nodes);
    const auto node_at = [&](int p) { return node[std::size_t(p)]; };
    const auto beside = [&](int k, int fixed, float cost) {
      const bool in = now[std::size_t(fixed)] != 0;
      graph.node(k, in ? 0 : cost, in ? cost : 0);
    };
    each_pair([&](int p, int q) {
      if (node_at(p) >= 0 && node_at(q) >= 0) graph.edge(node_at(p), node_at(q), weight(p, q));
      else if (node_at(p) >= 0) beside(node_at(p), q, weight(p, q));
      else if (node_at(q) >= 0) beside(node_at(q), p, weight(p, q));
    });
    for (int p = 0; p < w * h; ++p) {
      if (node_at(p) < 0) continue;
      graph.node(node_at(p), 0, odds.values[std::size_t(p)]);
      if (const int next = inwards(place(p), node_at); next >= 0) graph.follow(node_at(p), next);
    }
    const std::vector<bool> in = graph.solve();
    for (int p = 0; p < w * h; ++p)
      if (node_at(p) >= 0) now[std::size_t(p)] = in[std::size_t(node_at(p))];
    return now;
  }

private:
  int w, h;
  Image image;  // encoded
  PixelBox box;
  Superpixels pieces;
  vec2<float> heart;
  std::vector<vec2<float>> center;
  float beta = 0;

  int label(int p) const { return pieces.label[std::size_t(p)]; }
  vec2<float> place(int p) const { return {float(p % w) + 0.5f, float(p / w) + 0.5f}; }
  float difference(int p, int q) const {
    float sum = 0;
    for (int c = 0; c < 3; ++c)
      sum += (image.plane(c)[p] - image.plane(c)[q]) * (image.plane(c)[p] - image.plane(c)[q]);
    return sum;
  }
  float weight(int p, int q) const { return 25 * std::exp(-beta * difference(p, q)); }
  template <class F> void each_pair(F f) const {
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        if (x + 1 < w) f(y * w + x, y * w + x + 1);
        if (y + 1 < h) f(y * w + x, (y + 1) * w + x);
      }
  }
  /// The first other node on the way from a place to the middle; -1 where there is none.
  template <class F> int inwards(const vec2<float>& from, F node_at) const {
    const auto at = [&](const vec2<float>& v) { return std::min(int(v.y), h - 1) * w + std::min(int(v.x), w - 1); };
    const int self = node_at(at(from));
    const float dx = heart.x - from.x, dy = heart.y - from.y, length = std::hypot(dx, dy);
    if (!box.contains(from.x, from.y)) return -1;
    for (float d = 1; d < length; d += 1)
      if (const int next = node_at(at({from.x + dx * d / length, from.y + dy * d / length})); next != self) return next;
    return -1;
  }
};

}  // namespace burnish
