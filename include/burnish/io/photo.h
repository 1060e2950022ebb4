// burnish/io/photo.h -- photos, masks and rendered pictures, in all formats that OpenImageIO knows
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <burnish/io/file.h>
#include <burnish/scene/image.h>
#include <burnish/scene/mesh.h>

namespace burnish {
namespace detail {
/// The sRGB curve (IEC 61966-2-1), both ways.
inline float from_srgb(float x) { return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f); }
inline float to_srgb(float x) { return x <= 0.0031308f ? x * 12.92f : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f; }

/// A file as it is: channels of a pixel side by side, integers mapped to 0 .. 1.
struct Pixels {
  int width = 0, height = 0, channels = 0, alpha = -1;
  bool integers = false;  // 8 or 16 bit: encoded with the sRGB curve
  std::vector<float> values;
  float at(int x, int y, int c) const { return values[(std::size_t(y) * width + x) * channels + c]; }
};
inline Pixels read_pixels(const std::string& path) {
  if (std::filesystem::is_directory(path)) throw Error(path + ": a folder, expected a picture");
  if (!std::filesystem::exists(path)) throw Error(path + ": no such file");
  OIIO::ImageBuf file(path);
  if (!file.read(0, 0, true, OIIO::TypeDesc::FLOAT)) {
    std::string why = file.geterror();
    std::replace(why.begin(), why.end(), '\n', ' ');
    throw Error(path + ": not a picture that can be read: " + why);
  }
  const OIIO::TypeDesc stored = file.nativespec().format;
  if (file.orientation() > 1) file = OIIO::ImageBufAlgo::reorient(file);  // as the camera was held
  const OIIO::ImageSpec& spec = file.spec();
  Pixels p;
  p.width = spec.width, p.height = spec.height, p.channels = spec.nchannels, p.alpha = spec.alpha_channel;
  p.integers = !stored.is_floating_point();
  p.values.resize(std::size_t(p.width) * p.height * p.channels);
  if (!file.get_pixels(file.roi(), OIIO::TypeDesc::FLOAT, p.values.data())) throw Error(path + ": " + file.geterror());
  return p;
}
inline std::string size_of(int w, int h) { return std::to_string(w) + " x " + std::to_string(h); }

/// Channels side by side to a file of that format ("png": 8 bits; "openexr": float), beside and renamed.
inline void write_pixels(const std::string& path, const char* format, const OIIO::ImageSpec& spec,
                         const float* values) {
  write_beside(path, [&](const std::string& partial) {
    const auto out = OIIO::ImageOutput::create(format);
    if (!out) throw Error(path + ": OpenImageIO cannot write " + format);
    if (!out->open(partial, spec) || !out->write_image(OIIO::TypeDesc::FLOAT, values) || !out->close()) {
      throw Error(path + ": cannot be written: " + out->geterror());
    }
  });
}
/// The same as the bytes of such a file; "png" and "jpeg" can.
inline std::string encoded(const char* format, const OIIO::ImageSpec& spec, const float* values) {
  const auto out = OIIO::ImageOutput::create(format);
  OIIO::Filesystem::IOVecOutput bytes;
  if (!out || !out->set_ioproxy(&bytes) || !out->open("", spec) ||
      !out->write_image(OIIO::TypeDesc::FLOAT, values) || !out->close()) {
    throw Error(std::string("OpenImageIO cannot write ") + format + " into memory" +
                (out ? ": " + out->geterror() : std::string()));
  }
  return std::string(bytes.buffer().begin(), bytes.buffer().end());
}
}  // namespace detail

