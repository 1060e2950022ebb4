// burnish/scene/error.h -- the one exception type: a wrong file or a wrong argument
// SPDX-License-Identifier: Apache-2.0
//
// Thrown by io/, raycast.h and the programs, never by the floors ad to light.
#pragma once
#include <stdexcept>

namespace burnish {

/// what() is one line that names the file, what was found and what was expected: "car.obj: no triangles, expected
/// some".
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace burnish
