// tests/twin/retrieve.cpp -- the laws of burnish/twin/describe.h, search.h and retrieve.h
// SPDX-License-Identifier: Apache-2.0
#include <random>
#include <burnish/twin/retrieve.h>
#include <record.h>
#include <scene/shapes.h>
#include <burnish_test.h>
using namespace burnish;

namespace {
/// Vehicles of boxes and spheres: length, height of body and cabin, where the cabin begins and ends (shares of the
/// length from the rear), how far apart the wheels are.
Mesh box_car(float length, float body, float cabin, float from, float to, float wheels) {
  Mesh m;
  const float l = 0.5f * length;
  shapes::add_box(m, "body", {-l, 0.3f, -0.85f}, {l, 0.3f + body, 0.85f});
  const float top = 0.3f + body + cabin, rear = -l + from * length, front = -l + to * length;
  shapes::add_box(m, "cabin", {rear, 0.3f + body, -0.8f}, {front, top, 0.8f});
  shapes::add_box(m, "glass", {rear + 0.15f, 0.4f + body, -0.82f}, {front - 0.15f, top - 0.1f, 0.82f});
  for (const float x : {-0.5f * wheels, 0.5f * wheels})
    for (const float z : {-0.8f, 0.8f}) {
      const Mesh wheel = shapes::sphere({x, 0.33f, z}, 0.33f, 8);
      const int first = int(m.positions.size());
      for (std::size_t v = 0; v < wheel.positions.size(); ++v)
        m.add(wheel.positions[v], wheel.normals[v], wheel.uvs[v]);
      for (const auto& t : wheel.triangles)
        m.triangles.push_back({t[0] + first, t[1] + first, t[2] + first}), m.part.push_back(int(m.parts.size()));
      m.parts.push_back({.name = "wheel", .material = "rubber", .material_index = 3});
    }
  for (std::size_t p = 0; p < 3; ++p) m.parts[p].material_index = int(p);
  return m;
}
/// A saloon, an estate, a pickup, a van, a lorry, a small car.
const std::vector<Raycaster>& cars() {
  static const std::vector<Raycaster> all = [] {
    std::vector<Raycaster> list;
    list.emplace_back(box_car(4.6f, 0.6f, 0.5f, 0.2f, 0.7f, 2.7f));
    list.emplace_back(box_car(4.6f, 0.6f, 0.5f, 0.0f, 0.7f, 2.7f));
    list.emplace_back(box_car(5.2f, 0.7f, 0.6f, 0.4f, 0.75f, 3.2f));
    list.emplace_back(box_car(5.0f, 0.8f, 1.1f, 0.0f, 0.9f, 3.1f));
    list.emplace_back(box_car(7.5f, 1.0f, 1.3f, 0.75f, 1.0f, 4.5f));
    list.emplace_back(box_car(3.2f, 0.7f, 0.7f, 0.05f, 0.75f, 2.1f));
    return list;
  }();
  return all;
}
ViewOptions few_views() {
  ViewOptions o;
  o.azimuths = 24, o.elevations = {0.05f, 0.25f}, o.pixels = 96;
  return o;
}
struct Index {
  std::vector<float> rows;
  std::vector<int> first{0};
};
const Index& index() {
  static const Index all = [] {
    Index i;
    for (const Raycaster& car : cars()) {
      const DescribedViews v = describe_views(car, few_views());
      i.rows.insert(i.rows.end(), v.rows.begin(), v.rows.end());
      i.first.push_back(i.first.back() + v.size());
    }
    return i;
  }();
  return all;
}
struct Shot {
  Mask mask;
  Image photo;
};
/// A photo of a car: every part one colour under a light from one side, before a background.
Shot shot(const Raycaster& car, float azimuth, float elevation, int width, unsigned seed, float right = 0) {
  Pose<float> p;
  p.azimuth = azimuth, p.elevation = elevation, p.center = bounds(car.mesh()).center(), p.distance = 14, p.focal = 1.5f;
  p.width = width, p.height = width * 3 / 4, p.right = right;
  const GBuffer g = car.trace(p.camera(), 4);
  std::mt19937 random(seed);
  const auto draw = [&](float low, float high) { return low + (high - low) * float(random()) / 4294967296.0f; };
  std::vector<vec3<float>> colors;
  for (std::size_t i = 0; i < g.parts.size(); ++i)
    colors.emplace_back(draw(0.02f, 0.8f), draw(0.02f, 0.8f), draw(0.02f, 0.8f));
  const vec3<float> sun = normalize(vec3<float>(draw(-1, 1), draw(0.3f, 1), draw(-1, 1)));
  Shot s{Mask(g.width, g.height), Image(g.width, g.height, {draw(0, 1), draw(0, 1), draw(0, 1)})};
  for (int i = 0; i < g.size(); ++i) {
    const std::size_t k = std::size_t(i);
    const int x = g.pixel[k] % g.width, y = g.pixel[k] / g.width;
    s.mask.at(x, y) = g.plane[GBuffer::coverage][k];
    s.photo.set(x, y, colors[std::size_t(g.part[k])] * (0.3f + 0.7f * std::max(0.0f, dot(g.geometric_normal(i), sun))));
  }
  return s;
}
double cosine(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += double(a[i]) * double(b[i]);
  return sum;
}
}  // namespace

