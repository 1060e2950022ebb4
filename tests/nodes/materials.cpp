// tests/nodes/materials.cpp -- the laws of the vehicle's materials: car paint, window glass, rubber
// SPDX-License-Identifier: Apache-2.0
#include <burnish/nodes/car_paint.h>
#include <burnish/nodes/rubber.h>
#include <burnish/nodes/window_glass.h>
#include <burnish/scene/gbuffer.h>
#include <burnish/shade/brdf.h>
#include <differences.h>
using namespace differences;

namespace {
using Vec = vec3<double>;

Surfel<double> place(Random& r) {
  Surfel<double> at;
  at.position = {between(r, -2, 2), between(r, 0, 1.5), between(r, -1, 1)};
  at.normal = upward(r, 0.1);
  at.tangent = normalize(cross(at.normal, Vec(0.3, 0.8, 0.1)));
  at.view = at.normal;
  return at;
}
/// All that a surface says, in one number.
constexpr auto mixed = [](const auto& s) {
  auto sum = s.specular_roughness - s.specular_roughness;
  float weight = 1;
  each([&](const auto& x) { sum += weight * x, weight += 0.37f; }, s);
  return sum;
};
constexpr auto weigh = [](const auto& c) { return c.x + 2.0f * c.y + 3.0f * c.z; };
template <class M> std::vector<std::string> names() {
  std::vector<std::string> list;
  M m{};
  for_each_parameter(m, [&](const std::string& name, auto&, Range range) {
    CHECK(range.low < range.high);
    CHECK(range.high < anything.high);
    list.push_back(name);
  });
  return list;
}
/// What a pixel shows of a material under one lamp.
template <class M, class At, class V> auto lit(const M& material, const At& at, const V& v, const V& l) {
  const auto s = material(at);
  return weigh(brdf_cos(s, at.normal, at.tangent, v, l) + transmittance(s, 0.6f));
}
}  // namespace

TEST_CASE("Materials: every number has a name and a range, and its default lies inside", "[nodes][value]") {
  CHECK(names<CarPaint<float>>().size() == std::size_t(count<CarPaint<float>>()));
  CHECK(names<CarPaint<float>>()[0] == "base_color.x");
  CHECK(names<CarPaint<float>>().back() == "coat_ior");
  CHECK(names<WindowGlass<float>>().size() == 9);
  CHECK(names<Rubber<float>>().size() == 5);
  const auto inside_range = [](auto m) {
    int outside = 0;
    for_each_parameter(m,
                       [&](const std::string&, auto& x, Range range) { outside += x < range.low || x > range.high; });
    return outside == 0;
  };
  CHECK(inside_range(CarPaint<float>()));
  CHECK(inside_range(WindowGlass<float>()));
  CHECK(inside_range(Rubber<float>()));
}

TEST_CASE("Materials: what they hand on is theirs, the coat stays smooth", "[nodes][value]") {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const auto at = place(random);
    CarPaint<double> paint;
    paint.flakes.resolved = 1, paint.mottle.amount = 0;
    const Surface<double> s = paint(at);
    CHECK(length(s.geometry_normal) == Approx(1).epsilon(1e-12));
    CHECK((s.geometry_coat_normal.x == 0 && s.geometry_coat_normal.z == 1));
    CHECK(s.base_color.x == Approx(paint.base_color.x).epsilon(1e-6));
    CHECK(s.specular_roughness == Approx(paint.specular_roughness).epsilon(1e-6));  // nothing is left to widen
    CHECK(s.coat_ior == paint.coat_ior);
    const Surface<double> glass = WindowGlass<double>()(at), rubber = Rubber<double>()(at);
    CHECK(glass.transmission_weight == Approx(0.95));
    CHECK(transmittance(glass, 1.0).y == Approx(0.95 * 0.8 * (1 - 2 * 0.0426 / 1.0426)).epsilon(4e-3));
    CHECK(transmittance(rubber, 1.0).y == 0);
    CHECK(rubber.specular_roughness == Approx(0.7));
  }
}

