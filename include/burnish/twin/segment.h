// burnish/twin/segment.h -- a vehicle's mask from a box around it
// SPDX-License-Identifier: Apache-2.0
//
// Colours inside and outside the box are learnt by GrabCut (Rother et al. 2004, OpenCV's). Its labels are made anew on
// superpixels, where a vehicle's usual shape has a say, and once more on the pixels along the outline.
#pragma once
#include <array>
#include <cmath>
#include <optional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <burnish/ad/parallel.h>
#include <burnish/scene/image.h>
#include <burnish/twin/box.h>
#include <burnish/twin/star_cut.h>
#include <burnish/twin/seen_wheels.h>

namespace burnish {

struct SegmentOptions {
  int pixels = 240;       // the longer side of the box, at most, in the picture that is worked on
  float slack = 0.02f;    // by what share of its size the box may be too small
  int rounds = 1;         // with 2 a new box is laid round the first mask, for boxes that are some 8 % off
  bool certainty = true;  // find out how certain the mask is; takes about as long again
};
/// For the box of a detector.
inline SegmentOptions for_detections() { return {.slack = 0.08f, .rounds = 2}; }
struct Segmented {
  Mask mask;            // of the photo's size
  PixelBox box;         // around the mask
  float certainty = 0;  // mean IoU with the masks of boxes or points a little off: above 0.9 is a steady one
};

namespace detail {
inline cv::Mat encoded(const Image& image) {
  cv::Mat out(image.height, image.width, CV_8UC3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const vec3<float> c = srgb_from_linear(image.at(x, y)) * 255.0f;
      const auto code = [](float v) { return std::uint8_t(std::clamp(v, 0.0f, 255.0f) + 0.5f); };
      out.at<cv::Vec3b>(y, x) = {code(c.x), code(c.y), code(c.z)};
    }
  return out;
}

/// GrabCut's mixture of five Gaussians, as it keeps it: weights, means, covariances.
class CutColors {
public:
  explicit CutColors(const cv::Mat& model) {
    const double* m = model.ptr<double>();
    for (int k = 0; k < 5; ++k) {
      if (m[k] <= 0) continue;
      cv::Matx33d covariance(m + 20 + 9 * k);
      for (int i = 0; i < 3; ++i) covariance(i, i) += 4;  // two codes: less is noise
      parts_.push_back({m[k] / std::sqrt(cv::determinant(covariance)),
                        {m[5 + 3 * k], m[6 + 3 * k], m[7 + 3 * k]},
                        covariance.inv()});
    }
  }
  float log(const cv::Vec3b& color) const {
    double sum = 1e-12;
    for (const Part& p : parts_) {
      const cv::Vec3d d = cv::Vec3d(color[0], color[1], color[2]) - p.mean;
      sum += p.weight * std::exp(-0.5 * d.dot(p.inverse * d));
    }
    return float(std::log(sum));
  }

private:
  struct Part {
    double weight;
    cv::Vec3d mean;
    cv::Matx33d inverse;
  };
  std::vector<Part> parts_;
};

/// The logarithm of the odds that a vehicle is at (u, v) of its box, both -1 .. 1, y down: its middle is full, its corners
/// are empty, and the upper ones more.
inline float shape_odds(float u, float v) {
  const float wide = std::fabs(u) * (v < 0 ? 1 - 0.35f * v : 1.0f);
  const float r = std::pow(std::pow(wide, 2.5f) + std::pow(std::fabs(v), 2.5f), 0.4f);
  return std::clamp(2.8f * (0.97f - r), -1.4f, 1.4f);
}

/// What wheels say about a place: in them is the vehicle. Below the ground that two of them touch it is not, and hardly
/// beside their lower quarters, where the shadow lies.
inline float wheel_odds(const std::vector<SeenWheel>& wheels, float x, float y) {
  for (const SeenWheel& e : wheels)
    if (e.contains(x, y)) return 6;
  if (wheels.size() < 2) return 0;
  const SeenWheel &a = wheels[0].x < wheels[1].x ? wheels[0] : wheels[1],
                  &b = wheels[0].x < wheels[1].x ? wheels[1] : wheels[0];
  const float below = below_ground(a, b, x, y);
  if (below > 0) return -6;
  const float t = std::clamp((x - a.x) / std::max(b.x - a.x, 1.0f), 0.0f, 1.0f);
  const float quarters = below / (0.5f * (a.ry + t * (b.ry - a.ry)));
  return quarters > -0.8f ? -6.0f : quarters > -1.2f ? -3.0f : 0.0f;
}

/// The piece that has the place (or the largest one, where it is in none), without holes.
inline cv::Mat one_piece(const cv::Mat& labels, std::optional<cv::Point> place) {
  cv::Mat piece, stats, centers;
  const int n = cv::connectedComponentsWithStats(labels, piece, stats, centers, 4);
  int best = 0;
  if (place && cv::Rect(0, 0, labels.cols, labels.rows).contains(*place)) best = piece.at<int>(*place);
  for (int k = 1; k < n && !(place && best > 0 && piece.at<int>(*place) == best); ++k)
    if (best == 0 || stats.at<int>(k, cv::CC_STAT_AREA) > stats.at<int>(best, cv::CC_STAT_AREA)) best = k;
  cv::Mat out(labels.rows + 2, labels.cols + 2, CV_8U, cv::Scalar(0));
  if (best == 0) return cv::Mat::zeros(labels.size(), CV_8U);
  cv::Mat inner = out(cv::Rect(1, 1, labels.cols, labels.rows));
  inner.setTo(1, piece == best);
  cv::floodFill(out, {0, 0}, 2);
  return inner != 2;  // 255 or 0
}

/// The part of a photo that is worked on: the box with its surroundings, made smaller.
struct CutWindow {
  int x = 0, y = 0, w = 0, h = 0;  // in the photo
  float scale = 1;
  Image image;
  cv::Mat codes;
  PixelBox box;  // in the window's own pixels

