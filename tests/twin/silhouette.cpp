// tests/twin/silhouette.cpp -- the laws of burnish/twin/pose.h, silhouette.h and refine_pose.h by masks
// SPDX-License-Identifier: Apache-2.0
#include <burnish/twin/refine_pose.h>
#include <record.h>
#include <twin/toy_car.h>
#include <burnish_test.h>
using namespace burnish;
using toys::some_pose;

namespace {
double area(const Mask& m) {
  double sum = 0;
  for (int i = 0; i < m.width * m.height; ++i) sum += double(m.values[std::size_t(i)]);
  return sum;
}
constexpr auto by_pose = [](const auto& p, const vec3<float>& x) { return p.project(x); };
}  // namespace

TEST_CASE("Pose: its camera sees what it projects", "[twin][agreement]") {
  const Pose<float> p = some_pose(400, 300);
  const Camera c = p.camera();
  CHECK(dot(cross(c.right, c.down), c.forward) == Approx(1).epsilon(1e-5));
  for (const vec3<float> x : {vec3<float>(0, 0, 0), vec3<float>(2, 1, -0.5f), vec3<float>(-1.5f, 0.3f, 0.8f)}) {
    const vec3<float> a = p.project(x), b = c.project(x);
    CHECK(a.x == Approx(b.x).epsilon(1e-4));
    CHECK(a.y == Approx(b.y).epsilon(1e-4));
    CHECK(a.z == Approx(b.z).epsilon(1e-4));
  }
  Pose<float> front;
  front.elevation = 0, front.width = 100, front.height = 100;
  const vec3<float> right_side = front.project({0, 0.75f, 1}), top = front.project({0, 1.5f, 0});
  CHECK(right_side.x < 50);  // seen from ahead, the vehicle's right is the picture's left
  CHECK(top.y < 50);
}

TEST_CASE("Silhouette: its shares add up to the area that many rays find", "[twin][value]") {
  const Raycaster scene(toys::car());
  const MeshEdges edges(scene.mesh());
  double worst = 0;
  int poses = 0;
  for (int k = 0; k < 8; ++k) {
    Pose<float> p = some_pose(96, 72);
    p.azimuth += float(k) * 0.8f, p.elevation += 0.05f * float(k % 3);
    const Silhouette s(scene, edges, p.camera());
    const double many = area(scene.trace(p.resized(96 * 16, 72 * 16).camera(), 1).frame("coverage")) / 256;
    worst = std::max(worst, std::fabs(area(s.mask) / many - 1));
    CHECK(s.size() > 50);
    ++poses;
  }
  record::claim("Silhouette: area", "value", "256 rays a pixel", 5e-3, worst, poses);
}

namespace {
/// The derivative of the integral of weight(x, y) over the mesh's mask by the seven numbers of a pose, by sampling the
/// edges (Li et al. 2018, primary visibility): along each, where one side hits and the other does not, the weight times
/// the speed at which the edge moves sideways. Unbiased; `density` samples a pixel of length, stratified.
template <class W> std::array<double, 7> by_edge_sampling(const Raycaster& scene, const Pose<float>& pose, W weight,
                                                          double density) {
  const Mesh& m = scene.mesh();
  const Camera camera = pose.camera();
  auto lifted = lift<Dual<double, 7>>(pose);
  int k = 0;
  each([&](auto& x) { x = Dual<double, 7>(x.value, k++); }, lifted);
  std::array<double, 7> sum{};
  std::mt19937 random(17);
  const auto front = [&](int t) {
    return dot(m.cross_of(t), camera.position - m.positions[std::size_t(m.triangles[std::size_t(t)][0])]) > 0;
  };
  for (const MeshEdges::Edge& e : MeshEdges(m).edges) {
    if (e.face[1] >= 0 && front(e.face[0]) == front(e.face[1])) continue;
    const auto a = lifted.project(m.positions[std::size_t(e.a)]), b = lifted.project(m.positions[std::size_t(e.b)]);
    const double dx = b.x.value - a.x.value, dy = b.y.value - a.y.value, length = std::hypot(dx, dy);
    const int n = int(length * density) + (double(random()) / 4294967296.0 < std::fmod(length * density, 1.0));
    for (int i = 0; i < n; ++i) {
      const double t = (i + double(random()) / 4294967296.0) / n, x = a.x.value + t * dx, y = a.y.value + t * dy;
      std::array<vec3<float>, 2> from{camera.position, camera.position}, to;
      for (const int side : {0, 1}) {
        const double s = side ? 1e-3 : -1e-3;
        to[std::size_t(side)] = camera.ray(float(x - s * dy / length), float(y + s * dx / length)).direction;
      }
      std::array<std::uint8_t, 2> hit{};
      scene.occluded(from, to, hit);
      if (hit[0] == hit[1]) continue;
      const double out = hit[0] ? 1 : -1;  // +1: outwards is along (-dy, dx)
      for (std::size_t j = 0; j < 7; ++j) {
        const double vx = (1 - t) * a.x.slope[j] + t * b.x.slope[j], vy = (1 - t) * a.y.slope[j] + t * b.y.slope[j];
        sum[j] += out * weight(x, y) * (vy * dx - vx * dy) / length * (1 / density);
      }
    }
  }
  return sum;
}
}  // namespace