TEST_CASE("Car paint: flakes have the slopes they are asked for, in whatever size", "[nodes][value]") {
  Random random(2);
  for (const double size : {0.0005, 0.005})
    for (const double amount : {0.05, 0.2}) {
      const Flakes<double> flakes{size, amount, 1};
      double sum_x = 0, sum_y = 0, mean = 0;
      const int n = 20000;
      for (int i = 0; i < n; ++i) {
        const auto at = place(random);
        const Vec m = flakes.normal(at.position, at.normal, at.tangent);
        sum_x += m.x * m.x / (m.z * m.z) / n, sum_y += m.y * m.y / (m.z * m.z) / n, mean += m.x / m.z / n;
      }
      CHECK(std::sqrt(sum_x) == Approx(amount).epsilon(0.03));
      CHECK(std::sqrt(sum_y) == Approx(amount).epsilon(0.03));
      CHECK(mean == Approx(0).margin(0.03 * amount));
    }
}

TEST_CASE("Car paint: unresolved flakes reflect as the mean of resolved ones, as far as a GGX lobe can",
          "[nodes][agreement]") {
  // Half of the integral of |lobe - mean lobe|: the light that goes elsewhere. A GGX lobe blurred by a Gaussian of
  // slopes is none, so 7 % of it does at best; without the widening it were 16 %.
  Random random(3);
  const double amount = 0.1, base = 0.4;
  const Flakes<double> near{0.001, amount, 1}, far{0.001, amount, 0};
  const Vec n(0, 0, 1), t(1, 0, 0);
  std::vector<Vec> tilted(4000);
  for (Vec& m : tilted) m = near.normal(place(random).position, n, t);
  double astray = 0, unwidened = 0, all = 0;
  const double step = 0.02;
  for (double slope = step / 2; slope < 3; slope += step) {
    const Vec h = normalize(Vec(slope, 0, 1));
    double mean = 0;
    for (const Vec& m : tilted) mean += ggx_d(near.roughness(base), m, h) / double(tilted.size());
    const double ring = 6.2831853 * slope * step * h.z * h.z * h.z * h.z;  // cosine and solid angle, by slope
    all += mean * ring;
    astray += 0.5 * std::abs(ggx_d(far.roughness(base), n, h) - mean) * ring;
    unwidened += 0.5 * std::abs(ggx_d(base, n, h) - mean) * ring;
  }
  CHECK(all == Approx(1).epsilon(0.03));
  CHECK(astray < 0.085);
  CHECK(unwidened > 0.14);
  // Over a mirror the peak is the Gaussian's: 1 / (2 pi variance).
  CHECK(ggx_d(far.roughness(0.0), n, n) == Approx(1 / (6.2831853 * amount * amount)).epsilon(1e-3));
  const auto at = place(random);
  CHECK(far.normal(at.position, at.normal, at.tangent).z == 1);
}

TEST_CASE("Car paint: the mottle only darkens, and tints never pass white", "[nodes][limit]") {
  Random random(4);
  for (int i = 0; i < 500; ++i) {
    const auto paint = inside<CarPaint<double>>(random);
    const auto s = paint(place(random));
    CHECK(std::max({s.base_color.x, s.base_color.y, s.base_color.z}) <= 1);
    const double m = paint.mottle(place(random).position);
    CHECK(m <= 1);
    CHECK(m >= 1 - paint.mottle.amount);
  }
}

