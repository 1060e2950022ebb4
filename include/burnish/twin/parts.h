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

  std::vector<PartKind> kinds() const {
    std::vector<PartKind> out;
    for (const PartGuess& p : parts) out.push_back(p.kind);
    return out;
  }
};

namespace detail {
inline bool any_of(const std::string& text, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* w) { return text.find(w) != std::string::npos; });
}
/// "_words_of_the_material_" or of the part.
inline std::string words(const std::string& material, const std::string& name = "") {
  Part p;
  p.material = material, p.name = name;
  return words_of(p);
}
/// What words tell; nothing when they do not. English, French, German, Italian, Spanish and Portuguese.
inline std::optional<PartKind> told_by_words(const std::string& w, float opacity) {
  const bool lamp =
      any_of(w, {"light", "lamp", "optic", "_red", "orange", "yellow", "white", "indicator", "blinker", "luz", "faro",
                 "phare", "scheinw", "_turn_"});
  if (any_of(w, {"glass", "window", "windsh", "windsc", "vitre", "verre", "_glas", "vidro", "parabri", "scheibe",
                 "ventan", "vetro", "cristal"}))
    return lamp && opacity > 0.85f ? PartKind::light : PartKind::window;
  if (any_of(w, {"tire", "tyre", "rubber", "pneu", "borracha", "reifen", "llanta"})) return PartKind::tyre;
  if (any_of(w, {"_rim", "alloy", "hubcap", "felge", "jante", "cerchi"})) return PartKind::rim;
  if (lamp) return PartKind::light;
  if (any_of(w, {"chrom",     "interior", "interna",   "seat",     "plate",     "mirror",  "black",  "grill",
                 "doorline",  "door_line", "metal_",   "steel",    "plastic",   "logo",    "badge",  "under",
                 "exhaust",   "engine",   "reflector", "shadow",   "lowpart",   "holes",   "textured", "brake",
                 "caliper",   "banco",    "painel",    "volante"}))
    return PartKind::other;
  return {};
}
}  // namespace detail

/// Whether the material's name calls it the paint.
inline bool told_paint(const Part& p) {
  return detail::any_of(detail::words(p.material),
                        {"paint", "body", "carroc", "pintura", "firstcolor", "main_color", "lack_", "carross", "vernice"});
}
/// Whether the name of the material tells something.
inline bool told_by_material(const Part& p) {
  const std::string w = detail::words(p.material);
  return told_paint(p) || detail::told_by_words(w, p.opacity);
}
/// What a part's words and opacity tell: first its material's, then its own; nothing when they do not. A material that
/// is called paint tells nothing here, whatever its colour is called, but that it may be the body.
inline std::optional<PartKind> told_kind(const Part& p) {
  const std::string material = detail::words(p.material);
  if (detail::any_of(material, {"paint", "pintura"}) && !detail::any_of(material, {"black"})) return {};
  if (const auto kind = detail::told_by_words(material, p.opacity)) return kind;
  if (const auto kind = detail::told_by_words(detail::words("", p.name), p.opacity)) return kind;
  if (detail::any_of(detail::words(p.material, p.name), {"wheel", "wheek", "roda_", "roue_"})) return PartKind::wheel;
  if (p.opacity < 0.75f) return PartKind::window;
  return {};
}

}  // namespace burnish
