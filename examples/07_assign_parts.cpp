// examples/07_assign_parts.cpp -- a CAD vehicle goes in; what each of its parts is comes out, as a text one may edit
// SPDX-License-Identifier: Apache-2.0
//
// Shapes, names, opacities and, where they are given, masks of any segmenter say what is body, window, wheel or light
// (twin/assign_parts.h). With a photo and the camera that took it, the photo's own parts follow (twin/photo_parts.h):
// what 04_fit_material takes as --parts.
#include <burnish/io/camera.h>
#include <burnish/io/mesh.h>
#include <burnish/io/parts.h>
#include <burnish/io/report.h>
#include <burnish/twin/part_labels.h>
#include <burnish/twin/photo_parts.h>
#include <burnish/twin/split_parts.h>
#include "command.h"
#include "pictures.h"
#include "progress.h"

using namespace burnish;

namespace {
struct Options {
  std::string vehicle = "/usr/share/sweethome3d/furniture/Scopia.sh3f:scopia/suv/suv.obj";
  std::string masks, parts, photo, mask, camera, output = "burnish-parts";
  std::vector<std::string> roles;
  bool no_names = false, views = false, split = false;
  float threshold = 0.5f;
};

std::string view_name(std::size_t view) {
  char name[32];
  std::snprintf(name, sizeof name, "view_%02zu.png", view);
  return name;
}
/// Colours and the names of the kinds, as large as a panel.
Image legend(int w, int h) {
  Image out(w, h, {0.9f, 0.9f, 0.9f});
  OIIO::ImageBuf b = detail::buffer_of(out);
  const int row = h / (part_kinds + 1);
  for (int k = 0; k < part_kinds; ++k) {
    const vec3<float> c = kind_colors[std::size_t(k)];
    const float rgb[3] = {c.x, c.y, c.z};
    const int y = row / 2 + k * row;
    OIIO::ImageBufAlgo::render_box(b, 20, y, 20 + row, y + row * 3 / 4, rgb, true);
    detail::write_on(b, 40 + row, y + row * 3 / 4 - 4, std::string(part_kind_names[std::size_t(k)]), 18, 0.02f);
  }
  return detail::image_of(b);
}

/// The vehicle from four sides: as the file has it, and by kinds.
Image picture(const Raycaster& scene, const AssignedParts& parts) {
  const Box box = bounds(scene.mesh());
  std::vector<Panel> file, kinds;
  for (const auto& [azimuth, elevation, from] : {std::tuple{0.6f, 0.25f, "from ahead"},
                                                 {2.5f, 0.35f, "from behind"},
                                                 {1.5708f, 0.05f, "its right"},
                                                 {-2.2f, 0.6f, "its left, from above"}}) {
    Pose<float> p;
    p.azimuth = azimuth, p.elevation = elevation, p.focal = 3, p.center = box.center();
    p.distance = 2.9f * std::sqrt(dot(box.size(), box.size())), p.width = 360, p.height = 240;
    const GBuffer g = scene.trace(p.camera(), 1);
    const auto part = [&](int i) { return std::size_t(g.part[std::size_t(i)]); };
    file.push_back({from, drawn(g, [&](int i) { return scene.mesh().color(g.parts[part(i)], g.at(i).uv); })});
    kinds.push_back({"", drawn(g, [&](int i) { return kind_colors[std::size_t(parts.parts[part(i)].kind)]; })});
  }
  std::vector<Panel> all = file;
  all.push_back({"as the file has it", Image(360, 240, {0.9f, 0.9f, 0.9f})});
  all.insert(all.end(), kinds.begin(), kinds.end());
  all.push_back({"by kind", legend(360, 240)});
  return sheet(all, 5);
}

/// view_00.png .. of a folder; views without a file have no say.
std::vector<std::vector<int>> read_masks(const std::string& folder, const std::vector<Camera>& cameras) {
  if (!std::filesystem::is_directory(folder)) throw Error("--masks " + folder + ": no such folder");
  std::vector<std::vector<int>> out(cameras.size());
  int found = 0;
  for (std::size_t v = 0; v < cameras.size(); ++v) {
    const std::string path = folder + "/" + view_name(v);
    if (!std::filesystem::exists(path)) continue;
    out[v] = read_labels(path, cameras[v].width, cameras[v].height), ++found;
    for (const int label : out[v])
      if (label < 0 || label > part_kinds)
        throw Error(path + ": value " + std::to_string(label) + ", expected 0 to " + std::to_string(part_kinds));
  }
  if (found == 0) throw Error("--masks " + folder + ": no " + view_name(0) + " or other view in it, see --views");
  return out;
}

int run(const Options& o) {
  Progress whole("");
  if (o.photo.empty() != o.camera.empty() || o.photo.empty() != o.mask.empty())
    throw Error("--photo, --mask and --camera go together: one of them is missing");
  AssignOptions options;
  options.names = !o.no_names, options.threshold = o.threshold;
  if (!o.parts.empty()) options.given = read_parts(o.parts);
  for (const std::string& role : o.roles) options.given.push_back(parse_kind(role));
  Image photo;
  Mask mask;
  Camera camera;
  if (!o.photo.empty()) {
    photo = read_photo(o.photo), mask = read_mask(o.mask, photo.width, photo.height), camera = read_camera(o.camera);
    if (camera.width != photo.width || camera.height != photo.height)
      throw Error(o.camera + ": camera " + detail::size_of(camera.width, camera.height) + ", photo " +
                  detail::size_of(photo.width, photo.height) + ": they must agree");
  }
  MeshReport report;
  Mesh mesh = read_vehicle(o.vehicle, &report);
  if (o.split) split_wheels(mesh, report);
  std::printf("%s\n", o.vehicle.c_str());
  for (const std::string& line : report.lines) std::printf("  %s\n", line.c_str());
  const Raycaster scene(std::move(mesh));
  const std::vector<Camera> cameras = part_cameras(bounds(scene.mesh()), options.width);
  if (!o.masks.empty()) options.labels = read_masks(o.masks, cameras);
  Progress assigning("assign");
  const AssignedParts parts = assign_parts(scene, options);
  assigning.finish(std::to_string(parts.parts.size()) + " parts");

  std::printf("\n  %-5s %-7s %5s %7s  %-28s %s\n", "part", "kind", "sure", "seen", "material", "why");
  for (std::size_t p = 0; p < parts.parts.size(); ++p) {
    const PartGuess& g = parts.parts[p];
    std::printf("  %-5zu %-7s %4.0f%% %6.1f%%  %-28s %s\n", p, std::string(name_of(g.kind)).c_str(),
                double(100 * g.confidence), double(100 * g.share), scene.mesh().parts[p].material.c_str(),
                g.reason.c_str());
  }
  for (const std::string& note : parts.notes) std::printf("  %s\n", note.c_str());

  check_writable(o.output);
  write_parts(o.output + "/parts.txt", scene.mesh(), parts);
  write_png(o.output + "/parts.png", picture(scene, parts));
  if (o.views) {
    check_writable(o.output + "/views");
    for (std::size_t v = 0; v < cameras.size(); ++v) {
      const GBuffer g = scene.trace(cameras[v], 1);
      write_png(o.output + "/views/" + view_name(v), drawn(g, [&](int i) {
                  return scene.mesh().color(g.parts[std::size_t(g.part[std::size_t(i)])], g.at(i).uv);
                }));
    }
  }
  if (!o.photo.empty()) {
    Progress labelling("photo");
    const GBuffer g = scene.trace(camera, 1);
    if (g.size() == 0)
      throw Error(o.camera + ": the vehicle is not in the picture; it stands at the origin, x ahead, y up, metres");
    const std::vector<int> labels = photo_parts(photo, mask, g, part_labels(g, scene.mesh(), parts));
    Mask file(photo.width, photo.height);
    std::array<int, 5> count{};
    for (std::size_t i = 0; i < labels.size(); ++i)
      file.values[i] = float(labels[i]) / 255, ++count[std::size_t(labels[i])];
    write_png(o.output + "/photo_parts.png", file);
    write_png(o.output + "/photo_parts_shown.png", labelled(photo, labels));
    char note[128];
    std::snprintf(note, sizeof note, "pixels: paint %d, glass %d, rubber %d, other %d", count[1], count[2], count[3],
                  count[4]);
    labelling.finish(note);
  }
  std::printf("\nDone after %.1f s. %s/parts.png shows it; %s/parts.txt may be edited and given back as --parts.\n",
              whole.seconds(), o.output.c_str(), o.output.c_str());
  return 0;
}
}  // namespace

