// burnish/twin/parts.h -- what the parts of a vehicle are: kinds, and what names and opacity tell of them
// SPDX-License-Identifier: Apache-2.0
//
// A mesh part is a piece of one material (scene/mesh.h). CAD files say little about it and never in the same words;
// what they say is in names, opacities, colours and textures. What the shape tells is in twin/part_shape.h, and
// twin/assign_parts.h puts both together.
#pragma once
#include <algorithm>
#include <array>
#include <cctype>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <burnish/scene/vehicle.h>

namespace burnish {

/// wheel: tyre and rim in one. other: whatever is none of these, and what is never seen from outside.
enum class PartKind { body, window, wheel, tyre, rim, light, other };
inline constexpr int part_kinds = 7;
inline constexpr std::array<std::string_view, part_kinds> part_kind_names{"body", "window", "wheel", "tyre",
                                                                          "rim",  "light",  "other"};
constexpr std::string_view name_of(PartKind kind) { return part_kind_names[std::size_t(kind)]; }
/// Nothing when there is no kind of that name.
constexpr std::optional<PartKind> part_kind_of(std::string_view name) {
  for (int k = 0; k < part_kinds; ++k)
    if (part_kind_names[std::size_t(k)] == name) return PartKind(k);
  return {};
}
constexpr bool is_wheel(PartKind k) { return k == PartKind::wheel || k == PartKind::tyre || k == PartKind::rim; }
/// The label that a photo's pixels of this kind have: 1 paint, 2 glass, 3 rubber, 4 other (0 is not the vehicle).
constexpr int photo_label(PartKind k) {
  return k == PartKind::body ? 1 : k == PartKind::window ? 2 : k == PartKind::tyre || k == PartKind::wheel ? 3 : 4;
}

/// What a part is taken for.
struct PartGuess {
  PartKind kind = PartKind::other;
  float confidence = 0;  // 0 to 1; below `sure` it is said to be unsure
  float share = 0;       // of the vehicle's visible area, seen from all round, 0 to 1
  std::string reason;    // in a few words, "wheel discs 97 %, name tire"
  static constexpr float sure = 0.5f;
};

/// A kind for every part of a mesh, and what could not be decided.
struct AssignedParts {
  std::vector<PartGuess> parts;
  std::vector<std::string> notes;  // refusals and doubts, one line each
  int body_material = -1;          // Part::material_index of the largest body; -1: none, or the user said what it is

  std::vector<PartKind> kinds() const {
    std::vector<PartKind> out;
    for (const PartGuess& p : parts) out.push_back(p.kind);
    return out;
  }
};

/// What the words of a name hint at, English, French, German, Italian, Spanish or Portuguese; several may be true.
struct NameHints {
  bool glass = false, lamp = false, tyre = false, rim = false, wheel = false, paint = false;
  bool color = false;  // red, white, ...: of lamps, now and then of paint
  bool rest = false;   // chrome, seats, plastic and the like

  bool any() const { return glass || lamp || tyre || rim || wheel || paint || color || rest; }
};
inline NameHints name_hints(const std::string& name) {
  Part part;
  part.name = name;
  const std::string words = detail::words_of(part);
  const auto has = [&](std::initializer_list<const char*> wanted) {
    return std::any_of(wanted.begin(), wanted.end(), [&](const char* w) { return words.find(w) != words.npos; });
  };
  NameHints h;
  h.glass = has({"glass", "window", "windsh", "windsc", "vitre", "verre", "_glas", "vidro", "parabri", "scheibe",
                 "ventan", "vetro", "cristal"});
  h.lamp = has({"light", "lamp", "optic", "indicator", "blinker", "luz", "luces", "faro_", "farol", "phare", "feux",
                "scheinw", "_turn_", "lanterna", "lite_"});
  h.tyre = has({"tire_", "tires", "tyre", "rubber", "pneu", "borracha", "reifen", "gomma"});
  h.rim = has({"_rim", "alloy", "hubcap", "felge", "jante", "cerchi"});
  h.wheel = has({"wheel", "wheek", "roda_", "roue_", "_rad_", "ruota", "rueda"}) && !has({"steer", "arch", "well"});
  h.paint = has({"paint", "body", "carroc", "pintura", "firstcolor", "first_color", "main_color", "_lack", "carross",
                 "vernice", "karosse"});
  h.color = has({"_red_", "orange", "yellow", "white"});
  h.rest =
      has({"chrom",     "interior", "interna", "seat",      "plate",    "mirror",  "black",   "grill",   "doorline",
           "door_line", "metal_",   "steel",   "plastic",   "logo",     "badge",   "under",   "exhaust", "engine",
           "reflector", "shadow",   "lowpart", "holes",     "textured", "brake",   "caliper", "banco_",  "painel",
           "volante",   "motor_",   "armatur", "dashboard", "sedile",   "asiento", "espelho"});
  return h;
}

}  // namespace burnish
