// burnish/io/report.h -- pictures about pictures: a sheet with captions, a curve
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <burnish/io/page.h>

namespace burnish {

namespace detail {
inline OIIO::ImageBuf buffer_of(const Image& image) {
  OIIO::ImageBuf b(OIIO::ImageSpec(image.width, image.height, 3, OIIO::TypeDesc::FLOAT));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const vec3<float> c = image.at(x, y);
      const float rgb[3] = {c.x, c.y, c.z};
      b.setpixel(x, y, rgb);
    }
  return b;
}
inline Image image_of(const OIIO::ImageBuf& b) {
  Image image(b.spec().width, b.spec().height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      float rgb[3];
      b.getpixel(x, y, rgb, 3);
      image.set(x, y, {rgb[0], rgb[1], rgb[2]});
    }
  return image;
}
/// Where no font is found the picture goes without.
inline void write_on(OIIO::ImageBuf& b, int x, int y, const std::string& text, int size, float grey) {
  const float color[3] = {grey, grey, grey};
  (void)OIIO::ImageBufAlgo::render_text(b, x, y, text, size, "DejaVuSans", color);
  (void)b.geterror();
  (void)OIIO::geterror();
}
}  // namespace detail

/// A picture and the words over it.
struct Panel {
  std::string caption;
  Image image;  // linear RGB, all of one size
};
/// Panels side by side, `columns` a row, a caption over each. Linear RGB.
inline Image sheet(const std::vector<Panel>& panels, int columns) {
  constexpr int bar = 26, gap = 6;
  const int w = panels.front().image.width, h = panels.front().image.height;
  const int rows = (int(panels.size()) + columns - 1) / columns;
  Image out(columns * (w + gap) + gap, rows * (h + bar + gap) + gap, {0.01f, 0.01f, 0.01f});
  for (int i = 0; i < int(panels.size()); ++i)
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        out.set(gap + i % columns * (w + gap) + x, gap + bar + i / columns * (h + bar + gap) + y,
                panels[std::size_t(i)].image.at(x, y));
  OIIO::ImageBuf b = detail::buffer_of(out);
  for (int i = 0; i < int(panels.size()); ++i)
    detail::write_on(b, gap + 4 + i % columns * (w + gap), gap + 19 + i / columns * (h + bar + gap),
                     panels[std::size_t(i)].caption, 16, 0.8f);
  return detail::image_of(b);
}

/// A line of positive values against their number, on a logarithmic scale when they span more than a factor of 3. Linear RGB.
inline Image curve(const std::vector<double>& values, const std::string& title) {
  constexpr int w = 720, h = 360, left = 70, right = 20, top = 40, bottom = 40;
  OIIO::ImageBuf b = detail::buffer_of(Image(w, h, {0.95f, 0.95f, 0.95f}));
  const float axis[3] = {0.3f, 0.3f, 0.3f}, line[3] = {0.02f, 0.12f, 0.5f}, grid[3] = {0.75f, 0.75f, 0.75f};
  detail::write_on(b, left, 26, title, 16, 0.05f);
  double low = 1e300, high = 0;
  for (const double v : values) low = std::min(low, v), high = std::max(high, v);
  if (values.empty() || !(high > 0) || !(low > 0)) return detail::image_of(b);
  const bool logarithmic = high > 3 * low;
  if (!logarithmic) low = 0;
  if (high <= low) high = low + 1;
  const auto place = [&](double v) {
    const double t = logarithmic ? std::log(v / low) / std::log(high / low) : (v - low) / (high - low);
    return int(std::lround(h - bottom - t * (h - top - bottom)));
  };
  const auto across = [&](std::size_t i) {
    return left + int(double(i) * (w - left - right) / std::max<double>(1, double(values.size()) - 1));
  };
  for (int k = 0; k <= 4; ++k) {
    const double v = logarithmic ? low * std::pow(high / low, k / 4.0) : low + (high - low) * k / 4.0;
    OIIO::ImageBufAlgo::render_line(b, left, place(v), w - right, place(v), grid);
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", v);
    detail::write_on(b, 10, place(v) + 5, text, 13, 0.1f);
    const std::size_t i = (values.size() - 1) * std::size_t(k) / 4;
    detail::write_on(b, across(i) - 8, h - 15, std::to_string(i + 1), 13, 0.1f);
  }
  OIIO::ImageBufAlgo::render_line(b, left, top, left, h - bottom, axis);
  for (std::size_t i = 1; i < values.size(); ++i)
    for (const int thick : {0, 1})
      OIIO::ImageBufAlgo::render_line(b, across(i - 1), place(values[i - 1]) + thick, across(i),
                                      place(values[i]) + thick, line);
  return detail::image_of(b);
}

}  // namespace burnish
