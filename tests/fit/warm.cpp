// tests/fit/warm.cpp -- once warm, the players allocate nothing
// SPDX-License-Identifier: Apache-2.0
#include <burnish/nodes/image.h>
#include <atomic>
#include <cstdlib>
#include <new>
#include "players.h"

namespace {
std::atomic<int> allocations = 0;
}
void* operator new(std::size_t n) {
  ++allocations;
  return std::malloc(n);
}
void* operator new(std::size_t n, std::align_val_t a) {
  ++allocations;
  return std::aligned_alloc(std::size_t(a), (n + std::size_t(a) - 1) / std::size_t(a) * std::size_t(a));
}
void* operator new(std::size_t n, const std::nothrow_t&) noexcept { return operator new(n); }
void* operator new(std::size_t n, std::align_val_t a, const std::nothrow_t&) noexcept { return operator new(n, a); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }

using namespace burnish;
using namespace players;

namespace {
template <class T> struct Lamp {
  vec3<T> direction = {0, 0, 1};
  T power = 1;
  static constexpr auto parameters() {
    return std::tuple{Param{"direction", &Lamp::direction}, Param{"power", &Lamp::power}};
  }
};
template <class T> struct Print {
  ImageNode<T> print;
  T gain = 1.5f;
  static constexpr auto parameters() { return std::tuple{Param{"print", &Print::print}, Param{"gain", &Print::gain}}; }
};
constexpr auto look = [](const auto& p, const auto& at, const auto& lamps, const auto& exposure) {
  const auto c = p.print(at.uv) * p.gain;
  const auto light =
      repeat(lamps, [&](const auto& lamp) { return max(dot(at.normal, lamp.direction), 0.1f) * lamp.power; });
  return c * (exp(-light * p.gain) * exposure.power);
};
template <class F> int allocated(F f) {
  for (int i = 0; i < 3; ++i) f();  // which thread does which band, and so warms which buffer, is not said
  int least = 1000;
  for (int i = 0; i < 5 && least; ++i) {
    const int before = allocations;
    f();
    least = std::min(least, int(allocations) - before);
  }
  return least;
}
}  // namespace

TEST_CASE("players: the compiled player allocates nothing once warm", "[fit][cost]") {
  const GBuffer g = patch(900);
  const Image d_image = adjoint(g);
  Print<float> model, d;
  static_cast<TextureData&>(model.print.file) = TextureData(7, 5, 3, 0.5f);
  const std::vector<Lamp<float>> lamps(3);
  const Lamp<float> exposure;
  Image image(g.width, g.height);
  CHECK(allocated([&] { backward<Player::compiled>(g, with(look, lamps, exposure), model, d_image, d); }) == 0);
  CHECK(allocated([&] { render(g, with(look, lamps, exposure), model, image); }) == 0);
}
TEST_CASE("differentiate: allocates nothing once warm", "[fit][cost]") {
  double sum = 0;
  CHECK(allocated([&] {
    const auto [y, d_x, d_y] = differentiate([](auto x, auto r) {
      auto s = x;
      for (int i = 0; i < 50; ++i) s = sin(s) * r + x;
      return s;
    }, 0.3, 0.7);
    sum += y + d_x + d_y;
  }) == 0);
  CHECK(std::isfinite(sum));
}
