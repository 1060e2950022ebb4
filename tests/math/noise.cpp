// tests/math/noise.cpp -- noise: MaterialX's values, its slopes, its seams
// SPDX-License-Identifier: Apache-2.0
#include <burnish/math/noise.h>
#include <differences.h>

using namespace differences;

namespace {
/// Random places of a noise of D dimensions: uv or a point, and the numbers of a fractal.
template <class T> struct Place {
  vec3<T> p;
  T octaves = 3.0f, lacunarity = 2.0f, diminish = 0.5f;
  static constexpr auto parameters() {
    return std::tuple{Param{"p", &Place::p, Range{-2, 2}}, Param{"octaves", &Place::octaves, Range{0, 5}},
                      Param{"lacunarity", &Place::lacunarity, Range{1.5f, 3}},
                      Param{"diminish", &Place::diminish, Range{0.2f, 0.9f}}};
  }
};
constexpr auto mixed = [](const auto& h) { return h.value + 0.3f * h.slope.x - 0.7f * h.slope.y; };
constexpr auto mixed3 = [](const auto& h) { return h.value + 0.3f * h.slope.x - 0.7f * h.slope.y + 0.4f * h.slope.z; };
}  // namespace

// The references of the next three come from the text of MaterialX 1.39.5's lib/mx_noise.glsl, compiled as it stands in
// double precision against GLM, and from a transcription in another language, which agree in all digits. The places are
// whole multiples of 1/64, so that float meets them exactly.
TEST_CASE("noise2d: gives MaterialX's values", "[math][value]") {
  constexpr double table[][3] = {{-0.359375, -0.703125, 0.293506164238},     {0.296875, -0.859375, 0.0701238188833},
                                 {0.078125, -0.265625, -0.242607866476},     {-0.890625, 0.015625, -0.146572007302},
                                 {-3.703125, -0.53125, -0.368458863925},     {-3.4375, -3.28125, -0.0363379006142},
                                 {-0.609375, 2.609375, 0.014182643184},      {-3.015625, -2.21875, -0.189958976962},
                                 {7.640625, 26.859375, -0.0577962080477},    {4.625, -6.203125, 0.432284985952},
                                 {28.578125, -27.203125, 0.257089798911},    {21.515625, -12.625, -0.203755870001},
                                 {-711.484375, -764.421875, 0.443368403375}, {-383.03125, 632.25, 0.211420988044},
                                 {-638.546875, 163.203125, -0.375918846275}, {277.828125, -255.203125, 0.290209537719}};
  for (const auto& [x, y, n] : table) {
    CAPTURE(x, y);
    CHECK(noise2d(vec2<double>{x, y}).value == Approx(n).epsilon(0).margin(2e-8));
    CHECK(noise2d(vec2<float>{float(x), float(y)}).value == Approx(n).epsilon(0).margin(4e-7));
  }
}
TEST_CASE("noise3d: gives MaterialX's values", "[math][value]") {
  constexpr double table[][4] = {{0.09375, -0.875, -0.875, -0.254166451478},
                                 {-0.59375, 0.359375, -0.140625, 0.310367468402},
                                 {-0.375, 0.171875, -0.09375, 0.0217271580134},
                                 {-0.40625, 0.59375, 0.390625, 0.0145501985412},
                                 {-2.046875, 0.59375, 0.203125, 0.278622088535},
                                 {3.0, 1.828125, -1.703125, 0.324486766491},
                                 {3.84375, -3.0625, -0.65625, 0.0401333175069},
                                 {2.0625, -2.78125, -0.09375, 0.317241889847},
                                 {-27.640625, 10.09375, 15.875, 0.318132489797},
                                 {4.375, 22.53125, -11.171875, -0.74782787344},
                                 {11.71875, 5.65625, 4.796875, -0.25171120474},
                                 {-2.625, 20.390625, 26.6875, 0.3095203458},
                                 {-51.796875, 328.296875, -878.65625, -0.295273509324},
                                 {402.984375, 294.25, 986.1875, 0.24311439866},
                                 {643.84375, -430.8125, -228.421875, 0.444890898419},
                                 {337.3125, -954.875, -76.609375, 0.113038960202}};
  for (const auto& [x, y, z, n] : table) {
    CAPTURE(x, y, z);
    CHECK(noise3d(vec3<double>{x, y, z}).value == Approx(n).epsilon(0).margin(2e-8));
    CHECK(noise3d(vec3<float>{float(x), float(y), float(z)}).value == Approx(n).epsilon(0).margin(4e-7));
  }
}
TEST_CASE("fractal2d and fractal3d: give MaterialX's values at whole octaves", "[math][value]") {
  constexpr double table[][8] = {{-3.3125, -3.828125, -4.40625, 1, 2, 0.5, -0.323327973626, -0.067586342314},
                                 {2.6875, -3.703125, -2.53125, 3, 2, 0.5, 0.377643066315, 0.514037381794},
                                 {-1.09375, 3.71875, -4.1875, 4, 2.25, 0.625, 0.762297777864, -0.513186791801},
                                 {-0.515625, 0.5, 3.828125, 6, 1.75, 0.4375, 0.445431926692, 0.0947701625434}};
  for (const auto& [x, y, z, octaves, lacunarity, diminish, n2, n3] : table) {
    CAPTURE(x, y, z, octaves);
    CHECK(fractal2d(vec2<double>{x, y}, octaves, lacunarity, diminish).value == Approx(n2).epsilon(0).margin(5e-8));
    CHECK(fractal3d(vec3<double>{x, y, z}, octaves, lacunarity, diminish).value == Approx(n3).epsilon(0).margin(5e-8));
  }
}

