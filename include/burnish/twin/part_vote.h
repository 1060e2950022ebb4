// burnish/twin/part_vote.h -- masks of named components in several views, from whatever segmenter, vote on the parts
// SPDX-License-Identifier: Apache-2.0
//
// Lu et al., UrbanCAD (2024), supplement, "Part-level Material Prior Retrieval": a material's mask in the rendering is
// compared with its mask in the segmentation, that is with those of its pixels that the component's mask covers, and
// belongs to the component when their IoU is above 0.5. Here all views are counted together.
#pragma once
#include <burnish/twin/part_evidence.h>

namespace burnish {

/// Numbers of a label image: 0 for nothing known, else 1 + the place of the kind in PartKind.
constexpr int part_label(PartKind k) { return 1 + int(k); }

struct PartVote {
  PartKind kind = PartKind::other;
  float iou = 0;   // of the part's pixels that were labelled or not, the share under masks of that kind
  int pixels = 0;  // of the part, in all views that have labels
};
/// For every part the kind whose masks cover most of it. labels: a picture for every view, row by row; a view may be
/// left out with an empty one. Error for a picture of another size or with another number.
inline std::vector<PartVote> vote_parts(const std::vector<GBuffer>& views,
                                        const std::vector<std::vector<int>>& labels) {
  if (labels.size() > views.size())
    throw Error(std::to_string(labels.size()) + " label images for " + std::to_string(views.size()) + " views");
  const std::size_t parts = views.empty() ? 0 : views[0].parts.size();
  std::vector<PartVote> out(parts);
  std::vector<std::array<int, part_kinds>> covered(parts);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const GBuffer& g = views[v];
    if (labels[v].empty()) continue;
    if (labels[v].size() != std::size_t(g.width) * std::size_t(g.height))
      throw Error("label image of view " + std::to_string(v) + ": " + std::to_string(labels[v].size()) +
                  " pixels, expected " + std::to_string(g.width) + " x " + std::to_string(g.height));
    for (int i = 0; i < g.size(); ++i) {
      const int label = labels[v][std::size_t(g.pixel[std::size_t(i)])];
      const std::size_t p = std::size_t(g.part[std::size_t(i)]);
      if (label < 0 || label > part_kinds)
        throw Error("label image of view " + std::to_string(v) + ": value " + std::to_string(label) +
                    ", expected 0 to " + std::to_string(part_kinds));
      ++out[p].pixels;
      if (label > 0) ++covered[p][std::size_t(label - 1)];
    }
  }
  for (std::size_t p = 0; p < parts; ++p) {
    const auto most = std::max_element(covered[p].begin(), covered[p].end());
    out[p].kind = PartKind(most - covered[p].begin());
    out[p].iou = out[p].pixels > 0 ? float(*most) / float(out[p].pixels) : 0;
  }
  return out;
}

/// What a vote says; below the threshold nothing, but that the part is none of what was segmented.
inline PartWitness vote_witness(const PartVote& vote, float threshold = 0.5f) {
  PartWitness w(1, "");
  if (vote.pixels < 4 || vote.iou <= threshold) return w;
  w = PartWitness(1e-4f, "masks of " + std::string(name_of(vote.kind)) + ", IoU " + detail::percent(vote.iou));
  w[vote.kind] = vote.iou;
  if (is_wheel(vote.kind))  // segmenters know wheels, not what of them is rubber
    for (const PartKind k : {PartKind::tyre, PartKind::rim, PartKind::wheel}) w[k] = std::max(w[k], 0.7f * vote.iou);
  return w;
}

}  // namespace burnish
