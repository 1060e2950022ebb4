// tests/math/sh.cpp -- spherical harmonics: closed forms, orthonormality, slopes
// SPDX-License-Identifier: Apache-2.0
#include <burnish/math/sh.h>
#include <differences.h>

using namespace differences;

TEST_CASE("Spherical harmonics: the first three bands are the textbook's polynomials", "[math][value]") {
  std::mt19937_64 random(6);
  std::normal_distribution<double> gauss;
  for (int i = 0; i < 100; ++i) {
    const auto d = normalize(vec3<double>{gauss(random), gauss(random), gauss(random)});
    const auto [x, y, z] = std::array{d.x, d.y, d.z};
    const double expected[] = {0.28209479,
                               0.48860251 * y,
                               0.48860251 * z,
                               0.48860251 * x,
                               1.09254843 * x * y,
                               1.09254843 * y * z,
                               0.31539157 * (3 * z * z - 1),
                               1.09254843 * x * z,
                               0.54627422 * (x * x - y * y)};
    const auto sh = spherical_harmonics<4>(d);
    for (std::size_t k = 0; k < 9; ++k) CHECK(sh[k] == Approx(expected[k]).margin(1e-7));
    CHECK(sh[20] == Approx(0.10578555 * (35 * z * z * z * z - 30 * z * z + 3)).margin(1e-6));
    CHECK(sh[16] == Approx(2.50334294 * x * y * (x * x - y * y)).margin(1e-6));
  }
}
TEST_CASE("Spherical harmonics: are orthonormal over the sphere", "[math][energy]") {
  // Exact quadrature of polynomials to degree 8: Gauss-Legendre with 5 knots in z, 10 equal steps in phi.
  constexpr double knot[] = {-0.906179845938664, -0.538469310105683, 0, 0.538469310105683, 0.906179845938664};
  constexpr double weight[] = {0.236926885056189, 0.478628670499366, 0.568888888888889, 0.478628670499366,
                               0.236926885056189};
  double gram[25][25] = {};
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 10; ++j) {
      const double phi = (j + 0.3) * 2 * 3.14159265358979324 / 10, r = std::sqrt(1 - knot[i] * knot[i]);
      const auto y = spherical_harmonics<4>(vec3<double>{r * std::cos(phi), r * std::sin(phi), knot[i]});
      for (std::size_t a = 0; a < 25; ++a)
        for (std::size_t b = 0; b < 25; ++b) gram[a][b] += y[a] * y[b] * weight[i] * 2 * 3.14159265358979324 / 10;
    }
  for (int a = 0; a < 25; ++a)
    for (int b = 0; b < 25; ++b) CHECK(gram[a][b] == Approx(a == b).margin(1e-6));
}
TEST_CASE("Spherical harmonics: one value and right slopes in every number", "[math][gradient]") {
  // All harmonics are in the sum.
  holds("sh_sum, spherical_harmonics",
        [](const auto& d) {
          using T = std::remove_cvref_t<decltype(d.x)>;
          std::array<T, 25> c;
          for (int i = 0; i < 25; ++i) c[std::size_t(i)] = T(0.125f * float(i * 7 % 11) - 0.5f);
          return sh_sum<4>(c, normalize(d));
        },
        within([](const auto& d) { return length(d) > 0.3; }, vec3<double>()), {},
        {"poles, a zero-length vector", {{{0, 0, 1}}, {{0, 0, -1}}, {{0, 1, 0}}}, {{{0, 0, 0}}}});
  std::array<vec3<float>, 4> sky{vec3<float>(1.0f), vec3<float>(0.0f), vec3<float>(0.5f), vec3<float>(0.0f)};
  CHECK(sh_sum<1>(sky, vec3<float>{0, 0, 1}).y == Approx(0.28209479 + 0.24430126));
}
