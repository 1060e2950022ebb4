// tests/ad/packet.cpp -- packet functions against the C library: stated errors over wide ranges, and the edges
// SPDX-License-Identifier: Apache-2.0
#include <burnish/ad/packet.h>
#include <burnish_test.h>
#include <random>

using namespace burnish;

namespace {
using P16 = Packet<float, 16>;
using P8 = Packet<float, 8>;
using D8 = Packet<double, 8>;
constexpr float infinity = std::numeric_limits<float>::infinity();

/// The largest error of f at 20,000 numbers between low and high: error(f(x), exact(double(x)), x).
template <class P, class F, class G, class E> double worst(F f, G exact, double low, double high, E error) {
  std::mt19937 random(1);
  double most = 0;
  for (int i = 0; i < 20000; i += P::size) {
    typename P::Scalar x[16], y[16];
    for (int k = 0; k < P::size; ++k)
      x[k] = typename P::Scalar(std::uniform_real_distribution<double>(low, high)(random));
    P(f(P::load(x))).store(y);
    for (int k = 0; k < P::size; ++k) most = std::max(most, error(double(y[k]), exact(double(x[k])), double(x[k])));
  }
  return most;
}
/// In units of the last place of the exact value, denormal ones apart.
double ulp(double y, double exact, double) {
  const double place = std::max(std::ldexp(1.0, std::ilogb(exact == 0 ? 1e-37 : exact) - 23), 1.2e-38 * 1.2e-7);
  return std::fabs(y - exact) / place;
}
double absolute(double y, double exact, double) { return std::fabs(y - exact); }
double relative(double y, double exact, double) { return std::fabs(y / exact - 1); }
template <class F> float at(F f, float x) { return P16(f(P16(x)))[3]; }
}  // namespace

