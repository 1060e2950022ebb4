// burnish/math/color.h -- colour: transfer, luminance, hue, XYZ and Lab
// SPDX-License-Identifier: Apache-2.0
//
// A colour is a vec3 of linear RGB with the primaries of Rec. 709 (sRGB) and the white D65, unless its name says
// otherwise.
#pragma once
#include <burnish/math/vec.h>

namespace burnish {

/// An sRGB-coded number (0 to 1) made linear (IEC 61966-2-1). Below 0 the straight piece goes on. Edge: at 0.04045 the
/// slope jumps by 1.7 %, a flaw of the standard's rounded constants; there the straight piece's is given.
template <Number T> constexpr T linear_from_srgb(const T& c) {
  const T curve = pow((max(c, T(0.04045f)) + 0.055f) * (1.0f / 1.055f), T(2.4f));
  return select(c <= T(0.04045f), c * (1.0f / 12.92f), curve);
}
/// The inverse; its edge lies at 0.0031308.
template <Number T> constexpr T srgb_from_linear(const T& c) {
  const T curve = 1.055f * pow(max(c, T(0.0031308f)), T(1.0f / 2.4f)) - 0.055f;
  return select(c <= T(0.0031308f), c * 12.92f, curve);
}
template <class T> constexpr vec3<T> linear_from_srgb(const vec3<T>& c) {
  return {linear_from_srgb(c.x), linear_from_srgb(c.y), linear_from_srgb(c.z)};
}
template <class T> constexpr vec3<T> srgb_from_linear(const vec3<T>& c) {
  return {srgb_from_linear(c.x), srgb_from_linear(c.y), srgb_from_linear(c.z)};
}

/// Rec. 709; the Y of XYZ.
template <class T> constexpr T luminance(const vec3<T>& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

namespace detail {
/// A colour seen from its largest channel: hue * 6 = sector + offset / chroma, on the side of middle (-0.5 or 0.5).
template <class T> struct Hexcone {
  T largest, chroma, sector, offset, middle;
  typename std::remove_cvref_t<decltype(std::declval<T>() > std::declval<T>())> colored;
};
/// Ties between channels count as red above green above blue, in value and slope alike: grey has the slopes of the
/// colours next to it on that side, and not none.
template <class T> constexpr Hexcone<T> hexcone(const vec3<T>& c) {
  const auto red = c.x >= c.y && c.x >= c.z, green = c.y >= c.z;
  const auto blue_least = c.x >= c.z && c.y >= c.z, green_least = c.x >= c.y;
  const T largest = select(red, c.x, select(green, c.y, c.z));
  const T least = select(blue_least, c.z, select(green_least, c.y, c.x));
  const T sector = select(red, T(0.0f), select(green, T(2.0f), T(4.0f)));
  const T offset = select(red, c.y - c.z, select(green, c.z - c.x, c.x - c.y));
  const auto side = [](const auto& positive) { return select(positive, T(0.5f), T(-0.5f)); };
  const T middle = select(red, side(c.y >= c.z), select(green, side(c.z > c.x), side(c.x >= c.y)));
  return {largest, largest - least, sector, offset, middle, largest > least};
}
/// Of k = h + n, wrapped to [0, 6): 1 on [1, 3], 0 on [4, 6], straight between. The slope at an end is that above it,
/// so that the three channels of a colour are on one side.
template <class T> constexpr T hue_ramp(const T& h, float n) {
  const T k = (h + n) - 6.0f * floor((h + n) * (1.0f / 6.0f));
  return select(k < T(1.0f), k, select(k < T(3.0f), T(1.0f), select(k < T(4.0f), 4.0f - k, T(0.0f))));
}
}  // namespace detail

/// Hue, saturation and value, each 0 to 1, of a colour >= 0 (Smith 1978; MaterialX's rgbtohsv). Grey: hue 0, black also
/// saturation 0; there the slopes of hue (and of black's saturation) do not exist and are given as 0. Edges: where the
/// largest or the least two channels change places; at red the hue jumps from 1 to 0.
template <class T> constexpr vec3<T> rgbtohsv(const vec3<T>& c) {
  const auto x = detail::hexcone(c);
  const auto lit = x.largest > T(0.0f);
  const T h = select(x.colored, x.sector + x.offset / select(x.colored, x.chroma, T(1.0f)), T(0.0f)) * (1.0f / 6.0f);
  const T s = select(lit, x.chroma / select(lit, x.largest, T(1.0f)), T(0.0f));
  return {select(h < T(0.0f), h + 1.0f, h), s, x.largest};
}
/// MaterialX's hsvtorgb, but without its cut of saturations below 1e-4; hue wraps. Edges: every sixth of the
/// hue; the slopes there are those above.
template <class T> constexpr vec3<T> hsvtorgb(const vec3<T>& hsv) {
  const T h = 6.0f * hsv.x, d = hsv.y * hsv.z;
  return {hsv.z - d * detail::hue_ramp(h, 5.0f), hsv.z - d * detail::hue_ramp(h, 3.0f),
          hsv.z - d * detail::hue_ramp(h, 1.0f)};
}
/// A colour >= 0 with its hue turned by amount.x (1 is once round), saturation times amount.y, value times amount.z:
/// MaterialX's hsvadjust. It is the way there and back in one, because both ways have no slopes at grey while their
/// product has: a fit may start at grey. Edges as of the two above; at grey the slopes are those of neighbours with
/// red > green > blue.
template <class T> constexpr vec3<T> hsvadjust(const vec3<T>& c, const vec3<T>& amount) {
  const auto x = detail::hexcone(c);
  const T turned = x.sector + 6.0f * amount.x, chroma = x.chroma * amount.y * amount.z;
  const T offset = x.offset * amount.y * amount.z, top = x.largest * amount.z;
  // k is where the channel's ramp stands, in sixths of a turn. It decides only, so a hair (4e-6) keeps it off the ends
  // that ties would put it on; k times chroma, which gives the value, has no quotient.
  const T part = select(x.colored, x.offset / select(x.colored, x.chroma, T(1.0f)), x.middle);
  const T inside = x.sector + part + (x.middle - part) * 8e-6f + 6.0f * amount.x;
  const auto channel = [&](float n) {
    const T turns = 6.0f * floor((inside + n) * (1.0f / 6.0f)), k = inside + n - turns;
    const T up = (turned + n - turns) * chroma + offset, down = 4.0f * chroma - up;
    return top - select(k < T(1.0f), up, select(k < T(3.0f), chroma, select(k < T(4.0f), down, T(0.0f))));
  };
  return {channel(5.0f), channel(3.0f), channel(1.0f)};
}

/// CIE 1931 XYZ; white is (0.9505, 1, 1.0890).
template <class T> constexpr vec3<T> xyz_from_rgb(const vec3<T>& c) {
  return {0.4124564f * c.x + 0.3575761f * c.y + 0.1804375f * c.z,
          0.2126729f * c.x + 0.7151522f * c.y + 0.0721750f * c.z,
          0.0193339f * c.x + 0.1191920f * c.y + 0.9503041f * c.z};
}
template <class T> constexpr vec3<T> rgb_from_xyz(const vec3<T>& c) {
  return {3.2404542f * c.x - 1.5371385f * c.y - 0.4985314f * c.z,
          -0.9692660f * c.x + 1.8760108f * c.y + 0.0415560f * c.z,
          0.0556434f * c.x - 0.2040259f * c.y + 1.0572252f * c.z};
}
namespace detail {
inline constexpr float white_x = 0.95047f, white_z = 1.08883f, lab_edge = 6.0f / 29.0f;
template <class T> constexpr T lab_root(const T& t) {
  constexpr float cubed = lab_edge * lab_edge * lab_edge;
  return select(t > T(cubed), pow(max(t, T(cubed)), T(1.0f / 3.0f)),
                t * (1.0f / (3 * lab_edge * lab_edge)) + 4.0f / 29.0f);
}
template <class T> constexpr T lab_cube(const T& f) {
  return select(f > T(lab_edge), f * f * f, (f - 4.0f / 29.0f) * (3 * lab_edge * lab_edge));
}
}  // namespace detail
/// CIE 1976 L*a*b* (L 0 to 100) for the white D65. Value and slope are continuous; for black and below the straight
/// piece holds.
template <class T> constexpr vec3<T> lab_from_xyz(const vec3<T>& c) {
  const T x = detail::lab_root(c.x * (1.0f / detail::white_x)), y = detail::lab_root(c.y);
  const T z = detail::lab_root(c.z * (1.0f / detail::white_z));
  return {116.0f * y - 16.0f, 500.0f * (x - y), 200.0f * (y - z)};
}
template <class T> constexpr vec3<T> xyz_from_lab(const vec3<T>& lab) {
  const T y = (lab.x + 16.0f) * (1.0f / 116.0f), x = y + lab.y * (1.0f / 500.0f), z = y - lab.z * (1.0f / 200.0f);
  return {detail::lab_cube(x) * detail::white_x, detail::lab_cube(y), detail::lab_cube(z) * detail::white_z};
}
template <class T> constexpr vec3<T> lab_from_rgb(const vec3<T>& c) { return lab_from_xyz(xyz_from_rgb(c)); }
template <class T> constexpr vec3<T> rgb_from_lab(const vec3<T>& lab) { return rgb_from_xyz(xyz_from_lab(lab)); }

}  // namespace burnish
