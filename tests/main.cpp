// tests/main.cpp -- the test runner, for Catch2 2 and 3, and the record that it writes
// SPDX-License-Identifier: Apache-2.0
//
// A run of all tests of a program leaves its claims in record/<program>.tsv of the working folder: what, kind, against,
// tolerance, figure and points, a claim a line, in the order in which they were first made.
#if __has_include(<catch2/catch_session.hpp>)
#include <catch2/catch_message.hpp>
#include <catch2/catch_session.hpp>
#include <catch2/catch_test_macros.hpp>
#else
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#endif
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>
#include "record.h"

namespace {
struct Row {
  std::string what, kind, against;
  double tolerance, figure;
  long points;
};
std::vector<Row>& rows() {
  static std::vector<Row> all;
  return all;
}
void write(const std::filesystem::path& program) {
  if (rows().empty()) return;
  std::filesystem::create_directory("record");
  const std::filesystem::path to = "record" / program.filename().replace_extension(".tsv"), beside = to.string() + ".new";
  {
    std::ofstream file(beside);
    file.precision(4);
    for (const Row& r : rows())
      file << r.what << '\t' << r.kind << '\t' << r.against << '\t' << r.tolerance << '\t' << r.figure << '\t' << r.points
           << '\n';
  }
  std::filesystem::rename(beside, to);
}
}  // namespace

void record::claim(const std::string& what, const std::string& kind, const std::string& against, double tolerance,
                   double figure, long points) {
  INFO(what << ", " << kind << " against " << against);
  CHECK(figure <= tolerance);
  CHECK(points > 0);
  const auto same = [&](const Row& r) { return r.what == what && r.kind == kind && r.against == against; };
  const auto at = std::find_if(rows().begin(), rows().end(), same);
  if (at == rows().end()) {
    rows().push_back({what, kind, against, tolerance, figure, points});
    return;
  }
  at->tolerance = std::max(at->tolerance, tolerance);
  at->figure = std::isnan(figure) ? figure : std::max(at->figure, figure);
  at->points += points;
}

int main(int argc, char** argv) {
  const int failed = Catch::Session().run(argc, argv);
  if (argc == 1) write(argv[0]);
  return failed;
}
