// tests/misuse/forgotten_constexpr.cpp -- the compiler records only what it may run
// expect: the compiler cannot record this look; make every function that it calls constexpr
// SPDX-License-Identifier: Apache-2.0
#include <burnish/burnish.h>
using namespace burnish;

template <class T> struct Gloss {
  vec3<T> tint = {0.4f, 0.3f, 0.2f};
  static constexpr auto parameters() { return std::tuple{Param{"tint", &Gloss::tint, unit}}; }
};
template <class T> T darker(const T& x) { return 1.0f - x * x; }

int main() {
  const GBuffer g;
  const auto look = [](const auto& p, const auto& at) { return p.tint * darker(at.normal.z); };
  return backward<Player::compiled>(g, look, Gloss<float>{}, Image(1, 1)).tint.x > 0 ? 0 : 1;
}
