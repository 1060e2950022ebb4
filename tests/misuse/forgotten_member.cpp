// tests/misuse/forgotten_member.cpp -- a member that parameters() does not list would silently keep its value in a fit
// expect: parameters() of this struct does not list every member; add Param{
// SPDX-License-Identifier: Apache-2.0
#include <burnish/burnish.h>
using namespace burnish;

template <class T> struct Gloss {
  vec3<T> tint = {0.4f, 0.3f, 0.2f};
  T roughness = 0.3f;
  static constexpr auto parameters() { return std::tuple{Param{"tint", &Gloss::tint, unit}}; }
};

int main() {
  const auto [y, d] = differentiate([](const auto& g) { return g.roughness * g.tint.x; }, Gloss<float>{});
  return y > 0 && d.roughness > 0 ? 0 : 1;
}
