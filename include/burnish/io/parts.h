// burnish/io/parts.h -- which part is what, as a small text file that one may edit
// SPDX-License-Identifier: Apache-2.0
//
// A line a material: its name, its kind, how sure that is and why, tabs between; only the first two are read. Where
// parts of one material are of several kinds, the line of the material is for most of them, and lines of
// "material[part]" follow for the others. Lines that begin with "# " and empty ones say nothing.
#pragma once
#include <cstdio>
#include <burnish/io/file.h>
#include <burnish/twin/assign_parts.h>

namespace burnish {

namespace detail {
inline std::string all_kinds() {
  std::string all;
  for (int k = 0; k < part_kinds; ++k)
    all += (k == 0 ? "" : k + 1 < part_kinds ? ", " : " or ") + std::string(part_kind_names[std::size_t(k)]);
  return all;
}
/// "material" or "material[part]"; where: what an Error begins with.
inline GivenKind given_kind(const std::string& key, const std::string& kind, const std::string& where) {
  GivenKind g;
  g.material = key;
  const std::size_t open = key.rfind('[');
  if (open != std::string::npos && open > 0 && key.size() > open + 2 && key.size() < open + 11 && key.back() == ']' &&
      key.find_first_not_of("0123456789", open + 1) == key.size() - 1)
    g.material = key.substr(0, open), g.part = std::stoi(key.substr(open + 1));
  const auto known = part_kind_of(kind);
  if (!known) throw Error(where + ": kind \"" + kind + "\", expected " + all_kinds());
  g.kind = *known;
  return g;
}
}  // namespace detail

/// "material=kind" of a command line; Error, beginning with `option`, when it is not of that form.
inline GivenKind parse_kind(const std::string& text, const std::string& option = "--role") {
  const std::size_t eq = text.rfind('=');
  if (eq == std::string::npos || eq == 0)
    throw Error(option + " " + text + ": expected material=kind, a kind being " + detail::all_kinds());
  GivenKind given = detail::given_kind(text.substr(0, eq), text.substr(eq + 1), option + " " + text);
  given.from = option + " " + text.substr(0, eq);
  return given;
}

/// The file's text.
inline std::string parts_text(const Mesh& mesh, const AssignedParts& parts) {
  std::map<int, std::array<double, part_kinds>> shares;  // by material
  for (std::size_t p = 0; p < mesh.parts.size(); ++p)
    shares[mesh.parts[p].material_index][std::size_t(parts.parts[p].kind)] += double(parts.parts[p].share) + 1e-6;
  std::string out = "# material <tab> kind <tab> confidence <tab> why; kinds: " + detail::all_kinds() + "\n";
  for (const std::string& note : parts.notes) out += "# " + note + "\n";
  const auto line = [&](const std::string& key, PartKind kind, float confidence, const std::string& why) {
    char number[32];
    std::snprintf(number, sizeof number, "%.2f", double(confidence));
    out += key + "\t" + std::string(name_of(kind)) + "\t" + number + "\t" + why + "\n";
  };
  for (const auto& [material, share] : shares) {
    const PartKind most = PartKind(std::max_element(share.begin(), share.end()) - share.begin());
    const PartGuess* largest = nullptr;
    std::string name;
    for (std::size_t p = 0; p < mesh.parts.size(); ++p) {
      if (mesh.parts[p].material_index != material) continue;
      name = mesh.parts[p].material;
      if (parts.parts[p].kind == most && (!largest || parts.parts[p].share > largest->share)) largest = &parts.parts[p];
    }
    line(name, most, largest->confidence, largest->reason);
    for (std::size_t p = 0; p < mesh.parts.size(); ++p)
      if (const PartGuess& g = parts.parts[p]; mesh.parts[p].material_index == material && g.kind != most)
        line(name + "[" + std::to_string(p) + "]", g.kind, g.confidence, g.reason);
  }
  return out;
}
inline void write_parts(const std::string& path, const Mesh& mesh, const AssignedParts& parts) {
  write_text(path, parts_text(mesh, parts));
}

/// What such a text says, in its order, for AssignOptions::given. Error naming the file and the line for a line
/// without a tab, an unknown kind, or a name that was there before with another kind.
inline std::vector<GivenKind> parse_parts(const std::string& text, const std::string& path) {
  std::vector<GivenKind> out;
  std::map<std::string, PartKind> before;
  std::size_t number = 0;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = std::min(text.find('\n', at), text.size());
    std::string line = text.substr(at, end - at);
    at = end + 1, ++number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line == "#" || line.rfind("# ", 0) == 0) continue;
    const std::string where = path + ":" + std::to_string(number);
    const std::size_t tab = line.find('\t');
    if (tab == std::string::npos || tab == 0)
      throw Error(where + ": \"" + line + "\", expected a material, a tab and its kind");
    const std::string key = line.substr(0, tab), kind = line.substr(tab + 1, line.find('\t', tab + 1) - tab - 1);
    GivenKind g = detail::given_kind(key, kind, where);
    g.from = where + ": " + key;
    const auto [known, fresh] = before.emplace(key, g.kind);
    if (!fresh && known->second != g.kind)
      throw Error(where + ": " + key + " is " + kind + " here and " + std::string(name_of(known->second)) + " above");
    out.push_back(g);
  }
  return out;
}
inline std::vector<GivenKind> read_parts(const std::string& path) { return parse_parts(read_text(path), path); }

}  // namespace burnish
