// tests/reference/emitter_texture.cpp -- panoramas, lights, textures and normal maps against Mitsuba 3.9.1
// SPDX-License-Identifier: Apache-2.0
//
// Rows of a panorama: burnish's lie at v = (j + .5) / H, as pixels do; those of Mitsuba's envmap at v = j / (H - 1),
// from pole to pole. The same file is read half a row apart at the poles. Columns agree, and so do all axes. Mitsuba
// finds a place in the panorama in single precision, up to 1.2e-5 of the value off what a lookup in double gives.
#include <burnish/light/illuminate.h>
#include <burnish/nodes/image.h>
#include <burnish/nodes/normal.h>
#include <burnish_test.h>
#include "errors.h"
#include "inputs.h"
using namespace burnish;
using namespace reference;

namespace {
vec3<double> around(int stream, std::size_t i) {
  const double x = 2 * uniform(stream, i, 0) - 1, y = 2 * uniform(stream, i, 1) - 1, z = 2 * uniform(stream, i, 2) - 1,
               r = std::sqrt(x * x + y * y + z * z);
  return rounded(vec3<double>(x / r, y / r, z / r));
}
vec3<double> color(int stream, std::size_t i, int j, double low, double high) {
  return {between(stream, i, j, low, high), between(stream, i, j + 1, low, high), between(stream, i, j + 2, low, high)};
}
Image random_panorama() {
  Image image(32, 16);
  for (int i = 0; i < 512; ++i)
    image.set(i % 32, i / 32, color(20, std::size_t(i), 0, 0.1, 1));
  return image;
}
/// The green of that panorama at (u, v), bilinear, in double; v between the first and the last row's centres.
double looked_up(const Image& image, double u, double v) {
  const double x = u * image.width + image.width - 0.5, y = std::clamp(v * image.height - 0.5, 0.0, image.height - 1.0);
  const int i = int(x), j = std::min(int(y), image.height - 2);
  const auto at = [&](int a, int b) { return double(image.at(a % image.width, b).y); };
  const double fx = x - i, fy = y - j;
  return (1 - fy) * ((1 - fx) * at(i, j) + fx * at(i + 1, j)) + fy * ((1 - fx) * at(i, j + 1) + fx * at(i + 1, j + 1));
}
/// The direction that sees in rows at (j + .5) / H what d sees in rows at j / (H - 1).
vec3<float> in_centred_rows(const vec3<double>& d, double height, double yaw = 0) {
  const vec2<double> at = latlong(turned(d, -yaw));
  return vec3<float>(turned(latlong_direction(at.x, (at.y * (height - 1) + 0.5) / height), yaw));
}
}  // namespace

TEST_CASE("Mitsuba: a panorama is its envmap, once rows are where they belong", "[reference][agreement]") {
  const Array value = load("envmap_value"), turned_value = load("envmap_turned_value");
  const Image image = random_panorama();
  const Pyramid straight{EnvironmentLight(image, 0, false)};
  const double angle = 70 * 0.017453292519943295;
  const Pyramid yawed{EnvironmentLight(image, float(angle), false)};
  Errors errors, turned_errors, mirrored, ours;
  for (std::size_t i = 0; i < 4000; ++i) {
    const vec3<double> d = around(21, i);
    const vec3<float> y = straight.fetch(in_centred_rows(d, 16), 0);
    errors.add(y.x, value(i, 0)), errors.add(y.y, value(i, 1)), errors.add(y.z, value(i, 2));
    turned_errors.add(yawed.fetch(in_centred_rows(d, 16, angle), 0).y, turned_value(i));
    const vec2<double> at = latlong(d);
    const double exact = looked_up(image, at.x, (at.y * 15 + 0.5) / 16);
    ours.add(y.y, exact);
    mirrored.add(straight.fetch(in_centred_rows(vec3<double>(-d.x, d.y, d.z), 16), 0).x, value(i, 0));
  }
  errors.claim("EnvironmentLight", "value", "Mitsuba 3.9.1 envmap at v -> (v (H - 1) + .5) / H, relative", 2e-5);
  turned_errors.claim("EnvironmentLight", "value", "Mitsuba 3.9.1 envmap turned about +Y, likewise", 2e-5);
  ours.claim("EnvironmentLight", "value", "bilinear lookup in double, relative", 1e-5);
  CHECK(mirrored.worst() > 0.5);  // an axis the wrong way round does not pass
}

