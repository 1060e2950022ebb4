// burnish/io/vehicle_files.h -- the vehicle files of a folder and of the archives in it
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <string>
#include <vector>
#include <burnish/io/mesh.h>
#include <burnish/twin/library.h>

namespace burnish {

struct VehicleFiles {
  std::vector<LibraryEntry> files;  // path, name, bytes, modified; by path
  std::vector<std::string> notes;   // a line for every archive: what was passed over or cannot be read
};

namespace detail {
/// Formats of Assimp that hold polygons as a rule.
inline bool is_mesh_file(const std::filesystem::path& p) {
  static const std::set<std::string> endings = {
      ".obj",     ".glb", ".gltf",     ".fbx", ".dae", ".3ds", ".b3d", ".ac",   ".acc",  ".ac3d", ".blend",   ".ply",
      ".stl",     ".x",   ".lwo",      ".ase", ".off", ".3mf", ".x3d", ".ms3d", ".md2",  ".md3",  ".md5mesh", ".cob",
      ".irrmesh", ".dxf", ".smd", ".iqm", ".nff", ".q3o", ".xgl",  ".ogex", ".wrl"};
  return endings.count(lower(p.extension().string())) > 0;
}
inline bool is_archive(const std::filesystem::path& p) {
  static const std::set<std::string> endings = {".zip", ".sh3f", ".sh3d", ".kmz"};
  return endings.count(lower(p.extension().string())) > 0;
}
/// Whether one of the words in a path names a kind of vehicle.
inline bool names_a_vehicle(const std::string& path) {
  static const std::set<std::string> kinds = {
      "vehicle", "vehicles", "car",    "cars",      "auto",      "autos",    "automobile", "automobiles", "suv",
      "sedan",   "saloon",   "coupe",  "hatchback", "wagon",     "estate",   "pickup",     "truck",       "trucks",
      "lorry",   "van",      "vans",   "minivan",   "bus",       "buses",    "jeep",       "taxi",        "cab",
      "ambulance", "police", "firetruck", "limo",   "limousine", "roadster", "convertible", "cabrio",     "cabriolet",
      "tractor", "offroad",  "minibus", "motorhome", "camper"};
  bool any = false;
  each_word(path, [&](const std::string& word) { any |= kinds.count(word) > 0; });
  return any;
}
/// The stem, or the folder's name where the stem says nothing.
inline std::string shown_name(const std::filesystem::path& p) {
  static const std::set<std::string> hollow = {"scene", "model", "mesh", "object", "untitled", "source", "car", "base"};
  const std::string stem = p.stem().string(), folder = p.parent_path().filename().string();
  return hollow.count(lower(stem)) && !folder.empty() ? folder : stem;
}

/// What Sweet Home 3D's catalogue of an archive says of a model file: its category and its name.
struct Catalogued {
  std::string category, name;
};
/// model path (lower case, without "/" before) -> what is said of it. Java properties: "model#12=/scopia/suv/suv.obj".
inline std::map<std::string, Catalogued> read_catalogue(const std::string& text) {
  struct Item : Catalogued {
    std::string model;
  };
  std::map<std::string, Item> items;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.pop_back();
    const std::size_t sharp = line.find('#'), equals = line.find('=');
    if (sharp == line.npos || equals == line.npos || sharp > equals || sharp == 0) continue;
    const std::string key = line.substr(0, sharp), number = line.substr(sharp + 1, equals - sharp - 1);
    std::string value;
    for (std::size_t i = equals + 1; i < line.size(); ++i) {
      if (line[i] != '\\' || i + 1 == line.size()) value += line[i];
      else if (line[i + 1] == 'u') value += '?', i += 5;  // a letter beyond Latin 1
      else value += line[++i];
    }
    if (key == "name") items[number].name = value;
    if (key == "category") items[number].category = value;
    if (key == "model") items[number].model = lower(value.substr(value.find_first_not_of('/') == value.npos
                                                                      ? value.size()
                                                                      : value.find_first_not_of('/')));
  }
  std::map<std::string, Catalogued> out;
  for (const auto& [number, item] : items)
    if (!item.model.empty()) out[item.model] = item;
  return out;
}

/// Of an archive with a catalogue, the models that it calls vehicles; of another, those whose path, the archive's name
/// in it, names a vehicle.
inline void add_archive(const std::filesystem::path& archive, const LibraryEntry& file, VehicleFiles& out) {
  ZipFiles zip(archive.string());
  std::map<std::string, Catalogued> catalogue;
  for (const std::string& name : zip.names()) {
    if (std::filesystem::path(name).filename() != "PluginFurnitureCatalog.properties") continue;
    if (const std::unique_ptr<Assimp::IOStream> stream{zip.Open(name.c_str(), "rb")}) {
      std::string text(stream->FileSize(), '\0');
      stream->Read(text.data(), 1, text.size());
      catalogue = read_catalogue(text);
    }
  }
  int passed_over = 0, taken = 0;
  for (const std::string& name : zip.names()) {
    if (!is_mesh_file(name)) continue;
    LibraryEntry e = file;
    e.path = archive.string() + ":" + name, e.name = shown_name(name);
    const auto said = catalogue.find(lower(name));
    bool vehicle = catalogue.empty() && names_a_vehicle(archive.filename().string() + "/" + name);
    if (said != catalogue.end()) {
      vehicle = lower(said->second.category).find("vehicle") != std::string::npos;
      if (!said->second.name.empty()) e.name = said->second.name;
    }
    if (vehicle) out.files.push_back(e);
    ++(vehicle ? taken : passed_over);
  }
  out.notes.push_back(archive.string() + ": " + std::to_string(taken) + " vehicles by " +
                      (catalogue.empty() ? "their names" : "its catalogue") + ", " + std::to_string(passed_over) +
                      " other models passed over");
}
}  // namespace detail