TEST_CASE("Materials: all numbers agree and the slopes are right", "[nodes][gradient]") {
  // Off the edges: the hue's sixths, white, a widened roughness of 1, the horizon. Sizes are given as multiples, a few
  // cells of noise from the origin, where the differences' steps stay within a cell; the noise's third derivative jumps
  // between two.
  const auto paint = [](Random& r) {
    auto p = inside<CarPaint<double>>(r);
    p.base_color = {between(r, 0.5, 0.6), between(r, 0.3, 0.4), between(r, 0.1, 0.2)};
    p.tint.amount = {between(r, -0.01, 0.01), between(r, 0.8, 1.1), between(r, 0.5, 1.2)};
    p.specular_roughness = between(r, 0.3, 0.6), p.coat_roughness = between(r, 0.2, 0.5),
    p.coat_ior = between(r, 1.4, 2);
    p.flakes.amount = between(r, 0.02, 0.3);
    return p;
  };
  const auto sized = [](auto p, const auto& size, const auto& mottle_size) {
    p.flakes.size = 0.004f * size, p.mottle.size = 0.02f * mottle_size;
    return p;
  };
  const auto near = [](Random& r) {
    auto at = place(r);
    const auto cell = [&] { return 0.004 * (std::floor(between(r, -3, 3)) + between(r, 0.1, 0.9)); };
    at.position = {cell(), cell(), cell()};
    return at;
  };
  const auto size = [](Random& r, double cell) {
    for (;;) {
      const double s = between(r, 0.5, 1.5);
      bool within = true;
      for (const double x : {0.0061, 0.0013, -0.0052}) {
        const double part = x / (cell * s) - std::floor(x / (cell * s));
        within &= part > 0.03 && part < 0.97;
      }
      if (within) return s;
    }
  };
  holds(
      "CarPaint, Flakes, Mottle",
      [=](const auto& p, const auto& a, const auto& b) {
        Surfel<float> at;
        at.position = {0.0061f, 0.0013f, -0.0052f}, at.normal = {0, 0.6f, 0.8f}, at.tangent = {1, 0, 0};
        const vec3<float> v(0.6f, 0.48f, 0.64f), l(0.1f, 0.2f, 0.97f);
        return mixed(sized(p, a, b)(at)) + lit(sized(p, a, b), at, v, l);
      },
      [&](Random& r) {
        return std::tuple{paint(r), size(r, 0.004), size(r, 0.02)};
      },
      {.rounding = 1e-4, .step = 1e-3},
      {"saturated, black and white tints, metal and dielectric, least roughness, lattice corners", [] {
         std::vector<std::tuple<CarPaint<double>, double, double>> list;
         for (const double extreme : {0.0, 1.0})
           for (const vec3<double>& c : {vec3<double>(extreme), vec3<double>{1, 0, 0}})
             for (const double r : {0.01, 1.0}) {
               CarPaint<double> p;
               p.base_color = c, p.base_metalness = p.coat_weight = p.flakes.resolved = extreme;
               p.tint.amount = {0.5, 2 * extreme, 2}, p.specular_roughness = p.coat_roughness = r,
               p.coat_ior = 1 + extreme;
               p.flakes.amount = p.mottle.amount = 0.5 * extreme;
               list.push_back({p, 1.525, 0.305}), list.push_back({p, 1e-3, 1e3});  // the first: x lies on the lattice
             }
         return list;
       }()});
  holds(
      "CarPaint, Flakes, Mottle", [=](const auto& p, const auto& at) { return mixed(sized(p, 1.0f, 1.0f)(at)); },
      [&](Random& r) {
        return std::tuple{paint(r), near(r)};
      },
      {.rounding = 1e-4, .step = 1e-3});
  const auto look = [](const auto& p) {
    Surfel<float> at;
    at.normal = {0, 0, 1}, at.tangent = {1, 0, 0};
    const vec3<float> v(0.6f, 0, 0.8f), l(-0.55f, 0.1f, 0.83f);
    return lit(p, at, v, l);
  };
  holds("WindowGlass", look,
        [](Random& r) {
          auto g = inside<WindowGlass<double>>(r);
          g.specular_roughness = between(r, 0.15, 0.3);
          return std::tuple{g};
        },
        {.rounding = 1e-5, .scale = 1e-3});
  holds("Rubber", look, [](Random& r) { return std::tuple{inside<Rubber<double>>(r)}; },
        {.rounding = 1e-5, .scale = 1e-3});
}
