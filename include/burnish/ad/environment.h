// burnish/ad/environment.h -- what a player is given beside the recording
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/ad/operation.h>

namespace burnish {

/// count items of fields floats.
struct FlatList {
  const float* values;
  int fields, count;
};
struct Environment {
  const float* parameters = nullptr;       // of the model, in the order of each()
  const float* data = nullptr;             // the numbers of the look's data
  const float* const* pixels = nullptr;    // a plane for each field that differs from pixel to pixel
  float* const* d_pixels = nullptr;        // where the adjoints of active planes go, in the same order; else null
  const FlatList* lists = nullptr;
  const void* const* resources = nullptr;  // images, tables
  Scatter* scatters = nullptr;             // one a resource: adjoints of those that are fitted
  Lanes* kept = nullptr;                   // room for Turns::kept
};

}  // namespace burnish
