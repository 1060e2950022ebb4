// examples/command.cpp -- what command.h promises
// SPDX-License-Identifier: Apache-2.0
#include "command.h"
#include <cstdio>
#include <exception>
#include <filesystem>

int command(CLI::App& app, int argc, char** argv, const std::function<int()>& run) {
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
