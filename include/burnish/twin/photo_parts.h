// burnish/twin/photo_parts.h -- which pixels of a photo's vehicle are paint, glass, rubber or other
// SPDX-License-Identifier: Apache-2.0
//
// The posed CAD model says roughly where; panes and tyres of another model do not lie exactly on the photo's, so the
// photo's colours decide near the borders. A mixture of Gaussians in Lab for each label and the blurred projection as
// prior, by expectation and maximisation (Dempster, Laird and Rubin 1977); then neighbours of like colour agree (mean
// field with contrast-sensitive weights, after Boykov and Jolly 2001), and specks are dropped.
#pragma once
#include <burnish/math/color.h>
#include <burnish/scene/error.h>
#include <burnish/scene/gbuffer.h>
#include <burnish/twin/colors.h>

namespace burnish {

struct PhotoPartsOptions {
  float blur = 0.05f;  // of the prior, standard deviation in parts of the vehicle's diagonal in the picture
  int gaussians = 3;   // a label
  int iterations = 4;
  float color = 1;          // exponent of the colour's likelihood: pixels are not independent
  float neighbours = 1.2f;  // how strongly equal neighbours agree
  float speck = 0.001f;     // of the vehicle's pixels: regions smaller than that take their surroundings' label
};

namespace detail {
inline constexpr int photo_labels = 4;

/// Blurred by a box thrice, about a Gaussian of that standard deviation.
inline void blur(std::vector<float>& image, int w, int h, float deviation) {
  const int r = std::max(1, int(std::lround(deviation)));
  std::vector<float> line;
  const auto pass = [&](int n, int lines, std::size_t step, std::size_t next) {
    for (int k = 0; k < lines; ++k) {
      float* const from = image.data() + std::size_t(k) * next;
      line.assign(std::size_t(n), 0.0f);
      double sum = 0;
      for (int i = -r; i < n; ++i) {
        if (i + r < n) sum += double(from[std::size_t(i + r) * step]);
        if (i - r - 1 >= 0) sum -= double(from[std::size_t(i - r - 1) * step]);
        if (i >= 0) line[std::size_t(i)] = float(sum / (2 * r + 1));
      }
      for (int i = 0; i < n; ++i) from[std::size_t(i) * step] = line[std::size_t(i)];
    }
  };
  for (int k = 0; k < 3; ++k) pass(w, h, 1, std::size_t(w)), pass(h, w, std::size_t(w), 1);
}

}  // namespace detail

/// A label for every pixel of the photo: 0 not the vehicle, 1 paint, 2 glass, 3 rubber, 4 other. photo: linear RGB;
/// vehicle: its mask, above 0.5; g: the CAD model through the photo's camera, of the photo's size, with a label for
/// every surfel (part_labels). Error when sizes differ.
inline std::vector<int> photo_parts(const Image& photo, const Mask& vehicle, const GBuffer& g,
                                    const std::vector<int>& labels, const PhotoPartsOptions& options = {}) {
  constexpr int n = detail::photo_labels;
  const int w = photo.width, h = photo.height;
  if (vehicle.width != w || vehicle.height != h || g.width != w || g.height != h || int(labels.size()) != g.size())
    throw Error("photo " + std::to_string(w) + " x " + std::to_string(h) + ", mask " + std::to_string(vehicle.width) +
                " x " + std::to_string(vehicle.height) + ", model " + std::to_string(g.width) + " x " +
                std::to_string(g.height) + ": they must agree");
  std::vector<int> out(std::size_t(w) * std::size_t(h));
  int x0 = w, x1 = -1, y0 = h, y1 = -1;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      if (vehicle.at(x, y) > 0.5f)
        x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
  if (x1 < x0) return out;
  const int cw = x1 - x0 + 1, ch = y1 - y0 + 1;  // only the window that the vehicle is in
  const float diagonal = std::hypot(float(cw), float(ch));
  std::array<std::vector<float>, n> prior, inside;
  std::array<double, n> area{};
  for (auto& p : prior) p.assign(std::size_t(cw) * std::size_t(ch), 0.0f);
  for (int i = 0; i < g.size(); ++i) {
    const int x = g.pixel[std::size_t(i)] % w - x0, y = g.pixel[std::size_t(i)] / w - y0,
              c = labels[std::size_t(i)] - 1;
    if (c < 0 || c >= n) continue;
    ++area[std::size_t(c)];
    if (x >= 0 && x < cw && y >= 0 && y < ch) prior[std::size_t(c)][std::size_t(y * cw + x)] = 1;
  }
  inside = prior;
  for (auto& p : inside) detail::blur(p, cw, ch, 0.25f * options.blur * diagonal);
  for (auto& p : prior) detail::blur(p, cw, ch, options.blur * diagonal);
  std::vector<vec3<float>> color;
  std::vector<int> place;  // in the window, of each of the vehicle's pixels
  std::vector<int> number(std::size_t(cw) * std::size_t(ch), -1);
  for (int y = 0; y < ch; ++y)
    for (int x = 0; x < cw; ++x) {
      if (vehicle.at(x + x0, y + y0) <= 0.5f) continue;
      number[std::size_t(y * cw + x)] = int(place.size());
      place.push_back(y * cw + x);
      const vec3<float> c = photo.at(x + x0, y + y0);
      color.push_back(lab_from_rgb(vec3<float>(std::max(c.x, 0.0f), std::max(c.y, 0.0f), std::max(c.z, 0.0f))));
    }
  const std::size_t count = place.size();
  double all = 1e-9;
  for (const double a : area) all += a;
  std::array<std::vector<float>, n> before, now;
  for (std::size_t c = 0; c < n; ++c) {
    before[c].resize(count);
    const float floor = 0.02f * float(area[c] / all) + (area[c] > 0 ? 0.002f : 0.0f);
    for (std::size_t i = 0; i < count; ++i) before[c][i] = prior[c][std::size_t(place[i])] + floor;
  }
  for (std::size_t i = 0; i < count; ++i) {
    float sum = 1e-9f;
    for (std::size_t c = 0; c < n; ++c) sum += before[c][i];
    for (std::size_t c = 0; c < n; ++c) before[c][i] /= sum;
  }
  // Colours are learned at first where the model is sure; the paint's from what has the main colour there, the others'
  // from what has not, unless hardly anything is left. Rubber is dark and grey.
  std::array<detail::Mixture, n> mixture;
  std::vector<vec3<float>> sure;
  for (std::size_t c = 0; c < n; ++c) {
    now[c].resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const float x = inside[c][std::size_t(place[i])];
      now[c][i] = x > 0.8f ? x : 0.05f * x;
      if (c == 0 && x > 0.8f) sure.push_back(color[i]);
    }
  }
  const MainColor paint(sure);
  std::vector<float> lightness;
  for (const vec3<float>& c : color) lightness.push_back(c.x);
  std::sort(lightness.begin(), lightness.end());
  const float rubber = std::max(35.0f, 0.5f * (lightness[count / 20] + lightness[count / 2]));
  std::array<std::vector<float>, n> trust;
  for (std::size_t c = 0; c < n; ++c) {
    trust[c].assign(count, 1.0f);
    double kept = 0, of = 1e-9;
    for (std::size_t i = 0; i < count; ++i) {
      if (paint.like(color[i]) != (c == 0)) trust[c][i] = 0.03f;
      kept += double(now[c][i] * trust[c][i]), of += double(now[c][i]);
    }
    if (kept < 0.15 * of) trust[c].assign(count, 1.0f);
    for (std::size_t i = 0; i < count; ++i) {
      if (c == 2)
        trust[c][i] *= 0.03f + 0.97f * std::clamp((rubber + 15 - color[i].x) / 15, 0.0f, 1.0f) *
                                   std::clamp((25 - std::hypot(color[i].y, color[i].z)) / 10, 0.0f, 1.0f);
    }
  }
  for (int k = 0; k < options.iterations; ++k) {
    for (std::size_t c = 0; c < n; ++c)
      if (area[c] > 0) {
        std::vector<float> weight = now[c];
        for (std::size_t i = 0; i < count; ++i) weight[i] *= trust[c][i];
        mixture[c].fit(color, weight, options.gaussians);
      }
    for (std::size_t i = 0; i < count; ++i) {
      float sum = 1e-30f;
      for (std::size_t c = 0; c < n; ++c)
        sum += now[c][i] = before[c][i] * std::max(trust[c][i], c == 2 ? 0.0f : 0.3f) *
                           (area[c] > 0 ? std::pow(mixture[c](color[i]), options.color) : 0.0f);
      for (std::size_t c = 0; c < n; ++c) now[c][i] /= sum;
    }
  }
  // Neighbours of like colour agree.
  const std::array<std::vector<float>, n> single = now;
  double contrast = 0;
  long pairs = 0;
  const auto each_neighbour = [&](std::size_t i, auto&& with) {
    const int x = place[i] % cw, y = place[i] / cw;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        if ((dx == 0 && dy == 0) || x + dx < 0 || x + dx >= cw || y + dy < 0 || y + dy >= ch) continue;
        const int j = number[std::size_t((y + dy) * cw + x + dx)];
        if (j >= 0) with(std::size_t(j), dx != 0 && dy != 0 ? 0.7071f : 1.0f);
      }
  };
  const auto apart = [&](std::size_t i, std::size_t j) {
    const vec3<float> d = color[i] - color[j];
    return dot(d, d);
  };
  for (std::size_t i = 0; i < count; ++i)
    each_neighbour(i, [&](std::size_t j, float) { contrast += double(apart(i, j)), ++pairs; });
  const float scale = 1 / (2 * float(contrast / double(std::max(pairs, 1L))) + 1e-6f);
  for (int k = 0; k < 10; ++k) {
    const std::array<std::vector<float>, n> last = now;
    for (std::size_t i = 0; i < count; ++i) {
      std::array<float, n> field{};
      each_neighbour(i, [&](std::size_t j, float near) {
        const float like = near * std::exp(-apart(i, j) * scale);
        for (std::size_t c = 0; c < n; ++c) field[c] += like * last[c][j];
      });
      float sum = 1e-30f;
      for (std::size_t c = 0; c < n; ++c) sum += now[c][i] = single[c][i] * std::exp(options.neighbours * field[c]);
      for (std::size_t c = 0; c < n; ++c) now[c][i] /= sum;
    }
  }
  std::vector<int> label(count);
  for (std::size_t i = 0; i < count; ++i) {
    int best = n - 1;
    for (int c = 0; c < n; ++c)
      if (now[std::size_t(c)][i] > now[std::size_t(best)][i]) best = c;
    label[i] = best;
  }
  // Specks.
  std::vector<char> seen(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (seen[i]) continue;
    std::vector<std::size_t> region{i};
    std::array<int, n> around{};
    seen[i] = 1;
    for (std::size_t k = 0; k < region.size(); ++k)
      each_neighbour(region[k], [&](std::size_t j, float near) {
        if (label[j] != label[i]) ++around[std::size_t(label[j])];
        else if (!seen[j] && near == 1) seen[j] = 1, region.push_back(j);
      });
    const auto most = std::max_element(around.begin(), around.end());
    if (double(region.size()) < double(options.speck) * double(count) + 3 && *most > 0)
      for (const std::size_t j : region) label[j] = int(most - around.begin());
  }
  for (std::size_t i = 0; i < count; ++i)
    out[std::size_t((place[i] / cw + y0) * w + place[i] % cw + x0)] = label[i] + 1;
  return out;
}

}  // namespace burnish