  CutWindow(const Image& photo, const PixelBox& in_photo, int pixels) {
    const PixelBox around = in_photo.grown(0.35f, photo.width, photo.height);
    x = int(around.x0), y = int(around.y0);
    w = std::max(1, int(std::ceil(around.x1)) - x), h = std::max(1, int(std::ceil(around.y1)) - y);
    scale = std::min(1.0f, float(pixels) / std::max({in_photo.width(), in_photo.height(), 1.0f}));
    image = cropped(photo, x, y, w, h);
    if (scale < 1) image = resized(image, std::max(1, int(float(w) * scale)), std::max(1, int(float(h) * scale)));
    codes = encoded(image);
    box = from_photo(in_photo);
  }
  PixelBox to_photo(const PixelBox& b) const {
    const float sx = float(w) / float(image.width), sy = float(h) / float(image.height);
    return {float(x) + b.x0 * sx, float(y) + b.y0 * sy, float(x) + b.x1 * sx, float(y) + b.y1 * sy};
  }
  PixelBox from_photo(const PixelBox& b) const {
    const float sx = float(image.width) / float(w), sy = float(image.height) / float(h);
    return {(b.x0 - float(x)) * sx, (b.y0 - float(y)) * sy, (b.x1 - float(x)) * sx, (b.y1 - float(y)) * sy};
  }
  Mask to_photo(const cv::Mat& labels, const Image& photo) const {
    Mask small(image.width, image.height);
    for (int j = 0; j < small.height; ++j)
      for (int i = 0; i < small.width; ++i) small.at(i, j) = labels.at<std::uint8_t>(j, i) ? 1.0f : 0.0f;
    if (small.width != w || small.height != h) small = resized(small, w, h);
    return cropped(small, -x, -y, photo.width, photo.height);
  }
};

/// A mask of a window, 255 in and 0 out, and what was seen on the way.
struct Cut {
  cv::Mat labels;
  std::vector<SeenWheel> wheels;
};
/// The vehicle in the window's box. place, where there is one, is in it.
inline Cut cut_out(const CutWindow& window, std::optional<cv::Point> place) {
  const int w = window.image.width, h = window.image.height, keep = place ? place->y * w + place->x : -1;
  const PixelBox& b = window.box;
  Mask odds(w, h), grey(w, h), likeness(w, h);
  cv::Mat labels(h, w, CV_8U, cv::Scalar(cv::GC_BGD));
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const float px = float(x) + 0.5f, py = float(y) + 0.5f;
      const cv::Vec3b& c = window.codes.at<cv::Vec3b>(y, x);
      grey.at(x, y) = luminance(vec3<float>(c[0], c[1], c[2])) / 255;
      odds.at(x, y) = shape_odds(2 * (px - b.x0) / b.width() - 1, 2 * (py - b.y0) / b.height() - 1);
      if (b.contains(px, py)) labels.at<std::uint8_t>(y, x) = odds.at(x, y) > 0 ? cv::GC_PR_FGD : cv::GC_PR_BGD;
    }
  if (cv::countNonZero(labels) == w * h) cv::rectangle(labels, {0, 0, w, h}, cv::GC_BGD, 2);  // something must be out
  if (cv::countNonZero(labels == cv::GC_PR_FGD) < 25) return {cv::Mat::zeros(h, w, CV_8U), {}};
  cv::Mat background, foreground;
  const auto learn = [&](int rounds, int mode) {
    cv::Mat learning = labels.clone();
    if (place) cv::circle(learning, *place, 2, cv::GC_FGD, -1);
    cv::setRNGSeed(1);
    cv::grabCut(window.codes, learning, {}, background, foreground, rounds, mode);
    const CutColors in(foreground), out(background);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const cv::Vec3b& c = window.codes.at<cv::Vec3b>(y, x);
        likeness.at(x, y) = 0.5f * std::clamp(in.log(c) - out.log(c), -3.0f, 3.0f);
      }
  };
  const auto sum = [&] {
    Mask all = odds;
    for (std::size_t i = 0; i < all.values.size(); ++i) all.values[i] += likeness.values[i];
    return all;
  };
  learn(4, cv::GC_INIT_WITH_MASK);
  Cut cut;
  cut.wheels = seen_wheels(grey, likeness, b);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) odds.at(x, y) += wheel_odds(cut.wheels, float(x) + 0.5f, float(y) + 0.5f);
  const StarCut star(window.image, b);
  std::vector<char> in = star.by_pieces(sum(), keep);
  const auto take = [&] {
    for (int i = 0; i < w * h; ++i) {
      std::uint8_t& label = labels.at<std::uint8_t>(i / w, i % w);
      if (label != cv::GC_BGD) label = in[std::size_t(i)] ? cv::GC_PR_FGD : cv::GC_PR_BGD;
    }
    return one_piece((labels & 1) * 255, place);
  };
  take();
  if (cv::countNonZero(labels == cv::GC_PR_FGD) < 25) return {cv::Mat::zeros(h, w, CV_8U), {}};
  learn(1, cv::GC_EVAL);
  in = star.by_pieces(sum(), keep);
  // Along the outline the pixels decide.
  const cv::Mat mine = take();
  cv::Mat core, reach;
  const int across = 2 * StarCut::step - 1;
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {across, across});
  cv::erode(mine, core, disc), cv::dilate(mine, reach, disc);
  std::vector<char> open(in.size());
  for (int i = 0; i < w * h; ++i) {
    in[std::size_t(i)] = core.at<std::uint8_t>(i / w, i % w) != 0;
    const bool wheel = std::any_of(cut.wheels.begin(), cut.wheels.end(), [&](const SeenWheel& e) {
      return e.contains(float(i % w) + 0.5f, float(i / w) + 0.5f);
    });
    open[std::size_t(i)] = (reach.at<std::uint8_t>(i / w, i % w) || wheel) && !in[std::size_t(i)];
  }
  in = star.by_pixels(sum(), std::move(in), open);
  cv::Mat smooth;
  cv::morphologyEx(cv::Mat(h, w, CV_8U, in.data()) * 255, smooth, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3}));
  cut.labels = one_piece(smooth, place);
  return cut;
}
inline PixelBox around(const cv::Mat& labels) {
  const cv::Rect r = cv::boundingRect(labels);
  return {float(r.x), float(r.y), float(r.x + r.width), float(r.y + r.height)};
}
/// The mean IoU of the masks in boxes some percent off with that in the box itself, all in small.
inline float steadiness(const Image& photo, const PixelBox& box) {
  const float dx = 0.04f * box.width(), dy = 0.04f * box.height();
  const PixelBox boxes[] = {box,
                            {box.x0 - dx, box.y0 - dy, box.x1 + dx, box.y1 + dy},
                            {box.x0 + 0.5f * dx, box.y0 + 0.5f * dy, box.x1 - 0.5f * dx, box.y1 - 0.5f * dy},
                            {box.x0 + dx, box.y0 - dy, box.x1 + dx, box.y1 - dy},
                            {box.x0 - dx, box.y0 + dy, box.x1 - dx, box.y1 + dy}};
  // All are cut out of one window, so that their pixels are the same.
  const CutWindow window(photo, box, 120);
  std::array<cv::Mat, 5> masks;
  parallel_for(5, [&](int i) {
    CutWindow shifted = window;
    shifted.box = window.from_photo(boxes[i]);
    masks[std::size_t(i)] = cut_out(shifted, {}).labels;
  });
  float sum = 0;
  for (std::size_t i = 1; i < 5; ++i) {
    const int any = cv::countNonZero(masks[0] | masks[i]);
    sum += any ? float(cv::countNonZero(masks[0] & masks[i])) / float(any) : 0;
  }
  return sum / 4;
}
}  // namespace detail

