// tests/shade/sample.cpp -- what is drawn for path tracing has the density it says, and integrates to the reflectance
// SPDX-License-Identifier: Apache-2.0
#include <burnish/shade/sample.h>
#include <burnish_test.h>
#include <cmath>
#include <random>
#include <record.h>

using namespace burnish;

namespace {
/// Over the upper half around z, evenly in cosine and azimuth.
template <class F> double over_hemisphere(F f, int n = 600) {
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double z = (i + 0.5) / n, phi = 2 * 3.14159265358979 * (j + 0.5) / n, s = std::sqrt(1 - z * z);
      sum += f(vec3<float>(float(s * std::cos(phi)), float(s * std::sin(phi)), float(z)));
    }
  return sum * 2 * 3.14159265358979 / (double(n) * n);
}
Surface<float> paint() {
  Surface<float> s;
  s.base_color = {0.5f, 0.2f, 0.1f}, s.base_metalness = 0.4f, s.specular_roughness = 0.5f;
  s.coat_weight = 1, s.coat_roughness = 0.3f;
  return s;
}
}  // namespace

TEST_CASE("sample_brdf: the mean of f / density over what it draws is the reflectance", "[shade][agreement]") {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> u(0, 1);
  record::Worst worst;
  for (const float angle : {0.1f, 0.7f, 1.3f}) {
    const vec3<float> n(0, 0, 1), v(std::sin(angle), 0, std::cos(angle));
    const Layers<float> s = layers(paint());
    const LobeChances chances = lobe_chances(s, v.z);
    CHECK(double(chances.coat + chances.base + chances.diffuse) == Approx(1));
    double drawn = 0;
    const int count = 400000;
    for (int i = 0; i < count; ++i) {
      const vec3<float> l = sample_brdf(s, chances, n, v, {u(random), u(random), u(random)});
      const float p = brdf_density(s, chances, n, v, l);
      if (p > 0) drawn += double(brdf_cos(s, n, n, v, l).x / p) / count;
    }
    const double whole = over_hemisphere([&](const vec3<float>& l) { return double(brdf_cos(s, n, n, v, l).x); });
    worst(std::abs(drawn / whole - 1));
  }
  record::claim("sample_brdf: reflectance of a coated metal and dielectric, drawn", "law", "quadrature", 0.01,
                worst.value, 1200000);
}
TEST_CASE("brdf_density: it integrates to one, less what the lobes send below the surface", "[shade][energy]") {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> u(0, 1);
  for (const float angle : {0.1f, 0.7f, 1.3f}) {
    const vec3<float> n(0, 0, 1), v(std::sin(angle), 0, std::cos(angle));
    const Layers<float> s = layers(paint());
    const LobeChances chances = lobe_chances(s, v.z);
    double above = 0;
    for (int i = 0; i < 200000; ++i)
      above += sample_brdf(s, chances, n, v, {u(random), u(random), u(random)}).z > 0 ? 1 / 200000.0 : 0;
    const double whole = over_hemisphere([&](const auto& l) { return double(brdf_density(s, chances, n, v, l)); });
    CHECK(whole == Approx(above).margin(4e-3));
  }
}
