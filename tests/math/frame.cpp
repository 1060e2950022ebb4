// tests/math/frame.cpp -- frames are orthonormal, mirrored and refracted directions obey their laws
// SPDX-License-Identifier: Apache-2.0
#include <burnish/math/frame.h>
#include <differences.h>

using namespace differences;

namespace {
template <class T> bool orthonormal(const Frame<T>& f, double within) {
  const double errors[] = {double(dot(f.t, f.t)) - 1, double(dot(f.b, f.b)) - 1, double(dot(f.t, f.b)),
                           double(dot(f.t, f.n)),     double(dot(f.b, f.n)),     double(dot(cross(f.t, f.b), f.n)) - 1};
  return std::all_of(std::begin(errors), std::end(errors), [&](double e) { return std::fabs(e) < within; });
}
vec3<double> direction(std::mt19937_64& random) {
  std::normal_distribution<double> gauss;
  return normalize(vec3<double>{gauss(random), gauss(random), gauss(random)});
}
const auto long_enough = [](const auto& a, const auto&...) { return length(a) > 0.3; };
}  // namespace

TEST_CASE("Frame: is orthonormal and right-handed for every normal", "[math][value]") {
  std::mt19937_64 random(1);
  for (int i = 0; i < 1000; ++i) {
    const auto n = direction(random), a = direction(random);
    CHECK(orthonormal(frame_of(n), 1e-13));
    CHECK(orthonormal(frame_of(vec3<float>(n)), 1e-6));
    CHECK(orthonormal(frame_of(n, a * 3.0), 1e-12));
    CHECK(dot(frame_of(n, a).t, a) > 0);
    const auto f = frame_of(n, a), back = Frame<double>{f.t, f.b, f.n};
    CHECK(length(back.to_world(f.to_local(a)) - a) < 1e-14);
    CHECK(f.to_local(n).z == Approx(1));
  }
  for (const vec3<double> n :
       {vec3<double>{0, 0, 1}, vec3<double>{0, 0, -1}, vec3<double>{1, 0, 0}, vec3<double>{0, -1, 0}}) {
    CHECK(orthonormal(frame_of(n), 1e-15));
    CHECK(orthonormal(frame_of(n, n), 1e-15));
  }
}
TEST_CASE("Frame: one value and right slopes in every number", "[math][gradient]") {
  const auto off_turn = [](const auto& a, const auto&) { return std::fabs(a.z) > 0.1; };  // edge: n.z = 0
  const vec3<double> x{1, 0, 0}, z{0, 0, 1}, none;
  holds("frame_of, Frame", [](const auto& a, const auto& b) { return frame_of(normalize(a)).to_world(b); },
        within(off_turn, vec3<double>(), vec3<double>()), {},
        {"poles, n.z = 0, zero-length vectors", {{z, x}, {-z, x}, {x, x}, {z, none}}, {{none, x}}});
  holds("frame_of, Frame",
        [](const auto& a, const auto& b, const auto& c) { return frame_of(normalize(a), b).to_local(c); },
        within([](const auto& a, const auto& b,
                  const auto&) { return std::fabs(a.z) > 0.1 && length(a) > 0.3 && length(cross(a, b)) > 0.3; },
               vec3<double>(), vec3<double>(), vec3<double>()),
        {},
        {"poles, n.z = 0, zero-length vectors, a tangent along the normal",
         {{z, x, x}, {-z, x, z}},
         {{z, z, x}, {-x, x, x}, {z, none, x}, {none, x, x}, {none, none, none}}});
}
TEST_CASE("reflect and refract: lie in the plane of incidence and obey the laws of Euclid and Snell", "[math][value]") {
  std::mt19937_64 random(2);
  for (int i = 0; i < 1000; ++i) {
    const auto n = direction(random);
    auto v = direction(random);
    if (dot(n, v) < 0) v = -v;
    const auto r = reflect(v, n);
    CHECK(dot(r, n) == Approx(dot(v, n)));
    CHECK(length(r) == Approx(1));
    CHECK(std::fabs(dot(cross(v, n), r)) < 1e-14);
    for (const double eta : {1 / 1.5, 1.0, 1.3}) {
      const auto t = refract(v, n, eta);
      CHECK(length(t) == Approx(1).epsilon(1e-6));
      CHECK(std::fabs(dot(cross(v, n), t)) < 1e-14);
      CHECK(dot(t, n) < 0);
      const double sine = eta * length(cross(v, n));
      CHECK(length(cross(t, n)) == Approx(std::min(sine, 1.0)).epsilon(1e-6));
    }
  }
}
TEST_CASE("reflect and refract: one value and right slopes in every number", "[math][gradient]") {
  const vec3<double> x{1, 0, 0}, z{0, 0, 1}, none;
  holds("reflect", [](const auto& v, const auto& n) { return reflect(v, n); },
        within(anywhere, vec3<double>(), vec3<double>()), {},
        {"grazing, zero-length vectors", {{x, z}, {none, z}, {x, none}}});
  // Edge: the angle of total reflection.
  holds("refract",
        [](const auto& v, const auto& n, const auto& eta) { return refract(normalize(v), normalize(n), abs(eta)); },
        within(
            [](const auto& v, const auto& n, const auto& eta) {
              const double c = dot(normalize(v), normalize(n)), k = 1 - eta * eta * (1 - c * c);
              return long_enough(v) && long_enough(n) && std::fabs(k) > 0.15 && c * c < 0.99 && std::fabs(eta) > 0.1;
            },
            vec3<double>(), vec3<double>(), 1.0),
        {},
        {"grazing, along the normal, total reflection, index 1, zero-length vectors",
         {{x, z, 1.0}, {z, z, 1.5}, {x, z, 1.5}, {-x, z, 0.5}, {z, z, 1.0}},
         {{none, z, 1.5}, {x, none, 1.5}}});
}