TEST_CASE("Mitsuba: a smooth sky looks the same, each with rows of its own", "[reference][agreement]") {
  // 1 + .5 d.y + .3 d.x - .1 (-d.z), 64 x 32 texels; what is left is what bilinear lookup costs.
  const Array aligned = load("envmap_smooth_aligned"), centred = load("envmap_smooth_centred");
  Image image(64, 32);
  for (int i = 0; i < 64 * 32; ++i) {
    const vec3<double> d = latlong_direction((i % 64 + 0.5) / 64, (i / 64 + 0.5) / 32);
    image.set(i % 64, i / 64, vec3<float>(float(1 + 0.5 * d.y + 0.3 * d.x + 0.1 * d.z)));
  }
  const Pyramid sky{EnvironmentLight(image, 0, false)};
  Errors own, same_file, truth;
  for (std::size_t i = 0; i < 4000; ++i) {
    const vec3<double> d = around(21, i);
    const double y = sky.fetch(vec3<float>(d), 0).x;
    own.add(y, aligned(i)), same_file.add(y, centred(i));
    truth.add(y, 1 + 0.5 * d.y + 0.3 * d.x + 0.1 * d.z);
  }
  own.claim("EnvironmentLight", "value",
            "Mitsuba 3.9.1 envmap of a smooth sky, each sampled at its own rows, relative", 3e-3);
  same_file.claim("EnvironmentLight", "value",
                  "Mitsuba 3.9.1 envmap of the same 64 x 32 file, half a row (2.8 deg) apart at the poles; relative",
                  0.05);
  truth.claim("EnvironmentLight", "value", "the smooth sky itself, relative", 3e-3);
}

TEST_CASE("Mitsuba: a constant sky is its constant", "[reference][agreement]") {
  const Array value = load("constant_value");
  Image image(32, 16);
  for (int i = 0; i < 512; ++i) image.set(i % 32, i / 32, vec3<float>(0.25f, 0.5f, 2));
  const Pyramid sky{EnvironmentLight(image, 0, false)};
  Errors errors;
  for (std::size_t i = 0; i < 100; ++i) {
    const vec3<float> y = sky.fetch(vec3<float>(around(21, i)), 0);
    errors.add(y.x, value(0, 0)), errors.add(y.y, value(0, 1)), errors.add(y.z, value(0, 2));
  }
  errors.claim("EnvironmentLight", "value", "Mitsuba 3.9.1 constant, relative", 1e-6);
}

TEST_CASE("Mitsuba: a sun's light on a diffuse surface is its directional, and its slope by the irradiance",
          "[reference][agreement]") {
  const Array value = load("directional_value"), slope = load("directional_by_irradiance");
  Errors of_value, of_slope;
  for (std::size_t k = 0; k < 8; ++k) {
    Surface<double> s;
    s.base_color = color(26, k, 3, 0.1, 0.9), s.specular_weight = 0;
    Sun<double> sun;
    sun.direction = around(27, k) * -1.0, sun.power = color(26, k, 0, 0.2, 3);
    vec3<double> sum;
    for (std::size_t i = 125 * k; i < 125 * k + 125; ++i) {
      const vec3<double> n = around(25, i);
      const auto f = [&]<class T>(const vec3<T>& power) {
        Sun<T> lit = lift<T>(sun);
        lit.power = power;
        return sunlit(layers(lift<T>(s)), lift<T>(n), lift<T>(n), lift<T>(n), lit);
      };
      const vec3<double> y = f(sun.power);
      const vec3<double> facing = s.base_color * sun.power * double(inverse_pi);
      of_value.add(y.x, value(i, 0), facing.x), of_value.add(y.y, value(i, 1), facing.y);
      of_value.add(y.z, value(i, 2), facing.z);
      sum += std::get<1>(differentiate([&](const auto& e) { auto c = f(e); return c.x + c.y + c.z; }, sun.power));
    }
    of_slope.add(sum.x, slope(k, 0)), of_slope.add(sum.y, slope(k, 1)), of_slope.add(sum.z, slope(k, 2));
  }
  of_value.claim("sunlit", "value", "Mitsuba 3.9.1 directional on diffuse, relative to facing the sun", 1e-6);
  of_slope.claim("sunlit", "gradient", "Mitsuba 3.9.1 directional on diffuse by irradiance, relative", 1e-6);
}

