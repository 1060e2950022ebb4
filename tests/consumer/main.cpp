// tests/consumer/main.cpp -- includes what a user would, from where the package put it
// SPDX-License-Identifier: Apache-2.0
#include <burnish/burnish.h>
#if defined(CONSUMER_RAYCAST) && __has_include(<burnish/scene/raycast.h>)
#include <burnish/scene/raycast.h>
#endif
#if defined(CONSUMER_IO) && __has_include(<burnish/io/photo.h>)
#include <burnish/io/photo.h>
#endif
#include <cstdio>

int main() { std::printf("burnish %d.%d.%d\n", BURNISH_VERSION_MAJOR, BURNISH_VERSION_MINOR, BURNISH_VERSION_PATCH); }
