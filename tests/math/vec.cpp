// tests/math/vec.cpp -- vectors: what needs no own test elsewhere, and vectors of length zero
// SPDX-License-Identifier: Apache-2.0
#include <burnish/math/vec.h>
#include <differences.h>

using namespace differences;

TEST_CASE("vectors: one value and right slopes in every number", "[math][gradient]") {
  const auto apart = [](const auto& a, const auto& b, const auto& t) {
    using std::fabs;
    const bool far = fabs(a.x - b.x) > 0.1 && fabs(a.y - b.y) > 0.1 && fabs(a.z - b.z) > 0.1 && length(a) > 0.3;
    return far &&
           std::min({fabs(a.x), fabs(a.y), fabs(a.z), fabs(1 - fabs(a.x)), fabs(1 - fabs(a.y)), fabs(1 - fabs(a.z))}) >
               0.05 &&
           std::min({b.x, b.y, b.z, t}) > 0.2;
  };
  const vec3<double> none, b{1, 0.5, 2};
  holds("vec3",
        [](const auto& p, const auto& q, const auto& t) {
          auto sum = p * q + cross(p, q) / t - p / q * dot(p, q);
          sum += min(p, q) * length(p), sum -= max(p, q), sum *= mix(p, q, t);
          return normalize(p) + mix(sum, -p, q) + clamp(p * t, -t, t);
        },
        within(apart, vec3<double>(), vec3<double>(), 1.0), {.rounding = 1e-4},
        {"zero-length vectors", {}, {{none, b, 1.0}, {none, b, 0.5}}});
  holds("vec2",
        [](const auto& p3, const auto& q3, const auto& t) {
          const vec2 p{p3.x, p3.y}, q{q3.x, q3.y};
          auto sum = p * q - p / q * dot(p, q) - p / t;
          sum += -p * length(p), sum -= q, sum *= t;
          return normalize(p) + mix(sum, p, t);
        },
        within([&](const auto& p, const auto& q,
                   const auto& t) { return apart(p, q, t) && length(vec2<double>(p)) > 0.3; },
               vec3<double>(), vec3<double>(), 1.0),
        {.rounding = 1e-4}, {"zero-length vectors", {}, {{none, b, 1.0}}});
  holds(
      "vec4",
      [](const auto& p3, const auto& q3, const auto& t) {
        const vec4 p{p3, t}, q{q3, p3.x};
        return mix(p + q * t, p - q, dot(p, q));
      },
      within(apart, vec3<double>(), vec3<double>(), 1.0));
}
TEST_CASE("vectors: the zero vector normalised is itself", "[math][limit]") {
  CHECK(length(normalize(vec3<float>())) == 0);
  CHECK(length(normalize(vec2<double>())) == 0);
  CHECK(length(normalize(vec3<float>(1e-9f, 0, 0))) == Approx(1));
}
