// tests/math/sequence.cpp -- numbers of paths: even in pairs, apart from each other, the same everywhere
// SPDX-License-Identifier: Apache-2.0
#include <burnish/math/sequence.h>
#include <burnish_test.h>
#include <cmath>
#include <set>

using namespace burnish;

TEST_CASE("PathNumbers: each pair fills the square as (0, 2)-sequences do", "[math][value]") {
  for (const std::uint32_t pixel : {0u, 7u, 123456u})
    for (int pair = 0; pair < 4; ++pair)
      for (int m = 0; m <= 6; m += 2) {  // 2^m paths: one in each of the boxes of area 2^-m, whatever their shape
        const std::uint32_t n = 1u << m;
        for (int a = 0; a <= m; ++a) {
          std::set<std::pair<int, int>> boxes;
          for (std::uint32_t k = 0; k < n; ++k) {
            PathNumbers numbers(pixel, k, 1);
            vec2<float> u;
            for (int i = 0; i <= pair; ++i) u = numbers.pair();
            REQUIRE((u.x >= 0 && u.x < 1 && u.y >= 0 && u.y < 1));
            boxes.insert({int(u.x * float(1 << a)), int(u.y * float(1 << (m - a)))});
          }
          CHECK(boxes.size() == n);
        }
      }
}
TEST_CASE("PathNumbers: pairs, pixels and seeds do not follow each other", "[math][value]") {
  double by_pair = 0, by_pixel = 0, by_seed = 0;
  const int n = 4096;
  for (std::uint32_t k = 0; k < n; ++k) {
    PathNumbers a(k, 3, 1), b(k + 1, 3, 1), c(k, 3, 2);
    const float first = a.pair().x - 0.5f;
    by_pair += double(first * (a.pair().x - 0.5f)) * 12 / n;
    by_pixel += double(first * (b.pair().x - 0.5f)) * 12 / n;
    by_seed += double(first * (c.pair().x - 0.5f)) * 12 / n;
  }
  for (const double correlation : {by_pair, by_pixel, by_seed}) CHECK(std::abs(correlation) < 5 / std::sqrt(double(n)));
}
TEST_CASE("PathNumbers: the same numbers for the same path", "[math][value]") {
  constexpr auto third = [](std::uint32_t pixel) {
    PathNumbers n(pixel, 5, 9);
    n.pair(), n.pair();
    return n.pair();
  };
  constexpr vec2<float> fixed = third(11);
  const vec2<float> now = third(11);
  CHECK(now.x == fixed.x);
  CHECK(now.y == fixed.y);
  CHECK(third(12).x != fixed.x);
}
