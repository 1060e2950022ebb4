// burnish/ad/parallel.h -- work shared out over the cores, the same result for any number of them
// SPDX-License-Identifier: Apache-2.0
//
// parallel_for(count, f) calls f(0) ... f(count - 1), each once, on the threads of one pool that sleeps between calls.
// A result is the same for every number of threads as long as f(i) writes only what belongs to i; sums are then added in
// the order of i by the caller. Calls from inside f, and calls while another thread is in one, run where they are.
#pragma once
#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace burnish {

namespace detail {

class Pool {
public:
  static Pool& instance() {
    static Pool pool;
    return pool;
  }
  ~Pool() { resize(1); }
  int threads() const { return int(workers.size()) + 1; }
  /// Not while a parallel_for is under way.
  void resize(int threads) {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    wake.notify_all();
    for (auto& w : workers) w.join();
    workers.clear();
    stopping = false;
    for (int i = 1; i < threads; ++i) workers.emplace_back([this, seen = round] { work(seen); });
  }
  void run(int count, void (*call)(void*, int), void* f) {
    const std::unique_lock turn(busy, std::try_to_lock);
    if (inside() || !turn || workers.empty() || count < 2) {
      for (int i = 0; i < count; ++i) call(f, i);
      return;
    }
    {
      const std::lock_guard lock(mutex);
      job = {count, call, f};
      next = 0;
      active = int(workers.size());
      error = nullptr;
      ++round;
    }
    wake.notify_all();
    drain();
    std::unique_lock lock(mutex);
    done.wait(lock, [&] { return active == 0; });
    if (error) std::rethrow_exception(error);
  }

private:
  struct Job {
    int count = 0;
    void (*call)(void*, int) = nullptr;
    void* f = nullptr;
  };
  std::vector<std::thread> workers;
  std::mutex mutex, busy;
  std::condition_variable wake, done;
  Job job;
  std::atomic<int> next = 0;
  int active = 0;
  unsigned round = 0;
  bool stopping = false;
  std::exception_ptr error;

  Pool() { resize(int(std::max(1u, std::thread::hardware_concurrency()))); }
  static bool& inside() {
    static thread_local bool flag = false;
    return flag;
  }
  void drain() {
    inside() = true;
    try {
      for (int i; (i = next++) < job.count;) job.call(job.f, i);
    } catch (...) {
      next = job.count;
      const std::lock_guard lock(mutex);
      if (!error) error = std::current_exception();
    }
    inside() = false;
  }
  void work(unsigned seen) {
    for (;;) {
      std::unique_lock lock(mutex);
      wake.wait(lock, [&] { return stopping || round != seen; });
      if (stopping) return;
      seen = round;
      lock.unlock();
      drain();
      lock.lock();
      if (--active == 0) done.notify_one();
    }
  }
};

}  // namespace detail

/// Threads that parallel_for uses, the caller's among them; as many as the machine has cores unless set.
inline int threads() { return detail::Pool::instance().threads(); }
/// At least 1. Not from inside a parallel_for.
inline void set_threads(int n) { detail::Pool::instance().resize(n < 1 ? 1 : n); }

/// f(0) ... f(count - 1), in any order, on all threads. The first exception thrown by f is thrown again here.
template <class F> void parallel_for(int count, F&& f) {
  detail::Pool::instance().run(count, [](void* call, int i) { (*static_cast<std::remove_reference_t<F>*>(call))(i); },
                               const_cast<void*>(static_cast<const void*>(&f)));
}

}  // namespace burnish