int main(int argc, char** argv) {
  Options o;
  CLI::App app{
      "Tells which parts of a CAD vehicle are body, windows, wheels and lights.\n\n"
      "  07_assign_parts --vehicle car.glb --output parts\n"
      "  07_assign_parts --vehicle car.glb --parts parts/parts.txt   (after editing)\n"
      "  07_assign_parts --vehicle car.glb --views                   (pictures for a segmenter)\n"
      "  07_assign_parts --vehicle car.glb --masks labels            (view_00.png .. as 0 unknown, 1 body,\n"
      "    2 window, 3 wheel, 4 tyre, 5 rim, 6 light, 7 other)\n"
      "  07_assign_parts --vehicle car.glb --photo street.jpg --mask car.png --camera camera.json"};
  app.option_defaults()->take_last();
  app.add_option("--vehicle", o.vehicle, "any format Assimp reads; archive.zip:inner/path for a file in a zip archive");
  app.add_option("--parts", o.parts, "a text file of kinds, as this program writes it; outweighs what is found");
  app.add_option("--role", o.roles, "material=kind or material[part]=kind, as often as needed; outweighs all")
      ->take_all();
  app.add_option("--masks", o.masks, "folder with label images of the views, from any segmenter");
  app.add_option("--threshold", o.threshold, "of the IoU from which masks decide")
      ->check(CLI::Range(0.0f, 1.0f))
      ->capture_default_str();
  app.add_flag("--no-names", o.no_names, "names of parts and materials are not looked at");
  app.add_flag("--split", o.split, "wheels that share a part with other things become parts of their own");
  app.add_flag("--views", o.views, "writes the views that --masks are asked for");
  app.add_option("--photo", o.photo, "a photo; with --mask and --camera its own parts are labelled");
  app.add_option("--mask", o.mask, "the vehicle in the photo: white, same size");
  app.add_option("--camera", o.camera, "JSON, as 05_match_pose writes it");
  app.add_option("-o,--output", o.output, "folder for the text and the pictures")->capture_default_str();
  return command(app, argc, argv, [&] { return run(o); });
}
