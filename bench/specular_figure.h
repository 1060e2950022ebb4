// bench/specular_figure.h -- curves by roughness as an SVG: the error on a logarithmic axis, the wrong signs beside it
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>
#include <burnish/scene/error.h>

namespace specular_figure {

struct Curve {
  std::string name, color;
  std::vector<double> middle, least, most;  // a value a roughness; the band from least to most
  bool dashed = false;
};
struct Panel {
  std::string title;
  bool logarithmic = false;
  double low = 0, high = 100, limit = 0;  // limit: a dotted line, 0 for none
  std::vector<double> marks;
  std::vector<Curve> curves;
};

inline std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}
/// A panel's drawing, its plot's upper left corner at x, y.
inline std::string draw(const Panel& p, const std::vector<double>& roughness, double x, double y, double w, double h) {
  std::ostringstream out;
  const auto across = [&](double r) {
    return x + w * std::log(r / roughness.front()) / std::log(roughness.back() / roughness.front());
  };
  const auto up = [&](double v) {
    const double c = std::min(std::max(v, p.low), p.high);
    return y + h -
           h * (p.logarithmic ? std::log(c / p.low) / std::log(p.high / p.low) : (c - p.low) / (p.high - p.low));
  };
  const auto text = [&](double at_x, double at_y, const char* anchor, const std::string& what, const char* more = "") {
    out << "<text x='" << number(at_x) << "' y='" << number(at_y) << "' text-anchor='" << anchor << "' " << more << ">"
        << what << "</text>\n";
  };
  const auto line = [&](double x0, double y0, double x1, double y1, const char* style) {
    out << "<line x1='" << number(x0) << "' y1='" << number(y0) << "' x2='" << number(x1) << "' y2='" << number(y1)
        << "' " << style << "/>\n";
  };
  text(x, y - 14, "start", p.title, "font-size='15' font-weight='600' fill='#222'");
  for (const double m : p.marks) {
    line(x, up(m), x + w, up(m), "stroke='#e4e4e4'");
    text(x - 8, up(m) + 4, "end", number(m) + " %");
  }
  for (const double r : roughness) {
    line(across(r), y + h, across(r), y + h + 5, "stroke='#888'");
    text(across(r), y + h + 20, "middle", number(r));
  }
  text(x + w / 2, y + h + 42, "middle", "perceptual roughness");
  if (p.limit > 0) line(x, up(p.limit), x + w, up(p.limit), "stroke='#555' stroke-dasharray='2 4'");
  for (const Curve& c : p.curves) {
    const std::size_t n = roughness.size();
    out << "<path fill='" << c.color << "' fill-opacity='0.13' d='M";
    for (std::size_t i = 0; i < n; ++i) out << number(across(roughness[i])) << " " << number(up(c.most[i])) << " L";
    for (std::size_t i = n; i-- > 0;)
      out << number(across(roughness[i])) << " " << number(up(c.least[i])) << (i ? " L" : " Z'/>\n");
    out << "<polyline fill='none' stroke='" << c.color << "' stroke-width='2.2'"
        << (c.dashed ? " stroke-dasharray='7 4'" : "") << " points='";
    for (std::size_t i = 0; i < n; ++i) out << number(across(roughness[i])) << "," << number(up(c.middle[i])) << " ";
    out << "'/>\n";
    for (std::size_t i = 0; i < n; ++i)
      out << "<circle cx='" << number(across(roughness[i])) << "' cy='" << number(up(c.middle[i])) << "' r='3' fill='"
          << c.color << "'/>\n";
  }
  line(x, y + h, x + w, y + h, "stroke='#888'");
  line(x, y, x, y + h, "stroke='#888'");
  return out.str();
}
/// Panels side by side, one legend (the first panel's curves) below. Written beside and renamed; Error if it cannot be.
inline void write(const std::string& path, const std::string& title, const std::vector<double>& roughness,
                  const std::vector<Panel>& panels) {
  constexpr double w = 380, h = 290, left = 74, top = 86, gap = 96;
  const double width = left + double(panels.size()) * w + double(panels.size() - 1) * gap + 30, height = top + h + 118;
  std::ostringstream out;
  out << "<svg xmlns='http://www.w3.org/2000/svg' width='" << width << "' height='" << height << "' viewBox='0 0 "
      << width << " " << height << "' font-family='Helvetica, Arial, sans-serif' font-size='12' fill='#444'>\n"
      << "<rect width='100%' height='100%' fill='white'/>\n<text x='" << left
      << "' y='34' font-size='18' font-weight='600' fill='#222'>" << title << "</text>\n";
  for (std::size_t i = 0; i < panels.size(); ++i)
    out << draw(panels[i], roughness, left + double(i) * (w + gap), top, w, h);
  double x = left;
  for (const Curve& c : panels[0].curves) {
    const double y = top + h + 76;
    out << "<line x1='" << x << "' y1='" << y << "' x2='" << x + 34 << "' y2='" << y << "' stroke='" << c.color
        << "' stroke-width='2.2'" << (c.dashed ? " stroke-dasharray='7 4'" : "") << "/>\n<text x='" << x + 42 << "' y='"
        << y + 4 << "'>" << c.name << "</text>\n";
    x += 62 + 6.6 * double(c.name.size());
  }
  out << "<text x='" << left << "' y='" << height - 14
      << "' fill='#777'>Lines: all panoramas. Bands: from the best of them to the worst.</text>\n</svg>\n";
  const std::string partial = path + ".partial";
  std::ofstream file(partial);
  file << out.str();
  file.close();
  std::error_code failed;
  if (file) std::filesystem::rename(partial, path, failed);
  if (!file || failed) throw burnish::Error(path + ": cannot be written");
}
}  // namespace specular_figure
