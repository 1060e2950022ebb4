// burnish/twin/assign_parts.h -- which part of a CAD vehicle is body, window, wheel or light
// SPDX-License-Identifier: Apache-2.0
//
// Components that can be told come first, the body is the largest that remains, and what is coloured like it and lies
// outside is merged into it (Lu et al., UrbanCAD (2024), "Semantic-based Part Material Prior Retrieval"). Instead of
// networks the default witnesses are shape, names and opacity (twin/part_evidence.h); masks of any segmenter join in.
#pragma once
#include <map>
#include <set>
#include <burnish/twin/part_vote.h>

namespace burnish {

/// "This material is that", by the user; outweighs all. part < 0: all parts of that material.
struct GivenKind {
  std::string material;
  int part = -1;
  PartKind kind = PartKind::other;
  std::string from;  // what an Error about it begins with; empty: the material
};
struct AssignOptions {
  bool names = true;                     // whether names of parts and materials are looked at
  std::vector<std::vector<int>> labels;  // for vote_parts, in the order and size of part_cameras(); may be empty
  float threshold = 0.5f;                // IoU from which masks decide
  std::vector<GivenKind> given;
  int width = 256;  // of a view, pixels
};

namespace detail {
/// Around every pixel of a window, which other materials are near: pixels by material.
inline std::map<int, double> beside_windows(const std::vector<GBuffer>& views, const std::vector<PartGuess>& guess) {
  std::map<int, double> out;
  for (const GBuffer& g : views) {
    std::vector<int> part(std::size_t(g.width) * std::size_t(g.height), -1);
    for (int i = 0; i < g.size(); ++i) part[std::size_t(g.pixel[std::size_t(i)])] = g.part[std::size_t(i)];
    const int far = std::max(2, g.width / 40);
    for (int i = 0; i < g.size(); ++i) {
      if (guess[std::size_t(g.part[std::size_t(i)])].kind != PartKind::window) continue;
      const int x = g.pixel[std::size_t(i)] % g.width, y = g.pixel[std::size_t(i)] / g.width;
      for (const auto& [dx, dy] : {std::pair{far, 0}, {-far, 0}, {0, far}, {0, -far}}) {
        if (x + dx < 0 || x + dx >= g.width || y + dy < 0 || y + dy >= g.height) continue;
        const int p = part[std::size_t((y + dy) * g.width + x + dx)];
        if (p >= 0 && guess[std::size_t(p)].kind != PartKind::window) out[g.parts[std::size_t(p)].material_index] += 1;
      }
    }
  }
  return out;
}
/// For every part the one that is its mirror image across the middle plane, by their boxes; itself where it is its own,
/// -1 where there is none.
inline std::vector<int> mirrored_parts(const Mesh& m) {
  const Box box = bounds(m);
  const float near = 0.01f * box.size().x;
  std::vector<Box> boxes(m.parts.size());
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    for (int v : m.triangles[t]) boxes[std::size_t(m.part[t])].add(m.positions[std::size_t(v)]);
  std::vector<int> out(m.parts.size(), -1);
  for (std::size_t p = 0; p < out.size(); ++p) {
    float best = near;
    for (std::size_t q = 0; q < out.size(); ++q) {
      if (boxes[p].low.x > boxes[p].high.x || boxes[q].low.x > boxes[q].high.x) continue;
      const vec3<float> low(boxes[p].low.x, boxes[p].low.y, 2 * box.center().z - boxes[p].high.z),
          high(boxes[p].high.x, boxes[p].high.y, 2 * box.center().z - boxes[p].low.z);
      const vec3<float> a = low - boxes[q].low, b = high - boxes[q].high;
      const float d =
          std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z), std::abs(b.x), std::abs(b.y), std::abs(b.z)});
      if (d < best) best = d, out[p] = int(q);
    }
  }
  return out;
}
}  // namespace detail

