// examples/pattern.h -- the pattern of a part as one more loss of its fit: Gram matrices of features
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <numeric>
#include <burnish/fit/gram.h>
#include "watch.h"

namespace fitting {

/// Without the two outer rows of pixels, or one, or none: as many as leave a quarter of the part.
inline Mask inner(const Mask& mask) {
  const auto area = [](const Mask& m) { return std::accumulate(m.values.begin(), m.values.end(), 0.0); };
  for (const int radius : {2, 1})
    if (Mask m = eroded(mask, radius); 4 * area(m) >= area(mask)) return m;
  return mask;
}

/// weight times the GramLoss of every part, less its border. every: it is evaluated at each so many steps, and what it
/// gave stands until then; for features that cost much.
template <class F> MoreLoss pattern(const F& features, double weight, int every = 1) {
  struct Part {
    GramLoss<F> loss;
    int step = 0;
    double value = 0;
    Image d;
  };
  return [=](Role, const Photo& photo, const Mask& photographed, const Mask& rendered) -> Loss {
    const auto part = std::make_shared<Part>(Part{{features, photo.image, inner(photographed)}, 0, 0, {}});
    return [=, rendered = inner(rendered)](const Image& image, Image& d_image) {
      if (part->step++ % every == 0) {
        part->d = Image(image.width, image.height);
        part->value = part->loss(image, rendered, weight, part->d);
      }
      for (std::size_t i = 0; i < d_image.values.size(); ++i) d_image.values[i] += part->d.values[i];
      return part->value;
    };
  };
}

}  // namespace fitting
