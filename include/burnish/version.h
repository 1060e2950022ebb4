// burnish/version.h -- the only place of the version; CMake reads it
// SPDX-License-Identifier: Apache-2.0
//
// Semantic versioning (2.0.0). Before 1.0 a new minor version may change the API; CHANGELOG.md says how.
#pragma once

#define BURNISH_VERSION_MAJOR 0
#define BURNISH_VERSION_MINOR 1
#define BURNISH_VERSION_PATCH 0
