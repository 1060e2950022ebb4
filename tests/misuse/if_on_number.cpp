// tests/misuse/if_on_number.cpp -- a recording knows one way only, whatever the number is
// expect: write select(condition, a, b), min, max or clamp
// SPDX-License-Identifier: Apache-2.0
#include <burnish/burnish.h>

template <class T> constexpr T dimmed(const T& x) {
  if (x < 0.5f) return x;
  return sqrt(x);
}

int main() {
  const burnish::Recorded y = dimmed(burnish::Recorded(0.3f));
  return sizeof(y) > 0 ? 0 : 1;
}