/// A mask's piece at a place (the largest without one), holes filled; soft edges stay soft.
inline Mask cleaned(const Mask& mask, std::optional<vec2<float>> place = {}) {
  cv::Mat in(mask.height, mask.width, CV_8U);
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) in.at<std::uint8_t>(y, x) = mask.at(x, y) > 0.5f ? 255 : 0;
  std::optional<cv::Point> point;
  if (place) point = cv::Point(int(place->x), int(place->y));
  const cv::Mat piece = detail::one_piece(in, point);
  cv::Mat near;
  cv::dilate(piece, near, cv::Mat::ones(3, 3, CV_8U));
  Mask out = mask;
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) {
      if (!near.at<std::uint8_t>(y, x)) out.at(x, y) = 0;
      else if (piece.at<std::uint8_t>(y, x) && mask.at(x, y) <= 0.5f) out.at(x, y) = 1;
    }
  return out;
}

/// The vehicle in a box. The mask is empty where nothing in the box stands out.
inline Segmented segment(const Image& photo, const PixelBox& box, const SegmentOptions& options = {}) {
  Segmented s;
  s.mask = Mask(photo.width, photo.height);
  PixelBox given = box;
  for (int round = 0; round < options.rounds; ++round) {
    const float slack = round == 0 ? options.slack : std::min(options.slack, 0.02f);
    const PixelBox larger = given.grown(slack, photo.width, photo.height);
    if (!(larger.width() >= 4 && larger.height() >= 4)) return s;
    const detail::CutWindow window(photo, larger, options.pixels);
    const cv::Mat labels = detail::cut_out(window, {}).labels;
    if (cv::countNonZero(labels) == 0) return s;
    s.box = given = window.to_photo(detail::around(labels));
    if (round + 1 < options.rounds) continue;
    s.mask = window.to_photo(labels, photo);
    if (options.certainty) s.certainty = detail::steadiness(photo, larger);
  }
  return s;
}

}  // namespace burnish
