// examples/pictures.h -- how the programs show a pose and the kinds of parts
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <burnish/scene/gbuffer.h>
#include <burnish/twin/parts.h>

using burnish::GBuffer, burnish::Image, burnish::Mask, burnish::Surfel, burnish::vec3, burnish::part_kinds;

/// Colours of the kinds of parts, linear RGB, in the order of PartKind.
inline constexpr std::array<vec3<float>, part_kinds> kind_colors{{{0.70f, 0.07f, 0.05f},
                                                                  {0.08f, 0.30f, 0.80f},
                                                                  {0.60f, 0.08f, 0.60f},
                                                                  {0.03f, 0.03f, 0.03f},
                                                                  {0.45f, 0.45f, 0.45f},
                                                                  {0.90f, 0.65f, 0.03f},
                                                                  {0.15f, 0.40f, 0.13f}}};

/// A view as it comes, coloured by what color(surfel of g) says, shaded a little.
template <class Color> Image drawn(const GBuffer& g, Color color, const vec3<float>& behind = {0.9f, 0.9f, 0.9f}) {
  Image out(g.width, g.height, behind);
  for (int i = 0; i < g.size(); ++i) {
    const Surfel<float> s = g.at(i);
    const int p = g.pixel[std::size_t(i)];
    out.set(p % g.width, p / g.width, color(i) * (0.35f + 0.65f * dot(s.normal, s.view)));
  }
  return out;
}
/// The photo with the model's outline drawn over it: green where both agree, red where only the model is, blue where
/// only the mask is.
inline Image overlay(const Image& photo, const Mask& mask, const Mask& model) {
  Image out = photo;
  for (int y = 0; y < photo.height; ++y)
    for (int x = 0; x < photo.width; ++x) {
      const float a = mask.at(x, y), b = model.at(x, y);
      const vec3<float> color(b * (1 - a), a * b, a * (1 - b));
      const float strength = 0.45f * std::max(a, b);
      out.set(x, y, photo.at(x, y) * (1 - strength) + color * strength);
    }
  return out;
}
/// The photo in the colours of its labels: 1 paint, 2 glass, 3 rubber, 4 other; 0 as it is.
inline Image labelled(const Image& photo, const std::vector<int>& labels) {
  using burnish::PartKind;
  constexpr PartKind kind[5] = {PartKind::other, PartKind::body, PartKind::window, PartKind::tyre, PartKind::other};
  Image out = photo;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == 0) continue;
    const int x = int(i) % photo.width, y = int(i) / photo.width;
    out.set(x, y, photo.at(x, y) * 0.35f + kind_colors[std::size_t(kind[labels[i]])] * 0.65f);
  }
  return out;
}
