// bench/specular.cpp -- the environment's specular light on real panoramas: error of value and slope, and what it costs
// SPDX-License-Identifier: Apache-2.0
//
//   bench_specular [panorama]... [--quick] [--markdown] [--figure FILE.svg]
//
// Without panoramas: those of Debian's blender-data. For 240 views (normals all over the sphere, cosines of the view
// .08 to 1, nothing in the way) and eight roughnesses a dielectric of F0 = .04 that mirrors only is seen as a user of
// the library sees it, illuminate() and its derivative, and compared with bench/specular_reference.h; so is the grid of
// bench/specular_grid.h, with the same quadrature of its own lobe, so that its error is the grid's and the clamps'
// alone. "with sun" is the panorama as it is; "without" is what EnvironmentLight leaves of it once its suns are taken.
//
//   rms      root of the mean squared relative error of the value, %
//   wrong    views whose slope by roughness has the wrong sign, %: all, and of those where |d ln V / dr| > .1
//   noise    the same between two independent sets of the reference's directions, the rms halved: what of the figures
//            above is the reference's own
#include <atomic>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <CLI/CLI.hpp>
#include <burnish/ad/differentiate.h>
#include <burnish/burnish.h>
#include <burnish/io/photo.h>
#include "../examples/progress.h"
#include "specular_figure.h"
#include "specular_grid.h"

using namespace burnish;
using specular_reference::Ggx, specular_reference::Pair, specular_reference::Panorama, specular_reference::Published,
    specular_reference::Quadrature, specular_reference::View;

namespace {

const std::vector<double> roughnesses{0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0};

struct Options {
  std::vector<std::string> panoramas;
  bool quick = false, markdown = false;
  std::string figure;
  int views() const { return quick ? 60 : 240; }
  int samples() const { return quick ? 1 << 12 : 1 << 14; }
};

/// Views as surfels.
struct Surfels {
  const std::vector<View>* views;
  struct At {
    vec3<float> normal, tangent, view;
    float index;
  };
  int size() const { return int(views->size()); }
  At at(int i) const {
    const View& w = (*views)[std::size_t(i)];
    return {vec3<float>(w.n), vec3<float>(w.x), vec3<float>(w.v), float(i)};
  }
};
/// What a user gets: luminance and its slope by roughness.
Pair seen(const LightOf<float>& light, const EnvironmentLight& e, const Surfels::At& at, double roughness) {
  const auto look = [&]<class T>(const T& r) {
    Surface<T> s;
    s.base_color = vec3<T>(T(0.0f));
    s.specular_roughness = r;
    const vec3<T> c = illuminate(s, at, LightOf<T>{&light}, List<Sun, T>{e.suns}, LightStrength<T>{});
    return c.x * 0.2126f + c.y * 0.7152f + c.z * 0.0722f;
  };
  const auto [value, slope] = differentiate(look, roughness);
  return {value, slope};
}

struct Score {
  double rms = 0, wrong = 0, wrong_steep = 0;  // %
  int steep = 0;
};
Score score(const std::vector<Pair>& found, const std::vector<Pair>& truth) {
  Score s;
  int wrong = 0, wrong_steep = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double off = found[i].value / truth[i].value - 1;
    s.rms += off * off / double(truth.size());
    const bool opposite = found[i].slope * truth[i].slope <= 0, steep = std::abs(truth[i].slope) > 0.1 * truth[i].value;
    wrong += opposite, wrong_steep += opposite && steep, s.steep += steep;
  }
  s.rms = 100 * std::sqrt(s.rms);
  s.wrong = 100.0 * wrong / double(truth.size());
  s.wrong_steep = s.steep ? 100.0 * wrong_steep / s.steep : 0;
  return s;
}

struct Result {
  std::string name;
  bool indoors = false, sun = false;
  int suns = 0;
  std::vector<Score> burnish, grid, noise;  // a roughness each
  std::vector<double> turned;               // rms of d ln V by a turn of the normal, % a degree
};

