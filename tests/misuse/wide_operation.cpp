// tests/misuse/wide_operation.cpp -- an operation of one's own with more inputs than the players carry
// expect: an operation has at most 10 inputs and 14 outputs
// SPDX-License-Identifier: Apache-2.0
#include <burnish/burnish.h>
using namespace burnish;

struct Wide {
  static constexpr int inputs = 11, outputs = 1;
  static constexpr bool active = true;
  template <class T> static void value(const T* x, T* y) { y[0] = x[0] + x[10]; }
  template <class T> static void back(const T*, const T*, const T* d_y, T* d_x) {
    for (int k = 0; k < inputs; ++k) d_x[k] = k == 0 || k == 10 ? d_y[0] : T(0.0f);
  }
};

int main() { return info<Wide>.inputs == 11 ? 0 : 1; }