/// All mesh files below the folders, and the vehicles of zip archives there; a folder may also be one file or archive.
/// Paths are absolute. Error for a folder that is not there; what cannot be read in one is a note.
inline VehicleFiles find_vehicle_files(const std::vector<std::string>& folders) {
  namespace fs = std::filesystem;
  VehicleFiles out;
  const auto add = [&](const fs::path& p, bool asked_for) {
    std::error_code failed;
    LibraryEntry e;
    e.path = p.string(), e.name = detail::shown_name(p);
    e.bytes = std::int64_t(fs::file_size(p, failed));
    if (failed) return;
    e.modified = std::int64_t(fs::last_write_time(p, failed).time_since_epoch().count());
    if (failed) return;
    if (detail::is_archive(p)) {
      try {
        detail::add_archive(p, e, out);
      } catch (const std::exception& x) {
        out.notes.push_back(x.what());
      }
    } else if (asked_for || detail::is_mesh_file(p)) {
      out.files.push_back(e);
    }
  };
  for (const std::string& folder : folders) {
    std::error_code failed;
    fs::path top = fs::absolute(folder, failed).lexically_normal();
    if (!fs::exists(top, failed)) throw Error(folder + ": no such folder, expected one with vehicle files");
    if (fs::is_regular_file(top, failed)) {
      add(top, true);
      continue;
    }
    fs::recursive_directory_iterator at(top, fs::directory_options::skip_permission_denied, failed);
    if (failed) throw Error(folder + ": cannot be read: " + failed.message());
    for (; at != fs::recursive_directory_iterator(); at.increment(failed)) {
      if (failed) {
        out.notes.push_back(folder + ": cannot be read to its end: " + failed.message());
        break;
      }
      std::error_code gone;
      if (at->is_regular_file(gone) && !gone) add(at->path(), false);
    }
  }
  std::sort(out.files.begin(), out.files.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  out.files.erase(std::unique(out.files.begin(), out.files.end(),
                              [](const auto& a, const auto& b) { return a.path == b.path; }),
                  out.files.end());
  return out;
}

}  // namespace burnish
