// examples/command.h -- from a command line to an exit code: what was wrong is said in one line
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>

/// Reads the arguments and runs. The code: run's, 0 after --help, 2 after one line that says what was wrong.
template <class Run> int command(CLI::App& app, int argc, char** argv, Run run) {
  const std::string self = std::filesystem::path(argv[0]).filename().string();
  try {
    app.parse(argc, argv);
    return run();
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    std::fprintf(stderr, "%s: %s\n", self.c_str(), e.what());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: %s\n", self.c_str(), e.what());
  }
  return 2;
}
