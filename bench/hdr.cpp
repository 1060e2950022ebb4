// bench/hdr.cpp -- real HDR panoramas clipped to eight bits, and how much of their light is found again
// SPDX-License-Identifier: Apache-2.0
//
//   bench_hdr [FOLDER ...]
//
// Each panorama is exposed so that the mean luminance of what a camera records (clipped at 1) is 0.18, one stop less
// and half a stop more, coded in 8-bit sRGB, and given to estimate_hdr. Printed: how far the sun is off, and by how
// much the irradiances of a horizontal and of four vertical planes are wrong, beside those of the clipped panorama
// itself.
#include <cstdio>
#include <burnish/io/photo.h>
#include <burnish/street/expose.h>
#include <burnish/street/hdr.h>

using namespace burnish;
namespace {

const vec3<double> planes[5] = {{0, 1, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}};
std::array<double, 5> irradiances(const Image& p) {
  std::array<double, 5> e{};
  for (int y = 0; y < p.height; ++y) {
    for (int x = 0; x < p.width; ++x) {
      const vec3<double> d = latlong_direction((x + 0.5) / p.width, (y + 0.5) / p.height);
      const double l = double(luminance(p.at(x, y))) * detail::texel_area(p.width, p.height, y);
      for (std::size_t k = 0; k < 5; ++k) e[k] += l * std::max(dot(d, planes[k]), 0.0);
    }
  }
  return e;
}
/// The sun of the original: the middle of what lies within 2 degrees of the brightest texel above the horizon, and its
/// irradiance as a part of the whole sphere's.
struct TrueSun {
  vec3<double> direction;
  double part = 0;
};
TrueSun true_sun(const Image& p) {
  double best = 0, all = 0;
  vec3<double> at(0, 1, 0), sum;
  for (int y = 0; y < p.height / 2 + 2; ++y) {
    for (int x = 0; x < p.width; ++x) {
      const double l = double(luminance(p.at(x, y)));
      if (l > best) best = l, at = latlong_direction((x + 0.5) / p.width, (y + 0.5) / p.height);
    }
  }
  for (int y = 0; y < p.height; ++y) {
    for (int x = 0; x < p.width; ++x) {
      const vec3<double> d = latlong_direction((x + 0.5) / p.width, (y + 0.5) / p.height);
      const double l = double(luminance(p.at(x, y))) * detail::texel_area(p.width, p.height, y);
      all += l;
      if (dot(d, at) > 0.99939) sum += d * l;
    }
  }
  return {normalize(sum), length(sum) / all};
}
const char* word(SkyKind k) { return k == SkyKind::sunny ? "sunny" : k == SkyKind::cloudy ? "cloudy" : "none"; }

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> folders(argv + 1, argv + argc), files;
  if (folders.empty()) folders = {"/usr/share/blender/datafiles/studiolights/world"};
  for (const std::string& folder : folders) {
    if (!std::filesystem::exists(folder)) {
      std::printf("%s: not here (Debian: blender-data)\n", folder.c_str());
      continue;
    }
    if (!std::filesystem::is_directory(folder)) files.push_back(folder);
    else
      for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        const std::string kind = entry.path().extension().string();
        if (kind == ".exr" || kind == ".hdr") files.push_back(entry.path().string());
      }
  }
  std::sort(files.begin(), files.end());
  std::vector<double> ours, plain, ours_sky, plain_sky, ours_lost, plain_lost, off, darker, usual, brighter, sure;
  std::printf("%-30s %5s  %-6s %14s %6s %7s %10s   %-34s  %-34s\n", "panorama", "mean", "found", "sun: elevation",
              "part", "off", "(sigma)", "error of E: up, +x, -x, +z, -z, %", "of the clipped panorama, %");
  for (const std::string& file : files) {
    Image original = without_flaws(read_photo(file));
    if (original.height > 512) original = detail::resampled_panorama(original, 512);
    const TrueSun sun = true_sun(original);
    for (const float mean : {0.09f, 0.18f, 0.255f}) {
      const float exposure = metered_exposure(original, mean);
      const Image ldr = photographed(original, exposure);
      const HdrPanorama found = estimate_hdr(ldr);
      const auto truth = irradiances(original), with = irradiances(found.panorama), without = irradiances(ldr);
      const double angle =
          std::acos(std::clamp(dot(vec3<double>(found.sun_direction), sun.direction), -1.0, 1.0)) * 57.29578;
      std::printf("%-30s %5.3f  %-6s %14.1f %6.3f ", std::filesystem::path(file).filename().c_str(), double(mean),
                  word(found.kind), std::asin(sun.direction.y) * 57.29578, sun.part);
      if (found.kind == SkyKind::none) std::printf("%7s %10s  ", "-", "");
      else std::printf("%7.1f %10.1f  ", angle, found.sun_sigma * 57.29578);
      for (std::size_t k = 0; k < 5; ++k) {
        const double t = truth[k] * double(exposure), a = with[k] / t - 1, b = without[k] / t - 1;
        std::printf(" %6.0f", 100 * a);
        ours.push_back(std::fabs(a)), plain.push_back(std::fabs(b));
        if (found.kind == SkyKind::none) continue;
        ours_sky.push_back(std::fabs(a)), plain_sky.push_back(std::fabs(b));
        if (b < -0.1) ours_lost.push_back(std::fabs(a)), plain_lost.push_back(std::fabs(b));
      }
      std::printf("  ");
      for (std::size_t k = 0; k < 5; ++k) std::printf(" %6.0f", 100 * (without[k] / (truth[k] * double(exposure)) - 1));
      std::printf("\n");
      if (found.kind == SkyKind::sunny && sun.part > 0.01) {
        off.push_back(angle);
        (mean < 0.1f ? darker : mean < 0.2f ? usual : brighter).push_back(angle);
      }
      if (found.kind == SkyKind::sunny && found.sun_sigma < 0.035) sure.push_back(angle);
    }
  }
  const auto part_of = [](std::vector<double> v, double q) {
    if (v.empty()) return 0.0;
    std::sort(v.begin(), v.end());
    return v[std::size_t(q * double(v.size() - 1))];
  };
  const auto line = [&](const char* what, const std::vector<double>& a, const std::vector<double>& b) {
    std::printf("%-62s %4zu   %5.1f %5.1f   %5.1f %5.1f\n", what, a.size(), 100 * part_of(a, 0.5),
                100 * part_of(a, 0.9), 100 * part_of(b, 0.5), 100 * part_of(b, 0.9));
  };
  std::printf("\n%-62s %4s   %-12s  %s\n", "error of the irradiance, %: median and 90 % below", "n", "estimated",
              "clipped");
  line("all planes of all panoramas", ours, plain);
  line("under a sky that was found", ours_sky, plain_sky);
  line("and clipping takes more than a tenth of it", ours_lost, plain_lost);
  std::printf("\n%-62s %4s   median, 90 %% below\n", "the sun is off by, degrees", "n");
  const auto sun_line = [&](const char* what, const std::vector<double>& v) {
    std::printf("%-62s %4zu   %5.1f %5.1f\n", what, v.size(), part_of(v, 0.5), part_of(v, 0.9));
  };
  sun_line("it is said to be seen, and has 1 % of all light", off);
  sun_line("  exposed a stop less", darker);
  sun_line("  as metered", usual);
  sun_line("  half a stop more", brighter);
  sun_line("it is said to be seen, and sigma is below 2 degrees", sure);
}
