// burnish/io/network.h -- networks from files, run by OpenCV: ONNX, and Darknet's detectors
// SPDX-License-Identifier: Apache-2.0
//
// No network is needed by anything in burnish; where one is at hand, it may say where the vehicle is (detect), and what it
// gives for a photo (Network::run) is used like what was computed elsewhere (io/computed.h).
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>
#include <opencv2/dnn.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <burnish/io/decode.h>
#include <burnish/io/file.h>
#include <burnish/math/color.h>
#include <burnish/scene/image.h>
#include <burnish/scene/tensor.h>
#include <burnish/twin/box.h>

namespace burnish {
namespace detail {
/// As long as it lives, OpenCV prints nothing: what goes wrong is thrown.
class QuietOpenCv {
public:
  QuietOpenCv() : level_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {
    cv::redirectError([](int, const char*, const char*, const char*, int, void*) { return 0; });
  }
  ~QuietOpenCv() {
    cv::redirectError(nullptr);
    cv::utils::logging::setLogLevel(level_);
  }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

private:
  cv::utils::logging::LogLevel level_;
};
}  // namespace detail

/// A network that takes one tensor, 1 x c x h x w, and gives tensors.
class Network {
public:
  /// An ONNX file; or Darknet's two, the plan (.cfg) and the weights. Error where OpenCV cannot read them.
  explicit Network(const std::string& path, const std::string& weights = "") : path_(path) {
    const std::string text = read_text(path);
    if (!weights.empty() && std::filesystem::file_size(existing(weights)) < 20)
      throw Error(weights + ": too short, expected Darknet's weights");
    attempt("cannot be read as a network", [&] {
      net_ = weights.empty() ? cv::dnn::readNetFromONNX(path) : cv::dnn::readNetFromDarknet(path, weights);
      if (net_.empty()) throw Error(path + ": a network without layers");
      net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    });
    if (weights.empty()) return;
    // [net] width=320 height=320
    for (int k = 0; k < 2; ++k) {
      const std::size_t at = text.find(k ? "\nheight=" : "\nwidth=");
      size_[std::size_t(k)] = at == text.npos ? 0 : std::atoi(text.c_str() + text.find('=', at) + 1);
      if (size_[std::size_t(k)] < 1 || size_[std::size_t(k)] > 16384)
        throw Error(path + ": no width and height of the input, expected them in [net]");
    }
  }
  const std::string& path() const { return path_; }
  /// The size of the picture that a Darknet plan asks for; 0 where the file does not say.
  int width() const { return size_[0]; }
  int height() const { return size_[1]; }

  /// Every output, by its name.
  NamedTensors run(const Tensor& input) {
    NamedTensors out;
    const std::vector<int> shape(input.shape.begin(), input.shape.end());
    attempt("cannot be run on " + detail::shape_text(input.shape), [&] {
      net_.setInput(cv::Mat(shape, CV_32F, const_cast<float*>(input.values.data())));
      const std::vector<cv::String> names = net_.getUnconnectedOutLayersNames();
      std::vector<cv::Mat> outputs;
      net_.forward(outputs, names);
      for (std::size_t k = 0; k < outputs.size(); ++k) {
        const cv::Mat m = outputs[k].isContinuous() ? outputs[k] : outputs[k].clone();
        if (m.type() != CV_32F) throw Error(path_ + ": output " + names[k] + " is not of floats");
        Tensor& t = out.tensors[names[k]];
        for (int d = 0; d < m.dims; ++d) t.shape.push_back(std::size_t(m.size[d]));
        t.values.assign(m.ptr<float>(), m.ptr<float>() + m.total());
      }
    });
    return out;
  }

private:
  std::string path_;
  cv::dnn::Net net_;
  std::array<int, 2> size_{};

  static const std::string& existing(const std::string& path) {
    if (!std::filesystem::is_regular_file(path)) throw Error(path + ": no such file");
    return path;
  }
  template <class F> void attempt(const std::string& what, F f) {
    const detail::QuietOpenCv quiet;
    try {
      f();
    } catch (const cv::Exception& e) {
      std::string why = e.err.substr(0, 200);
      std::replace_if(
          why.begin(), why.end(), [](char c) { return static_cast<unsigned char>(c) < 32; }, ' ');
      throw Error(path_ + ": " + what + ": OpenCV says: " + why);
    }
  }
};

/// A photo as networks want it, 1 x 3 x height x width: encoded (sRGB) red, green, blue, (code - mean) / deviation, codes
/// 0 .. 1. Stretched to that size as codes, not as light: so were the pictures that networks learn from.
inline Tensor network_input(const Image& photo, int width, int height, const std::array<float, 3>& mean = {0, 0, 0},
                            const std::array<float, 3>& deviation = {1, 1, 1}) {
  Image codes = photo;
  for (float& v : codes.values) v = srgb_from_linear(std::clamp(v, 0.0f, 1.0f));
  const Image small = resized(codes, width, height);
  Tensor t{{1, 3, std::size_t(height), std::size_t(width)}, {}};
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < width * height; ++i)
      t.values.push_back((small.plane(c)[i] - mean[std::size_t(c)]) / deviation[std::size_t(c)]);
  return t;
}

struct Detection {
  PixelBox box;     // in the photo
  int kind = 0;     // the number of the class, from 0
  float score = 0;  // 0 .. 1
};
/// Cars, buses and trucks in the order of COCO's 80 names.
inline bool is_vehicle(int coco_kind) { return coco_kind == 2 || coco_kind == 5 || coco_kind == 7; }

/// What a Darknet detector (YOLO) finds, the surest first; of boxes that overlap by more than 0.45 (IoU) the surest.
inline std::vector<Detection> detect(Network& yolo, const Image& photo, float least = 0.25f) {
  if (yolo.width() < 1) throw Error(yolo.path() + ": not a Darknet detector, expected a .cfg file with its weights");
  const NamedTensors found = yolo.run(network_input(photo, yolo.width(), yolo.height()));
  std::vector<Detection> all, kept;
  for (const auto& [name, t] : found.tensors) {
    // Rows of centre, size (of the picture: 0 .. 1), any object's score, each class's score.
    if (t.shape.size() != 2 || t.shape[1] < 6)
      throw Error(yolo.path() + ": output " + detail::shape_text(t.shape) + ", expected rows of boxes and scores");
    for (std::size_t r = 0; r < t.shape[0]; ++r) {
      const float* row = t.values.data() + r * t.shape[1];
      const float* best = std::max_element(row + 5, row + t.shape[1]);
      if (!(*best >= least)) continue;
      const float w = float(photo.width), h = float(photo.height);
      const PixelBox box{(row[0] - 0.5f * row[2]) * w, (row[1] - 0.5f * row[3]) * h, (row[0] + 0.5f * row[2]) * w,
                         (row[1] + 0.5f * row[3]) * h};
      all.push_back({box.grown(0, photo.width, photo.height), int(best - row - 5), *best});
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Detection& a, const Detection& b) { return a.score > b.score; });
  for (const Detection& d : all)
    if (std::none_of(kept.begin(), kept.end(), [&](const Detection& k) { return iou(k.box, d.box) > 0.45f; }))
      kept.push_back(d);
  return kept;
}
/// The surest vehicle with that place of the photo in its box.
inline std::optional<Detection> vehicle_at(const std::vector<Detection>& found, float x, float y) {
  for (const Detection& d : found)
    if (is_vehicle(d.kind) && d.box.contains(x, y)) return d;
  return std::nullopt;
}

}  // namespace burnish
