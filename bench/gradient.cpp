// bench/gradient.cpp -- what a gradient costs: every player against the packet primal and the adjoint written by hand
// SPDX-License-Identifier: Apache-2.0
//
// Rows of one run are interleaved round by round and the medians compared, so that a slow spell of the machine hits all.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include "kernel.h"

using namespace kernel;

namespace {

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}
/// f(first, last, thread-local) over whole tiles on all threads, as the players share them out.
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
/// The largest difference to the first row's derivatives, in parts of a thousandth of the largest.
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
  std::vector<double> ns;
};

template <std::size_t Count> void bench(int width, int height, int rounds, bool unrolled) {
  const Scene s(width, height, int(Count));
  std::array<Light<float>, Count> array{};
  std::copy(s.lights.begin(), s.lights.end(), array.begin());
  const auto lifted_array = lift<Lanes>(array);
  const List<Light, Lanes> lifted_list{s.lights};
  Planes<Paint> d(s.paint.size()), truth(s.paint.size());
  hand<int(Count)>(s, truth);
  std::vector<Row> rows{
      {"primal, packets", [&] { return unrolled ? primal(s, lifted_array, loss_over_array) : primal(s, lifted_list, loss_over_list); }, {}},
      {"adjoint by hand, packets", [&] { return hand<int(Count)>(s, d); }, {}},
      {"recorded by the compiler, loop node", [&] { return sum_and_gradient<Player::compiled>(s.pixels, with(loss_over_list, s.lights), s.paint, d); }, {}},
      {"recorded at run time, loop node", [&] { return sum_and_gradient<Player::replayed>(s.pixels, with(loss_over_list, s.lights), s.paint, d); }, {}},
  };
  if constexpr (Count <= 8) {
    rows.push_back({"recorded by the compiler, unrolled", [&] { return sum_and_gradient<Player::compiled>(s.pixels, with(loss_over_array, array), s.paint, d); }, {}});
    rows.push_back({"recorded at run time, unrolled", [&] { return sum_and_gradient<Player::replayed>(s.pixels, with(loss_over_array, array), s.paint, d); }, {}});
  }
  double sum = 0;
  for (int r = 0; r < rounds; ++r)
    for (Row& row : rows) {
      const auto start = std::chrono::steady_clock::now();
      sum += row.run();
      row.ns.push_back(std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count() / (width * height));
    }
  std::printf("\n%d lights, %d x %d pixels, %d threads   [checksum %.6g]\n", int(Count), width, height, threads(), sum / rounds);
  std::printf("  %-38s %9s %10s %9s %11s\n", "", "ns/pixel", "x primal", "x hand", "difference");
  const double p = median(rows[0].ns), h = median(rows[1].ns);
  for (Row& row : rows) {
    const double t = median(row.ns);
    if (&row == &rows[0]) std::printf("  %-38s %9.2f %10.2f %9.2f\n", row.name, t, t / p, t / h);
    else {
      row.run();
      std::printf("  %-38s %9.2f %10.2f %9.2f %11.1e\n", row.name, t, t / p, t / h, difference(d, truth));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 15;
  std::printf("%s, %d rounds; medians\n", __VERSION__, rounds);
  for (const int t : {1, 2}) {
    set_threads(t);
    bench<8>(512, 512, rounds, true);
    bench<32>(512, 128, rounds, false);
  }
}
