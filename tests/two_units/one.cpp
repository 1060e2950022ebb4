// tests/two_units/one.cpp -- everything included in two files of one program: nothing is defined twice
// SPDX-License-Identifier: Apache-2.0
#include <burnish/burnish.h>

int version_seen_by_two();

int main() {
  const int version = BURNISH_VERSION_MAJOR * 10000 + BURNISH_VERSION_MINOR * 100 + BURNISH_VERSION_PATCH;
  return version == version_seen_by_two() ? 0 : 1;
}
