// tests/ad/differentiate.cpp -- the tape at one point: any control flow, any arguments, nested and on every thread
// SPDX-License-Identifier: Apache-2.0
#include <burnish/ad/differentiate.h>
#include <burnish/ad/dual.h>
#include <burnish/ad/parallel.h>
#include <burnish/math/vec.h>
#include <burnish_test.h>

using namespace burnish;

TEST_CASE("differentiate: the first example", "[ad][value]") {
  const auto [z, dz_dx, dz_dy] = differentiate([](auto x, auto y) { return sin(x) * exp(x * y); }, 1.0, 2.0);
  CHECK(z == Approx(std::sin(1.0) * std::exp(2.0)));
  CHECK(dz_dx == Approx((std::cos(1.0) + 2 * std::sin(1.0)) * std::exp(2.0)));
  CHECK(dz_dy == Approx(std::sin(1.0) * std::exp(2.0)));
}
TEST_CASE("differentiate: in float", "[ad][value]") {
  const auto [y, d] = differentiate([](auto x) { return x * x * x; }, 2.0f);
  static_assert(std::is_same_v<decltype(d), const float>);
  CHECK((y == 8 && d == 12));
}
TEST_CASE("differentiate: if, while and recursion on a number", "[ad][value]") {
  const auto root = [](auto x) {  // Newton (1669), until it stands
    auto y = x;
    while (abs(y * y - x) > 1e-14f) y = 0.5f * (y + x / y);
    return y;
  };
  const auto [y, d] = differentiate(root, 2.0);
  CHECK(y == Approx(std::sqrt(2.0)).epsilon(1e-12));
  CHECK(d == Approx(0.5 / std::sqrt(2.0)).epsilon(1e-9));
  const auto [z, e] = differentiate([](auto x) { if (x > 3.0f) return x * 2.0f; return x * x; }, 1.5);
  CHECK((z == 2.25 && e == 3));
}
TEST_CASE("differentiate: a function of nothing given has slope zero", "[ad][limit]") {
  const auto [y, d] = differentiate([](auto) { return 4.0; }, 1.0);
  CHECK((y == 4 && d == 0));
  const auto [z, e] = differentiate([](auto x) { return x; }, 3.0);
  CHECK((z == 3 && e == 1));
}
TEST_CASE("differentiate: a number used many times collects every slope", "[ad][value]") {
  const auto [y, d] = differentiate([](auto x) {
    auto s = x;
    for (int i = 0; i < 9; ++i) s += x * float(i);
    s *= s;
    s -= x;
    s /= x;
    return -s;
  }, 2.0);
  CHECK(y == Approx(-(37.0 * 37 * 2 - 1)));
  CHECK(d == Approx(-37.0 * 37));
}
TEST_CASE("differentiate: inside another differentiate, with numbers of its own", "[ad][value]") {
  const auto outer = [](auto x) {
    const auto [y, d] = differentiate([](auto t) { return t * t * t; }, x.value);
    return x * float(d) + float(y);
  };
  const auto [y, d] = differentiate(outer, 2.0);
  CHECK(y == Approx(2 * 12 + 8));
  CHECK(d == Approx(12));
}
TEST_CASE("differentiate: on every thread at once", "[ad][agreement]") {
  std::vector<double> slopes(200);
  parallel_for(200, [&](int i) {
    slopes[std::size_t(i)] = std::get<1>(differentiate([](auto x) {
      auto s = x;
      for (int k = 0; k < 100; ++k) s = sin(s + x);
      return s;
    }, 0.01 * i));
  });
  for (int i = 0; i < 200; ++i) {
    using D = Dual<double, 1>;
    const D x(0.01 * i, 0);
    D s = x;
    for (int k = 0; k < 100; ++k) s = sin(s + x);
    CHECK(slopes[std::size_t(i)] == Approx(s.slope[0]).epsilon(1e-12).margin(1e-15));
  }
}
TEST_CASE("differentiate: an exception in the function leaves the tape usable", "[ad][limit]") {
  CHECK_THROWS_AS(differentiate([](auto x) -> decltype(x) { throw std::runtime_error("no"); }, 1.0),
                  std::runtime_error);
  CHECK(std::get<1>(differentiate([](auto x) { return x * x; }, 3.0)) == 6);
}
TEST_CASE("duals: a Jacobian in one sweep, of packets too", "[ad][value]") {
  using D = Dual<double, 2>;
  const D x(0.5, 0), y(2.0, 1);
  const D u = x * y + sin(x), v = pow(x, y) / (x + y);
  CHECK(u.slope[0] == Approx(2 + std::cos(0.5)));
  CHECK(u.slope[1] == Approx(0.5));
  CHECK(v.slope[0] == Approx(2 * 0.5 / 2.5 - 0.25 / 6.25));
  CHECK(v.slope[1] == Approx(0.25 * std::log(0.5) / 2.5 - 0.25 / 6.25));
  using P = Packet<float, 16>;
  const Dual<P, 1> p(P(0.5f), 0), q = select(p > 0.2f, p * p, p);
  CHECK(q.slope[0][3] == 1.0f);
}
