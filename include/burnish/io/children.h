// burnish/io/children.h -- work on files that nobody vouches for, each in a process of its own: POSIX
// SPDX-License-Identifier: Apache-2.0
//
// A reader may crash, never end or eat all memory; the child process does so alone. It is forked from a program that
// has no other thread at that moment: burnish's and OpenImageIO's pools are put to sleep for that long. Other threads
// of the caller must not hold a lock that the work needs.
#pragma once
#include <signal.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <new>
#include <string>
#include <thread>
#include <vector>
#include <OpenImageIO/imageio.h>
#include <burnish/ad/parallel.h>
#include <burnish/scene/error.h>

namespace burnish {

struct ChildLimits {
  double seconds = 60;           // by the clock
  std::size_t megabytes = 4096;  // of address space beyond what the parent has; not with sanitizers, which take it all
};
/// How a child ended; text: what it did in words, "" after work that returned.
struct ChildEnd {
  bool done = false;
  std::string text;
  double seconds = 0;
};

namespace detail {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool address_space_is_ours = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
inline constexpr bool address_space_is_ours = false;
#else
inline constexpr bool address_space_is_ours = true;
#endif
#else
inline constexpr bool address_space_is_ours = true;
#endif

/// One thread only while it lives.
class OneThread {
public:
  OneThread() : ours(threads()) {
    OIIO::getattribute("threads", theirs);
    OIIO::attribute("threads", 1);
    set_threads(1);
  }
  ~OneThread() {
    set_threads(ours);
    OIIO::attribute("threads", theirs);
  }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

private:
  int ours, theirs = 0;
};

inline constexpr int child_returned = 0, child_threw = 3, child_out_of_memory = 4;

inline void limit(int what, rlim_t most) {
  rlimit r;
  if (getrlimit(what, &r) != 0) return;
  r.rlim_cur = r.rlim_max == RLIM_INFINITY ? most : std::min(most, r.rlim_max);
  setrlimit(what, &r);
}
/// In the child: does the work and never returns.
template <class Work> [[noreturn]] void be_child(const ChildLimits& limits, pid_t parent, Work work) {
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  if (getppid() != parent) _exit(child_threw);
  signal(SIGINT, SIG_IGN);  // Ctrl-C goes to all; the parent decides
  for (const int s : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM}) signal(s, SIG_DFL);
  if (const int nowhere = open("/dev/null", O_RDWR); nowhere >= 0)
    for (const int stream : {0, 1, 2}) dup2(nowhere, stream);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, rlim_t(std::ceil(limits.seconds)) * 2 + 10);
  if (address_space_is_ours) {
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    limit(RLIMIT_AS, rlim_t(pages) * rlim_t(sysconf(_SC_PAGESIZE)) + (rlim_t(limits.megabytes) << 20));
  }
  try {
    work();
  } catch (const std::bad_alloc&) {
    _exit(child_out_of_memory);
  } catch (...) {
    _exit(child_threw);
  }
  _exit(child_returned);
}
inline ChildEnd end_of(int status, double seconds, bool overtime, const ChildLimits& limits) {
  ChildEnd e{false, "", seconds};
  if (overtime) {
    char text[80];
    std::snprintf(text, sizeof text, "the reader took over %.3g s", limits.seconds);
    e.text = text;
  } else if (WIFSIGNALED(status)) {
    const char* const name = strsignal(WTERMSIG(status));
    e.text = std::string("the reader crashed: ") + (name ? name : "unknown signal");
  } else if (WEXITSTATUS(status) == child_out_of_memory) {
    e.text = "too large for memory: more than " + std::to_string(limits.megabytes) + " MB";
  } else if (WEXITSTATUS(status) != child_returned) {
    e.text = "the reader gave up with code " + std::to_string(WEXITSTATUS(status));
  } else {
    e.done = true;
  }
  return e;
}
}  // namespace detail

/// work(i) for i = 0 .. count - 1, each in a child process, `workers` at a time; what it changes stays there, what it
/// leaves in files is left. ended(i, ChildEnd) is called here, in the order in which they end, and tick() some hundred
/// times a second. When tick() gives false, what runs is killed and no more begun; false then. Error where no process can be
/// made.
template <class Work, class Ended, class Tick>
bool in_children(int count, int workers, const ChildLimits& limits, Work work, Ended ended, Tick tick) {
  using Clock = std::chrono::steady_clock;
  struct Running {
    pid_t pid;
    int index;
    Clock::time_point start;
  };
  const detail::OneThread alone;
  std::vector<Running> running;
  const auto kill_all = [&] {
    for (const Running& r : running) {
      kill(r.pid, SIGKILL);
      waitpid(r.pid, nullptr, 0);
    }
    running.clear();
  };
  struct AtEnd {
    decltype(kill_all)& f;
    ~AtEnd() { f(); }
  } const at_end{kill_all};
  int next = 0;
  const pid_t self = getpid();
  while (next < count || !running.empty()) {
    if (!tick()) return false;
    while (next < count && int(running.size()) < std::max(workers, 1)) {
      const pid_t pid = fork();
      if (pid == 0) detail::be_child(limits, self, [&] { work(next); });
      if (pid < 0 && running.empty()) throw Error(std::string("no process can be made: ") + std::strerror(errno));
      if (pid < 0) break;
      running.push_back({pid, next++, Clock::now()});
    }
    bool any = false;
    for (std::size_t k = 0; k < running.size();) {
      const Running r = running[k];
      const double seconds = std::chrono::duration<double>(Clock::now() - r.start).count();
      int status = 0;
      pid_t ended_now = waitpid(r.pid, &status, WNOHANG);
      const bool overtime = ended_now == 0 && seconds > limits.seconds;
      if (overtime) {
        kill(r.pid, SIGKILL);
        ended_now = waitpid(r.pid, &status, 0);
      }
      if (ended_now == 0) {
        ++k;
        continue;
      }
      running.erase(running.begin() + std::ptrdiff_t(k));
      any = true;
      ended(r.index, detail::end_of(status, seconds, overtime, limits));
    }
    if (!any) std::this_thread::sleep_for(std::chrono::milliseconds(4));
  }
  return true;
}

}  // namespace burnish