/// A kind for every part. Error for a given material that the mesh has not, or label images that do not fit.
inline AssignedParts assign_parts(const Raycaster& scene, const AssignOptions& options = {}) {
  using enum PartKind;
  const Mesh& mesh = scene.mesh();
  const std::size_t n = mesh.parts.size();
  const std::vector<GBuffer> views = part_views(scene, options.width);
  const std::vector<Wheel> wheels = find_wheels(mesh);
  const std::vector<PartShape> shapes = part_shapes(scene, views, wheels);
  const std::vector<PartVote> votes =
      options.labels.empty() ? std::vector<PartVote>(n) : vote_parts(views, options.labels);

  // A hatch or a bonnet is shaped like a pane; but then most of its material is not.
  std::map<int, std::pair<double, double>> panes;  // by material: what is shaped so, and all but the wheels
  for (std::size_t p = 0; p < n; ++p) {
    auto& [like, all] = panes[mesh.parts[p].material_index];
    const double area = double(shapes[p].share) * double(1 - shapes[p].wheel);
    like += area * double(like_panes(shapes[p])), all += area;
  }

  AssignedParts out;
  out.parts.resize(n);
  std::vector<bool> told(n), fixed(n);  // told: by name or mask
  for (std::size_t p = 0; p < n; ++p) {
    const auto& [like, all] = panes[mesh.parts[p].material_index];
    const float material = all > 0 ? detail::ramp(float(like / all), 0.2f, 0.5f) : 0;
    // A pane too narrow for the views is one when the rest of its material is.
    const float own = like_panes(shapes[p]), pane = shapes[p].share < 0.02f && material > 0.9f && shapes[p].above > 0.7f
                                                        ? std::max(own, 0.7f)
                                                        : own * material;
    std::vector<PartWitness> w{shape_witness(shapes[p], mesh.parts[p], !wheels.empty(), pane),
                               opacity_witness(shapes[p], mesh.parts[p])};
    if (options.names) w.push_back(name_witness(mesh.parts[p]));
    told[p] = options.names && !w.back().says.empty();
    if (votes[p].iou > options.threshold) w.push_back(vote_witness(votes[p], options.threshold)), told[p] = true;
    out.parts[p] = judge(w, shapes[p].share);
  }
  // Left and right are of one kind: that of which more is known.
  const std::vector<int> mirrored = detail::mirrored_parts(mesh);
  const auto weight = [&](std::size_t p) { return out.parts[p].confidence * (shapes[p].share + 1e-6f); };
  for (std::size_t p = 0; p < n; ++p) {
    if (mirrored[p] < 0 || out.parts[p].kind == out.parts[std::size_t(mirrored[p])].kind) continue;
    const std::size_t q = std::size_t(mirrored[p]), from = weight(p) < weight(q) ? q : p, to = from == p ? q : p;
    if (mesh.parts[from].material_index != mesh.parts[to].material_index) continue;
    out.parts[to].kind = out.parts[from].kind;
    out.parts[to].reason += (out.parts[to].reason.empty() ? "" : ", ") + std::string("as on the other side");
    told[to] = told[to] || told[from];
  }
  for (const GivenKind& g : options.given) {
    bool found = false;
    for (std::size_t p = 0; p < n; ++p) {
      if (detail::lower(mesh.parts[p].material) != detail::lower(g.material) || (g.part >= 0 && g.part != int(p)))
        continue;
      out.parts[p].kind = g.kind, out.parts[p].confidence = 1, out.parts[p].reason = "given";
      found = fixed[p] = true;
    }
    if (found) continue;
    std::string all;
    std::set<std::string> names;
    for (const Part& p : mesh.parts)
      if (names.insert(p.material).second) all += (all.empty() ? "" : ", ") + p.material;
    const std::string part = g.part >= 0 ? "[" + std::to_string(g.part) + "]" : "";
    throw Error((g.from.empty() ? g.material + part : g.from) + ": the vehicle has no such material" +
                (g.part >= 0 ? " with that part" : "") + "; it has " + all);
  }

  // The body: of the materials that are nothing else, the largest, those more that windows are set in.
  const auto free = [&](std::size_t p) {
    return !fixed[p] && (out.parts[p].kind == body || (out.parts[p].kind == other && !told[p])) && shapes[p].pixels > 0;
  };
  const auto beside = detail::beside_windows(views, out.parts);
  double all_beside = 1e-9;
  for (const auto& [material, pixels] : beside) all_beside += pixels;
  std::map<int, double> score;
  bool given_body = false;
  for (std::size_t p = 0; p < n; ++p) {
    given_body |= fixed[p] && out.parts[p].kind == body;
    if (!free(p) || shapes[p].open < 0.2f) continue;
    const auto b = beside.find(mesh.parts[p].material_index);
    const double near = b == beside.end() ? 0 : b->second / all_beside;
    score[mesh.parts[p].material_index] +=
        double(shapes[p].share) * (0.2 + near) * (options.names && name_hints(mesh.parts[p].material).paint ? 3 : 1);
  }
  const auto largest =
      std::max_element(score.begin(), score.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const int main = largest == score.end() ? -1 : largest->first;
  out.body_material = main;
  double area = 0;
  vec3<float> paint;
  float paint_open = 0;
  for (std::size_t p = 0; p < n; ++p) {
    const bool is =
        given_body ? fixed[p] && out.parts[p].kind == body : free(p) && mesh.parts[p].material_index == main;
    if (!is) continue;
    area += double(shapes[p].share), paint = paint + shapes[p].color * shapes[p].share,
                                     paint_open += shapes[p].open * shapes[p].share;
  }
  if (area > 0) paint = paint / float(area), paint_open /= float(area);
  // Exporters write light greys where they know no colour.
  const bool untold = detail::apart(paint, vec3<float>(paint.y)) < 0.01f && paint.y > 0.45f;
  // A panel at the rear, shaped like a pane, in the body's colour is the body's.
  for (std::size_t p = 0; p < n; ++p) {
    const PartShape& s = shapes[p];
    if (out.parts[p].kind == window && !told[p] && !fixed[p] && s.ends > 0.8f && mesh.parts[p].opacity > 0.9f &&
        area > 0 && !untold && luminance(paint) > 0.05f && detail::apart(s.color, paint) < 0.06f)
      out.parts[p].kind = other;
  }
  for (std::size_t p = 0; p < n; ++p) {
    if (!free(p) || area == 0) continue;
    PartGuess& g = out.parts[p];
    const Part& part = mesh.parts[p];
    const PartShape& s = shapes[p];
    const float away = detail::apart(s.color, paint);
    const bool same = part.material_index == main, outside = s.open > 0.5f * paint_open;
    const auto b = beside.find(part.material_index);
    if (same && !given_body) {
      g.kind = body, g.confidence = std::max(g.confidence, std::clamp(0.6f + float(area), 0.0f, 0.95f));
      g.reason += (g.reason.empty() ? "" : ", ") + std::string("the largest that remains");
    } else if (outside && away < 0.06f && part.opacity > 0.9f && (!untold || (s.share > 0.03f && s.smooth > 0.3f))) {
      g.kind = body, g.confidence = 0.75f,
      g.reason += (g.reason.empty() ? "" : ", ") + std::string("coloured like the body");
    } else if (outside && luminance(s.color) > 0.08f && s.smooth > 0.3f &&
               (double(s.share) > area || (s.share > 0.05f && b != beside.end() && b->second > 0.15 * all_beside))) {
      g.kind = body, g.confidence = 0.55f,
      g.reason += (g.reason.empty() ? "" : ", ") + std::string("a second colour of the body");
    } else {
      g.kind = other, g.confidence = std::clamp(
                          0.5f + (outside ? 0.0f : 0.3f) + 0.3f * detail::ramp(s.share, 0.05f, 0.005f), 0.0f, 0.9f);
      if (g.reason.empty()) g.reason = "neither body nor anything that was found";
    }
  }

  // What is not seen takes the kind that the seen rest of its material has.
  std::map<int, std::array<double, part_kinds>> by_material;
  for (std::size_t p = 0; p < n; ++p)
    by_material[mesh.parts[p].material_index][std::size_t(out.parts[p].kind)] += double(shapes[p].share);
  for (std::size_t p = 0; p < n; ++p) {
    if (shapes[p].pixels > 0 || fixed[p]) continue;
    const auto& shares = by_material[mesh.parts[p].material_index];
    const auto most = std::max_element(shares.begin(), shares.end());
    double sum = 0;
    for (const double x : shares) sum += x;
    if (*most < 0.8 * sum || sum == 0) continue;
    out.parts[p].kind = PartKind(most - shares.begin()), out.parts[p].confidence = 0.6f;
    out.parts[p].reason = "not seen, its material is elsewhere";
  }

  // What could not be told apart.
  std::array<double, part_kinds> seen{};
  for (std::size_t p = 0; p < n; ++p) seen[std::size_t(out.parts[p].kind)] += double(shapes[p].share);
  const auto largest_part =
      std::max_element(shapes.begin(), shapes.end(), [](const auto& a, const auto& b) { return a.share < b.share; });
  const std::string most = n > 0 ? mesh.parts[std::size_t(largest_part - shapes.begin())].material : "";
  if (seen[std::size_t(window)] < 0.005)
    out.notes.push_back("windows: no part stands apart" +
                        (n > 0 && largest_part->share > 0.4f
                             ? "; not separable if there are any: material " + most + " covers " +
                                   detail::percent(largest_part->share) + " of what is seen"
                             : std::string()));
  if (seen[std::size_t(wheel)] + seen[std::size_t(tyre)] + seen[std::size_t(rim)] < 0.005)
    out.notes.push_back(
        "wheels: nothing round stands on the ground in pairs: missing, or not separable from material " + most);
  for (std::size_t p = 0; p < n; ++p) {
    const PartShape& s = shapes[p];
    if (s.wheel > 0.05f && s.wheel < 0.9f && s.wheel * s.share > 0.01f)
      out.notes.push_back("not separable: material " + mesh.parts[p].material + " (part " + std::to_string(p) +
                          ") is " + std::string(name_of(out.parts[p].kind)) + " and, to " + detail::percent(s.wheel) +
                          ", wheels");
    if (s.share > 0.01f && out.parts[p].confidence < PartGuess::sure)
      out.notes.push_back("unsure: material " + mesh.parts[p].material + " (part " + std::to_string(p) + ", " +
                          detail::percent(s.share) + ") may be " + std::string(name_of(out.parts[p].kind)));
  }
  return out;
}

}  // namespace burnish
