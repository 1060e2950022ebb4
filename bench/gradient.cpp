// bench/gradient.cpp -- what a gradient costs: every player against the packet primal and the adjoint written by hand
// SPDX-License-Identifier: Apache-2.0
//
//   bench_gradient [rounds]
//
// The kernel is that of bench/kernel.h: 8 derivatives of every pixel, 8 or 32 lights. A row is one way to get them:
//   primal             the loss alone, in packets of 16 pixels; the faster of a loop over a list and an unrolled array
//   adjoint by hand    value and derivatives as an expert writes them, in the same packets
//   compiled           the user's function recorded by the compiler, played as straight-line packet code
//   replayed           the same function recorded at run time, played operation by operation over strips of pixels
// "loop node" rows hand the lights over as a list of any length, "unrolled" rows as an array. The last lines are one
// pixel alone: the function on plain floats, taped by differentiate(), and on duals with 8 directions.
//
// Rows are interleaved round by round and the best round of each counts, so that a slow spell of a shared machine hits
// none of them alone. With one thread a row is timed in processor time, which strangers do not lengthen, with more by
// the clock; the targets judge one thread. Compare ratios, not nanoseconds. "difference" is that of the derivatives to
// those by hand, as a part of their root mean square.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <functional>
#include <string>
#include <burnish/ad/differentiate.h>
#include <burnish/ad/dual.h>
#include "kernel.h"

using namespace kernel;

namespace {

/// Nanoseconds: of this process's work if it has one thread, else of the clock on the wall.
double now() {
  if (threads() > 1)
    return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now().time_since_epoch()).count();
  return 1e9 * double(std::clock()) / CLOCKS_PER_SEC;
}
std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown processor";
}
/// The sum of f(first, last) over whole tiles on all threads, as the players share them out.
template <class F> double over_bands(int pixels, F f) {
  std::array<double, 32> part{};
  parallel_for(32, [&](int b) {
    const auto [begin, end] = detail::band(int(padded(std::size_t(pixels), tile)), b);
    part[std::size_t(b)] = f(begin, end);
  });
  double s = 0;
  for (const double p : part) s += p;
  return s;
}
vec3<Lanes> load3(const Scene& s, int plane, int p) {
  const auto& f = s.pixels.plane;
  const std::size_t k = std::size_t(plane);
  return {Lanes::load(f[k].data() + p), Lanes::load(f[k + 1].data() + p), Lanes::load(f[k + 2].data() + p)};
}
template <class Lights, class Loss> double primal(const Scene& s, const Lights& lights, Loss loss) {
  return over_bands(s.paint.size(), [&](int begin, int end) {
    Lanes sum = 0.0f;
    for (int p = begin; p < end; p += lanes) {
      const auto paint = detail::load<Paint>(s.paint.pointers(), p);
      sum += loss(paint, Pixel<Lanes>{load3(s, 0, p), load3(s, 3, p)}, lights);
    }
    return double(sum.sum());
  });
}
template <int MaxLights> double hand(const Scene& s, Planes<Paint>& d) {
  return over_bands(s.paint.size(), [&](int begin, int end) {
    Lanes sum = 0.0f;
    for (int p = begin; p < end; p += lanes) {
      Lanes in[8], g[8];
      for (std::size_t k = 0; k < 8; ++k) in[k] = Lanes::load(s.paint.plane[k].data() + p);
      sum += by_hand<Lanes, MaxLights>(in, load3(s, 0, p), load3(s, 3, p), s.lights.data(), int(s.lights.size()), g);
      for (std::size_t k = 0; k < 8; ++k) g[k].store(d.plane[k].data() + p);
    }
    return double(sum.sum());
  });
}
/// Root of the mean squared difference, as a part of b's own.
double difference(const Planes<Paint>& a, const Planes<Paint>& b) {
  double num = 0, den = 0;
  for (std::size_t k = 0; k < 8; ++k)
    for (int i = 0; i < a.size(); ++i) {
      const double x = double(a.plane[k][std::size_t(i)]), y = double(b.plane[k][std::size_t(i)]);
      num += (x - y) * (x - y), den += y * y;
    }
  return std::sqrt(num / den);
}

struct Row {
  const char* name;
  std::function<double()> run;
  double best = 1e300;
};
struct Target {
  const char* row;
  double by_primal, by_hand;  // at most so many times; 0: no target
};