TEST_CASE("describe: a unit vector, and an error without a vehicle", "[twin][value]") {
  const Shot s = shot(cars()[0], 0.7f, 0.1f, 160, 1);
  const std::vector<float> v = describe(s.mask, s.photo);
  REQUIRE(int(v.size()) == view_numbers);
  CHECK(view_numbers <= 1280);
  CHECK(cosine(v, v) == Approx(1).epsilon(1e-5));
  CHECK_THROWS_AS(describe(Mask(160, 120), s.photo), Error);
  CHECK_THROWS_AS(describe(Mask(16, 12, 1), s.photo), Error);
  const DescribedViews views = describe_views(cars()[0], few_views());
  REQUIRE(views.size() == 48);
  for (int i = 0; i < views.size(); ++i) {
    const std::vector<float> row(views.row(i).begin(), views.row(i).end());
    CHECK(cosine(row, row) == Approx(1).epsilon(1e-5));
  }
}

TEST_CASE("describe: size and place of the vehicle do not count", "[twin][symmetry]") {
  double apart = 0;
  int n = 0;
  for (int car = 0; car < 6; ++car) {
    const float azimuth = 0.4f + 0.9f * float(car);
    const Shot a = shot(cars()[std::size_t(car)], azimuth, 0.12f, 320, 5);
    const std::vector<float> at = describe(a.mask, a.photo);
    // Half and twice as many pixels; cut out with the same pixels elsewhere.
    for (const int width : {160, 640}) {
      const Shot b = shot(cars()[std::size_t(car)], azimuth, 0.12f, width, 5);
      apart = std::max(apart, 1 - cosine(at, describe(b.mask, b.photo))), ++n;
    }
    const Mask moved = cropped(a.mask, -40, -25, 500, 330);
    CHECK(cosine(at, describe(moved, cropped(a.photo, -40, -25, 500, 330))) == Approx(1).epsilon(1e-4));
  }
  record::claim("describe: the same at half and twice the size", "law", "1 - cosine", 0.05, apart, n);
}

TEST_CASE("retrieve: from between the views it knows, in another light, the same vehicle", "[twin][value]") {
  int wrong = 0, far = 0, n = 0;
  const ViewOptions o = few_views();
  for (int car = 0; car < 6; ++car)
    for (int k = 0; k < 4; ++k) {  // sides: from ahead and behind boxes look too much alike
      const float azimuth = (float(12 * (k % 2) + 4 + (car + k) % 4) + 0.5f) * 2 * pi / float(o.azimuths);
      const Shot s = shot(cars()[std::size_t(car)], azimuth, 0.15f, 240, unsigned(10 * car + k));
      const auto found = retrieve(index().rows, index().first, s.mask, s.photo, 3);
      REQUIRE(found.size() == 3);
      CHECK(found[0].cosine >= found[1].cosine);
      wrong += found[0].model != car;
      const int view = (found[0].row - index().first[std::size_t(found[0].model)]) % o.azimuths;
      const float off = std::remainder(2 * pi * float(view) / float(o.azimuths) - azimuth, 2 * pi);
      far += std::abs(off) > 0.3f;
      ++n;
    }
  record::claim("retrieve: vehicles mistaken, views not in the index, other light", "value", "which vehicle was drawn",
                0.06, double(wrong) / n, n);
  record::claim("retrieve: views more than 17 degrees off", "value", "the azimuth that was drawn", 0.06,
                double(far) / n, n);
}

TEST_CASE("retrieve: with a fifth hidden it still finds the vehicle", "[twin][value]") {
  int wrong = 0, plain = 0, n = 0;
  for (int car = 0; car < 6; ++car)
    for (int k = 0; k < 4; ++k) {
      Shot s = shot(cars()[std::size_t(car)], (k % 2 ? 1.2f : 4.3f) + 0.15f * float(car), 0.15f, 240, unsigned(car));
      double area = 0;
      for (int i = 0; i < s.mask.width * s.mask.height; ++i) area += double(s.mask.values[std::size_t(i)]);
      // From the left, the right, below, above: a strip grows over the picture until a fifth is gone.
      const auto line = [&](int i, int j) -> std::pair<int, int> {
        return k == 0 ? std::pair(i, j) : k == 1 ? std::pair(s.mask.width - 1 - i, j)
               : k == 2                 ? std::pair(j, s.mask.height - 1 - i)
                                        : std::pair(j, i);
      };
      const int lines = k < 2 ? s.mask.width : s.mask.height, across = k < 2 ? s.mask.height : s.mask.width;
      double gone = 0;
      for (int i = 0; i < lines && gone < 0.2 * area; ++i)
        for (int j = 0; j < across; ++j) {
          const auto [x, y] = line(i, j);
          gone += double(s.mask.at(x, y)), s.mask.at(x, y) = 0, s.photo.set(x, y, {0.3f, 0.2f, 0.1f});
        }
      wrong += retrieve(index().rows, index().first, s.mask, s.photo, 1)[0].model != car;
      plain += nearest_models(index().rows, view_numbers, index().first, describe(s.mask, s.photo), 1)[0].model != car;
      ++n;
    }
  CHECK(plain >= wrong);
  record::claim("retrieve: vehicles mistaken, a fifth hidden at one side", "value", "which vehicle was drawn", 0.13,
                double(wrong) / n, n);
}