bool is_indoors(std::string name) {
  for (char& c : name) c = char(std::tolower(c));
  for (const char* word : {"interior", "indoor", "studio", "warehouse", "lebombo", "room", "hall", "hangar", "garage"})
    if (name.find(word) != std::string::npos) return true;
  return false;
}
/// f(view) for all views, the bar moving on.
template <class F> void over(int count, Progress& bar, std::atomic<int>& done, int all, const std::string& note, F f) {
  std::mutex drawing;
  parallel_for(count, [&](int i) {
    f(i);
    const int now = ++done;
    if (const std::unique_lock turn(drawing, std::try_to_lock); turn) bar.show(now, all, note);
  });
}

Result measure(const std::string& name, const Image& picture, const EnvironmentLight& whole, bool sun,
               const Options& options, Progress& bar, std::atomic<int>& done, int all) {
  Result result{name, is_indoors(name), sun, int(whole.suns.size()), {}, {}, {}, {}};
  EnvironmentLight e = whole;
  if (!sun) e.suns.clear();
  const int count = options.views();
  const std::vector<View> views = specular_reference::views(count);
  const Surfels surfels{&views};
  const LightOf<float> light(e, surfels);
  const Image& shown = sun ? picture : e.map;
  const Panorama truth(shown), coarse(detail::resampled_panorama(shown, 256));
  const Quadrature one(truth, options.samples(), 0), two(truth, options.samples(), 1),
      few(truth, options.samples() / 4, 0);
  const std::size_t n = roughnesses.size();
  std::vector<std::vector<Pair>> a(n, std::vector<Pair>(std::size_t(count))), b = a, ours = a, theirs = a,
                                                                              their_truth = a;
  std::vector<std::vector<double>> turn(n, std::vector<double>(std::size_t(count)));
  over(count, bar, done, all, name, [&](int i) {
    const std::size_t v = std::size_t(i);
    const specular_grid::Cells cells = specular_grid::means(coarse, views[v]);
    // Turns of the normal towards the side, the viewer staying where he is.
    const double angle = 0.01;
    const View left(views[v].n + views[v].y * angle, views[v].v), right(views[v].n - views[v].y * angle, views[v].v);
    for (std::size_t k = 0; k < n; ++k) {
      const double r = roughnesses[k];
      a[k][v] = one.integral<Ggx>(views[v], r), b[k][v] = two.integral<Ggx>(views[v], r);
      ours[k][v] = seen(light, e, surfels.at(i), r);
      theirs[k][v] = specular_grid::specular(cells, views[v], r);
      their_truth[k][v] = few.integral<Published>(views[v], r);
      turn[k][v] = (few.integral<Ggx>(left, r).value - few.integral<Ggx>(right, r).value) / (2 * angle) / a[k][v].value;
    }
  });
  for (std::size_t k = 0; k < n; ++k) {
    std::vector<Pair> mean = a[k];
    for (std::size_t i = 0; i < mean.size(); ++i)
      mean[i] = {(a[k][i].value + b[k][i].value) / 2, (a[k][i].slope + b[k][i].slope) / 2};
    result.burnish.push_back(score(ours[k], mean));
    result.grid.push_back(score(theirs[k], their_truth[k]));
    result.noise.push_back(score(a[k], b[k]));
    result.noise.back().rms /= 2;  // of the mean of two sets
    double sum = 0;
    for (const double t : turn[k]) sum += t * t / count;
    result.turned.push_back(100 * std::sqrt(sum) * specular_reference::pi / 180);
  }
  return result;
}

// ---- tables ---------------------------------------------------------------------------------------------------------

