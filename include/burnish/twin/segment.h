// burnish/twin/segment.h -- a vehicle's mask from a point inside it or a box around it
// SPDX-License-Identifier: Apache-2.0
//
// Colours inside and outside the box are learnt by GrabCut (Rother et al. 2004, OpenCV's). Its labels are made anew on
// superpixels, where a vehicle's usual shape has a say, and once more on the pixels along the outline.
#pragma once
#include <array>
#include <map>
#include <utility>
#include <cmath>
#include <optional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <burnish/scene/image.h>
#include <burnish/twin/box.h>
#include <burnish/twin/cut.h>
#include <burnish/twin/superpixels.h>

namespace burnish {

struct SegmentOptions {
  int pixels = 360;      // the longer side of the box, at most, in the picture that is worked on
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
  return std::clamp(4 * (0.97f - r), -2.0f, 2.0f);
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

/// 255 in, 0 out, for the window's box.
inline cv::Mat cut_out(const CutWindow& window, std::optional<cv::Point> place) {
  const int w = window.image.width, h = window.image.height;
  const PixelBox& b = window.box;
  cv::Mat odds(h, w, CV_32F), labels(h, w, CV_8U);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const float px = float(x) + 0.5f, py = float(y) + 0.5f;
      const float o = shape_odds(2 * (px - b.x0) / b.width() - 1, 2 * (py - b.y0) / b.height() - 1);
      odds.at<float>(y, x) = o;
      labels.at<std::uint8_t>(y, x) = std::uint8_t(!b.contains(px, py) ? cv::GC_BGD : o > 0 ? cv::GC_PR_FGD : cv::GC_PR_BGD);
    }
  const cv::Mat outside = labels == cv::GC_BGD;
  if (cv::countNonZero(outside) == 0) {  // a box as large as the photo: its rim is background
    cv::rectangle(labels, {0, 0, w, h}, cv::GC_BGD, 2);
  }
  if (place) cv::circle(labels, *place, 2, cv::GC_FGD, -1);
  cv::Mat background, foreground;
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
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const cv::Vec3b& c = window.codes.at<cv::Vec3b>(y, x);
        float& sum = cost[std::size_t(label_of(x, y))];
        if (outside.at<std::uint8_t>(y, x)) sum -= 100;
        else sum += std::clamp(in.log(c) - out.log(c), -3.0f, 3.0f) + odds.at<float>(y, x);
      }
    if (place) cost[std::size_t(label_of(place->x, place->y))] = 1e6f;
    MinimumCut graph(pieces.count);
    for (int k = 0; k < pieces.count; ++k) graph.node(k, 0, cost[std::size_t(k)]);
    std::map<std::pair<int, int>, float> edges;
    each_pair([&](int x, int y, int i, int j) {
      const int p = label_of(x, y), q = label_of(i, j);
      if (p != q) edges[std::minmax(p, q)] += 50 * std::exp(-beta * difference(x, y, i, j));
    });
    for (const auto& [pair, weight] : edges) graph.edge(pair.first, pair.second, weight);
    const std::vector<bool> inside = graph.solve();
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        std::uint8_t& label = labels.at<std::uint8_t>(y, x);
        label = std::uint8_t(inside[std::size_t(label_of(x, y))] ? cv::GC_PR_FGD : cv::GC_PR_BGD);
        if (outside.at<std::uint8_t>(y, x)) label = cv::GC_BGD;
      }
    if (place) cv::circle(labels, *place, 2, cv::GC_FGD, -1);
    if (round == 1) break;
    cv::Mat again = labels.clone();
    cv::grabCut(window.codes, again, {}, background, foreground, 1, cv::GC_EVAL);
  }
  // Along the outline the pixels decide.
  const cv::Mat mine = one_piece((labels & 1) * 255, place);
  cv::Mat core, reach;
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {step, step});
  cv::erode(mine, core, disc), cv::dilate(mine, reach, disc);
  labels.setTo(cv::GC_BGD, reach == 0);
  labels.setTo(cv::GC_FGD, core);
  if (cv::countNonZero(core) > 0) cv::grabCut(window.codes, labels, {}, background, foreground, 1, cv::GC_EVAL);
  cv::Mat smooth;
  cv::morphologyEx((labels & 1) * 255, smooth, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3}));
  return one_piece(smooth, place);
}
}  // namespace detail

/// The vehicle in a box, which may be some percent off. The mask is empty where nothing in the box stands out.
inline Segmented segment(const Image& photo, const PixelBox& box, const SegmentOptions& options = {}) {
  Segmented s;
  const detail::CutWindow window(photo, box.grown(0.02f, photo.width, photo.height), options.pixels);
  const cv::Mat labels = detail::cut_out(window, {});
  s.mask = window.to_photo(labels, photo);
  return s;
}

}  // namespace burnish
