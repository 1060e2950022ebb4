// tests/twin/match_pose.cpp -- the laws of burnish/twin/match_pose.h and of what it is made of
// SPDX-License-Identifier: Apache-2.0
#include <burnish/twin/match_pose.h>
#include <record.h>
#include <twin/toy_car.h>
#include <burnish_test.h>
using namespace burnish;

namespace {
/// The angle between two cameras' view axes, degrees.
double between(const Pose<float>& a, const Pose<float>& b) {
  return std::acos(std::min(1.0, double(dot(a.axes().forward, b.axes().forward)))) * 57.29577951308232;
}
MatchOptions by(const Pose<float>& truth) {
  MatchOptions options;
  options.focal = truth.focal, options.pixels = 128, options.azimuths = 16, options.elevations = {0.03f, 0.2f};
  return options;
}
Mask mask_of(const Raycaster& scene, const Pose<float>& pose) {
  return scene.trace(pose.camera(), 4).frame("coverage");
}
}  // namespace

TEST_CASE("Window: its camera sees what it projects, and the photo's pixels", "[twin][agreement]") {
  const Pose<float> p = toys::some_pose(400, 300);
  const Window w{37, 21, 250, 190, 125, 95};
  const Camera c = w.camera(p);
  for (const vec3<float> x : {vec3<float>(0, 0, 0), vec3<float>(2, 1, -0.5f), vec3<float>(-1.5f, 0.3f, 0.8f)}) {
    const vec3<float> a = w.project(p, x), b = c.project(x), whole = p.project(x);
    CHECK(a.x == Approx(b.x).epsilon(1e-4));
    CHECK(a.y == Approx(b.y).epsilon(1e-4));
    CHECK(a.x == Approx((whole.x - 37) / 2).epsilon(1e-4));
    CHECK(a.y == Approx((whole.y - 21) / 2).epsilon(1e-4));
  }
  Mask m(400, 300);
  for (int y = 100; y < 160; ++y)
    for (int x = 150; x < 250; ++x) m.at(x, y) = 1;
  const Window around = Window::around(m, 64, 0.1f);
  CHECK(around.x == 140);
  CHECK(around.y == 90);
  CHECK(around.w == 120);
  CHECK(around.h == 80);
  CHECK(around.width == 64);
  double sum = 0;
  const Mask small = around.of(m);
  for (int i = 0; i < small.width * small.height; ++i) sum += double(small.values[std::size_t(i)]);
  CHECK(sum * 120 / around.width * 80 / around.height == Approx(6000).epsilon(1e-3));
  CHECK_THROWS_AS(Window::around(Mask(64, 48), 64), Error);
}

TEST_CASE("StretchedCamera: it sees of the mesh what a camera sees of the stretched mesh", "[twin][agreement]") {
  StretchedPose<float> p{toys::some_pose(160, 120), 0.12f, -0.09f};
  const Raycaster plain(toys::car()), changed(stretched(toys::car(), p.factors()));
  const StretchedCamera camera{p.pose.camera(), p.factors()};
  const Silhouette a(plain, MeshEdges(plain.mesh()), camera), b(changed, MeshEdges(changed.mesh()), p.pose.camera());
  CHECK(mask_iou(a.mask, b.mask) > 0.999);
  CHECK(mask_iou(a.mask, Silhouette(plain, MeshEdges(plain.mesh()), p.pose.camera()).mask) < 0.97);
  const vec3<float> x(1.5f, 0.8f, -0.7f), q = p.project(x), r = p.pose.project(x * p.factors());
  CHECK(q.x == Approx(r.x).epsilon(1e-5));
  CHECK(q.y == Approx(r.y).epsilon(1e-5));
}

TEST_CASE("EdgeField: its slopes are those of differences", "[twin][gradient]") {
  const Raycaster scene(toys::car());
  const Tones tones(scene.mesh());
  double worst = 0;
  const int poses = 6;
  for (int k = 0; k < poses; ++k) {
    Pose<float> truth = toys::some_pose(240, 180);
    truth.azimuth += 1.1f * float(k);
    const Mask mask = mask_of(scene, truth);
    const Window window = Window::around(mask, 160);
    const EdgeField field(appearance_of(window.of(toys::photo_of(scene, truth)), window.of(mask), 2.5f), window);
    const auto points = edge_points(scene.trace(window.camera(truth), 1), tones);
    REQUIRE(points.size() > 100);
    StretchedPose<float> p{truth, 0.01f, -0.02f};
    p.pose.azimuth += 0.02f, p.pose.right += 0.002f;
    const EdgeField::Sum sum = field.at(points, p, true);
    CHECK(sum.loss > field.at(points, {truth}, false).loss);
    CHECK(sum.loss == Approx(field.at(points, p, false).loss).epsilon(1e-5));
    // In steps that move the picture about equally far: about 0.03 pixels.
    const double steps[EdgeField::n] = {2e-4, 4e-4, 4e-4, 2e-3, 1e-4, 1e-4, 2e-4, 2e-4, 4e-4};
    double off = 0, all = 0;
    for (std::size_t i = 0; i < EdgeField::n; ++i) {
      double value[2], moved[2];
      for (const std::size_t side : {0u, 1u}) {
        StretchedPose<float> q = p;
        std::size_t j = 0;
        each(
            [&](float& x) {
              if (j++ == i) x += float(side ? steps[i] : -steps[i]), moved[side] = double(x);
            },
            q);
        value[side] = field.at(points, q, false).loss;
      }
      const double difference = (value[1] - value[0]) / (moved[1] - moved[0]);
      off += std::pow((sum.slope[i] - difference) * steps[i], 2), all += std::pow(difference * steps[i], 2);
    }
    worst = std::max(worst, std::sqrt(off / all));
  }
  record::claim("EdgeField: slopes by stretched pose", "gradient", "central differences", 0.02, worst, poses);
}