TEST_CASE("packets: exp and log are within 2 units in the last place", "[ad][value]") {
  const auto e = [](double x) { return std::exp(x); };
  CHECK(worst<P16>([](P16 x) { return exp(x); }, e, -87, 88.7, ulp) <= 2);
  CHECK(worst<P8>([](P8 x) { return exp(x); }, e, -1, 1, ulp) <= 2);
  const auto l = [](double x) { return std::log(x); };
  CHECK(worst<P16>([](P16 x) { return log(x); }, l, 1e-6, 3, ulp) <= 2);
  CHECK(worst<P16>([](P16 x) { return log(x); }, l, 1e-30, 1e30, ulp) <= 2);
  CHECK(worst<P8>([](P8 x) { return log(x); }, l, 0.5, 1e4, ulp) <= 2);
  CHECK(worst<P16>([](P16 x) { return sqrt(x); }, [](double x) { return std::sqrt(x); }, 0, 1e6, ulp) <= 0.5001);
  CHECK(worst<P8>([](P8 x) { return sqrt(x); }, [](double x) { return std::sqrt(x); }, 0, 1e6, ulp) <= 0.5001);
  CHECK(worst<P16>([](P16 x) { return rsqrt(x); }, [](double x) { return 1 / std::sqrt(x); }, 1e-6, 1e6, ulp) <= 2);
}
TEST_CASE("packets: exp2, log2 and pow lose what their docstrings say", "[ad][value]") {
  CHECK(worst<P16>([](P16 x) { return exp2(x); }, [](double x) { return std::exp2(x); }, -20, 20, relative) <= 3e-6);
  CHECK(worst<P16>([](P16 x) { return log2(x); }, [](double x) { return std::log2(x); }, 1e-6, 0.9, relative) <= 4e-7);
  for (const double b : {0.3, 2.2, -1.5, 5.0, 17.0}) {
    CAPTURE(b);
    const auto error = [&](double y, double exact, double x) {
      return std::fabs(y / exact - 1) / (1 + std::fabs(b * std::log(x)));
    };
    CHECK(worst<P16>([&](P16 x) { return pow(x, float(b)); }, [&](double x) { return std::pow(x, double(float(b))); },
                     0.01, 10, error) <= 2.5e-7);
  }
}
TEST_CASE("packets: sin, cos and tan hold their absolute error", "[ad][value]") {
  CHECK(worst<P16>([](P16 x) { return sin(x); }, [](double x) { return std::sin(x); }, -8000, 8000, absolute) <= 2e-7);
  CHECK(worst<P8>([](P8 x) { return sin(x); }, [](double x) { return std::sin(x); }, -4, 4, absolute) <= 2e-7);
  CHECK(worst<P16>([](P16 x) { return cos(x); }, [](double x) { return std::cos(x); }, -4, 4, absolute) <= 4e-7);
  const auto beyond = [](double y, double exact, double x) { return std::fabs(y - exact) / std::fabs(x); };
  CHECK(worst<P16>([](P16 x) { return cos(x); }, [](double x) { return std::cos(x); }, 4, 1e5, beyond) <= 1e-7);
  CHECK(worst<P16>([](P16 x) { return sin(x); }, [](double x) { return std::sin(x); }, 8000, 1e5, beyond) <= 1e-7);
  CHECK(worst<P16>([](P16 x) { return tan(x); }, [](double x) { return std::tan(x); }, -1.2, 1.2, absolute) <= 4e-6);
}
TEST_CASE("packets: the inverse and hyperbolic functions hold their absolute error", "[ad][value]") {
  CHECK(worst<P16>([](P16 x) { return asin(x); }, [](double x) { return std::asin(x); }, -1, 1, absolute) <= 5e-7);
  CHECK(worst<P16>([](P16 x) { return acos(x); }, [](double x) { return std::acos(x); }, -1, 1, absolute) <= 6e-7);
  CHECK(worst<P16>([](P16 x) { return tanh(x); }, [](double x) { return std::tanh(x); }, -12, 12, relative) <= 5e-7);
  for (const float x : {-3.0f, -0.1f, 0.2f, 5.0f}) {
    CAPTURE(x);
    CHECK(worst<P16>([&](P16 y) { return atan2(y, x); }, [&](double y) { return std::atan2(y, double(x)); }, -6, 6,
                     absolute) <= 5e-7);
  }
}
TEST_CASE("packets: edges are those of the C library", "[ad][limit]") {
  const float nan = std::nanf("");
  const auto isnan = [](float x) { return std::isnan(x); };
  CHECK(at([](auto x) { return exp(x); }, infinity) == infinity);
  CHECK(at([](auto x) { return exp(x); }, 100) == infinity);
  CHECK(at([](auto x) { return exp(x); }, -infinity) == 0);
  CHECK(at([](auto x) { return exp(x); }, -100) == 0);
  CHECK(at([](auto x) { return exp(x); }, 0) == 1);
  CHECK(isnan(at([](auto x) { return exp(x); }, nan)));
  CHECK(at([](auto x) { return log(x); }, 0) == -infinity);
  CHECK(at([](auto x) { return log(x); }, 1) == 0);
  CHECK(at([](auto x) { return log(x); }, infinity) == infinity);
  CHECK(isnan(at([](auto x) { return log(x); }, -1)));
  CHECK(isnan(at([](auto x) { return log(x); }, nan)));
  CHECK(at([](auto x) { return sqrt(x); }, 0) == 0);
  CHECK(at([](auto x) { return sqrt(x); }, infinity) == infinity);
  CHECK(isnan(at([](auto x) { return sqrt(x); }, -1)));
  CHECK(at([](auto x) { return pow(x, 0.0f); }, 0) == 1);
  CHECK(at([](auto x) { return pow(x, 2.0f); }, 0) == 0);
  CHECK(at([](auto x) { return pow(x, -1.0f); }, 0) == infinity);
  CHECK(at([](auto x) { return tanh(x); }, 200) == 1);
  CHECK(at([](auto x) { return tanh(x); }, -infinity) == -1);
  CHECK(at([](auto x) { return asin(x); }, 1) == Approx(1.5707963f));
  CHECK(at([](auto x) { return acos(x); }, -1) == Approx(3.1415927f));
  CHECK(at([](auto x) { return acos(x); }, 1) == 0);
  CHECK(at([](auto x) { return atan2(x, 0.0f); }, 0) == 0);
  CHECK(at([](auto x) { return atan2(x, 0.0f); }, -2) == Approx(-1.5707963f));
  CHECK(at([](auto x) { return atan2(x, -1.0f); }, 0) == Approx(3.1415927f));
}
TEST_CASE("packets: floor of every size of number", "[ad][limit]") {
  for (const float x : {0.0f, -0.5f, 0.5f, -1.0f, 2.999999f, -2.000001f, 8388607.5f, -8388607.5f, 8388609.0f, 1e20f,
                        -1e30f, infinity, -infinity}) {
    CAPTURE(x);
    CHECK(at([](auto v) { return floor(v); }, x) == std::floor(x));
  }
  CHECK(std::isnan(at([](auto v) { return floor(v); }, std::nanf(""))));
}
TEST_CASE("packets: min, max, select and comparisons lane by lane", "[ad][value]") {
  float a[16], b[16];
  for (int i = 0; i < 16; ++i) a[i] = float(i * 7 % 16), b[i] = float(i);
  const P16 x = P16::load(a), y = P16::load(b), high = max(x, y), low = min(x, y),
            chosen = select(x < y && !(y > 12.0f), x, -y);
  for (int i = 0; i < 16; ++i) {
    CHECK(high[i] == std::max(a[i], b[i]));
    CHECK(low[i] == std::min(a[i], b[i]));
    CHECK(chosen[i] == (a[i] < b[i] && !(b[i] > 12) ? a[i] : -b[i]));
    CHECK(abs(y - x)[i] == std::fabs(b[i] - a[i]));
  }
  CHECK(y.sum() == 120);
  CHECK(max(P16(std::nanf("")), P16(2.0f))[5] == 2);  // where a is NaN, b: as for plain numbers
  CHECK(max(std::nanf(""), 2.0f) == 2);
}
TEST_CASE("packets: double packets call the C library", "[ad][agreement]") {
  const D8 x = 0.37;
  CHECK(exp(x)[2] == std::exp(0.37));
  CHECK(log(x)[2] == std::log(0.37));
  CHECK(pow(x, D8(1.7))[2] == std::pow(0.37, 1.7));
  CHECK(atan2(x, D8(-0.2))[7] == std::atan2(0.37, -0.2));
  CHECK(floor(D8(-0.5))[0] == -1);
  CHECK(sqrt(x)[5] == std::sqrt(0.37));
}
TEST_CASE("packets: whole numbers and gathers", "[ad][value]") {
  float table[64];
  for (int i = 0; i < 64; ++i) table[i] = float(i * i);
  float f[16];
  for (int i = 0; i < 16; ++i) f[i] = float(3 * i) + 0.75f;
  const P16 g = gather<P16>(table, to_int(P16::load(f)));
  for (int i = 0; i < 16; ++i) CHECK(g[i] == table[3 * i]);
  CHECK(to_real<P16>(to_int(P16(-7.9f)))[0] == -7);
  CHECK(gather<float>(table, 5) == 25);
  const D8 d = gather<D8>(table, to_int(D8(6.5)));
  CHECK(d[1] == 36);
}
