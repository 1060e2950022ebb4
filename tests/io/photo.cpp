// tests/io/photo.cpp -- pictures there and back, and files that are wrong
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include "files.h"
#include <burnish/io/photo.h>

using namespace burnish;
using files::error_of;

namespace {
Image gradient() {
  Image image(19, 11);
  for (int y = 0; y < 11; ++y) {
    for (int x = 0; x < 19; ++x) image.set(x, y, {float(x) / 18, float(y) / 10, float(x * y) / 180});
  }
  return image;
}
}  // namespace

TEST_CASE("Photo: an EXR comes back to the bit, a PNG within half a step of its 8 bits", "[io][agreement]") {
  const files::Folder folder;
  const Image image = gradient();
  write_exr(folder / "a.exr", image);
  write_png(folder / "a.png", image);
  const Image exr = read_photo(folder / "a.exr"), png = read_photo(folder / "a.png");
  REQUIRE(png.width == 19);
  REQUIRE(png.height == 11);
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < 19 * 11; ++i) {
      const float v = image.plane(c)[i], encoded = detail::to_srgb(v);
      CHECK(exr.plane(c)[i] == v);
      CHECK(std::abs(detail::to_srgb(png.plane(c)[i]) - encoded) <= 0.5f / 255 + 1e-4f);
    }
  }
  CHECK(folder.count() == 2);  // no .partial left
}

TEST_CASE("Photo: the sRGB curve is the standard's", "[io][value]") {
  // IEC 61966-2-1: code 0.5 is 0.21404 in linear light, code 0.04 lies on the straight part.
  CHECK(detail::from_srgb(0.5f) == Approx(0.2140411));
  CHECK(detail::from_srgb(0.04f) == Approx(0.04 / 12.92));
  for (float x : {0.0f, 0.002f, 0.1f, 0.7f, 1.0f})
    CHECK(detail::from_srgb(detail::to_srgb(x)) == Approx(x).margin(1e-6));
}

TEST_CASE("Photo: a value that is no number is refused with its pixel", "[io][limit]") {
  const files::Folder folder;
  Image image = gradient();
  image.plane(1)[3 * 19 + 7] = std::nanf("");
  write_exr(folder / "nan.exr", image);
  CHECK(error_of([&] { read_photo(folder / "nan.exr"); }).find("pixel (7, 3) is not a number") != std::string::npos);
  image.plane(1)[3 * 19 + 7] = std::numeric_limits<float>::infinity();
  write_exr(folder / "inf.exr", image);
  CHECK(error_of([&] { read_photo(folder / "inf.exr"); }).find("(7, 3)") != std::string::npos);
}

TEST_CASE("Photo: no file, a folder and a text are told apart", "[io][limit]") {
  const files::Folder folder;
  CHECK(error_of([&] { read_photo(folder / "none.png"); }) == (folder / "none.png") + ": no such file");
  CHECK(error_of([&] { read_photo(folder.path.string()); }).find("a folder, expected a picture") != std::string::npos);
  const std::string text = folder.write("text.png", "not a picture at all");
  const std::string error = error_of([&] { read_photo(text); });
  CHECK(error.find(text + ": not a picture that can be read") == 0);
  CHECK(error.find('\n') == std::string::npos);
}

TEST_CASE("Mask: must have the size of the photo", "[io][limit]") {
  const files::Folder folder;
  Mask mask(64, 48);
  mask.at(5, 6) = 0.5f, mask.at(63, 47) = 1;
  write_png(folder / "m.png", mask);
  const Mask back = read_mask(folder / "m.png", 64, 48);
  CHECK(back.at(5, 6) == Approx(0.5).margin(0.003));
  CHECK(back.at(63, 47) == 1);
  CHECK(back.at(0, 0) == 0);
  CHECK(error_of([&] { read_mask(folder / "m.png", 768, 576); }) ==
        (folder / "m.png") + ": mask 64 x 48, photo 768 x 576: they must agree");
  CHECK(error_of([&] { read_labels(folder / "m.png", 768, 576); }).find("they must agree") != std::string::npos);
}

TEST_CASE("Mask: alpha where there is one, else the luminance", "[io][value]") {
  const files::Folder folder;
  Image image(4, 4, {1, 1, 1});
  image.set(1, 2, {0, 0, 0});
  write_png(folder / "rgb.png", image);
  const Mask grey = read_mask(folder / "rgb.png");
  CHECK(grey.at(0, 0) == Approx(1));
  CHECK(grey.at(1, 2) == 0);
  std::vector<float> rgba(4 * 4 * 4, 1.0f);
  rgba[4 * 5 + 3] = 0;
  detail::write_pixels(folder / "rgba.png", "png", OIIO::ImageSpec(4, 4, 4, OIIO::TypeDesc::UINT8), rgba.data());
  const Mask alpha = read_mask(folder / "rgba.png");
  CHECK(alpha.at(1, 1) == 0);
  CHECK(alpha.at(2, 2) == 1);
}

TEST_CASE("Labels: come back as the numbers they are", "[io][value]") {
  const files::Folder folder;
  Mask labels(8, 8);
  for (int i = 0; i < 64; ++i) labels.values[i] = float(i % 5) / 255;
  write_png(folder / "l.png", labels);
  const auto back = read_labels(folder / "l.png", 8, 8);
  for (int i = 0; i < 64; ++i) CHECK(back[i] == i % 5);
}

TEST_CASE("Files: what cannot be written is refused, and nothing is half-written", "[io][limit]") {
  const files::Folder folder;
  const std::string file = folder.write("file", "in the way");
  CHECK(error_of([&] { check_writable(file + "/out"); }).find(file + "/out: not a folder that can be made") == 0);
  CHECK(error_of([&] { write_png(file + "/out.png", Image(2, 2)); }).find(file + "/out.png: cannot be written") == 0);
  check_writable(folder / "deep/er");
  CHECK(std::filesystem::is_empty(folder / "deep/er"));
  folder.write("kept.txt", "old");
  CHECK(error_of([&] {
          write_beside(folder / "kept.txt", [](const std::string& partial) {
            std::ofstream(partial) << "half";
            throw Error("stopped");
          });
        }) == "stopped");
  CHECK(read_text(folder / "kept.txt") == "old");
  CHECK(!std::filesystem::exists(folder / "kept.txt.partial"));
  std::filesystem::create_directory(folder / "taken.png");  // a folder where the file should go: renaming fails
  folder.write("taken.png/x", "");
  CHECK(error_of([&] { write_png(folder / "taken.png", Image(2, 2)); }).find("cannot be written") != std::string::npos);
  CHECK(!std::filesystem::exists(folder / "taken.png.partial"));
}
