// tests/misuse/nested_repeat.cpp -- a recording has loops, but no loop in a loop
// expect: repeat inside repeat is not recorded; flatten the two lists into one
// SPDX-License-Identifier: Apache-2.0
#include <burnish/burnish.h>
using namespace burnish;

template <class T> struct Gloss {
  vec3<T> tint = {0.4f, 0.3f, 0.2f};
  static constexpr auto parameters() { return std::tuple{Param{"tint", &Gloss::tint, unit}}; }
};
template <class T> struct Lamp {
  vec3<T> radiance = {1, 1, 1};
  static constexpr auto parameters() { return std::tuple{Param{"radiance", &Lamp::radiance}}; }
};

int main() {
  const GBuffer g;
  const std::vector<Lamp<float>> lamps(2);
  const auto look = [](const auto& p, const auto&, const auto& list) {
    return repeat(list, [&](const auto& a) { return repeat(list, [&](const auto& b) { return p.tint * a.radiance * b.radiance; }); });
  };
  return backward<Player::compiled>(g, with(look, lamps), Gloss<float>{}, Image(1, 1)).tint.x > 0 ? 0 : 1;
}
