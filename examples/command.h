// examples/command.h -- from a command line to an exit code: what was wrong is said in one line
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>
#include <functional>

/// Reads the arguments and runs. The code: run's, 0 after --help, 2 after one line that says what was wrong.
int command(CLI::App& app, int argc, char** argv, const std::function<int()>& run);
