// examples/twin_find.h -- which vehicle of a library a photo shows, and from where
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <burnish/io/build_library.h>
#include <burnish/io/photo.h>
#include <burnish/twin/match_pose.h>
#include <burnish/twin/preview.h>
#include <burnish/twin/retrieve.h>
#include "cards.h"
#include "pictures.h"
#include "progress.h"

namespace twin {
using namespace burnish;

/// A vehicle that may be the photo's, and its best pose.
struct Candidate {
  std::string path, name;
  double cosine = 0;                 // of its best view with the photo; 0 where it was given
  std::shared_ptr<Raycaster> scene;  // none where the file could not be read
  MeshReport report;
  std::vector<PoseCandidate> poses;  // best first; of different headings
  double score() const { return poses.empty() ? -1 : poses.front().score; }
};

/// The index at a path, brought up to date with the folders.
inline Library open_library(const std::string& index, const std::vector<std::string>& folders) {
  Progress bar("library");
  LibraryBuild b = build_library(
      index, folders, {}, LibraryOptions(),
      [&](int done, int of, double) { bar.show(done, of, std::to_string(done) + " of " + std::to_string(of)); },
      [] { return interrupted != 0; });
  char note[160];
  std::snprintf(note, sizeof note, "%d vehicles can be found, %d refused, %d failed; %d read now",
                b.vehicles.count(LibraryStatus::indexed), b.vehicles.count(LibraryStatus::refused),
                b.vehicles.count(LibraryStatus::failed), b.done);
  bar.finish(note);
  return std::move(b.vehicles);
}
/// The vehicles whose views are nearest to the photo's.
inline std::vector<Candidate> retrieve(const Library& library, const std::string& index, const Image& photo,
                                       const Mask& mask, int count) {
  const auto space = library.spaces.find("views");
  if (space == library.spaces.end() || space->second.rows() == 0)
    throw Error(index + ": no vehicle is indexed, expected some; 06_retrieve --report says why");
  const LibrarySpace& s = space->second;
  Progress bar("retrieve");
  std::vector<Candidate> out;
  for (const NearestModel& f : burnish::retrieve(s.values, first_rows(library, s), mask, photo, count)) {
    const LibraryEntry& e = library.entries[std::size_t(f.model)];
    out.push_back({e.path, e.name, double(f.cosine), nullptr, {}, {}});
  }
  bar.finish(std::to_string(s.rows()) + " views of " + std::to_string(library.count(LibraryStatus::indexed)) +
             " vehicles compared; nearest: " + out.front().name);
  return out;
}
/// Reads and poses all of them, the best first. Those that cannot be read are said and dropped; Error if none is left.
inline std::vector<Candidate> pose_all(std::vector<Candidate> all, const Image& photo, const Mask& mask,
                                       const MatchOptions& options) {
  Progress bar("pose");
  std::vector<Candidate> out;
  for (std::size_t k = 0; k < all.size() && !interrupted; ++k) {
    Candidate& c = all[k];
    try {
      c.scene = std::make_shared<Raycaster>(read_vehicle(c.path, &c.report));
      c.poses = match_pose(*c.scene, mask, photo, options, 2, [&](int done, int of) {
        bar.show(int(k) * 100 + 100 * done / of, 100 * int(all.size()), c.name);
      });
      out.push_back(std::move(c));
    } catch (const Error& e) {
      std::printf("  %s\n", e.what());
    }
  }
  if (out.empty()) throw Error("no vehicle of those found could be posed");
  std::stable_sort(out.begin(), out.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score() > b.score(); });
  char note[200];
  const PoseCandidate& p = out.front().poses.front();
  std::snprintf(note, sizeof note, "%zu vehicles tried; %s, from %.0f degrees, IoU %.3f", out.size(),
                out.front().name.c_str(), double(std::remainder(p.pose.azimuth, 2 * pi)) * 57.29578, p.iou);
  bar.finish(note);
  return out;
}

/// The window of the picture that the mask is in, with its surroundings, at most `wide` pixels wide.
inline Image around(const Image& picture, const Mask& mask, float margin, int wide) {
  int x0 = mask.width, y0 = mask.height, x1 = 0, y1 = 0;
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x)
      if (mask.at(x, y) > 0.5f)
        x0 = std::min(x0, x), x1 = std::max(x1, x + 1), y0 = std::min(y0, y), y1 = std::max(y1, y + 1);
  const int more = int(margin * float(x1 - x0));
  x0 = std::max(0, x0 - more), y0 = std::max(0, y0 - more);
  x1 = std::min(mask.width, x1 + more), y1 = std::min(mask.height, y1 + more);
  const Image out = cropped(picture, x0, y0, x1 - x0, y1 - y0);
  return resized(out, wide, std::max(1, wide * out.height / out.width));
}
/// The candidates in their poses, in the file's own colours, beside the photo.
inline Image contact_sheet(const std::vector<Candidate>& all, const Image& photo, const Mask& mask) {
  constexpr int width = 300, height = 200;
  const auto framed_photo = [&] {
    const Image wide = around(photo, mask, 0.15f, 600);
    Image out(width, height, {1, 1, 1});
    const float scale = std::min(float(width) / float(wide.width), float(height) / float(wide.height));
    const Image small =
        resized(wide, std::max(1, int(float(wide.width) * scale)), std::max(1, int(float(wide.height) * scale)));
    for (int y = 0; y < small.height; ++y)
      for (int x = 0; x < small.width; ++x)
        out.set(x + (width - small.width) / 2, y + (height - small.height) / 2, small.at(x, y));
    return out;
  };
  std::vector<Card> cards{{framed_photo(), "photo", ""}};
  for (const Candidate& c : all) {
    char text[80];
    const PoseCandidate& p = c.poses.front();
    std::snprintf(text, sizeof text, "score %.1f, IoU %.2f, cosine %.2f", c.score(), p.iou, c.cosine);
    cards.push_back(
        {preview(*c.scene, framed(bounds(c.scene->mesh()), p.pose.azimuth, p.pose.elevation, width, height).camera()),
         c.name, text});
  }
  return card_sheet(cards, 3);
}

}  // namespace twin