template <std::size_t Count> void bench(int width, int height, int rounds, const std::vector<Target>& targets) {
  const Scene s(width, height, int(Count));
  constexpr bool unrolled = Count <= 8;
  std::array<Light<float>, unrolled ? Count : 1> array{};
  std::copy_n(s.lights.begin(), array.size(), array.begin());
  const auto lifted_array = lift<Lanes>(array);
  const List<Light, Lanes> lifted_list{s.lights};
  Planes<Paint> d(s.paint.size()), truth(s.paint.size());
  hand<int(Count)>(s, truth);
  std::vector<Row> rows{
      {"primal, loop", [&] { return primal(s, lifted_list, loss_over_list); }},
      {"adjoint by hand", [&] { return hand<int(Count)>(s, d); }},
      {"compiled, loop node",
       [&] { return sum_and_gradient<Player::compiled>(s.pixels, with(loss_over_list, s.lights), s.paint, d); }},
      {"replayed, loop node",
       [&] { return sum_and_gradient<Player::replayed>(s.pixels, with(loss_over_list, s.lights), s.paint, d); }},
  };
  if constexpr (unrolled) {
    rows.push_back({"primal, unrolled", [&] { return primal(s, lifted_array, loss_over_array); }});
    rows.push_back({"compiled, unrolled", [&] {
                      return sum_and_gradient<Player::compiled>(s.pixels, with(loss_over_array, array), s.paint, d);
                    }});
    rows.push_back({"replayed, unrolled", [&] {
                      return sum_and_gradient<Player::replayed>(s.pixels, with(loss_over_array, array), s.paint, d);
                    }});
  }
  double sum = 0;
  for (int r = 0; r < rounds; ++r)
    for (Row& row : rows) {
      const double start = now();
      sum += row.run();
      row.best = std::min(row.best, (now() - start) / (width * height));
    }
  double p = rows[0].best;
  if constexpr (unrolled) p = std::min(p, rows[4].best);
  const double h = rows[1].best;
  std::printf("\n%d lights, %d x %d pixels, %d thread%s   [checksum %.6g]\n", int(Count), width, height, threads(),
              threads() > 1 ? "s" : "", sum / (rounds * double(rows.size())));
  std::printf("  %-22s %9s %10s %9s %11s\n", "", "ns/pixel", "x primal", "x hand", "difference");
  for (Row& row : rows) {
    std::printf("  %-22s %9.2f %10.2f %9.2f", row.name, row.best, row.best / p, row.best / h);
    if (std::string(row.name).rfind("primal", 0) == 0) std::printf("\n");
    else {
      row.run();
      std::printf(" %11.1e\n", difference(d, truth));
    }
    for (const Target& t : targets) {
      if (row.name != std::string(t.row)) continue;
      const auto judge = [](double ratio, double most, const char* of) {
        if (most > 0)
          std::printf("      at most %.2f x %s: %s (%.2f)\n", most, of, ratio <= most ? "met" : "MISSED", ratio);
      };
      judge(row.best / p, t.by_primal, "primal");
      judge(row.best / h, t.by_hand, "hand");
    }
  }
}

/// One pixel, 8 lights: nanoseconds of the plain function, of differentiate() and of duals in 8 directions.
void bench_point(int rounds) {
  using Directions = Dual<float, 8>;
  const Scene s(8, 8, 8);
  const auto at = [&](int i) { return lift<float>(s.pixels.at(i)); };
  const List<Light, float> lights{s.lights};
  float sum = 0;
  std::vector<Row> rows{
      {"plain floats", [&] {
         for (int i = 0; i < 64; ++i) sum += loss_over_list(s.paint.at(i), at(i), lights);
         return 0.0;
       }},
      {"differentiate()", [&] {
         for (int i = 0; i < 64; ++i)
           sum += std::get<1>(differentiate([&]<class P>(const P& paint) {
                    using T = detail::scalar_in_t<P>;
                    return loss_over_list(paint, lift<T>(at(i)), List<Light, T>{s.lights});
                  }, s.paint.at(i))).roughness;
         return 0.0;
       }},
      {"duals, 8 directions", [&] {
         for (int i = 0; i < 64; ++i) {
           auto paint = lift<Directions>(s.paint.at(i));
           int k = 0;
           each([&](Directions& x) { x = Directions(x.value, k++); }, paint);
           sum += loss_over_list(paint, lift<Directions>(at(i)), List<Light, Directions>{s.lights}).slope[3];
         }
         return 0.0;
       }},
  };
  for (int r = 0; r < 20 * rounds; ++r)
    for (Row& row : rows) {
      const auto start = std::chrono::steady_clock::now();
      row.run();
      row.best = std::min(
          row.best, std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count() / 64);
    }
  std::printf("\none pixel at a time, 8 lights   [checksum %.6g]\n", double(sum));
  std::printf("  %-22s %9s %10s\n", "", "ns", "x plain");
  for (const Row& row : rows) std::printf("  %-22s %9.0f %10.2f\n", row.name, row.best, row.best / rows[0].best);
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = std::max(1, argc > 1 ? std::atoi(argv[1]) : 15);
  std::printf("%s, %s; best of %d rounds\n", processor().c_str(),
#if defined(__clang__)
              __VERSION__,
#else
              "g++ " __VERSION__,
#endif
              rounds);
  for (const int t : {1, 2}) {
    set_threads(t);
    std::vector<Target> few, many;
    if (t == 1) {  // two threads may have to share a core with strangers
      few = {{"compiled, loop node", 2.6, 1.25},
             {"compiled, unrolled", 2.6, 1.25},
             {"replayed, loop node", 6.5, 0},
             {"replayed, unrolled", 6.5, 0}};
      many = {{"compiled, loop node", 0, 1.4}};
    }
    bench<8>(512, 512, rounds, few);
    bench<32>(512, 128, rounds, many);
  }
  set_threads(1);
  bench_point(rounds);
}