/// A photo or panorama as linear RGB. 8 and 16 bit files are taken as sRGB, floating point ones as linear; grey becomes
/// RGB, alpha is left out, the camera's orientation tag is obeyed. Error for a NaN or infinite value, naming its pixel.
inline Image read_photo(const std::string& path) {
  const detail::Pixels p = detail::read_pixels(path);
  const bool grey = p.channels < 3;
  Image image(p.width, p.height);
  for (int y = 0; y < p.height; ++y) {
    for (int x = 0; x < p.width; ++x) {
      float rgb[3];
      for (int c = 0; c < 3; ++c) {
        const float v = p.at(x, y, grey ? 0 : c);
        if (!detail::finite(v)) {
          throw Error(path + ": pixel (" + std::to_string(x) + ", " + std::to_string(y) +
                      ") is not a number, expected finite values");
        }
        rgb[c] = p.integers ? detail::from_srgb(v) : v;
      }
      image.set(x, y, {rgb[0], rgb[1], rgb[2]});
    }
  }
  return image;
}

/// A mask, 0 out to 1 in: the alpha channel where there is one, else the encoded grey or luminance, as it is (a soft
/// edge stays soft). With width > 0, Error unless it has the size of the photo.
inline Mask read_mask(const std::string& path, int width = 0, int height = 0) {
  const detail::Pixels p = detail::read_pixels(path);
  if (width > 0 && (p.width != width || p.height != height)) {
    throw Error(path + ": mask " + detail::size_of(p.width, p.height) + ", photo " + detail::size_of(width, height) +
                ": they must agree");
  }
  Mask mask(p.width, p.height);
  for (int y = 0; y < p.height; ++y) {
    for (int x = 0; x < p.width; ++x) {
      const float v = p.alpha >= 0     ? p.at(x, y, p.alpha)
                      : p.channels < 3 ? p.at(x, y, 0)
                                       : 0.2126f * p.at(x, y, 0) + 0.7152f * p.at(x, y, 1) + 0.0722f * p.at(x, y, 2);
      if (!detail::finite(v)) {
        throw Error(path + ": pixel (" + std::to_string(x) + ", " + std::to_string(y) +
                    ") of the mask is not a number");
      }
      mask.at(x, y) = std::clamp(v, 0.0f, 1.0f);
    }
  }
  return mask;
}

/// A picture of numbers, such as part labels: the first channel as stored, 0 .. 255 for 8 bits. The size as in
/// read_mask.
inline std::vector<int> read_labels(const std::string& path, int width = 0, int height = 0) {
  const detail::Pixels p = detail::read_pixels(path);
  if (width > 0 && (p.width != width || p.height != height)) {
    throw Error(path + ": labels " + detail::size_of(p.width, p.height) + ", photo " + detail::size_of(width, height) +
                ": they must agree");
  }
  std::vector<int> labels(std::size_t(p.width) * p.height);
  for (std::size_t i = 0; i < labels.size(); ++i)
    labels[i] = int(std::lround(p.values[i * p.channels] * (p.integers ? 255.0f : 1.0f)));
  return labels;
}

/// 8-bit sRGB; values outside 0 .. 1 are clipped.
inline void write_png(const std::string& path, const Image& image) {
  std::vector<float> rgb(std::size_t(image.width) * image.height * 3);
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    const float v = image.plane(int(i % 3))[i / 3];
    rgb[i] = detail::to_srgb(v > 0 ? std::min(v, 1.0f) : 0.0f);
  }
  detail::write_pixels(path, "png", OIIO::ImageSpec(image.width, image.height, 3, OIIO::TypeDesc::UINT8), rgb.data());
}
/// Grey, 8 bits, without a curve.
inline void write_png(const std::string& path, const Mask& mask) {
  detail::write_pixels(path, "png", OIIO::ImageSpec(mask.width, mask.height, 1, OIIO::TypeDesc::UINT8),
                       mask.values.data());
}
/// Linear 32-bit floats.
inline void write_exr(const std::string& path, const Image& image) {
  std::vector<float> rgb(std::size_t(image.width) * image.height * 3);
  for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = image.plane(int(i % 3))[i / 3];
  OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeDesc::FLOAT);
  spec.attribute("compression", "zip");
  detail::write_pixels(path, "openexr", spec, rgb.data());
}

}  // namespace burnish
