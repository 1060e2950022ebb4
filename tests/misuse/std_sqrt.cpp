// tests/misuse/std_sqrt.cpp -- std::sqrt knows plain numbers only; write sqrt
// expect: no matching function for call to
// expect: std::sqrt(x)
// SPDX-License-Identifier: Apache-2.0
#include <burnish/burnish.h>

template <class T> constexpr T dimmed(const T& x) { return std::sqrt(x); }

int main() {
  const burnish::Recorded y = dimmed(burnish::Recorded(0.3f));
  return sizeof(y) > 0 ? 0 : 1;
}