TEST_CASE("Mitsuba: an image is its bitmap in every way to wrap, by uv and by texels", "[reference][agreement]") {
  // Texels within [0, 1], 7 x 5. Edges, and left out where single precision may fall on the other side of them: lines
  // through texel centres. Row 0 is at v = 0 in both.
  const std::pair<const char*, AddressMode> modes[] = {
      {"repeat", AddressMode::periodic}, {"mirror", AddressMode::mirror}, {"clamp", AddressMode::clamp}};
  for (const auto& [name, mode] : modes) {
    const std::string key = std::string("bitmap_") + name, theirs = std::string("Mitsuba 3.9.1 bitmap, ") + name;
    const Array value = load(key + "_value"), by_uv = load(key + "_by_uv"), by_texels = load(key + "_by_texels");
    TextureData image(7, 5, 3);
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < 7; ++x)
        for (int c = 0; c < 3; ++c) image.at(x, y, c) = float(between(22, 7 * y + x, c, 0, 1));
    image.uaddressmode = image.vaddressmode = mode;
    const auto in = [&]<class T>(T) {
      Errors of_value, of_uv, of_texels;
      std::vector<double> d_texels(image.texels.size());
      for (std::size_t i = 0; i < 4000; ++i) {
        const double u = between(23, i, 0, -1.5, 2.5), v = between(23, i, 1, -1.5, 2.5);
        const T x[] = {T(u), T(v)};
        T y[3];
        op::ImageRead<3>::value(image, x, y);
        for (int c = 0; c < 3; ++c) of_value.add(double(y[c]), value(i, c), 1);
        const T d_y[] = {T(1), T(2), T(3)};
        T d_x[2];
        Scatter scatter;
        op::ImageRead<3>::back(image, x, y, d_y, d_x, &scatter);
        const double weight = between(23, i, 2, 0.5, 1.5);
        for (const auto& e : scatter.entries) d_texels[std::size_t(e.index[0])] += weight * double(e.value[0]);
        const auto off = [](double a) { return std::fabs(a - std::round(a)); };
        if (off(7 * u - 0.5) < 1e-5 || off(5 * v - 0.5) < 1e-5) continue;
        of_uv.add(double(d_x[0]), by_uv(i, 0), 6 * 7), of_uv.add(double(d_x[1]), by_uv(i, 1), 6 * 5);
      }
      for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 7; ++x)
          for (int c = 0; c < 3; ++c)
            of_texels.add(d_texels[std::size_t((c * 5 + y) * 7 + x)], by_texels(y, x, c));
      of_value.claim("ImageNode", "value", theirs + ", of the range of texels", 2e-6);
      of_uv.claim("ImageNode", "gradient", theirs + " by uv, of the steepest slope", 2e-6);
      of_texels.claim("ImageNode", "gradient", theirs + " by texels, relative", 1e-5);
    };
    in(double());
    in(float());
  }
}

TEST_CASE("Mitsuba: NormalMap is its normalmap, by the colour too", "[reference][agreement]") {
  for (const std::string nested : {"ggx", "diffuse"}) {
    const Array value = load("normalmap_" + nested + "_value"), slope = load("normalmap_" + nested + "_by_color");
    Errors of_value, of_slope;
    long dark = 0;
    for (std::size_t i = 0; i < 4000; ++i) {
      const auto [v, l] = directions(24, i, 0.3);
      const vec3<double> coded(between(24, i, 8, 0.25, 0.75), between(24, i, 9, 0.25, 0.75),
                               between(24, i, 10, 0.7, 1));
      const auto f = [&, to_v = v, to_l = l]<class U>(const vec3<U>& c) {
        const vec3<U> n = NormalMap<U>{}(c), out = constant<U>(to_v), from = constant<U>(to_l);
        const vec3<U> h = normalize(out + from);
        const U nv = dot(n, out), nl = dot(n, from), r = sqrt(U(0.3f));
        const U seen = select(nv > U(0.0f) && nl > U(0.0f), U(1.0f), U(0.0f));
        const U lobe = nested == "ggx" ? ggx_d(r, n, h) * ggx_v_smith_separable(r, max(nl, 0.0f), max(nv, 0.0f))
                                       : U(0.5f * inverse_pi);
        return lobe * nl * seen;
      };
      const vec3<double> n = normalize(coded * 2.0 - vec3<double>(1.0));
      if (std::min(std::fabs(dot(n, v)), std::fabs(dot(n, l))) < 1e-3) continue;  // edges: the horizons
      const auto [y, d] = differentiate(f, coded);
      dark += value(i) == 0;
      // A value may lie near its own horizon: the cosine's rounding is one of 1.
      const double scale = std::fabs(value(i)) / std::min(std::fabs(dot(n, l)), std::fabs(dot(n, v)));
      of_value.add(y, value(i), scale);
      of_slope.add(d.x, slope(i, 0), scale), of_slope.add(d.y, slope(i, 1), scale);
      of_slope.add(d.z, slope(i, 2), scale);
    }
    CHECK(dark > 10);
    of_value.claim("NormalMap", "value", "Mitsuba 3.9.1 normalmap on " + nested + ", relative to value / cosine", 5e-6);
    of_slope.claim("NormalMap", "gradient",
                   "Mitsuba 3.9.1 normalmap on " + nested + " by colour, relative to max(slope, value / cosine)", 1e-5);
  }
}