TEST_CASE("Silhouette: its slopes are those that sampled edges have", "[twin][gradient]") {
  const Raycaster scene(toys::car(24));
  const MeshEdges edges(scene.mesh());
  double worst = 0, area_worst = 0;
  const int poses = 6;
  for (int k = 0; k < poses; ++k) {
    Pose<float> p = some_pose(160, 120);
    p.azimuth += 1.1f * float(k);
    // Where pixels weigh unequally, but smoothly: all seven numbers matter.
    const auto weigh = [](double x, double y) { return 1 + std::sin(0.045 * x + 0.4) * std::cos(0.06 * y - 0.2); };
    Mask weight(160, 120);
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < 160; ++x) weight.at(x, y) = float(weigh(x + 0.5, y + 0.5));
    const Silhouette s(scene, edges, p.camera());
    const Pose<float> d = s.backward(weight, p, by_pose), d_area = s.backward(Mask(160, 120, 1), p, by_pose);
    const auto reference = by_edge_sampling(scene, p, weigh, 200);
    // In steps that move the outline about equally far.
    const double steps[7] = {0.01, 0.01, 0.01, 0.06, 0.003, 0.003, 0.01};
    double off = 0, all = 0;
    std::size_t i = 0;
    each(
        [&](const float& x) {
          off += std::pow((double(x) - reference[i]) * steps[i], 2), all += std::pow(reference[i] * steps[i], 2), ++i;
        },
        d);
    worst = std::max(worst, std::sqrt(off / all));
    area_worst = std::max(area_worst, std::fabs(double(d_area.focal) * double(p.focal) / (2 * area(s.mask)) - 1));
  }
  record::claim("Silhouette: slopes by pose", "gradient", "edge sampling (Li et al. 2018), 200 a pixel", 0.02, worst,
                poses);
  record::claim("Silhouette: area grows by the square of the focal length", "gradient", "2 area / focal", 0.03,
                area_worst, poses);
}

TEST_CASE("refine_pose: from a pose that is off, back to the one that the mask was seen from", "[twin][value]") {
  const Raycaster scene(toys::car());
  const MeshEdges edges(scene.mesh());
  std::vector<double> degrees, distance;
  for (int k = 0; k < 8; ++k) {
    Pose<float> truth = some_pose(192, 144), start = truth;
    truth.azimuth += 0.75f * float(k);
    start = truth;
    start.azimuth += k % 2 ? 0.15f : -0.15f, start.elevation += 0.06f, start.roll -= 0.04f, start.distance *= 1.1f;
    start.right += 0.02f, start.down -= 0.02f;
    const Mask target = scene.trace(truth.camera(), 4).frame("coverage");
    const MatchedPose found = refine_pose(scene, edges, target, start, false);
    degrees.push_back(std::fabs(double(found.pose.azimuth - truth.azimuth)) * 180 / 3.14159265);
    distance.push_back(std::fabs(double(found.pose.distance / truth.distance - 1)));
    CHECK(found.iou > 0.97);
  }
  std::sort(degrees.begin(), degrees.end()), std::sort(distance.begin(), distance.end());
  record::claim("refine_pose: azimuth, degrees, median", "value", "the pose that the mask was made with", 0.2,
                degrees[4], 8);
  record::claim("refine_pose: distance, part, median", "value", "the pose that the mask was made with", 0.002,
                distance[4], 8);
}
