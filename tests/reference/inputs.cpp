// tests/reference/inputs.cpp -- the random inputs are the generator's, and wrong files are named
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
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

TEST_CASE("Reference files: types are read, and what is wrong is named", "[reference][value]") {
  CHECK(reference::from_half(0x3C00) == 1);
  CHECK(reference::from_half(0xC000) == -2);
  CHECK(reference::from_half(0x3555) == 0.333251953125);
  CHECK(reference::from_half(0x0001) == std::ldexp(1, -24));
  CHECK(reference::from_half(0x7BFF) == 65504);
  const auto message = [](const std::string& bytes) -> std::string {
    std::ofstream("wrong.npy", std::ios::binary) << bytes;
    try {
      const reference::Array a = reference::read_npy("wrong.npy");
      return "read " + std::to_string(a.size());
    } catch (const std::runtime_error& e) {
      return e.what();
    }
  };
  const auto npy = [](const std::string& header, const std::string& numbers) {
    return std::string("\x93NUMPY\x01\x00", 8) + char(header.size()) + char(0) + header + numbers;
  };
  const std::string shape = "'fortran_order': False, 'shape': (2,), }\n";
  CHECK(message(npy("{'descr': '|u1', " + shape, "ab")) == "read 2");
  CHECK(message(npy("{'descr': '|u1', " + shape, "a")) == "wrong.npy: 1 bytes of numbers, expected 2");
  CHECK(message(npy("{'descr': '<f8', " + shape, "ab")) ==
        "wrong.npy: type '<f8', expected '<f4', '<f2', '<i4' or '|u1'");
  CHECK(message("no numbers at all") == "wrong.npy: no .npy file");
  CHECK(message(npy("{'descr': '|u1', 'fortran_order': True, 'shape': (2,), }", "ab")) ==
        "wrong.npy: columns first, expected rows first");
  std::filesystem::remove("wrong.npy");
  CHECK_THROWS_WITH(reference::load("none"), Catch::Matchers::EndsWith("generate.py --write makes it"));
}