TEST_CASE("noise2d and noise3d: one value and right slopes in every number", "[math][gradient]") {
  // No edges: the second derivatives are continuous, the third jump at lattice lines; off those by 0.02.
  const auto off_lines = [](const auto& p) {
    const auto off = [](double x) { return std::fabs(x - std::round(x)) > 0.02; };
    return off(p.x) && off(p.y) && off(p.z);
  };
  const Hard<std::tuple<vec3<double>>> lattice{
      "lattice corners and lines", {{{0, 0, 0}}, {{1, -1, 2}}, {{-2, 0.5, 3}}, {{0.25, 7, -0.0}}, {{1e5, -1e5, 0.5}}}};
  holds(
      "noise2d, op::Noise",
      [](const auto& p) {
        return noise2d(vec2{p.x, p.y});
      },
      within(off_lines, vec3<double>()), {.rounding = 1e-4}, lattice);
  holds(
      "noise3d, op::Noise", [](const auto& p) { return noise3d(p); }, within(off_lines, vec3<double>()),
      {.rounding = 1e-4}, lattice);
}
TEST_CASE("Sloped: sums, products and what goes through a function, with their slopes", "[math][gradient]") {
  holds("Sloped",
        [](const auto& p, const auto& s) {
          using T = std::remove_cvref_t<decltype(s)>;
          const Height<T> a{p.x, {p.y, p.z}}, b{s, {s * p.x, p.z}};
          const auto c = mix(a * b - s, -(s - b) + a, s) + (a - b) * s + s * (s + b);
          return c.through(c.value * c.value, 2.0f * c.value);
        },
        within(anywhere, vec3<double>(), 0.0), {.rounding = 1e-4, .scale = 10});
}
TEST_CASE("noise2d and noise3d: the slopes they give are those of their value", "[math][gradient]") {
  std::mt19937_64 random(3);
  for (int i = 0; i < 1000; ++i) {
    vec3<double> p{3, 4, 5};
    move(random, p);
    const auto [n, dx, dy, dz] = differentiate(
        [](auto x, auto y, auto z) {
          return noise3d(vec3{x, y, z}).value;
        },
        p.x, p.y, p.z);
    const auto h = noise3d(p);
    CHECK(h.value == n);
    CHECK(std::max({std::fabs(h.slope.x - dx), std::fabs(h.slope.y - dy), std::fabs(h.slope.z - dz)}) < 1e-13);
    const auto [m, du, dv] = differentiate([](auto x, auto y) { return noise2d(vec2{x, y}).value; }, p.x, p.y);
    const auto g = noise2d(vec2{p.x, p.y});
    CHECK(g.value == m);
    CHECK(std::max(std::fabs(g.slope.x - du), std::fabs(g.slope.y - dv)) < 1e-13);
  }
}
TEST_CASE("fractal2d and fractal3d: one value and right slopes in every number", "[math][gradient]") {
  // Edges: whole numbers of octaves. The third derivatives jump at the lattice lines of every octave.
  const auto off_lines = [](const auto& p) {
    const auto off = [](double x, double by) { return std::fabs(x - std::round(x)) > by; };
    bool far = off(p.octaves, 0.06);
    for (double s = 1, i = 0; i < 5; ++i, s *= p.lacunarity) far = far && off(p.p.x * s, 0.02) && off(p.p.y * s, 0.02);
    return far;
  };
  const auto off_lines3 = [&](const auto& p) {
    auto q = p;
    q.p.y = p.p.z;
    return off_lines(p) && off_lines(q);
  };
  const How how{.rounding = 1e-3, .step = 1e-4}, far{.rounding = 1e-2, .step = 1e-4};
  const Hard<std::tuple<Place<double>>> lattice{"lattice corners and lines, no, whole and too many octaves",
                                                {{{{0, 0, 0}, 3, 2, 0.5}},
                                                 {{{1, -1, 0.5}, 0, 2, 0.5}},
                                                 {{{0.3, 0.2, -2}, 40, 2, 0.5}},
                                                 {{{0.5, 1, 2}, -1, 1, 0}},
                                                 {{{0.5, 1, 2}, 2.5, 0, 1}}}};
  // Where the last octave lies beyond 50 of its cells, a float's position in it is no better than 1e-5 of one.
  const auto near = [](auto away) {
    return [=](const auto& p) {
      const double last = std::pow(p.lacunarity, std::floor(p.octaves));
      return away(p) && last * std::max({std::fabs(p.p.x), std::fabs(p.p.y), std::fabs(p.p.z)}) < 50;
    };
  };
  const auto plane = [](const auto& p) {
    return mixed(fractal2d(vec2{p.p.x, p.p.y}, p.octaves, p.lacunarity, p.diminish));
  };
  const auto space = [](const auto& p) { return mixed3(fractal3d(p.p, p.octaves, p.lacunarity, p.diminish)); };
  holds("fractal2d, op::Fractal", plane, within(near(off_lines), Place<double>()), how, lattice);
  holds("fractal2d, op::Fractal", plane, within(off_lines, Place<double>()), far);
  holds("fractal3d, op::Fractal", space, within(near(off_lines3), Place<double>()), how, lattice);
  holds("fractal3d, op::Fractal", space, within(off_lines3, Place<double>()), far);
}
TEST_CASE("fractal2d: at a whole number of octaves the slope is that from below", "[math][limit]") {
  const auto slope = [](double octaves) {
    return std::get<1>(differentiate(
        [](auto o) {
          return fractal2d(vec2<decltype(o)>{0.3f, 0.8f}, o, 2.0f, 0.5f).value;
        },
        octaves));
  };
  CHECK(slope(3.0) == slope(2.5));
  CHECK(slope(3.0) != slope(3.5));
  CHECK(slope(3.0) == Approx(0.25 * noise2d(vec2<double>{double(0.3f) * 4, double(0.8f) * 4}).value));
  CHECK(slope(0.0) == 0);
  CHECK(slope(40.0) == 0);
}
TEST_CASE("noise: value and slopes have no seam at lattice lines and corners", "[math][limit]") {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> corner(-40, 40);
  std::uniform_real_distribution<double> along(-1, 1);
  for (int i = 0; i < 500; ++i) {
    const vec3<double> c{double(corner(random)), double(corner(random)),
                         i % 2 ? along(random) : double(corner(random))};
    const vec3<double> d{along(random), along(random), along(random)};
    const auto a = noise3d(c - d * 1e-9), b = noise3d(c + d * 1e-9);
    CHECK(std::fabs(a.value - b.value) < 1e-8);
    CHECK(length(a.slope - b.slope) < 1e-7);
    const auto e = noise2d(vec2<double>{c.x - d.x * 1e-9, c.y - d.y * 1e-9}),
               f = noise2d(vec2<double>{c.x + d.x * 1e-9, c.y + d.y * 1e-9});
    CHECK(std::fabs(e.value - f.value) < 1e-8);
    CHECK(length(e.slope - f.slope) < 1e-7);
  }
}
TEST_CASE("noise: is zero at lattice points and has mean zero", "[math][symmetry]") {
  double sum = 0, square = 0;
  constexpr int n = 200;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double v = noise2d(vec2<double>{i * 0.37 + 0.1, j * 0.41 - 30}).value;
      sum += v, square += v * v;
      CHECK(std::fabs(v) <= 1.0);
    }
  CHECK(std::fabs(sum / (n * n)) < 0.02);
  CHECK(std::sqrt(square / (n * n)) == Approx(0.3).margin(0.05));
  for (int i = -5; i < 5; ++i) CHECK(noise3d(vec3<double>{double(i), 3.0 * i, 7.0 - i}).value == 0);
}
