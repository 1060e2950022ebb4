// tests/fit/lists.cpp -- loops over lists: any length, sums that the way back needs and sums that it does not
// SPDX-License-Identifier: Apache-2.0
#include "players.h"

using namespace burnish;
using namespace players;

namespace {

template <class T> struct Lamp {
  vec3<T> direction = {0, 0, 1}, radiance = {1, 1, 1};
  static constexpr auto parameters() {
    return std::tuple{Param{"direction", &Lamp::direction}, Param{"radiance", &Lamp::radiance}};
  }
};
template <class T> struct Gloss {
  vec3<T> tint = {0.4f, 0.3f, 0.6f};
  T sharpness = 4.0f, lift = 0.1f;
  static constexpr auto parameters() {
    return std::tuple{Param{"tint", &Gloss::tint, unit}, Param{"sharpness", &Gloss::sharpness},
                      Param{"lift", &Gloss::lift}};
  }
};
std::vector<Lamp<float>> lamps(int n) {
  std::vector<Lamp<float>> v;
  for (int i = 0; i < n; ++i) {
    const float a = 2.4f * float(i);
    v.push_back(
        {normalize(vec3<float>{std::cos(a), std::sin(a), 1.2f}), vec3<float>{1.0f, 0.8f, 0.3f + 0.1f * float(i)}});
  }
  return v;
}
constexpr auto one_lamp = [](const auto& p, const auto& at, const auto& n, const auto& lamp) {
  const auto nl = dot(n, lamp.direction), nh = max(dot(n, normalize(lamp.direction + at.view)), 0.05f);
  return (p.tint * max(nl, 0.0f) + decltype(p.tint)(pow(nh, p.sharpness))) * lamp.radiance;
};
/// What does not change from turn to turn is written inside the loop, and hoisted.
constexpr auto look = [](const auto& p, const auto& at, const auto& list) {
  return repeat(list, [&](const auto& lamp) {
    const auto n = normalize(at.normal + at.tangent * p.lift);
    return one_lamp(p, at, n, lamp);
  });
};
constexpr auto film_look = [](const auto& p, const auto& at, const auto& list) {
  const auto c = look(p, at, list);
  const auto film = [&](const auto& x) { return 1.0f - exp(-x * p.sharpness * 0.2f); };
  return std::remove_cvref_t<decltype(c)>{film(c.x), film(c.y), film(c.z * c.x)};
};
/// Two loops, the second reads the first one's sum.
constexpr auto two_loops = [](const auto& p, const auto& at, const auto& list, const auto& others) {
  const auto c = repeat(list, [&](const auto& lamp) { return one_lamp(p, at, at.normal, lamp); });
  return repeat(others,
                [&](const auto& lamp) { return c * (p.lift * dot(lamp.radiance, c)) + p.tint * lamp.radiance; });
};
/// A parameter, a number of the pixel, a number of the item: none made in the loop.
constexpr auto same_terms = [](const auto& p, const auto& at, const auto& list) {
  const auto bent = at.uv.x * p.lift;
  const auto c = repeat(list, [&](const auto& lamp) {
    return std::remove_cvref_t<decltype(p.tint)>{p.sharpness, bent, lamp.radiance.z};
  });
  return c * c * p.tint;
};
constexpr auto array_look = [](const auto& p, const auto& at, const auto& array) {
  auto sum = one_lamp(p, at, at.normal, array[0]);
  for (std::size_t i = 1; i < array.size(); ++i) sum = sum + one_lamp(p, at, at.normal, array[i]);
  return sum;
};

}  // namespace

TEST_CASE("lists: lists of 0, 1, 2 and 9 items have the slopes of a tape in double", "[fit][agreement]") {
  const GBuffer g = patch(70);
  for (const int n : {0, 1, 2, 9}) {
    CAPTURE(n);
    agree(g, 3e-5, look, Gloss<float>{}, lamps(n));
  }
}
TEST_CASE("lists: a curve after the sum needs the sum on the way back", "[fit][agreement]") {
  const GBuffer g = patch(70);
  for (const int n : {0, 1, 9}) {
    CAPTURE(n);
    agree(g, 3e-5, film_look, Gloss<float>{}, lamps(n));
  }
}
TEST_CASE("lists: a second loop may read the sum of the first", "[fit][agreement]") {
  agree(patch(70), 3e-5, two_loops, Gloss<float>{}, lamps(3), lamps(5));
  agree(patch(70), 3e-5, two_loops, Gloss<float>{}, lamps(0), lamps(2));
}
TEST_CASE("lists: terms that do not depend on the item are counted as often as it is long", "[fit][limit]") {
  for (const int n : {0, 1, 3}) {
    CAPTURE(n);
    agree(patch(70), 3e-5, same_terms, Gloss<float>{}, lamps(n));
  }
}
TEST_CASE("lists: an array is unrolled and gives what a list gives", "[fit][agreement]") {
  const auto v = lamps(4);
  std::array<Lamp<float>, 4> array;
  std::copy(v.begin(), v.end(), array.begin());
  agree(patch(70), 3e-5, array_look, Gloss<float>{}, array);
}
