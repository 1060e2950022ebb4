// examples/progress.h -- a progress bar for long work, and Ctrl-C that ends it in good order
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <unistd.h>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <string>

/// Set by Ctrl-C; work that sees it stops and keeps what it has. A second Ctrl-C ends the program at once.
inline volatile std::sig_atomic_t interrupted = 0;
inline void catch_interrupt() {
  std::signal(SIGINT, [](int) {
    interrupted = 1;
    std::signal(SIGINT, SIG_DFL);
  });
}

/// One line that is drawn over itself on a terminal; in a log, only its last state.
class Progress {
public:
  explicit Progress(std::string what) : label(std::move(what)), start(std::chrono::steady_clock::now()), last(start) {}
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); }
  void show(int done, int of, const std::string& note = "") {
    const auto now = std::chrono::steady_clock::now();
    const bool terminal = isatty(fileno(stderr)) != 0;
    if (!terminal || (done < of && now - last < std::chrono::milliseconds(60))) return;
    last = now;
    constexpr int width = 28;
    const int filled = of > 0 ? done * width / of : width;
    const double left = done > 0 ? seconds() / done * (of - done) : 0;
    std::fprintf(stderr, "\r%-14s [%s%s] %3d %%  %s  %.0f s left\033[K", label.c_str(),
                 std::string(std::size_t(filled), '#').c_str(), std::string(std::size_t(width - filled), '.').c_str(),
                 of > 0 ? 100 * done / of : 100, note.c_str(), left);
  }
  void finish(const std::string& note) {
    if (isatty(fileno(stderr))) std::fprintf(stderr, "\r\033[K");
    std::printf("%-14s %s (%.2f s)\n", label.c_str(), note.c_str(), seconds());
    std::fflush(stdout);
  }

private:
  std::string label;
  std::chrono::steady_clock::time_point start, last;
};
