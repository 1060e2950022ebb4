// burnish/io/library.h -- a library of vehicles as one file
// SPDX-License-Identifier: Apache-2.0
//
// In the safetensors format (safetensors.h), so that others can open it, too. Texts: "burnish_library", the version, 1;
// "descriptor"; "entries", a JSON list of objects, by path, with the members of LibraryEntry; "rules", a JSON list of
// {"pattern": "*.stl", "accept": false}. Tensors: for every space its NAME [rows, columns] and NAME.entry [rows], the
// place of the row's entry in that list, ascending, and for views NAME.azimuth and NAME.elevation [rows], rad;
// "thumbnails" [n, height, width, 3], sRGB 0 to 255, and "thumbnails.entry" [n].
#pragma once
#include <fnmatch.h>
#include <nlohmann/json.hpp>
#include <burnish/io/safetensors.h>
#include <burnish/twin/library.h>

namespace burnish {

namespace detail {
inline nlohmann::ordered_json to_json(const LibraryEntry& e) {
  return {{"path", e.path},
          {"name", e.name},
          {"status", library_status_names[std::size_t(e.status)]},
          {"reason", e.reason},
          {"by_hand", e.by_hand},
          {"bytes", e.bytes},
          {"modified", e.modified},
          {"size", {e.size.x, e.size.y, e.size.z}},
          {"parts", e.parts},
          {"materials", e.materials},
          {"triangles", e.triangles},
          {"shape", e.shape},
          {"seconds", e.seconds}};
}
inline LibraryEntry library_entry(const nlohmann::json& j) {
  LibraryEntry e;
  j.at("path").get_to(e.path), j.at("name").get_to(e.name), j.at("reason").get_to(e.reason);
  j.at("by_hand").get_to(e.by_hand), j.at("bytes").get_to(e.bytes), j.at("modified").get_to(e.modified);
  j.at("parts").get_to(e.parts), j.at("materials").get_to(e.materials), j.at("triangles").get_to(e.triangles);
  j.at("shape").get_to(e.shape), j.at("seconds").get_to(e.seconds);
  const auto size = j.at("size").get<std::array<float, 3>>();
  e.size = {size[0], size[1], size[2]};
  const auto status = std::find(library_status_names.begin(), library_status_names.end(), j.at("status"));
  if (status == library_status_names.end()) throw Error("status " + j.at("status").dump());
  e.status = LibraryStatus(status - library_status_names.begin());
  return e;
}
inline Tensor tensor_of(std::vector<std::size_t> shape, std::vector<float> values) {
  return {std::move(shape), std::move(values)};
}
template <class X> std::vector<float> floats_of(const std::vector<X>& x) { return {x.begin(), x.end()}; }
}  // namespace detail

/// Written beside and renamed.
inline void write_library(const std::string& path, const Library& library) {
  nlohmann::ordered_json entries = nlohmann::ordered_json::array(), rules = entries;
  for (const LibraryEntry& e : library.entries) entries.push_back(detail::to_json(e));
  for (const LibraryRule& r : library.rules) rules.push_back({{"pattern", r.pattern}, {"accept", r.accept}});
  // A path need not be UTF-8, JSON must: what is not becomes a replacement character.
  const auto text = [](const nlohmann::ordered_json& j) {
    return j.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  };
  NamedTensors out;
  std::map<std::string, detail::NumberType> narrow;
  out.texts = {{"burnish_library", "1"},
               {"descriptor", library.descriptor},
               {"entries", text(entries)},
               {"rules", text(rules)}};
  for (const auto& [name, s] : library.spaces) {
    const std::size_t n = std::size_t(s.rows());
    narrow[name] = detail::NumberType::f16;
    out.tensors[name] = detail::tensor_of({n, std::size_t(s.columns)}, s.values);
    out.tensors[name + ".entry"] = detail::tensor_of({n}, detail::floats_of(s.entry));
    if (s.azimuth.empty()) continue;
    out.tensors[name + ".azimuth"] = detail::tensor_of({n}, s.azimuth);
    out.tensors[name + ".elevation"] = detail::tensor_of({n}, s.elevation);
  }
  narrow["thumbnails"] = detail::NumberType::u8;
  const std::size_t n = library.thumbnail_of.size();
  out.tensors["thumbnails"] = detail::tensor_of({n, Library::thumbnail_height, Library::thumbnail_width, 3},
                                                detail::floats_of(library.thumbnails));
  out.tensors["thumbnails.entry"] = detail::tensor_of({n}, detail::floats_of(library.thumbnail_of));
  write_safetensors(path, out, narrow);
}

/// Error, one line, for a file that is no library, is damaged or is of another version.
inline Library read_library(const std::string& path) {
  const auto damaged = [&](const std::string& what) {
    return Error(path + ": no usable library index: " + what + "; take it away and it is built anew");
  };
  NamedTensors in;
  try {
    in = read_safetensors(path);
  } catch (const std::exception& e) {
    const std::string why = e.what();
    throw damaged(why.rfind(path + ": ", 0) == 0 ? why.substr(path.size() + 2) : why);
  }
  if (in.texts["burnish_library"] != "1")
    throw damaged("its version is \"" + in.texts["burnish_library"] + "\", expected \"1\"");
  Library out;
  out.descriptor = in.texts["descriptor"];
  try {
    for (const auto& j : nlohmann::json::parse(in.texts["entries"])) out.entries.push_back(detail::library_entry(j));
    for (const auto& j : nlohmann::json::parse(in.texts["rules"]))
      out.rules.push_back({j.at("pattern").get<std::string>(), j.at("accept").get<bool>()});
  } catch (const std::exception& e) {
    throw damaged(std::string("its entries cannot be read: ") + e.what());
  }
  for (std::size_t i = 1; i < out.entries.size(); ++i)
    if (!(out.entries[i - 1].path < out.entries[i].path))
      throw damaged("its entries are not in the order of their paths");
  const auto entries_of = [&](const std::string& name, std::size_t n) {
    const auto at = in.tensors.find(name + ".entry");
    if (at == in.tensors.end() || at->second.shape != std::vector<std::size_t>{n})
      throw damaged("no tensor " + name + ".entry of " + std::to_string(n) + " numbers");
    std::vector<int> entry;
    for (const float v : at->second.values) {
      if (!(v >= 0 && v < float(out.entries.size())) || (!entry.empty() && int(v) < entry.back()))
        throw damaged(name + ".entry is not in the order of the entries");
      entry.push_back(int(v));
    }
    return entry;
  };
  for (auto& [name, t] : in.tensors) {
    if (const std::size_t dot = name.find('.'); dot != std::string::npos) {
      const std::string of = name.substr(dot);
      if (!in.tensors.count(name.substr(0, dot)) || (of != ".entry" && of != ".azimuth" && of != ".elevation"))
        throw damaged("tensor " + name + " belongs to none");
      continue;
    }
    if (name == "thumbnails") {
      const std::size_t n = t.shape.empty() ? 0 : t.shape[0];
      if (t.shape != std::vector<std::size_t>{n, Library::thumbnail_height, Library::thumbnail_width, 3})
        throw damaged("its thumbnails are " + detail::shape_text(t.shape));
      out.thumbnail_of = entries_of(name, n);
      out.thumbnails.assign(t.values.begin(), t.values.end());
      continue;
    }
    if (t.shape.size() != 2) throw damaged("tensor " + name + " is " + detail::shape_text(t.shape) + ", expected rows");
    LibrarySpace& s = out.spaces[name];
    s.columns = int(t.shape[1]);
    s.entry = entries_of(name, t.shape[0]);
    for (const auto& [which, values] : {std::pair{".azimuth", &s.azimuth}, {".elevation", &s.elevation}}) {
      const auto at = in.tensors.find(name + which);
      if (at == in.tensors.end()) continue;
      if (at->second.shape != std::vector<std::size_t>{t.shape[0]})
        throw damaged("tensor " + name + which + " does not fit");
      *values = std::move(at->second.values);
    }
    s.values = std::move(t.values);
  }
  return out;
}

/// The last rule that fits the entry, or null.
inline const LibraryRule* rule_for(const Library& library, const LibraryEntry& e) {
  const LibraryRule* last = nullptr;
  const std::size_t slash = e.path.find_last_of("/:");
  const std::string file = slash == std::string::npos ? e.path : e.path.substr(slash + 1);
  for (const LibraryRule& r : library.rules)
    for (const std::string& text : {e.path, e.name, file})
      if (fnmatch(r.pattern.c_str(), text.c_str(), 0) == 0) last = &r;
  return last;
}

}  // namespace burnish
