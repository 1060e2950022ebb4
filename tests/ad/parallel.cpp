// tests/ad/parallel.cpp -- the thread pool: each index once, nested, from many threads, with exceptions
// SPDX-License-Identifier: Apache-2.0
#include <burnish/ad/parallel.h>
#include <burnish_test.h>
#include <numeric>
#include <stdexcept>

using namespace burnish;

TEST_CASE("parallel_for: every index is done once, for any number of threads", "[ad][value]") {
  const int before = threads();
  for (const int t : {1, 2, 5}) {
    set_threads(t);
    CHECK(threads() == t);
    for (const int n : {0, 1, 2, 1000}) {
      std::vector<int> done(std::size_t(n), 0);
      parallel_for(n, [&](int i) { ++done[std::size_t(i)]; });
      CHECK(std::accumulate(done.begin(), done.end(), 0) == n);
      CHECK((n == 0 || *std::max_element(done.begin(), done.end()) == 1));
    }
  }
  set_threads(0);
  CHECK(threads() == 1);
  set_threads(before);
}
TEST_CASE("parallel_for: inside itself and from two threads at once", "[ad][value]") {
  std::atomic<int> sum = 0;
  const auto work = [&] { parallel_for(40, [&](int) { parallel_for(10, [&](int) { ++sum; }); }); };
  std::thread other(work);
  work();
  other.join();
  CHECK(sum == 800);
}
TEST_CASE("parallel_for: the first exception comes back, and the pool goes on", "[ad][limit]") {
  const int before = threads();
  for (const int t : {1, 2, 3}) {
    set_threads(t);
    CHECK_THROWS_WITH(parallel_for(100, [](int i) { if (i == 31) throw std::runtime_error("31"); }), "31");
    std::atomic<int> sum = 0;
    parallel_for(100, [&](int i) { sum += i; });
    CHECK(sum == 4950);
  }
  set_threads(before);
}
