// examples/06_retrieve.cpp -- folders of vehicle files become an index; a photo's vehicle is looked up in it
// SPDX-License-Identifier: Apache-2.0
//
// Every file is read once, in a process of its own (io/build_library.h), and described from many sides
// (twin/describe.h). The photo's mask and edges are described alike, and the nearest views found (twin/retrieve.h).
#include <burnish/io/build_library.h>
#include <burnish/io/embeddings.h>
#include <burnish/io/photo.h>
#include <burnish/twin/retrieve.h>
#include "cards.h"
#include "command.h"
#include "progress.h"

using namespace burnish;

namespace {
struct Options {
  std::string photo = "/usr/share/darknet/data/dog.jpg", mask, index, output = "burnish-retrieve";
  std::string by = "views", query;
  std::vector<std::string> folders, accept, refuse, spaces;
  int top = 8, workers = 0;
  double seconds = 60;
  std::size_t megabytes = 4096;
  bool index_only = false, report = false;
};
/// Turns of less than half a turn, in degrees.
double degrees(float radians) { return double(std::remainder(radians, 2 * pi)) * 57.29577951308232; }

/// What was refused and why, by kind.
std::string refusals(const Library& l) {
  std::string out;
  for (const LibraryStatus s : {LibraryStatus::failed, LibraryStatus::refused, LibraryStatus::duplicate}) {
    if (l.count(s) == 0) continue;
    out += std::to_string(l.count(s)) + " " + library_status_names[std::size_t(s)] + ":\n";
    for (const LibraryEntry& e : l.entries)
      if (e.status == s) out += "  " + e.path + "\n      " + e.reason + "\n";
  }
  for (const LibraryEntry& e : l.entries)
    if (e.status == LibraryStatus::indexed && e.by_hand) out += "  " + e.path + "\n      " + e.reason + "\n";
  return out;
}
Image thumbnail(const Library& l, std::size_t i) {
  constexpr int w = Library::thumbnail_width, h = Library::thumbnail_height;
  Image out(w, h);
  const std::uint8_t* const from = l.thumbnails.data() + i * std::size_t(w * h * 3);
  for (int p = 0; p < w * h; ++p) {
    const auto value = [&](int c) { return detail::from_srgb(float(from[3 * p + c]) / 255); };
    out.set(p % w, p / w, {value(0), value(1), value(2)});
  }
  return out;
}
void write_overview(const std::string& path, const Library& l) {
  std::vector<Card> cards;
  for (std::size_t i = 0; i < l.thumbnail_of.size(); ++i) {
    const LibraryEntry& e = l.entries[std::size_t(l.thumbnail_of[i])];
    char text[80];
    std::snprintf(text, sizeof text, "%.1f m, %d materials", double(e.size.x), e.materials);
    cards.push_back({thumbnail(l, i), e.name, text});
  }
  if (!cards.empty()) write_png(path, card_sheet(cards, std::clamp(int(std::sqrt(1.3 * double(cards.size()))), 4, 24)));
}

/// The photo around the mask, the rest of it darker; white where it ends.
Image crop_of(const Image& photo, const Mask& mask, int width, int height) {
  int x0 = photo.width, y0 = photo.height, x1 = 0, y1 = 0;
  for (int y = 0; y < photo.height; ++y)
    for (int x = 0; x < photo.width; ++x)
      if (mask.at(x, y) > 0.5f)
        x0 = std::min(x0, x), x1 = std::max(x1, x + 1), y0 = std::min(y0, y), y1 = std::max(y1, y + 1);
  const double scale = std::max(1.12 * (x1 - x0) / width, 1.12 * (y1 - y0) / height);
  const int w = std::max(1, int(width * scale)), h = std::max(1, int(height * scale));
  const int x = (x0 + x1 - w) / 2, y = (y0 + y1 - h) / 2;
  Image out = cropped(photo, x, y, w, h);
  const Mask inside = cropped(mask, x, y, w, h);
  for (int j = 0; j < h; ++j)
    for (int i = 0; i < w; ++i) {
      const bool there = x + i >= 0 && x + i < photo.width && y + j >= 0 && y + j < photo.height;
      out.set(i, j, there ? out.at(i, j) * (0.25f + 0.75f * inside.at(i, j)) : vec3<float>(1));
    }
  return resized(out, width, height);
}

LibraryBuild build(const Options& o, const std::string& index) {
  LibraryOptions options;
  options.workers = o.workers, options.limits = {o.seconds, o.megabytes};
  std::vector<LibraryRule> rules;
  for (const std::string& p : o.accept) rules.push_back({p, true});
  for (const std::string& p : o.refuse) rules.push_back({p, false});
  Progress bar("index");
  LibraryBuild b = build_library(
      index, o.folders, rules, options,
      [&](int done, int of, double) { bar.show(done, of, std::to_string(done) + "/" + std::to_string(of)); },
      [] { return interrupted != 0; });
  for (const std::string& n : b.notes) std::printf("  %s\n", n.c_str());
  const Library& l = b.vehicles;
  char text[200];
  std::snprintf(text, sizeof text, "%d files read now, %.2f s each; %d known before", b.done,
                b.done > 0 ? b.seconds / b.done : 0.0, int(l.entries.size()) - b.done);
  bar.finish(text);
  std::printf("%-14s %s: %d vehicles indexed, %d refused, %d duplicates, %d failed%s\n", "", index.c_str(),
              l.count(LibraryStatus::indexed), l.count(LibraryStatus::refused), l.count(LibraryStatus::duplicate),
              l.count(LibraryStatus::failed),
              b.gone > 0 ? (", " + std::to_string(b.gone) + " gone").c_str() : "");
  return b;
}

int run(Options o) {
  Progress whole("");
  if (o.index.empty()) o.index = o.output + "/library.safetensors";
  if (o.folders.empty() && !std::filesystem::exists(o.index)) {
    if (o.photo != Options().photo) throw Error("--library is missing, and there is no index " + o.index);
    o.folders = {"/usr/share/sweethome3d/furniture"};
  }
  Image photo;
  Mask mask;
  std::vector<float> query;
  std::vector<std::pair<std::string, std::string>> spaces;  // name, file
  for (const std::string& s : o.spaces) {
    const std::size_t equals = s.find('=');
    if (equals == std::string::npos) throw Error("--space " + s + ": expected name=file");
    spaces.emplace_back(s.substr(0, equals), s.substr(equals + 1));
    read_embeddings(spaces.back().second);
  }
  if (!o.index_only && o.by != "views") {
    if (o.query.empty()) throw Error("--query is missing: which vector of the space " + o.by + " is looked for?");
    Embeddings e = read_embeddings(o.query);
    if (e.vectors.shape[0] != 1) throw Error(o.query + ": several rows, expected one");
    query = std::move(e.vectors.values);
    normalise_rows(query, int(query.size()));
  } else if (!o.index_only) {
    if (o.mask.empty() && o.photo == Options().photo)
      o.mask = std::string(BURNISH_EXAMPLES_DATA) + "/dog_pickup.mask.png";
    if (o.mask.empty()) throw Error("--mask is missing: which pixels of " + o.photo + " are the vehicle?");
    photo = read_photo(o.photo), mask = read_mask(o.mask, photo.width, photo.height);
    try {
      query = describe(mask, photo);
    } catch (const Error& e) {
      throw Error(o.mask + ": " + e.what());
    }
  }
  // What is wrong with them is said before anything is written.
  for (const std::string& f : o.folders)
    if (!std::filesystem::exists(f)) throw Error(f + ": no such folder, expected one with vehicle files");
  if (std::filesystem::exists(o.index)) read_library(o.index);
  catch_interrupt();
  check_writable(o.output);
  LibraryBuild built = build(o, o.index);
  Library library = std::move(built.vehicles);
  if (interrupted) {
    std::printf("Stopped: %d files are left; the same command goes on.\n", built.left);
    return 130;
  }
  for (const auto& [name, file] : spaces) {
    const int strange = add_space(library, name, read_embeddings(file), file);
    std::printf("%-14s space %s: %d rows, %d of no vehicle here\n", "", name.c_str(), library.spaces[name].rows(),
                strange);
  }
  if (!spaces.empty()) write_library(o.index, library);
  if (o.report) {
    std::fputs(refusals(library).c_str(), stdout);
    write_text(o.output + "/refused.txt", refusals(library));
    write_overview(o.output + "/library.png", library);
    std::printf("%s/library.png shows what is indexed, refused.txt says what is not; --accept PATTERN overrules.\n",
                o.output.c_str());
  }
  if (o.index_only) return 0;
  const auto space = library.spaces.find(o.by);
  if (space == library.spaces.end() || space->second.rows() == 0)
    throw Error(o.index + (o.by == "views" ? ": no vehicle is indexed, expected some; --report says why"
                                           : ": has no space " + o.by + "; --space " + o.by + "=FILE adds one"));
  if (int(query.size()) != space->second.columns)
    throw Error(o.query + ": " + std::to_string(query.size()) + " numbers, the space " + o.by + " has " +
                std::to_string(space->second.columns));
  const std::vector<int> first = first_rows(library, space->second);
  Progress search("search");
  const auto found = o.by == "views"
                         ? retrieve(space->second.values, first, mask, photo, o.top)
                         : nearest_models(space->second.values, space->second.columns, first, query, o.top);
  search.finish(std::to_string(space->second.rows()) + " rows of " +
                std::to_string(library.count(LibraryStatus::indexed)) + " vehicles");

  constexpr int width = 300, height = 200;
  std::vector<Card> cards;
  nlohmann::ordered_json result = {{"index", o.index}, {"by", o.by}};
  if (o.by == "views") {
    cards.push_back({crop_of(photo, mask, width, height), "photo", std::filesystem::path(o.photo).filename().string()});
    result["photo"] = o.photo, result["mask"] = o.mask;
  } else result["query"] = o.query;
  const bool views = !space->second.azimuth.empty();
  Progress drawing("draw");
  for (std::size_t k = 0; k < found.size() && !interrupted; ++k) {
    const NearestModel& f = found[k];
    const LibraryEntry& e = library.entries[std::size_t(f.model)];
    const float azimuth = views ? space->second.azimuth[std::size_t(f.row)] : 0.6f,
                elevation = views ? space->second.elevation[std::size_t(f.row)] : 0.2f;
    std::printf("%2zu  cosine %.4f  ", k + 1, double(f.cosine));
    if (views) std::printf("from %4.0f degrees  ", degrees(azimuth));
    std::printf("%s\n", e.path.c_str());
    nlohmann::ordered_json j = {{"name", e.name}, {"file", e.path}, {"cosine", f.cosine}, {"length", e.size.x}};
    if (views) j["azimuth"] = azimuth, j["elevation"] = elevation;
    result["found"].push_back(std::move(j));
    char text[80];
    std::snprintf(text, sizeof text, "%zu   cosine %.3f", k + 1, double(f.cosine));
    Image picture(width, height, {1, 1, 1});
    try {
      const Raycaster scene(read_vehicle(e.path));
      picture = preview(scene, framed(bounds(scene.mesh()), azimuth, elevation, width, height).camera());
    } catch (const Error& x) {
      std::printf("    %s\n", x.what());
    }
    cards.push_back({std::move(picture), e.name, text});
    drawing.show(int(k) + 1, int(found.size()));
  }
  drawing.finish(std::to_string(found.size()) + " vehicles");
  write_png(o.output + "/retrieved.png", card_sheet(cards, 3));
  write_text(o.output + "/result.json",
             result.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
  std::printf("\nDone after %.1f s. %s/retrieved.png shows it, %s/result.json has the numbers.\n", whole.seconds(),
              o.output.c_str(), o.output.c_str());
  return 0;
}
}  // namespace

int main(int argc, char** argv) {
  Options o;
  CLI::App app{
      "Finds the CAD vehicles that look most like the one in a photo.\n\n"
      "  06_retrieve --library cars more-cars.zip --photo street.jpg --mask car.png --output found\n\n"
      "The index is built on the way, each file once; Ctrl-C keeps what is done. Without arguments: a pickup in\n"
      "a street, among Sweet Home 3D's vehicles."};
  app.option_defaults()->take_last();
  app.add_option("--library", o.folders, "folders with vehicle files and zip archives; none: the index as it is")
      ->take_all();
  app.add_option("--index", o.index, "the index; if not given, library.safetensors in the output folder");
  app.add_option("--photo", o.photo, "any format OpenImageIO reads");
  app.add_option("--mask", o.mask, "the vehicle in the photo: white, same size");
  app.add_option("--top", o.top, "how many are shown")->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_flag("--index-only", o.index_only, "build the index and look nothing up");
  app.add_flag("--report", o.report, "say what was refused and why, and draw all that is indexed (library.png)");
  app.add_option(
         "--accept", o.accept,
         "index what fits this pattern though it was refused, as often as needed: a name, a file or a whole path, "
         "* and ? as in a shell; the index remembers it")
      ->take_all();
  app.add_option("--refuse", o.refuse, "leave out what fits this pattern; of all such rules the last counts")
      ->take_all();
  app.add_option("--space", o.spaces,
                 "name=file, as often as needed: vectors of the vehicles from elsewhere, kept in the index (.npz or "
                 ".safetensors with names, or .npy with .npy.txt)")
      ->take_all();
  app.add_option("--by", o.by, "the space that is searched; others than views want --query")->capture_default_str();
  app.add_option("--query", o.query, "the vector looked for in such a space: .npy, .npz or .safetensors");
  app.add_option("--workers", o.workers, "files read at a time; 0: one a core")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  app.add_option("--seconds", o.seconds, "that reading one file may take")
      ->check(CLI::Range(0.01, 1e6))
      ->capture_default_str();
  app.add_option("--megabytes", o.megabytes, "of memory that reading one file may take")
      ->check(CLI::Range(64, 1 << 20))
      ->capture_default_str();
  app.add_option("-o,--output", o.output, "folder for the pictures and files")->capture_default_str();
  return command(app, argc, argv, [&] { return run(o); });
}
