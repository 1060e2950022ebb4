// tests/io/network.cpp -- networks that the test writes byte by byte, against their sums in C++
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include <record.h>
#include "files.h"
#include <burnish/io/network.h>

using namespace burnish;
using files::error_of;

namespace {
// ---- ONNX is protocol buffers: a field is its number and kind, then a whole number (0) or a length and bytes (2).
std::string varint(std::uint64_t n) {
  std::string s;
  for (; n >= 128; n >>= 7) s += char(n | 128);
  return s + char(n);
}
std::string field(int number, std::uint64_t n) { return varint(std::uint64_t(number) << 3) + varint(n); }
std::string field(int number, const std::string& bytes) {
  return varint(std::uint64_t(number) << 3 | 2) + varint(bytes.size()) + bytes;
}
std::string value_info(const std::string& name, const std::vector<int>& shape) {
  std::string dims;
  for (const int n : shape) dims += field(1, field(1, std::uint64_t(n)));
  return field(1, name) + field(2, field(1, field(1, std::uint64_t(1)) + field(2, dims)));
}
std::string initializer(const std::string& name, const std::vector<int>& shape, const std::vector<float>& values) {
  std::string s;
  for (const int n : shape) s += field(1, std::uint64_t(n));
  s += field(2, std::uint64_t(1)) + field(8, name);
  return s + field(9, std::string(reinterpret_cast<const char*>(values.data()), values.size() * 4));
}
std::string whole_numbers(const std::string& name, const std::vector<int>& list) {
  std::string s = field(1, name);
  for (const int n : list) s += field(8, std::uint64_t(n));
  return field(5, s + field(20, std::uint64_t(7)));
}
std::string model(const std::string& graph) {
  return field(1, std::uint64_t(6)) + field(8, field(2, std::uint64_t(11))) +
         field(7, graph + field(2, std::string("g")));
}
std::vector<float> numbers(std::mt19937& random, std::size_t n) {
  std::vector<float> v(n);
  for (float& x : v) x = float(random() % 2001) / 1000 - 1;
  return v;
}
}  // namespace

TEST_CASE("Network: an ONNX convolution with a rectifier gives the sums", "[io][agreement]") {
  const files::Folder folder;
  constexpr int in = 3, out = 4, h = 7, w = 9;
  std::mt19937 random(3);
  const std::vector<float> kernel = numbers(random, out * in * 9), bias = numbers(random, out);
  const std::string node = field(1, std::string("x")) + field(1, std::string("k")) + field(1, std::string("b")) +
                           field(2, std::string("c")) + field(4, std::string("Conv")) +
                           whole_numbers("kernel_shape", {3, 3}) + whole_numbers("pads", {1, 1, 1, 1});
  const std::string rectifier = field(1, std::string("c")) + field(2, std::string("y")) + field(4, std::string("Relu"));
  const std::string file = folder.write(
      "conv.onnx", model(field(1, node) + field(1, rectifier) + field(5, initializer("k", {out, in, 3, 3}, kernel)) +
                         field(5, initializer("b", {out}, bias)) + field(11, value_info("x", {1, in, h, w})) +
                         field(12, value_info("y", {1, out, h, w}))));
  Network net(file);
  Tensor x{{1, in, h, w}, numbers(random, in * h * w)};
  const NamedTensors result = net.run(x);
  REQUIRE(result.tensors.size() == 1);
  const Tensor& y = result.tensors.begin()->second;
  REQUIRE(y.shape == std::vector<std::size_t>{1, out, h, w});
  record::Worst worst;
  for (int o = 0; o < out; ++o)
    for (int j = 0; j < h; ++j)
      for (int i = 0; i < w; ++i) {
        double sum = double(bias[std::size_t(o)]);
        for (int c = 0; c < in; ++c)
          for (int v = 0; v < 3; ++v)
            for (int u = 0; u < 3; ++u) {
              const int a = j + v - 1, b = i + u - 1;
              if (a >= 0 && a < h && b >= 0 && b < w)
                sum += double(kernel[std::size_t(((o * in + c) * 3 + v) * 3 + u)]) * double(x(0, c, a, b));
            }
        worst(std::abs(double(y(0, o, j, i)) - std::max(sum, 0.0)));
      }
  record::claim("Network::run", "value", "an ONNX file's convolution, summed in double", 1e-5, worst.value,
                out * h * w);
  CHECK(error_of([&] {
          net.run({{1, 2, h, w}, std::vector<float>(2 * h * w)});
        }).find(file + ": cannot be run on [1, 2, 7, 9]") == 0);
}