using Cell = std::function<double(std::size_t)>;
std::string shortly(double x) {
  char text[16];
  std::snprintf(text, sizeof text, x < 10 ? "%.2f" : x < 1000 ? "%.0f" : "%.2g", x);
  return text;
}
void header(const std::string& title, bool markdown) {
  std::printf(markdown ? "\n| %s |" : "\n%-46s", title.c_str());
  for (const double r : roughnesses) std::printf(markdown ? " %.2g |" : " %7.2g", r);
  if (markdown) {
    std::printf("\n|---|");
    for (std::size_t k = 0; k < roughnesses.size(); ++k) std::printf("---:|");
  }
  std::printf("\n");
}
void row(std::string title, bool markdown, const Cell& cell) {
  for (std::size_t at = 0; markdown && (at = title.find('|', at)) != std::string::npos; at += 2) title.insert(at, "\\");
  std::printf(markdown ? "| %s |" : "  %-44s", title.c_str());
  for (std::size_t k = 0; k < roughnesses.size(); ++k)
    std::printf(markdown ? " %s |" : " %7s", shortly(cell(k)).c_str());
  std::printf("\n");
}
void print(const Result& r, bool markdown) {
  header(r.name + ", " + (r.indoors ? "indoors" : "outdoors") + ", " +
             (r.suns == 0 ? "no sun"
                          : (r.sun ? "with " : "without ") + std::to_string(r.suns) + (r.suns > 1 ? " suns" : " sun")) +
             ": %",
         markdown);
  row("burnish: rms", markdown, [&](std::size_t k) { return r.burnish[k].rms; });
  row("burnish: wrong sign, all", markdown, [&](std::size_t k) { return r.burnish[k].wrong; });
  row("burnish: wrong sign, |d ln V/dr| > .1", markdown, [&](std::size_t k) { return r.burnish[k].wrong_steep; });
  row("8 x 16 grid: rms", markdown, [&](std::size_t k) { return r.grid[k].rms; });
  row("8 x 16 grid: wrong sign, all", markdown, [&](std::size_t k) { return r.grid[k].wrong; });
  row("8 x 16 grid: wrong sign, |d ln V/dr| > .1", markdown, [&](std::size_t k) { return r.grid[k].wrong_steep; });
  row("reference's noise: rms", markdown, [&](std::size_t k) { return r.noise[k].rms; });
  row("reference's noise: wrong sign, all", markdown, [&](std::size_t k) { return r.noise[k].wrong; });
  row("reference's noise: wrong sign, |..| > .1", markdown, [&](std::size_t k) { return r.noise[k].wrong_steep; });
}
/// Middle (root of the mean square, or mean), least and most of a figure over the panoramas of a kind.
struct Range3 {
  double middle = 0, least = 1e300, most = 0;
  int count = 0;
};
template <class F> Range3 over_kind(const std::vector<Result>& all, bool indoors, F figure, bool squared) {
  Range3 x;
  for (const Result& r : all) {
    if (r.indoors != indoors) continue;
    const double f = figure(r);
    x.middle += squared ? f * f : f, x.least = std::min(x.least, f), x.most = std::max(x.most, f), ++x.count;
  }
  x.middle = x.count ? squared ? std::sqrt(x.middle / x.count) : x.middle / x.count : 0;
  return x;
}
void summary(const std::vector<Result>& all, bool markdown) {
  for (const bool most : {false, true}) {
    header(most ? "The worst panorama of each kind: %" : "All panoramas of a kind, with and without sun: %", markdown);
    for (const bool indoors : {false, true}) {
      if (over_kind(
              all, indoors, [](const Result&) { return 0.0; }, false)
              .count == 0)
        continue;
      const std::string where = indoors ? "indoors" : "outdoors";
      const auto line = [&](const char* what, bool squared, auto figure) {
        row(where + ", " + what, markdown, [&](std::size_t k) {
          const Range3 x = over_kind(
              all, indoors, [&](const Result& r) { return figure(r, k); }, squared);
          return most ? x.most : x.middle;
        });
      };
      line("burnish: rms", true, [](const Result& r, std::size_t k) { return r.burnish[k].rms; });
      line("burnish: wrong sign", false, [](const Result& r, std::size_t k) { return r.burnish[k].wrong; });
      line("burnish: wrong where > .1", false, [](const Result& r, std::size_t k) { return r.burnish[k].wrong_steep; });
      line("grid: rms", true, [](const Result& r, std::size_t k) { return r.grid[k].rms; });
      line("grid: wrong sign", false, [](const Result& r, std::size_t k) { return r.grid[k].wrong; });
      line("grid: wrong where > .1", false, [](const Result& r, std::size_t k) { return r.grid[k].wrong_steep; });
    }
  }
  header("By the normal: what the sky's part answers with 0", markdown);
  for (const bool indoors : {false, true}) {
    if (over_kind(
            all, indoors, [](const Result&) { return 0.0; }, false)
            .count == 0)
      continue;
    row(std::string(indoors ? "indoors" : "outdoors") + ": |d ln V|, rms, % a degree", markdown, [&](std::size_t k) {
      return over_kind(
                 all, indoors, [&](const Result& r) { return r.turned[k]; }, true)
          .middle;
    });
  }
}
/// Targets: rms below 2 % outdoors, 3.5 % anywhere; wrong signs where |d ln V/dr| > .1 below 1 %.
void judge(const std::vector<Result>& all) {
  double rms[2] = {}, wrong = 0;
  for (const Result& r : all) {
    for (std::size_t k = 0; k < roughnesses.size(); ++k) {
      rms[r.indoors] = std::max(rms[r.indoors], r.burnish[k].rms);
      wrong = std::max(wrong, r.burnish[k].wrong_steep);
    }
  }
  const auto say = [](const char* what, double most, double x) {
    std::printf("  %-44s at most %.1f %%: %s (%.2f)\n", what, most, x < most ? "met" : "MISSED", x);
  };
  std::printf("\nworst panorama, worst roughness\n");
  say("rms outdoors", 2, rms[0]), say("rms indoors", 3.5, rms[1]), say("wrong sign where |d ln V/dr| > .1", 1, wrong);
}
void draw(const std::string& path, const std::vector<Result>& all) {
  specular_figure::Panel error{"Error of the value, rms", true, 0.03, 1000, 0, {0.1, 1, 10, 100, 1000}, {}};
  specular_figure::Panel sign{"Slope by roughness with the wrong sign", false, 0, 100, 0, {0, 20, 40, 60, 80, 100}, {}};
  for (const bool grid : {false, true}) {
    for (const bool indoors : {false, true}) {
      specular_figure::Curve rms{std::string(grid ? "8 x 16 grid" : "burnish") + (indoors ? ", indoors" : ", outdoors"),
                                 grid ? "#d1495b" : "#1b6ca8",
                                 {},
                                 {},
                                 {},
                                 indoors};
      specular_figure::Curve wrong = rms;
      for (std::size_t k = 0; k < roughnesses.size(); ++k) {
        const auto add = [&](specular_figure::Curve& to, const Range3& x) {
          to.middle.push_back(x.middle), to.least.push_back(x.least), to.most.push_back(x.most);
        };
        add(rms, over_kind(
                     all, indoors, [&](const Result& r) { return (grid ? r.grid : r.burnish)[k].rms; }, true));
        add(wrong, over_kind(
                       all, indoors, [&](const Result& r) { return (grid ? r.grid : r.burnish)[k].wrong; }, false));
        if (over_kind(
                all, indoors, [](const Result&) { return 0.0; }, false)
                .count == 0)
          rms.middle.clear();
      }
      if (rms.middle.empty()) continue;
      error.curves.push_back(rms), sign.curves.push_back(wrong);
    }
  }
  specular_figure::write(path, "GGX under real panoramas, against a converged quadrature",
                         roughnesses, {error, sign});
}

