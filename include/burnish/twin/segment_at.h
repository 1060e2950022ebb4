// burnish/twin/segment_at.h -- a vehicle's mask from one point inside it
// SPDX-License-Identifier: Apache-2.0
//
// Nothing says how large the vehicle is: things are cut out in boxes of all sizes, and the one that looks most like a whole
// vehicle is taken. A detector's box (io/network.h) is the surer way.
#pragma once
#include <burnish/twin/segment.h>

namespace burnish {
namespace detail {
/// How much a mask looks like a whole thing: the share of its outline where colours change (a difference of 40 codes or
/// more counts whole), times what wheels and a vehicle's proportions add.
inline float wholeness(const CutWindow& window, const Cut& cut) {
  const int w = cut.labels.cols, h = cut.labels.rows;
  const cv::Rect all(0, 0, w, h);
  const auto in = [&](const cv::Point& p) { return all.contains(p) && cut.labels.at<std::uint8_t>(p); };
  cv::Mat smooth;
  cv::blur(window.codes, smooth, {3, 3});
  double sum = 0;
  int outline = 0;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      for (const cv::Point& d : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
        const cv::Point p(x, y);
        if (!in(p) || in(p + d)) continue;
        ++outline;
        if (!all.contains(p + 3 * d) || !all.contains(p - d)) continue;  // at the window's rim: no evidence
        const cv::Vec3f step = cv::Vec3f(smooth.at<cv::Vec3b>(p - d)) - cv::Vec3f(smooth.at<cv::Vec3b>(p + 3 * d));
        sum += std::min(1.0, cv::norm(step) / 40);
      }
  if (outline == 0) return 0;
  const PixelBox b = around(cut.labels);
  const float aspect = b.width() / b.height(), fill = float(cv::countNonZero(cut.labels)) / b.area();
  const float off = std::max({0.0f, 0.9f - aspect, 0.5f * (aspect - 3.2f), 2 * (0.6f - fill), 3 * (fill - 0.92f)});
  const float wheels = cut.wheels.size() == 2 ? 1.4f : cut.wheels.size() == 1 ? 1.35f : 1.0f;
  return float(sum / outline) * wheels * std::exp(-3 * off);
}
struct BoxGuess {
  PixelBox box;
  float score = 0;
};
/// A box around the thing at a place of the photo: a mask is grown in a box of the given width, a box laid around it, and
/// so on; the one that is most like a whole thing is kept, of two alike the larger.
inline BoxGuess guess_box(const Image& photo, float x, float y, float width) {
  BoxGuess best;
  PixelBox box{x - 0.5f * width, y - 0.26f * width, x + 0.5f * width, y + 0.26f * width};
  for (int round = 0; round < 4; ++round) {
    const CutWindow window(photo, box.grown(0, photo.width, photo.height), 96);
    const PixelBox at = window.from_photo({x, y, x, y});
    const cv::Point place(std::min(int(at.x0), window.image.width - 1), std::min(int(at.y0), window.image.height - 1));
    const Cut cut = cut_out(window, place);
    if (cv::countNonZero(cut.labels) == 0) break;
    const PixelBox next = window.to_photo(around(cut.labels));
    const float score = wholeness(window, cut) * std::pow(next.area(), 0.2f);
    if (score > best.score) best = {next, score};
    if (iou(next, box) > 0.93f) break;
    box = next.grown(0.12f, photo.width, photo.height);
  }
  return best;
}
}  // namespace detail

/// The vehicle at a place of the photo. The certainty falls, too, when boxes of other sizes lead to other things that are
/// about as whole.
inline Segmented segment(const Image& photo, const vec2<float>& place, const SegmentOptions& options = {}) {
  std::vector<detail::BoxGuess> guesses;
  const float large = float(std::max(photo.width, photo.height));
  for (float size = 0.06f; size < 1; size *= 1.35f) guesses.push_back({{}, size * large});
  parallel_for(int(guesses.size()), [&](int i) {
    detail::BoxGuess& g = guesses[std::size_t(i)];
    g = detail::guess_box(photo, place.x, place.y, g.score);
  });
  const detail::BoxGuess best =
      *std::max_element(guesses.begin(), guesses.end(), [](const auto& a, const auto& b) { return a.score < b.score; });
  Segmented s = segment(photo, best.box, options);
  float sum = 0, agree = 0;
  for (const detail::BoxGuess& g : guesses) sum += g.score * g.score, agree += g.score * g.score * iou(g.box, best.box);
  s.certainty *= sum > 0 ? agree / sum : 0;
  return s;
}

}  // namespace burnish
