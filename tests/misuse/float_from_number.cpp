// tests/misuse/float_from_number.cpp -- a number is no float: what is done with the float would have no slope
// expect: burnish::Recorded
// expect: const float r = p.roughness
// SPDX-License-Identifier: Apache-2.0
#include <burnish/burnish.h>
using namespace burnish;

template <class T> struct Gloss {
  vec3<T> tint = {0.4f, 0.3f, 0.2f};
  T roughness = 0.3f;
  static constexpr auto parameters() {
    return std::tuple{Param{"tint", &Gloss::tint, unit}, Param{"roughness", &Gloss::roughness, unit}};
  }
};

int main() {
  const GBuffer g;
  const auto look = [](const auto& p, const auto&) {
    const float r = p.roughness;
    return p.tint * r;
  };
  return backward(g, look, Gloss<float>{}, Image(1, 1)).roughness > 0 ? 0 : 1;
}