// ---- costs ----------------------------------------------------------------------------------------------------------

double processor_seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }
/// The least of three runs, in processor time of one thread.
template <class F> double seconds(F f) {
  double best = 1e300;
  for (int k = 0; k < 3; ++k) {
    const double start = processor_seconds();
    f();
    best = std::min(best, processor_seconds() - start);
  }
  return best;
}
void costs(const std::string& name, const EnvironmentLight& e, bool markdown) {
  const int before = threads(), side = 80, count = side * side;
  std::vector<View> views;  // pixels of a ball seen from afar: neighbours look into neighbouring directions
  for (int i = 0; i < count; ++i) {
    const double x = 1.36 * ((i % side + 0.5) / side - 0.5), y = 1.36 * ((i / side + 0.5) / side - 0.5);
    views.emplace_back(vec3<double>(x, -y, std::sqrt(1 - x * x - y * y)), vec3<double>(0, 0, 1));
  }
  const std::vector<View> one(views.begin(), views.begin() + 1);
  set_threads(1);
  std::unique_ptr<Illumination> light;
  const double prepared = seconds([&] { light = std::make_unique<Illumination>(e, Surfels{&one}); });
  const double gathered = seconds([&] { light = std::make_unique<Illumination>(e, Surfels{&views}); }) - prepared;
  using P = Packet<float, 16>;
  float checksum = 0;
  const auto resolve = [&](bool slope) {
    constexpr int rounds = 50;
    return seconds([&] {
             for (int k = 0; k < rounds; ++k) {
               for (int i = 0; i < count; i += 16) {
                 P x[2], y[12], d[12], back[2];
                 for (int j = 0; j < 16; ++j) x[0].v[j] = float(i + j);
                 x[1] = P(0.02f + 0.0192f * float(k));
                 LightTable<12>::value(*light, x, y);
                 checksum += y[0][0];
                 if (!slope) continue;
                 for (int c = 0; c < 12; ++c) d[c] = y[c] * 2.0f;
                 LightTable<12>::back(*light, x, y, d, back, nullptr);
                 checksum += back[1][0];
               }
             }
           }) /
           (double(rounds) * count) * 1e9;
  };
  const double value = resolve(false), both = resolve(true);
  set_threads(before);
  std::printf(markdown ? "\n| Cost, one thread (%s) | |\n|---|---:|\n" : "\nCost, one thread (%s)   [checksum %.3g]\n",
              name.c_str(), double(checksum));
  const auto line = [&](const char* what, double x, const char* unit) {
    std::printf(markdown ? "| %s | %.3g %s |\n" : "  %-44s %8.3g %s\n", what, x, unit);
  };
  line("preparing the panorama, once", 1e3 * prepared, "ms");
  line("gathering a surfel, once", 1e6 * gathered / count, "us");
  line("a surfel's memory", double(light->bytes()) / count, "bytes");
  line("value of a pixel (12 numbers)", value, "ns");
  line("value and slope by roughness", both, "ns");
}