TEST_CASE("Network: an ONNX product of a flattened picture is an embedding", "[io][agreement]") {
  const files::Folder folder;
  std::mt19937 random(4);
  const std::vector<float> matrix = numbers(random, 5 * 12);
  const std::string flatten =
      field(1, std::string("x")) + field(2, std::string("f")) + field(4, std::string("Flatten"));
  const std::string product = field(1, std::string("f")) + field(1, std::string("m")) + field(2, std::string("y")) +
                              field(4, std::string("MatMul"));
  Network net(folder.write("embed.onnx",
                           model(field(1, flatten) + field(1, product) + field(5, initializer("m", {12, 5}, matrix)) +
                                 field(11, value_info("x", {1, 3, 2, 2})) + field(12, value_info("y", {1, 5})))));
  Image photo(2, 2, {0.5f, 0.1f, 1});
  photo.set(1, 0, {0, 0.3f, 0.2f});
  const Tensor x = network_input(photo, 2, 2, {0.5f, 0.5f, 0.5f}, {0.25f, 0.25f, 0.25f});
  CHECK(x(0, 0, 0, 0) == Approx((0.7353569831 - 0.5) / 0.25));  // the sRGB code of 0.5
  CHECK(x(0, 2, 1, 1) == Approx(2));
  CHECK(x(0, 0, 0, 1) == Approx(-2));
  const NamedTensors result = net.run(x);
  const Tensor& y = result.tensors.begin()->second;
  REQUIRE(y.size() == 5);
  for (std::size_t k = 0; k < 5; ++k) {
    double sum = 0;
    for (std::size_t i = 0; i < 12; ++i) sum += double(matrix[i * 5 + k]) * double(x.values[i]);
    CHECK(y.values[k] == Approx(sum).margin(1e-5));
  }
}

TEST_CASE("Network: its input is stretched as codes, half of white and black is 1/2", "[io][value]") {
  Image photo(2, 1);
  photo.set(0, 0, {1, 1, 1});
  const Tensor x = network_input(photo, 1, 1);
  REQUIRE(x.size() == 3);
  for (const float v : x.values) CHECK(v == Approx(0.5).margin(1e-6));  // the code of the mean light is 0.735
}

namespace {
/// A detector of one cell: any picture has one object in its middle, as large as its anchor; a bias says how sure, and the
/// colour says of which of eight classes: red 2, blue 0.
struct OneCell {
  std::string plan, weights;
  OneCell(const files::Folder& folder, float sure) {
    plan = folder.write("one.cfg",
                        "[net]\nwidth=32\nheight=32\nchannels=3\n\n[convolutional]\nfilters=13\nsize=1\nstride=32\n"
                        "pad=0\nactivation=linear\n\n[yolo]\nmask=0\nanchors=16,8\nclasses=8\nnum=1\n");
    std::vector<float> bias(13, 0), kernel(13 * 3, 0);
    bias[4] = sure;
    for (std::size_t k = 5; k < 13; ++k) bias[k] = -6;
    kernel[(5 + 2) * 3 + 0] = 12, kernel[(5 + 0) * 3 + 2] = 12;
    std::string bytes(20, '\0');  // version 0.2.0, a count of 8 bytes
    bytes[4] = 2;
    for (const auto* list : {&bias, &kernel})
      bytes.append(reinterpret_cast<const char*>(list->data()), list->size() * 4);
    weights = folder.write("one.weights", bytes);
  }
};
}  // namespace

TEST_CASE("Detector: a Darknet network of one cell finds its anchor, and the class by the colour", "[io][value]") {
  const files::Folder folder;
  const OneCell files(folder, 6);
  Network yolo(files.plan, files.weights);
  CHECK(yolo.width() == 32);
  CHECK(yolo.height() == 32);
  const std::vector<Detection> red = detect(yolo, Image(64, 48, {1, 0, 0})),
                               blue = detect(yolo, Image(64, 48, {0, 0, 1}));
  REQUIRE(red.size() == 1);
  REQUIRE(blue.size() == 1);
  // Centre: logistic(0) = 0.5 of the only cell; size: the anchor's share of 32 pixels.
  CHECK(red[0].box.x0 == Approx(64 * 0.25));
  CHECK(red[0].box.x1 == Approx(64 * 0.75));
  CHECK(red[0].box.y0 == Approx(48 * 0.375));
  CHECK(red[0].box.y1 == Approx(48 * 0.625));
  const double logistic = 1 / (1 + std::exp(-6.0));
  CHECK(red[0].score == Approx(logistic * logistic));
  CHECK(red[0].kind == 2);
  CHECK(blue[0].kind == 0);
  CHECK(is_vehicle(red[0].kind));
  CHECK(vehicle_at(red, 32, 24));
  CHECK(!vehicle_at(red, 8, 24));
  CHECK(!vehicle_at(blue, 32, 24));
  CHECK(detect(yolo, Image(64, 48, {1, 0, 0}), 0.999f).empty());
}

TEST_CASE("Network: files that are none are refused in one line", "[io][limit]") {
  const files::Folder folder;
  const OneCell files(folder, 6);
  const auto line = [&](const std::string& path, const std::string& weights) {
    const std::string said = error_of([&] { Network(path, weights); });
    CHECK(said.find('\n') == std::string::npos);
    return said;
  };
  CHECK(line(folder / "none.onnx", "") == (folder / "none.onnx") + ": no such file");
  const std::string text = folder.write("text.onnx", "not a network at all");
  CHECK(line(text, "").find(text + ": cannot be read as a network: OpenCV says: ") == 0);
  CHECK(line(files.plan, folder / "none.weights") == (folder / "none.weights") + ": no such file");
  CHECK(line(files.plan, folder.write("short.weights", "abc")).find("too short") != std::string::npos);
  const std::string unknown =
      folder.write("unknown.cfg", "[net]\nwidth=32\nheight=32\nchannels=3\n\n[dream]\nfilters=8\n");
  CHECK(line(unknown, files.weights).find(unknown + ": cannot be read as a network") == 0);
  const std::string sizeless = folder.write("sizeless.cfg", "[net]\nchannels=3\n");
  CHECK(line(sizeless, files.weights).find(sizeless + ": ") == 0);
}
