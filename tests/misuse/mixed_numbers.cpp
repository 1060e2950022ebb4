// tests/misuse/mixed_numbers.cpp -- one tape holds one number type
// expect: differentiate takes arguments of one plain number type: all float or all double
// SPDX-License-Identifier: Apache-2.0
#include <burnish/burnish.h>

int main() {
  const auto r = burnish::differentiate([](auto x, auto y) { return x * y; }, 1.0f, 2.0);
  return std::get<0>(r) > 0 ? 0 : 1;
}
