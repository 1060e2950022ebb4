// tests/record.h -- a claim that a test makes: checked, and kept as a row of the table in tests/README.md
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdlib>
#include <string>

namespace record {

/// Requires figure <= tolerance (not a number fails) and keeps the row for the page.
/// what: the function or struct by its public name, or a law in a few words. kind: gradient, value, law, image, ...
/// against: the independent path. figure: the worst that was found over `points` places. Of several claims that agree
/// in what, kind and against, the worst figure, the largest tolerance and all points make the row.
void claim(const std::string& what, const std::string& kind, const std::string& against, double tolerance,
           double figure, long points);

/// The largest of what it is given; what is no number stays.
struct Worst {
  double value = 0;
  void operator()(double x) {
    if (!(x <= value) && value == value) value = x;
  }
};

/// At how many random places a function is tried: 1,000, or what the environment's BURNISH_TEST_POINTS says.
inline int points() {
  static const int n = [] {
    const char* const text = std::getenv("BURNISH_TEST_POINTS");
    return text ? std::atoi(text) : 1000;
  }();
  return n;
}

}  // namespace record
