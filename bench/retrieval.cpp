// bench/retrieval.cpp -- how often a vehicle is found again: seen from elsewhere, painted and lit otherwise, hidden by
// a fifth
// SPDX-License-Identifier: Apache-2.0
//
// bench_retrieval LIST [queries a vehicle] [seed] [PHOTOS]. LIST: a text file, one vehicle a line: its path as
// io/mesh.h reads it, a tab, its body type. PHOTOS: one photo a line: its path, a tab, its mask, a tab, the body type.
#include <unistd.h>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <map>
#include <random>
#include <burnish/io/mesh.h>
#include <burnish/io/photo.h>
#include <burnish/scene/raycast.h>
#include <burnish/twin/retrieve.h>

using namespace burnish;

namespace {
struct Vehicle {
  std::string path, name, body;
};
double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct Random {
  std::mt19937 engine;
  explicit Random(unsigned seed) : engine(seed) {}
  float operator()(float low, float high) { return low + (high - low) * float(engine()) / 4294967296.0f; }
};

struct Query {
  Image photo;
  Mask mask, whole;
  bool cut = false;  // whether what hides it reaches over the mask's box
};

/// A picture of the vehicle: paint, glass and rubber by the parts' names in seven of ten, else one paint all
/// over; a sun and a sky with a horizon, shadows; hidden by a bar or a block that covers a fifth of it.
Query picture(const Raycaster& scene, Random& random) {
  const Box box = bounds(scene.mesh());
  Pose<float> pose;
  pose.azimuth = random(-pi, pi), pose.elevation = random(0.0f, 0.4f), pose.roll = random(-0.05f, 0.05f);
  pose.center = box.center();
  pose.distance = random(1.3f, 4.0f) * length(box.size());
  pose.width = 480, pose.height = 360;
  // As large as 0.35 to 0.9 of the picture's width.
  pose.focal = 1;
  float x0 = 1e9f, y0 = 1e9f, x1 = -1e9f, y1 = -1e9f;
  for (int k = 0; k < 8; ++k) {
    const vec3<float> p = pose.project(
        {k & 1 ? box.low.x : box.high.x, k & 2 ? box.low.y : box.high.y, k & 4 ? box.low.z : box.high.z});
    x0 = std::min(x0, p.x), x1 = std::max(x1, p.x), y0 = std::min(y0, p.y), y1 = std::max(y1, p.y);
  }
  pose.focal = random(0.35f, 0.9f) * 480 / std::max(x1 - x0, (y1 - y0) * 4 / 3);
  pose.right = random(-0.05f, 0.05f) / pose.focal, pose.down = random(-0.05f, 0.05f) / pose.focal;
  const GBuffer g = scene.trace(pose.camera(), 4);
  // Materials.
  const bool by_parts = random(0, 1) < 0.7f;
  const auto color = [&] { return vec3<float>(random(0.02f, 0.8f), random(0.02f, 0.8f), random(0.02f, 0.8f)); };
  const vec3<float> paint = random(0, 1) < 0.5f ? vec3<float>(random(0.02f, 0.8f)) : color();
  std::vector<vec3<float>> diffuse;
  std::vector<float> gloss;
  for (const Part& p : g.parts) {
    const std::string s = detail::words_of(p);
    const auto has = [&](std::initializer_list<const char*> words) {
      return std::any_of(words.begin(), words.end(), [&](const char* w) { return s.find(w) != s.npos; });
    };
    diffuse.push_back(paint), gloss.push_back(0.04f);
    if (!by_parts) continue;
    if (has({"glass", "window", "windsh", "glas_", "vitre"}) || p.opacity < 0.9f)
      diffuse.back() = vec3<float>(0.01f), gloss.back() = 0.08f;
    else if (has({"tire", "tyre", "rubber", "wheel", "pneu"}))
      diffuse.back() = vec3<float>(0.03f), gloss.back() = 0.01f;
    else if (has({"light", "lamp", "chrome", "rim", "optic"})) diffuse.back() = vec3<float>(0.4f), gloss.back() = 0.3f;
    else if (has({"black", "plastic", "interior", "seat"})) diffuse.back() = vec3<float>(0.04f);
  }
  // Light.
  const float sun_azimuth = random(-pi, pi), sun_height = random(0.25f, 1.3f),
              sun = random(0, 1) < 0.3f ? 0 : random(0.5f, 2.0f);
  const vec3<float> to_sun(std::cos(sun_height) * std::cos(sun_azimuth), std::sin(sun_height),
                           std::cos(sun_height) * std::sin(sun_azimuth));
  const vec3<float> sky(random(0.3f, 0.6f), random(0.4f, 0.7f), random(0.5f, 1.0f)), ground(random(0.05f, 0.3f));
  const float skyline = random(0.02f, 0.3f), phase = random(0, 6.28f);
  const std::array<vec3<float>, 1> suns{to_sun};
  const std::vector<std::uint8_t> lit = scene.visible(g, suns);
  const auto environment = [&](const vec3<float>& d) {
    const float houses = skyline * (0.6f + 0.4f * std::sin(5 * std::atan2(d.z, d.x) + phase));
    if (d.y < 0) return ground;
    if (d.y < houses) return ground * 0.5f;
    return sky * (0.6f + 0.8f * (1 - d.y));
  };
  Query q{Image(480, 360), Mask(480, 360), {}};
  Random noise(random.engine());
  const vec3<float> back = color();
  for (int y = 0; y < 360; ++y)
    for (int x = 0; x < 480; ++x)
      q.photo.set(x, y, back * (0.5f + 0.3f * std::sin(0.11f * float(x) + phase) * std::cos(0.07f * float(y))) +
                            vec3<float>(noise(0, 0.05f)));
  for (int i = 0; i < g.size(); ++i) {
    const std::size_t k = std::size_t(i);
    const Surfel<float> s = g.at(i);
    const float nv = std::max(dot(s.normal, s.view), 0.0f), nl = std::max(dot(s.normal, to_sun), 0.0f) * float(lit[k]);
    const vec3<float> mirror = s.normal * (2 * nv) - s.view, half = normalize(s.view + to_sun);
    const int part = g.part[k];
    const float f0 = gloss[std::size_t(part)], f = f0 + (1 - f0) * std::pow(1 - nv, 5.0f);
    const float highlight = float(lit[k]) * std::pow(std::max(dot(half, s.normal), 0.0f), 400.0f) * 30 * f;
    const vec3<float> around = sky * (0.5f + 0.5f * s.normal.y) + ground * (0.5f - 0.5f * s.normal.y);
    const vec3<float> out = diffuse[std::size_t(part)] * (around + vec3<float>(sun * nl)) +
                            environment(mirror) * f + vec3<float>(sun * highlight);
    const int x = g.pixel[k] % 480, y = g.pixel[k] / 480;
    const float c = g.plane[GBuffer::coverage][k];
    q.photo.set(x, y, out * c + q.photo.at(x, y) * (1 - c));
    q.mask.at(x, y) = c;
  }
  // What hides it: a bar or a block about a random place of the box, grown until it covers a fifth of the mask.
  double area = 0;
  for (int i = 0; i < 480 * 360; ++i) area += double(q.mask.values[std::size_t(i)]);
  const detail::Rectangle frame = detail::rectangle_of(q.mask);
  const int kind = int(random(0, 3));
  const float cx = random(frame.x0, frame.x1), cy = random(frame.y0, frame.y1);
  const vec3<float> hue = color();
  const float wide = kind == 1 ? 1e4f : 1, high = kind == 0 ? 1e4f : 0.7f;  // upright bar, lying bar, block
  float size = 2;
  q.whole = q.mask;
  const auto hidden = [&](int x, int y) {
    return std::abs(float(x) - cx) < size * wide && std::abs(float(y) - cy) < size * high;
  };
  for (; size < 400; size += 1) {
    double sum = 0;
    for (int y = 0; y < 360; ++y)
      for (int x = 0; x < 480; ++x)
        if (hidden(x, y)) sum += double(q.mask.at(x, y));
    if (sum >= 0.2 * area) break;
  }
  for (int y = 0; y < 360; ++y)
    for (int x = 0; x < 480; ++x)
      if (hidden(x, y)) q.mask.at(x, y) = 0, q.photo.set(x, y, hue);
  const detail::Rectangle left = detail::rectangle_of(q.mask);
  const float most = 0.02f * std::max(frame.x1 - frame.x0, frame.y1 - frame.y0) + 1;
  q.cut = std::max({left.x0 - frame.x0, frame.x1 - left.x1, left.y0 - frame.y0, frame.y1 - left.y1}) > most;
  // A camera's exposure: the vehicle's mean becomes 0.1 to 0.4.
  double mean = 0, shown = 1e-9;
  for (int y = 0; y < 360; ++y)
    for (int x = 0; x < 480; ++x)
      if (q.mask.at(x, y) > 0.5f) mean += double(q.photo.at(x, y).y), shown += 1;
  const float gain = random(0.1f, 0.4f) / float(mean / shown + 1e-4);
  for (float& v : q.photo.values) v = std::clamp(v * gain, 0.0f, 1.0f);
  return q;
}
}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "bench_retrieval LIST [queries a vehicle] [seed] [PHOTOS]\n");
    return 2;
  }
  const int queries = argc > 2 ? std::atoi(argv[2]) : 4;
  const unsigned seed = argc > 3 ? unsigned(std::atoi(argv[3])) : 77u;
  std::vector<Vehicle> vehicles;
  std::ifstream list(argv[1]);
  for (std::string line; std::getline(list, line);) {
    const std::size_t tab = line.find('\t');
    if (line.empty()) continue;
    const std::string path = line.substr(0, tab);
    const std::string name = path.substr(path.find_last_of("/:", path.find_last_of("/:") - 1) + 1);
    vehicles.push_back({path, name, tab == line.npos ? "" : line.substr(tab + 1)});
  }
  std::vector<float> rows, azimuth;
  std::vector<int> first{0};
  std::vector<Vehicle> indexed;
  std::vector<std::pair<int, Query>> asked;
  double reading = 0, viewing = 0, asking = 0;
  for (std::size_t i = 0; i < vehicles.size(); ++i) {
    try {
      const double t0 = seconds();
      const Raycaster scene(read_vehicle(vehicles[i].path));
      const double t1 = seconds();
      const DescribedViews views = describe_views(scene);
      const double t2 = seconds();
      reading += t1 - t0, viewing += t2 - t1;
      if (isatty(2)) std::fprintf(stderr, "\r%zu of %zu: %s\033[K", i + 1, vehicles.size(), vehicles[i].name.c_str());
      rows.insert(rows.end(), views.rows.begin(), views.rows.end());
      azimuth.insert(azimuth.end(), views.azimuth.begin(), views.azimuth.end());
      first.push_back(int(rows.size() / view_numbers));
      Random random(seed + unsigned(i));
      for (int k = 0; k < queries; ++k) asked.emplace_back(int(indexed.size()), picture(scene, random));
      indexed.push_back(vehicles[i]);
    } catch (const std::exception& e) {
      std::printf("left out: %s\n", e.what());
    }
  }
  const int n = int(indexed.size());
  std::printf("%d vehicles, %zu rows; read %.2f s, described %.2f s a vehicle\n", n,
               rows.size() / view_numbers, reading / n, viewing / n);
  struct Count {
    int all = 0, top1 = 0, top5 = 0;
  } kept, cut;
  std::map<std::string, int> confused;
  for (const auto& [truth, q] : asked) {
    const double t0 = seconds();
    const auto found = retrieve(rows, first, q.mask, q.photo, 5);
    asking += seconds() - t0;
    Count& count = q.cut ? cut : kept;
    ++count.all, count.top1 += found[0].model == truth;
    bool in = false;
    for (const NearestModel& m : found) in = in || m.model == truth;
    count.top5 += in;
    if (found[0].model != truth)
      ++confused[indexed[std::size_t(truth)].name + " -> " + indexed[std::size_t(found[0].model)].name +
                 (in ? "" : "  (not in 5)")];
  }
  const int all = int(asked.size());
  for (const auto& [pair, count] : confused) std::printf("%3d  %s\n", count, pair.c_str());
  const auto say = [](const char* what, const Count& c) {
    if (c.all > 0)
      std::printf("%-22s top-1 %d of %d (%.1f %%), top-5 %d (%.1f %%)\n", what, c.top1, c.all,
                  100.0 * c.top1 / c.all, c.top5, 100.0 * c.top5 / c.all);
  };
  say("hidden amid its box:", kept), say("its box cut:", cut);
  say("all:", {all, kept.top1 + cut.top1, kept.top5 + cut.top5});
  if (all > 0) std::printf("%.3f s a query\n", asking / all);

  int right = 0, photos = 0;
  std::ifstream shown(argc > 4 ? argv[4] : "");
  for (std::string line; std::getline(shown, line);) {
    const std::size_t tab = line.find('\t'), second = line.find('\t', tab + 1);
    if (second == line.npos) continue;
    const std::string path = line.substr(0, tab), body = line.substr(second + 1);
    const Image photo = read_photo(path);
    const Mask mask = read_mask(line.substr(tab + 1, second - tab - 1), photo.width, photo.height);
    const auto found = retrieve(rows, first, mask, photo, 5);
    bool in = false;
    std::printf("%s (%s):", path.substr(path.find_last_of('/') + 1).c_str(), body.c_str());
    for (std::size_t i = 0; i < found.size(); ++i) {
      const Vehicle& v = indexed[std::size_t(found[i].model)];
      if (i < 3) in = in || v.body == body;
      std::printf("  %s (%s, %.3f, %.0f degrees)", v.name.c_str(), v.body.c_str(), double(found[i].cosine),
                  double(57.2958f * azimuth[std::size_t(found[i].row)]));
    }
    std::printf("%s\n", in ? "" : "  NOT IN 3");
    right += in, ++photos;
  }
  if (photos > 0) std::printf("photos: body type right in the top 3: %d of %d\n", right, photos);
  return 0;
}
