// tests/reference/inputs.cpp -- the random inputs are the generator's, and wrong files are named
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include "npy.h"
#include "inputs.h"

TEST_CASE("Reference inputs: splitmix64 gives its published first numbers", "[reference][value]") {
  // The first outputs for the state 0, as in the known-answer tests of Java, Rust's rand_xoshiro and NumPy's seeds.
  CHECK(reference::splitmix64(0) == 0xE220A8397B1DCDAFu);
  CHECK(reference::splitmix64(1) == 0x6E789E6AA1B965F4u);
  CHECK(reference::splitmix64(2) == 0x06C45D188009454Fu);
}

TEST_CASE("Reference inputs: test and generator make the same", "[reference][agreement]") {
  const reference::Array made = reference::load("inputs");
  REQUIRE(made.shape == std::vector<std::size_t>{250, 4});
  int other = 0;
  for (std::size_t i = 0; i < 250; ++i)
    for (std::size_t j = 0; j < 4; ++j) other += made(i, j) != reference::between(1, i, j, -3, 0.7);
  CHECK(other == 0);
}

TEST_CASE("Reference files: one that is missing says how it is made", "[reference][limit]") {
  CHECK_THROWS_WITH(reference::load("none"), Catch::Matchers::EndsWith("generate.py --write makes it"));
}
