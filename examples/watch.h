// examples/watch.h -- what a fit of parts tells of itself, and what more it may be told to match
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include "street.h"

namespace fitting {
using namespace burnish;
using parts::Role;
using street::Photo;

/// Told how far a stage of the work is: done < of while it goes on, and once done == of with a note on what came of it.
/// Gives false to stop; what was done is kept.
using Watch = std::function<bool(const std::string& stage, int done, int of, const std::string& note)>;

/// One more loss of a part's picture: its value; adds its derivative to d_image.
using Loss = std::function<double(const Image& image, Image& d_image)>;
/// Makes it for a part, from the photo, the part's mask there and the part's mask in the model's picture; may be empty,
/// and may give an empty one.
using MoreLoss = std::function<Loss(Role, const Photo&, const Mask& photographed, const Mask& rendered)>;

}  // namespace fitting
