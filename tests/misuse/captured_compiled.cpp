// tests/misuse/captured_compiled.cpp -- the compiler cannot record what is known at run time only
// expect: this look captures; the compiler cannot record it. Hand run-time data over with with(look, data...)
// SPDX-License-Identifier: Apache-2.0
#include <burnish/burnish.h>
using namespace burnish;

template <class T> struct Gloss {
  vec3<T> tint = {0.4f, 0.3f, 0.2f};
  static constexpr auto parameters() { return std::tuple{Param{"tint", &Gloss::tint, unit}}; }
};

int main(int count, char**) {
  const GBuffer g;
  const float exposure = float(count);
  const auto look = [exposure](const auto& p, const auto& at) { return p.tint * (at.normal.z * exposure); };
  return backward<Player::compiled>(g, look, Gloss<float>{}, Image(1, 1)).tint.x > 0 ? 0 : 1;
}
