// bench/parts.cpp -- how much of what is seen of vehicles is given its right kind: wheels, windows, body
// SPDX-License-Identifier: Apache-2.0
//
// bench_parts [FOLDER]: the vehicles of bench/data/parts_truth.tsv, which lie under FOLDER or in the archives of
// sweethome3d-furniture. The truth was written by hand from names and pictures: file, material or material[part],
// kind; "-" where a material is of several kinds: not counted; trim where it is a matter of taste: may be body or
// other. Each vehicle twice: with names, and with all names hidden. Right: of the pixels of a class in views all round,
// those whose part has that class. False: of all pixels, those of other things that were called wheel, window or body.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <burnish/io/mesh.h>
#include <burnish/io/parts.h>
#include <burnish/twin/split_parts.h>

using namespace burnish;

namespace {
/// 0 wheels, 1 windows, 2 body, 3 else; -1 not counted, -2 trim.
int class_of(PartKind k) { return is_wheel(k) ? 0 : k == PartKind::window ? 1 : k == PartKind::body ? 2 : 3; }
struct Row {
  std::string key, kind;
};
struct Score {
  std::array<double, 4> seen{}, right{};
  double claimed = 0;  // of other things and trim, what was called wheel or window, or body without being trim
  double all = 0;
};

Score score(const Raycaster& scene, const std::vector<int>& truth, const std::vector<PartKind>& kinds) {
  Score s;
  const Box box = bounds(scene.mesh());
  for (int k = 0; k < 12; ++k) {
    Pose<float> p;
    p.azimuth = 0.26f + 0.5236f * float(k), p.elevation = k % 2 ? 0.1f : 0.35f;
    p.focal = 3, p.distance = 4.1f * std::sqrt(dot(box.size(), box.size())), p.center = box.center();
    p.width = 256, p.height = 192;
    const GBuffer g = scene.trace(p.camera(), 1);
    for (int i = 0; i < g.size(); ++i) {
      const std::size_t part = std::size_t(g.part[std::size_t(i)]);
      const int t = truth[part], guess = class_of(kinds[part]);
      ++s.all;
      if (t == -1) continue;
      if (t >= 0) ++s.seen[std::size_t(t)], s.right[std::size_t(t)] += t == guess;
      if ((t == 3 && guess != 3) || (t == -2 && guess < 2)) ++s.claimed;
    }
  }
  return s;
}
}  // namespace

int main(int argc, char** argv) {
  try {
    const std::string folder = argc > 1 ? argv[1] : ".";
    const std::string table = read_text(BURNISH_BENCH_DATA "/parts_truth.tsv");
    std::map<std::string, std::vector<Row>> truth;
    for (std::size_t at = 0; at < table.size();) {
      const std::size_t end = std::min(table.find('\n', at), table.size());
      const std::string line = table.substr(at, end - at);
      at = end + 1;
      const std::size_t a = line.find('\t'), b = line.find('\t', a + 1);
      if (line.rfind("# ", 0) == 0 || b == std::string::npos) continue;
      truth[line.substr(0, a)].push_back({line.substr(a + 1, b - a - 1), line.substr(b + 1)});
    }
    std::printf("%-58s%s\n", "", "   with names                   names hidden");
    std::printf("%-58s%s\n", "vehicle", " wheels windows  body  false    wheels windows  body  false");
    std::array<Score, 2> total;
    std::array<std::array<int, 5>, 2> good{};
    std::array<int, 5> had{};
    for (const auto& [file, rows] : truth) {
      std::string path = folder + "/" + file;
      if (file.find(".sh3f:") != std::string::npos) path = "/usr/share/sweethome3d/furniture/" + file;
      if (!std::filesystem::exists(
              path.substr(0, path.find(".sh3f:") == std::string::npos ? path.size() : path.find(".sh3f:") + 5))) {
        std::printf("%-58s not there\n", file.c_str());
        continue;
      }
      Mesh mesh = read_vehicle(path);
      std::vector<int> wanted(mesh.parts.size(), -1);
      for (int specific : {0, 1})
        for (const Row& r : rows) {
          const GivenKind g = detail::given_kind(r.key, "body", file);
          const int c = r.kind == "-"      ? -1
                        : r.kind == "trim" ? -2
                                           : class_of(detail::given_kind(r.key, r.kind, file).kind);
          for (std::size_t p = 0; p < mesh.parts.size(); ++p)
            if ((g.part >= 0) == (specific == 1) && (g.part < 0 || g.part == int(p)) &&
                mesh.parts[p].material == g.material)
              wanted[p] = c;
        }
      const std::size_t before = mesh.parts.size();
      MeshReport report;
      split_wheels(mesh, report);
      // A wheel taken out of something that is not one, or is of several kinds, is a wheel.
      for (std::size_t p = before; p < mesh.parts.size(); ++p) wanted.push_back(0);
      const Raycaster scene(std::move(mesh));
      std::printf("%-58s", file.size() > 57 ? file.substr(file.size() - 57).c_str() : file.c_str());
      for (int hidden : {0, 1}) {
        AssignOptions options;
        options.names = hidden == 0;
        const AssignedParts parts = assign_parts(scene, options);
        const Score s = score(scene, wanted, parts.kinds());
        bool all = true, any = false;
        for (int c = 0; c < 3; ++c) {
          const double seen = s.seen[std::size_t(c)], share = seen > 0 ? s.right[std::size_t(c)] / seen : 1;
          total[std::size_t(hidden)].seen[std::size_t(c)] += seen / s.all;
          total[std::size_t(hidden)].right[std::size_t(c)] += s.right[std::size_t(c)] / s.all;
          if (seen < 0.005 * s.all) {
            std::printf("      -");
            continue;
          }
          std::printf(" %5.1f%%", 100 * share);
          any = true, all &= share >= 0.9;
          good[std::size_t(hidden)][std::size_t(c)] += share >= 0.9, had[std::size_t(c)] += hidden;
        }
        good[std::size_t(hidden)][3] += any && all, had[3] += any && hidden;
        total[std::size_t(hidden)].claimed += s.claimed / s.all, total[std::size_t(hidden)].all += 1;
        std::printf(" %5.1f%%%s", 100 * s.claimed / s.all, hidden ? "\n" : "   ");
      }
      std::fflush(stdout);
    }
    for (int h : {0, 1}) {
      const Score& s = total[std::size_t(h)];
      std::printf("%s: ", h ? "names hidden" : "with names");
      const char* names[] = {"wheels", "windows", "body"};
      for (std::size_t c = 0; c < 3; ++c)
        std::printf("%s %.1f %% of the area, 90 %% on %d of %d vehicles; ", names[c],
                    100 * s.right[c] / std::max(s.seen[c], 1e-9), good[std::size_t(h)][c], had[c]);
      std::printf("all three on %d of %d; false claims %.1f %%\n", good[std::size_t(h)][3], had[3],
                  100 * s.claimed / std::max(s.all, 1.0));
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench_parts: %s\n", e.what());
    return 2;
  }
  return 0;
}