TEST_CASE("Tones: names first, then wheels, then the file's colours", "[twin][value]") {
  Mesh m = toys::car(24);
  shapes::add_box(m, "window", {-1.5f, 1.0f, -0.76f}, {0.3f, 1.4f, 0.76f});
  shapes::add_box(m, "stripe", {-2.11f, 0.72f, -0.86f}, {2.11f, 0.82f, 0.86f});
  for (std::size_t t = 0; t < m.triangles.size(); ++t)  // balls become discs
    if (m.parts[std::size_t(m.part[t])].name == "wheel")
      for (const int v : m.triangles[t]) {
        float& z = m.positions[std::size_t(v)].z;
        z = std::clamp(z, z > 0 ? 0.7f : -0.9f, z > 0 ? 0.9f : -0.7f);
      }
  for (Part& p : m.parts)
    if (p.name == "wheel") p.name = p.material = "round";
  m.parts.back().base_color = {0.02f, 0.02f, 0.02f};
  const Raycaster scene(m);
  Pose<float> side = toys::some_pose(120, 90);
  side.azimuth = 1.5f;
  const GBuffer g = scene.trace(side.camera(), 1);
  const Tones tones(scene.mesh()), given(scene.mesh(), std::vector<float>(m.parts.size(), 0.3f));
  int seen[4] = {};
  for (int i = 0; i < g.size(); ++i) {
    const std::string& name = g.parts[std::size_t(g.part[std::size_t(i)])].name;
    const float t = tones.at(g, i);
    const bool right0 = name != "window" || (t == -0.8f);
    CHECK(right0);
    seen[0] += name == "window";
    const bool right1 = name != "stripe" || (t < -0.5f);
    CHECK(right1);
    seen[1] += name == "stripe";
    const bool right2 = name != "cabin" || (std::abs(t) < 0.01f);
    CHECK(right2);
    seen[2] += name == "cabin";
    const bool right3 = name != "round" || (t < -0.1f);
    CHECK(right3);
    seen[3] += name == "round";
    CHECK(given.at(g, i) == 0.3f);
  }
  for (const int n : seen) CHECK(n > 20);
}

TEST_CASE("match_pose: from the mask alone", "[twin][value]") {
  const Raycaster scene(toys::car());
  Pose<float> truth = toys::some_pose(240, 180);
  truth.azimuth = 2.3f, truth.center = bounds(scene.mesh()).center();
  const Mask target = scene.trace(truth.camera(), 4).frame("coverage");
  MatchOptions options;
  options.focal = truth.focal;
  const auto found = match_pose(scene, target, options);
  REQUIRE(found.size() == 1);
  CHECK(found[0].iou > 0.97);
  CHECK(std::cos(found[0].pose.azimuth - truth.azimuth) > std::cos(0.02f));
  CHECK(found[0].pose.distance == Approx(truth.distance).epsilon(0.01));
  CHECK(found[0].deviation.azimuth < 0.02f);
  CHECK(found[0].deviation.azimuth > 1e-4f);  // and is not taken for certain
  CHECK(found[0].deviation.elevation > 1e-4f);
  CHECK_THROWS_AS(match_pose(scene, Mask(64, 48)), Error);
}

