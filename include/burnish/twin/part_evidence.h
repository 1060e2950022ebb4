// burnish/twin/part_evidence.h -- what shapes, names, masks and the user say about a part, as weights of its kinds
// SPDX-License-Identifier: Apache-2.0
//
// Each witness gives every kind a factor; the factors multiply (independent witnesses, Bayes), and the kind's share of
// the sum is the confidence. The numbers were set by hand, looking at about 60 vehicles of many makers.
#pragma once
#include <cmath>
#include <span>
#include <burnish/twin/part_views.h>

namespace burnish {

/// A factor for every kind, and what it is that speaks.
struct PartWitness {
  std::array<float, part_kinds> factor{};
  std::string says;

  PartWitness(float all, std::string words) : says(std::move(words)) { factor.fill(all); }
  float& operator[](PartKind k) { return factor[std::size_t(k)]; }
  float operator[](PartKind k) const { return factor[std::size_t(k)]; }
};

namespace detail {
/// 0 below a, 1 above b, straight between; also with a > b.
inline float ramp(float x, float a, float b) { return std::clamp((x - a) / (b - a), 0.0f, 1.0f); }
inline std::string percent(float x) { return std::to_string(int(std::lround(100 * x))) + " %"; }
/// How far two colours are apart to the eye, roughly: of the square roots, the largest difference.
inline float apart(const vec3<float>& a, const vec3<float>& b) {
  const auto d = [](float x, float y) { return std::abs(std::sqrt(std::max(x, 0.0f)) - std::sqrt(std::max(y, 0.0f))); };
  return std::max({d(a.x, b.x), d(a.y, b.y), d(a.z, b.z)});
}
inline float chroma(const vec3<float>& c) {
  const float high = std::max({c.x, c.y, c.z}), low = std::min({c.x, c.y, c.z});
  return high > 0.02f ? (high - low) / high : 0;
}
}  // namespace detail

/// How much a part is shaped like panes: in the greenhouse, not a roof, smooth, looking outwards, not most of the car.
inline float like_panes(const PartShape& s) {
  using detail::ramp;
  // A black greenhouse may have its roof in one with it.
  const bool black = luminance(s.color) < 0.03f && s.share > 0.03f;
  const float roof = black ? ramp(s.up, 0.6f, 0.35f) : ramp(s.up, 0.4f, 0.15f);
  return roof * ramp(s.above, 0.7f, 0.92f) * ramp(s.open, 0.3f, 0.55f) *
         ramp(s.smooth, 0.1f, 0.25f) * ramp(s.share, 0.45f, 0.3f) * ramp(s.share, 0.001f, 0.004f) *
         ramp(s.height, 0.48f, 0.56f);
}
/// How much a part is placed like head and tail lights: small, at the ends, at mid height, on both sides.
inline float like_lights(const PartShape& s) {
  using detail::ramp;
  return ramp(s.ends, 0.75f, 0.95f) * ramp(s.share, 0.05f, 0.025f) * ramp(s.height, 0.12f, 0.25f) *
         ramp(s.height, 0.8f, 0.65f) * ramp(s.aside, 0.35f, 0.5f) * ramp(s.middle, 0.35f, 0.15f) *
         ramp(s.balance, 0.3f, 0.7f);
}

/// What the shape says. any_wheels: whether wheels were found at all. panes: like_panes, or less where the rest of its
/// material is nothing like panes.
inline PartWitness shape_witness(const PartShape& s, const Part& part, bool any_wheels, float panes) {
  using enum PartKind;
  using detail::percent;
  if (s.pixels == 0) {
    PartWitness w(0.03f, "not seen from outside");
    w[other] = 0.8f;
    return w;
  }
  PartWitness w(0.02f, "");
  if (s.wheel > 0.5f) {
    const bool tread = s.inner > 0.55f && s.outer > 0.9f, disc = s.outer < 0.9f;
    w[tread ? tyre : disc ? rim : wheel] = s.wheel;
    for (const PartKind k : {tyre, rim, wheel}) w[k] = std::max(w[k], 0.15f * s.wheel);
    w[other] = 0.3f * (1 - s.wheel) + 0.05f, w[body] = 0.5f * (1 - s.wheel) + 0.01f;
    w.says = percent(s.wheel) + " inside the wheels, radius " + percent(s.inner) + " to " + percent(s.outer);
    return w;
  }
  const float lights = like_lights(s);
  const float dark = detail::ramp(luminance(s.color), 0.2f, 0.05f);
  const bool clear = part.opacity < 0.9f;
  // Panes are clear, dark, grey or blueish, hardly ever red, yellow, brown or violet.
  const float warm = detail::chroma(s.color) * detail::ramp(s.color.x - 0.8f * s.color.z, 0.02f, 0.1f);
  for (const PartKind k : {tyre, rim, wheel}) w[k] = any_wheels ? 0.002f : 0.05f;  // none found: names may know
  w[window] = 0.02f + panes * (clear ? 1 : (0.55f + 0.25f * dark) * (1 - 0.9f * std::min(1.0f, 1.6f * warm)));
  w[light] = 0.02f + 0.6f * lights * (clear || detail::chroma(s.color) > 0.6f || luminance(s.color) > 0.5f ? 1 : 0.5f);
  const float outer = detail::ramp(s.open, 0.15f, 0.5f);
  w[body] = 0.02f + 0.5f * outer * detail::ramp(s.share, 0.002f, 0.05f) * (1 - panes) * (1 - 0.7f * lights);
  w[other] = 0.1f + 0.4f * (1 - outer) + 0.3f * detail::ramp(s.share, 0.03f, 0.003f) + 0.1f * dark;
  if (panes > 0.5f) w.says = "smooth and outside, " + percent(s.above) + " in the greenhouse";
  else if (lights > 0.5f) w.says = "small, at the ends, on both sides";
  else if (outer < 0.4f) w.says = "lies inside";
  else if (s.share < 0.01f) w.says = "small";
  return w;
}

/// What the file's see-through parts are, by where they are.
inline PartWitness opacity_witness(const PartShape& s, const Part& part) {
  using enum PartKind;
  PartWitness w(1, "");
  if (part.opacity > 0.9f || s.pixels == 0) return w;
  w[body] = 0.05f, w[tyre] = w[rim] = w[wheel] = 0.1f, w[other] = 0.3f;
  w[light] = s.ends > 0.6f ? 1.0f : 0.2f, w[window] = s.ends > 0.9f && s.above < 0.7f ? 0.3f : 1.0f;
  w.says = "see-through";
  return w;
}

/// What a name says. doubt: the factor of what it does not say; nodes are named with less care than materials.
inline PartWitness name_witness(const std::string& name, float doubt) {
  using enum PartKind;
  const NameHints h = name_hints(name);
  PartWitness w(1, "");
  if (!h.any()) return w;
  w = PartWitness(doubt, "name " + name);
  const bool paint = h.paint && !(h.rest && !h.color);
  if (h.glass) {
    w[window] = 1;
    if (h.lamp || h.color) w[window] = w[light] = 1;  // "brake light glass", "lights and glass": the place decides
  } else if (paint && !h.lamp) w[body] = 1, w[other] = std::max(0.1f, doubt);
  else if (h.tyre) w[tyre] = 1, w[wheel] = w[rim] = 0.3f;
  else if (h.rim) w[rim] = 1, w[wheel] = w[tyre] = 0.3f;
  else if (h.wheel) w[wheel] = 1, w[rim] = w[tyre] = 0.5f;
  else if (h.lamp) w[light] = 1;
  else if (h.rest) w.factor = {0.1f, 0.1f, 0.5f, 0.4f, 0.6f, 0.2f, 1};
  else w.factor = {0.7f, 0.3f, 0.3f, 0.3f, 0.3f, 1, 0.5f};
  if (h.rest && w[other] < 0.1f) w[other] = 0.1f;
  return w;
}
/// The material's name, or where it tells nothing the part's own.
inline PartWitness name_witness(const Part& part) {
  PartWitness w = name_witness(part.material, 0.02f);
  return w.says.empty() ? name_witness(part.name, 0.1f) : w;
}

/// The kind with the largest product, its share of the sum, and the words of the witnesses that agree.
inline PartGuess judge(std::span<const PartWitness> witnesses, float share) {
  std::array<double, part_kinds> product;
  product.fill(1);
  for (const PartWitness& w : witnesses)
    for (std::size_t k = 0; k < product.size(); ++k) product[k] *= double(w.factor[k]);
  PartGuess out;
  double sum = 0;
  for (const double p : product) sum += p;
  const auto best = std::max_element(product.begin(), product.end());
  out.kind = PartKind(best - product.begin());
  out.confidence = sum > 0 ? float(*best / sum) : 0;
  // Among tyre, rim and wheel a doubt does not make the whole doubtful.
  if (is_wheel(out.kind)) {
    double wheels = 0;
    for (const PartKind k : {PartKind::tyre, PartKind::rim, PartKind::wheel}) wheels += product[std::size_t(k)];
    out.confidence = float(wheels / sum);
  }
  out.share = share;
  for (const PartWitness& w : witnesses) {
    const float most = *std::max_element(w.factor.begin(), w.factor.end());
    if (w.says.empty()) continue;
    out.reason += (out.reason.empty() ? "" : ", ") + w.says + (w[out.kind] < 0.3f * most ? " (against)" : "");
  }
  return out;
}

}  // namespace burnish