std::vector<std::string> installed() {
  std::vector<std::string> found;
  std::error_code failed;
  const std::filesystem::path root = "/usr/share/blender", tail = "datafiles/studiolights/world";
  std::vector<std::filesystem::path> folders{root / tail};
  for (const auto& version : std::filesystem::directory_iterator(root, failed))
    folders.push_back(version.path() / tail);
  for (const auto& folder : folders) {
    for (const auto& file : std::filesystem::directory_iterator(folder, failed))
      if (file.path().extension() == ".exr") found.push_back(file.path().string());
  }
  std::sort(found.begin(), found.end());
  return found;
}
int run(Options options) {
  if (!options.figure.empty() && std::filesystem::path(options.figure).extension() != ".svg")
    throw Error("--figure " + options.figure + ": expected a name that ends in .svg");
  if (options.panoramas.empty()) options.panoramas = installed();
  if (options.panoramas.empty())
    throw Error("no panorama: expected files, or Debian's blender-data under /usr/share/blender");
  std::vector<Image> pictures;
  std::vector<EnvironmentLight> lights;
  int all = 0;
  for (const std::string& path : options.panoramas) {
    pictures.push_back(read_photo(path));
    lights.emplace_back(pictures.back());
    all += options.views() * (lights.back().suns.empty() ? 1 : 2);
  }
  std::printf("%d views, %d directions a technique and set, %d threads\n", options.views(), options.samples(),
              threads());
  Progress bar("panoramas");
  std::atomic<int> done = 0;
  std::vector<Result> results;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const std::string name = std::filesystem::path(options.panoramas[i]).filename().string();
    for (const bool sun : {true, false}) {
      if (sun && lights[i].suns.empty()) continue;
      results.push_back(measure(name, pictures[i], lights[i], sun, options, bar, done, all));
    }
  }
  bar.finish(std::to_string(pictures.size()) + " measured");
  for (const Result& r : results) print(r, options.markdown);
  summary(results, options.markdown);
  judge(results);
  costs(std::filesystem::path(options.panoramas[0]).filename().string(), lights[0], options.markdown);
  if (!options.figure.empty()) draw(options.figure, results);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "How right the environment's specular light is: rms error and wrong slopes by roughness on panoramas,\n"
      "against a converged quadrature, beside an 8 x 16 grid; and what it costs.\n\n"
      "  bench_specular --markdown --figure specular.svg /usr/share/blender/datafiles/studiolights/world/*.exr\n"};
  app.add_option("panoramas", options.panoramas, "lat-long pictures; those of blender-data if none is given");
  app.add_flag("--quick", options.quick, "60 views and a rougher reference");
  app.add_flag("--markdown", options.markdown, "tables as Markdown");
  app.add_option("--figure", options.figure, "draw the error and the wrong signs into this SVG");
  CLI11_PARSE(app, argc, argv);
  try {
    return run(options);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench_specular: %s\n", e.what());
    return 2;
  }
}