TEST_CASE("match_pose: poses of the same model, seen whole and behind a bar", "[twin][value]") {
  const Raycaster scene(toys::car());
  for (const bool bar : {false, true}) {
    std::vector<double> degrees, distance;
    const int views = 5;
    for (int k = 0; k < views; ++k) {
      Pose<float> truth = toys::some_pose(240, 180);
      truth.azimuth = 0.5f + 1.3f * float(k), truth.elevation = 0.06f + 0.03f * float(k % 3);
      truth.center = bounds(scene.mesh()).center();
      Mask mask = mask_of(scene, truth);
      Image photo = toys::photo_of(scene, truth);
      if (bar) {  // a fifth of the vehicle's width
        const auto box = detail::box_of(mask);
        const float across = box[2] - box[0];
        const int wide = int(0.2f * across), from = int(box[0] + across * (0.2f + 0.1f * float(k)));
        for (int y = 0; y < 180; ++y)
          for (int x = from; x < from + wide; ++x) mask.at(x, y) = 0, photo.set(x, y, {0.2f, 0.2f, 0.2f});
      }
      const auto found = match_pose(scene, mask, photo, by(truth));
      degrees.push_back(between(found[0].pose, truth));
      distance.push_back(std::fabs(double(found[0].pose.distance / truth.distance - 1)));
    }
    std::sort(degrees.begin(), degrees.end()), std::sort(distance.begin(), distance.end());
    const std::string how = bar ? " behind a bar of a fifth" : "";
    record::claim("match_pose: view axis, degrees, median" + how, "value", "the pose that the photo was made with", 1,
                  degrees[2], views);
    record::claim("match_pose: distance, part, median" + how, "value", "the pose that the photo was made with", 0.01,
                  distance[2], views);
  }
}

TEST_CASE("match_pose: where the outline cannot tell front from rear it says so, and a photo can", "[twin][limit]") {
  const Raycaster scene(toys::two_way());
  for (const float azimuth : {0.8f, 0.8f + pi, -1.3f}) {
    Pose<float> truth = toys::some_pose(240, 180);
    truth.azimuth = azimuth, truth.center = bounds(scene.mesh()).center();
    const Mask mask = mask_of(scene, truth);
    const auto alone = match_pose(scene, mask, by(truth), 2);
    REQUIRE(alone.size() == 2);
    CHECK(!alone[0].sure());
    CHECK(std::abs(between(alone[0].pose, alone[1].pose)) > 120);
    const auto told = match_pose(scene, mask, toys::photo_of(scene, truth), by(truth), 2);
    INFO("belief " << told[0].belief << ", agreement " << told[0].agreement.edges << " " << told[1].agreement.edges);
    CHECK(told[0].sure());
    CHECK(between(told[0].pose, truth) < 2);
  }
}

TEST_CASE("match_pose: of a model with other proportions the heading is right", "[twin][value]") {
  const Raycaster real(toys::car()), model(stretched(toys::car(), {0.92f, 1.06f, 1}));
  Pose<float> truth = toys::some_pose(240, 180);
  truth.azimuth = 2.2f, truth.center = bounds(real.mesh()).center();
  const Mask mask = mask_of(real, truth);
  const Image photo = toys::photo_of(real, truth);
  MatchOptions options = by(truth);
  CHECK(between(match_pose(model, mask, photo, options)[0].pose, truth) < 3);
  options.keep_shape = false;
  const auto found = match_pose(model, mask, photo, options);
  CHECK(between(found[0].pose, truth) < 3);
  CHECK(found[0].iou > 0.95);
  CHECK(found[0].stretch.x > 1.03f);
  CHECK(found[0].stretch.y < 0.99f);
}

TEST_CASE("match_pose: the same on any number of threads", "[twin][symmetry]") {
  const Raycaster scene(toys::car());
  const Pose<float> truth = toys::some_pose(160, 120);
  const Mask mask = mask_of(scene, truth);
  const Image photo = toys::photo_of(scene, truth);
  const int before = threads();
  std::vector<PoseCandidate> found[2];
  for (const int k : {0, 1}) {
    set_threads(1 + 2 * k);
    found[k] = match_pose(scene, mask, photo, by(truth), 3);
  }
  set_threads(before);
  REQUIRE(found[0].size() == found[1].size());
  for (std::size_t i = 0; i < found[0].size(); ++i) {
    CHECK(found[0][i].pose.azimuth == found[1][i].pose.azimuth);
    CHECK(found[0][i].pose.distance == found[1][i].pose.distance);
    CHECK(found[0][i].score == found[1][i].score);
  }
}

TEST_CASE("match_models: the one that the photo shows comes first", "[twin][value]") {
  const Raycaster scenes[] = {Raycaster(toys::two_way()), Raycaster(toys::car())};
  for (const int shown : {0, 1}) {
    const Pose<float> truth = toys::some_pose(200, 150);
    const Mask mask = mask_of(scenes[shown], truth);
    int last = 0, all = 1;
    const auto found = match_models(
        2, [&](int k) -> const Raycaster& { return scenes[k]; }, mask, toys::photo_of(scenes[shown], truth), by(truth),
        1, [&](int done, int of) { last = done, all = of; });
    REQUIRE(found.size() == 2);
    CHECK(found[0].model == shown);
    CHECK(found[0].poses[0].score > found[1].poses[0].score + 3);
    CHECK(last == all);
  }
}
