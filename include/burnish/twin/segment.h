// burnish/twin/segment.h -- a vehicle's mask from a point inside it or a box around it
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
  float slack = 0.02f;    // how far off the box may be, as a share of its size; a detector's is 0.08 off
  int pixels = 240;       // the longer side of the box, at most, in the picture that is worked on
  bool certainty = true;  // find out how certain the mask is; takes about as long again
};
struct Segmented {
  Mask mask;             // of the photo's size
  PixelBox box;          // around the mask
  float certainty = 0;   // mean IoU with the masks of boxes or points a little off: above 0.9 is a steady one
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
      parts_.push_back({m[k] / std::sqrt(cv::determinant(covariance)), {m[5 + 3 * k], m[6 + 3 * k], m[7 + 3 * k]},
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
  const SeenWheel &a = wheels[0].x < wheels[1].x ? wheels[0] : wheels[1], &b = wheels[0].x < wheels[1].x ? wheels[1] : wheels[0];
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
    const float sx = float(image.width) / float(w), sy = float(image.height) / float(h);
    box = {(in_photo.x0 - float(x)) * sx, (in_photo.y0 - float(y)) * sy, (in_photo.x1 - float(x)) * sx,
           (in_photo.y1 - float(y)) * sy};
  }
  Mask to_photo(const cv::Mat& labels, const Image& photo) const {
    Mask small(image.width, image.height);
    for (int j = 0; j < small.height; ++j)
      for (int i = 0; i < small.width; ++i) small.at(i, j) = labels.at<std::uint8_t>(j, i) ? 1.0f : 0.0f;
    if (small.width != w || small.height != h) small = resized(small, w, h);
    return cropped(small, -x, -y, photo.width, photo.height);
  }
};

<<<<<<< HEAD
/// A mask of a window, 255 in and 0 out, and what was seen on the way.
struct Cut {
  cv::Mat labels;
  std::vector<SeenWheel> wheels;
};
/// The vehicle in the window's box. place, where there is one, is in it.
inline Cut cut_out(const Window& window, std::optional<cv::Point> place) {
  const int w = window.image.width, h = window.image.height, keep = place ? place->y * w + place->x : -1;
=======
/// 255 in, 0 out, for the window's box.
inline cv::Mat cut_out(const CutWindow& window, std::optional<cv::Point> place) {
  const int w = window.image.width, h = window.image.height;
>>>>>>> f8eba721aaa03928bec211caa3ee974dd64bbb62
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
<<<<<<< HEAD
  const auto learn = [&](int rounds, int mode) {
    cv::Mat learning = labels.clone();
    if (place) cv::circle(learning, *place, 2, cv::GC_FGD, -1);
    cv::setRNGSeed(1);
    cv::grabCut(window.codes, learning, {}, background, foreground, rounds, mode);
    const Mixture in(foreground), out(background);
=======
  cv::setRNGSeed(1);
  cv::grabCut(window.codes, labels, {}, background, foreground, 4, cv::GC_INIT_WITH_MASK);

  const int step = 6;
  const Superpixels pieces = superpixels(window.image, step);
  const auto label_of = [&](int x, int y) { return pieces.label[std::size_t(y) * w + x]; };
  // GrabCut's own weight of an edge: 50 exp(-beta d^2), beta from the mean contrast.
  double contrast = 0;
  long pairs = 0;
  const auto difference = [&](int x, int y, int i, int j) {
    const cv::Vec3f d = cv::Vec3f(window.codes.at<cv::Vec3b>(y, x)) - cv::Vec3f(window.codes.at<cv::Vec3b>(j, i));
    return d.dot(d);
  };
  const auto each_pair = [&](auto f) {
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        if (x + 1 < w) f(x, y, x + 1, y);
        if (y + 1 < h) f(x, y, x, y + 1);
      }
  };
  each_pair([&](int x, int y, int i, int j) { contrast += difference(x, y, i, j), ++pairs; });
  const float beta = float(0.5 * double(pairs) / std::max(contrast, 1e-3));

  for (int round = 0; round < 2; ++round) {
    const CutColors in(foreground), out(background);
    std::vector<float> cost(std::size_t(pieces.count), 0);
>>>>>>> f8eba721aaa03928bec211caa3ee974dd64bbb62
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
    open[std::size_t(i)] = reach.at<std::uint8_t>(i / w, i % w) && !in[std::size_t(i)];
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
/// How much a mask looks like a whole thing: the share of its outline where colours change (a difference of 40 codes or
/// more counts whole), times what wheels and a vehicle's proportions add.
inline float wholeness(const Window& window, const Cut& cut) {
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
struct Guess {
  PixelBox box;
  float score = 0;
};
/// A box around the thing at a place of the photo: a mask is grown in a box of the given width, a box laid around it, and
/// so on; the one that is most like a whole thing is kept, of two alike the larger.
inline Guess guess_box(const Image& photo, float x, float y, float width) {
  Guess best;
  PixelBox box{x - 0.5f * width, y - 0.26f * width, x + 0.5f * width, y + 0.26f * width};
  for (int round = 0; round < 4; ++round) {
    const Window window(photo, box.grown(0, photo.width, photo.height), 96);
    const float sx = float(window.image.width) / float(window.w), sy = float(window.image.height) / float(window.h);
    const cv::Point place(int((x - float(window.x)) * sx), int((y - float(window.y)) * sy));
    const Cut cut = cut_out(window, place);
    const PixelBox b = around(cut.labels);
    if (b.area() <= 0) break;
    const PixelBox next{float(window.x) + b.x0 / sx, float(window.y) + b.y0 / sy, float(window.x) + b.x1 / sx,
                        float(window.y) + b.y1 / sy};
    const float score = wholeness(window, cut) * std::pow(next.area(), 0.2f);
    if (score > best.score) best = {next, score};
    if (iou(next, box) > 0.93f) break;
    box = next.grown(0.12f, photo.width, photo.height);
  }
  return best;
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
  const Window window(photo, box, 120);
  const float sx = float(window.image.width) / float(window.w), sy = float(window.image.height) / float(window.h);
  std::array<cv::Mat, 5> masks;
  parallel_for(5, [&](int i) {
    Window shifted = window;
    const PixelBox& b = boxes[i];
    shifted.box = {(b.x0 - float(window.x)) * sx, (b.y0 - float(window.y)) * sy, (b.x1 - float(window.x)) * sx,
                   (b.y1 - float(window.y)) * sy};
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

/// The vehicle in a box, which may be some percent off. The mask is empty where nothing in the box stands out.
inline Segmented segment(const Image& photo, const PixelBox& box, const SegmentOptions& options = {}) {
  Segmented s;
<<<<<<< HEAD
  s.mask = Mask(photo.width, photo.height);
  const PixelBox larger = box.grown(options.slack, photo.width, photo.height);
  if (!(larger.width() >= 4 && larger.height() >= 4)) return s;
  const detail::Window window(photo, larger, options.pixels);
  const cv::Mat labels = detail::cut_out(window, {}).labels;
  const PixelBox b = detail::around(labels);
  if (b.area() <= 0) return s;
  const float sx = float(window.w) / float(window.image.width), sy = float(window.h) / float(window.image.height);
  s.box = {float(window.x) + b.x0 * sx, float(window.y) + b.y0 * sy, float(window.x) + b.x1 * sx,
           float(window.y) + b.y1 * sy};
=======
  const detail::CutWindow window(photo, box.grown(0.02f, photo.width, photo.height), options.pixels);
  const cv::Mat labels = detail::cut_out(window, {});
>>>>>>> f8eba721aaa03928bec211caa3ee974dd64bbb62
  s.mask = window.to_photo(labels, photo);
  if (options.certainty) s.certainty = detail::steadiness(photo, larger);
  return s;
}

/// The vehicle at a place of the photo. The certainty falls, too, when boxes of other sizes lead to other things that are
/// about as whole.
inline Segmented segment(const Image& photo, float x, float y, const SegmentOptions& options = {}) {
  std::vector<detail::Guess> guesses;
  const float large = float(std::max(photo.width, photo.height));
  for (float size = 0.06f; size < 1; size *= 1.35f) guesses.push_back({{}, size * large});
  parallel_for(int(guesses.size()), [&](int i) {
    detail::Guess& g = guesses[std::size_t(i)];
    g = detail::guess_box(photo, x, y, g.score);
  });
  const detail::Guess best = *std::max_element(guesses.begin(), guesses.end(), [](const auto& a, const auto& b) { return a.score < b.score; });
  Segmented s = segment(photo, best.box, options);
  float sum = 0, agree = 0;
  for (const detail::Guess& g : guesses) sum += g.score * g.score, agree += g.score * g.score * iou(g.box, best.box);
  s.certainty *= sum > 0 ? agree / sum : 0;
  return s;
}

}  // namespace burnish
