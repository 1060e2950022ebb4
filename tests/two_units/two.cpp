// tests/two_units/two.cpp -- the other file of the program
// SPDX-License-Identifier: Apache-2.0
#include <burnish/burnish.h>

int version_seen_by_two() { return BURNISH_VERSION_MAJOR * 10000 + BURNISH_VERSION_MINOR * 100 + BURNISH_VERSION_PATCH; }
