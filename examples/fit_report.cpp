// examples/fit_report.cpp -- the lines, pictures and the page of fit_report.h
// SPDX-License-Identifier: Apache-2.0
#include "fit_report.h"
#include <burnish/io/exr.h>
#include <burnish/io/model.h>
#include <burnish/io/report.h>

namespace report {

Rows materials_of(const Seen& seen) {
  std::map<std::string, std::array<int, 4>> found;
  const GBuffer& g = seen.g;
  for (int i = 0; i < g.size(); ++i)
    ++found[g.parts[std::size_t(g.part[std::size_t(i)])].material][std::size_t(seen.roles[std::size_t(i)])];
  Rows rows{{"material", "taken as", "pixels"}};
  for (const auto& [material, counts] : found)
    for (std::size_t r = 0; r < 4; ++r)
      if (counts[r] > 0) rows.push_back({material, parts::role_names[r], std::to_string(counts[r])});
  return rows;
}

void print_materials(const Seen& seen) {
  if (!seen.guess.empty()) std::printf("  %s\n", seen.guess.c_str());
  const Rows rows = materials_of(seen);
  for (std::size_t i = 1; i < rows.size(); ++i)
    std::printf("  %-28s %-6s %6s pixels\n", rows[i][0].c_str(), rows[i][1].c_str(), rows[i][2].c_str());
}

void write_materials(const std::string& folder, const Materials& found, const Seen& seen) {
  write_model(folder + "/paint.json", found.paint.state.best);
  write_model(folder + "/glass.json", found.window.state.best);
  write_model(folder + "/rubber.json", found.rubber.state.best);
  write_exr(folder + "/gbuffer.exr", seen.g);
}

Image panel(const Image& image) {
  constexpr int wide = 640;
  return resized(image, wide, std::max(1, wide * image.height / image.width));
}

Image difference_to_photo(const Seen& seen, Image drawn) {
  for (float& x : drawn.values) x = detail::to_srgb(x);
  return shot::difference(drawn, seen.photo.image, seen.g.frame("coverage"), seen.photo.vehicle);
}

void write_pictures(const std::string& folder, const Seen& seen, const Image& before, const Image& after) {
  write_png(folder + "/fit.png",
            sheet({{"photo", panel(shot::linear(seen.photo.image))},
                   {"before", panel(before)},
                   {"after", panel(after)},
                   {"difference, where photo and model overlap", panel(difference_to_photo(seen, after))}},
                  2));
  write_png(folder + "/after.png", after);
  const auto [normals, kinds] = shot::shown_gbuffer(seen.g, seen.roles);
  write_png(
      folder + "/gbuffer.png",
      sheet({{"normals", panel(normals)}, {"paint red, glass blue, rubber grey, the rest yellow", panel(kinds)}}, 2));
}

Rows numbers(const Materials& found, const fitting::Settings& settings) {
  const looks::Vehicle before{looks::first_paint(), {}, {}};
  Rows rows{{"parameter", "before", "fitted", "", "range", ""}};
  if (found.paint.state.step() > 0) fitted::add_rows(rows, "paint", before.paint, found.paint, settings);
  if (found.window.state.step() > 0) fitted::add_rows(rows, "glass", before.window, found.window, settings);
  if (found.rubber.state.step() > 0) fitted::add_rows(rows, "rubber", before.rubber, found.rubber, settings);
  return rows;
}

void print(const Rows& rows) {
  for (const auto& row : rows)
    if (!row[3].empty())
      std::printf("  %-28s %8s %-10s %s\n", row[0].c_str(), row[2].c_str(), row[3].c_str(), row[5].c_str());
}

void write_page(const street::Options& o, const MeshReport& mesh, const Seen& seen, const Lit& lit,
                const Materials& found, const std::string& loss, double seconds) {
  const std::vector<double>& losses = found.paint.state.losses;
  Page page("The paint of a vehicle, fitted to a photo");
  page.text(o.photo + "   |   " + o.vehicle + "   |   " + o.environment + ", turned by " +
            std::to_string(int(std::lround(lit.yaw))) + " degrees");
  page.picture(o.output + "/fit.png",
               "Photo; the model with its first paint; the model with the fitted materials; what is left, where photo "
               "and model overlap.");
  char note[256];
  std::snprintf(note, sizeof note,
                "The paint took %d steps on %d pixels: %.2f s on %d threads. Its loss went from %.4f to %.4f.%s",
                found.paint.state.step(), found.paint.pixels, found.paint.seconds, threads(),
                losses.empty() ? 0 : losses.front(), losses.empty() ? 0 : found.paint.state.best_loss,
                interrupted ? " It was interrupted." : "");
  page.text(note);
  if (!losses.empty()) {
    write_png(o.output + "/loss.png", curve(losses, "loss of the paint, by step"));
    page.picture(o.output + "/loss.png", loss);
  }
  const Rows rows = numbers(found, o);
  page.heading("The fitted numbers");
  page.table(rows);
  page.text(
      "Linear colours; lengths in metres. +- is a standard deviation: how much a number could change and the picture "
      "still fit as well, given the light. How strong the light was one photo does not tell: brightness of light and "
      "paint can be exchanged. Here the light is neutral and as strong as a street of middling grey needs to give the "
      "photo's mean brightness, or as a paint of albedo 0.8 needs to be as bright as this one.");
  page.heading("What the camera sees");
  page.picture(o.output + "/gbuffer.png", "Normals, and what each surface was taken as. gbuffer.exr holds all of it.");
  page.table(materials_of(seen));
  if (!seen.guess.empty()) page.text(seen.guess);
  page.heading("What was done to the vehicle's file");
  for (const std::string& line : mesh.lines) page.text(line);
  std::snprintf(note, sizeof note, "%.1f s from start to end.", seconds);
  page.text(note);
  page.write(o.output + "/report.html");
  print(rows);
}

}  // namespace report
