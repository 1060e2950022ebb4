// bench/search.cpp -- the exact search among 26,000 vectors of 1,280 numbers, against reading them at all
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>
#include <limits>
#include <burnish/twin/search.h>

using namespace burnish;

namespace {
/// The shortest of several runs, seconds.
template <class F> double shortest(F f) {
  double best = std::numeric_limits<double>::infinity();
  for (int run = 0; run < 15; ++run) {
    const auto start = std::chrono::steady_clock::now();
    f();
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best;
}
}  // namespace

int main() {
  constexpr int models = 26000, columns = 1280, block = 64;
  std::vector<float> rows(std::size_t(models) * columns), query(columns);
  unsigned state = 1;
  const auto fill = [&](std::vector<float>& to) {
    for (float& v : to) state = state * 1664525u + 1013904223u, v = float(state >> 8) / 8388608.0f - 1;
    normalise_rows(to, columns);
  };
  fill(rows), fill(query);
  using P = Packet<float, 16>;
  std::vector<float> sums((models + block - 1) / block);
  const double read = shortest([&] {
    parallel_for(int(sums.size()), [&](int b) {
      std::array<P, 4> sum{P(0.0f), P(0.0f), P(0.0f), P(0.0f)};
      const std::size_t end = std::min(std::size_t(b + 1) * block, std::size_t(models)) * columns;
      for (std::size_t i = std::size_t(b) * block * columns; i < end; i += 64)
        for (std::size_t k = 0; k < 4; ++k) sum[k] += P::load(rows.data() + i + 16 * k);
      const P all = sum[0] + sum[1] + sum[2] + sum[3];
      sums[std::size_t(b)] = all[0];
    });
  });
  int found = 0;
  const double one = shortest([&] { found += nearest(rows, columns, query, 10)[0].row; });
  std::vector<float> eight;
  for (int i = 0; i < 8; ++i)
    eight.insert(eight.end(), rows.begin() + i * 40 * columns, rows.begin() + (i * 40 + 1) * columns);
  const double several = shortest([&] { found += nearest(rows, columns, eight, 10)[0].row; });
  const double bytes = double(rows.size()) * 4e-9;
  std::printf("%d x %d floats, %d threads: read %.1f GB/s, searched %.1f GB/s (%.1f ms), ratio %.2f; "
              "8 queries at once %.1f ms%s\n",
              models, columns, threads(), bytes / read, bytes / one, 1e3 * one, read / one, 1e3 * several,
              found < 0 ? " " : "");
  return 0;
}