TEST_CASE("nearest: what brute force in double finds, on any number of threads", "[twin][agreement]") {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  double worst = 0;
  for (const int columns : {1, 7, 64, 100, 1200}) {
    const int count = 700;
    std::vector<float> rows(std::size_t(count * columns)), queries(std::size_t(3 * columns));
    for (float& v : rows) v = normal(random);
    for (float& v : queries) v = normal(random);
    normalise_rows(rows, columns), normalise_rows(queries, columns);
    std::vector<std::pair<double, int>> reference;
    for (int i = 0; i < count; ++i) {
      double best = -2;
      for (int q = 0; q < 3; ++q) {
        double sum = 0;
        for (int k = 0; k < columns; ++k)
          sum += double(rows[std::size_t(i * columns + k)]) * double(queries[std::size_t(q * columns + k)]);
        best = std::max(best, sum);
      }
      reference.emplace_back(-best, i);
    }
    const std::vector<float> all = cosines(rows, columns, queries);
    for (int i = 0; i < count; ++i)
      worst = std::max(worst, std::fabs(double(all[std::size_t(i)]) + reference[std::size_t(i)].first));
    std::sort(reference.begin(), reference.end());
    const std::vector<Nearest> found = nearest(rows, columns, queries, 10);
    REQUIRE(found.size() == 10);
    for (std::size_t i = 0; i < 10; ++i) {
      CHECK(double(found[i].cosine) == Approx(-reference[i].first).epsilon(1e-5));
      if (columns >= 64) CHECK(found[i].row == reference[i].second);
    }
    const int before = threads();
    for (const int t : {1, 3}) {
      set_threads(t);
      const std::vector<float> again = cosines(rows, columns, queries);
      CHECK(std::equal(all.begin(), all.end(), again.begin()));
    }
    set_threads(before);
  }
  record::claim("cosines", "value", "sums in double", 1e-5, worst, 3500);
  CHECK_THROWS_AS(nearest(std::vector<float>(10), 3, std::vector<float>(3), 1), Error);
  CHECK(nearest(std::vector<float>(9), 3, std::vector<float>(3), 100).size() == 3);
}

TEST_CASE("known_cosines: numbers that are not known count on neither side", "[twin][agreement]") {
  std::mt19937 random(4);
  std::normal_distribution<float> normal;
  const int columns = 90, count = 50;
  std::vector<float> rows(std::size_t(count * columns)), query(columns), known(columns);
  for (float& v : rows) v = normal(random);
  for (float& v : query) v = normal(random);
  for (float& v : known) v = float(random() % 3) * 0.5f;
  std::vector<int> chosen{3, 17, 49, 0};
  const auto found = known_cosines(rows, columns, chosen, query, known);
  double worst = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    double qr = 0, qq = 0, rr = 0;
    for (std::size_t k = 0; k < std::size_t(columns); ++k) {
      const double q = double(query[k]), r = double(rows[std::size_t(chosen[i] * columns) + k]), w = double(known[k]);
      qr += w * q * r, qq += w * q * q, rr += w * r * r;
    }
    worst = std::max(worst, std::fabs(double(found[i].cosine) - qr / std::sqrt(qq * rr)));
  }
  record::claim("known_cosines", "value", "sums in double", 1e-5, worst, long(chosen.size()));
  // A copy of a row with nonsense where nothing is known is that row.
  std::vector<float> copy(rows.begin() + 17 * columns, rows.begin() + 18 * columns);
  for (std::size_t k = 0; k < copy.size(); ++k)
    if (known[k] == 0) copy[k] = 100;
  CHECK(double(known_cosines(rows, columns, chosen, copy, known)[1].cosine) == Approx(1).epsilon(1e-5));
}

TEST_CASE("retrieve: the same on one thread as on three", "[twin][agreement]") {
  const Shot s = shot(cars()[2], 0.8f, 0.15f, 200, 9);
  const int before = threads();
  std::vector<NearestModel> first;
  for (const int t : {1, 3}) {
    set_threads(t);
    const DescribedViews views = describe_views(cars()[2], few_views());
    const std::size_t from = std::size_t(index().first[2]) * view_numbers;
    CHECK(std::equal(views.rows.begin(), views.rows.end(), index().rows.begin() + std::ptrdiff_t(from)));
    const auto found = retrieve(index().rows, index().first, s.mask, s.photo, 6);
    if (first.empty()) first = found;
    REQUIRE(found.size() == first.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      CHECK(found[i].model == first[i].model);
      CHECK(found[i].row == first[i].row);
      CHECK(found[i].cosine == first[i].cosine);
    }
  }
  set_threads(before);
}
