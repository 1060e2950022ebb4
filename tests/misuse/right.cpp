// tests/misuse/right.cpp -- what the other programs here should have written
// compiles
// SPDX-License-Identifier: Apache-2.0
#include <burnish/burnish.h>
using namespace burnish;

template <class T> struct Gloss {
  vec3<T> tint = {0.4f, 0.3f, 0.2f};
  T roughness = 0.3f;
  int rows = 4;
  static constexpr auto parameters() {
    return std::tuple{Param{"tint", &Gloss::tint, unit}, Param{"roughness", &Gloss::roughness, unit}, Fixed{&Gloss::rows}};
  }
};
template <class T> constexpr T dimmed(const T& x) { return select(x < 0.5f, x, sqrt(x)); }

int main() {
  const auto [y, d] = differentiate([](const auto& g) { return dimmed(g.roughness) * g.tint.x; }, Gloss<float>{});
  const auto [z, dz] = differentiate([](auto x) { return dimmed(x); }, 0.3);
  const Recorded constant = dimmed(Recorded(0.3f));
  return y > 0 && d.roughness > 0 && z > 0 && dz > 0 && sizeof(constant) > 0 ? 0 : 1;
}
