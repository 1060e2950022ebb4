// tests/twin/cut.cpp -- minimum cuts against all labellings, superpixels and star shapes against their definitions
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include <record.h>
#include <set>
#include <burnish/twin/star_cut.h>

using namespace burnish;

TEST_CASE("Minimum cut: no labelling of a small graph costs less", "[twin][agreement]") {
  std::mt19937 random(7);
  const auto cost = [&] { return float(random() % 1000) / 100; };
  record::Worst worst;
  constexpr int nodes = 9, graphs = 200;
  for (int g = 0; g < graphs; ++g) {
    struct Edge {
      int a, b;
      float cost;
    };
    std::vector<std::array<float, 2>> node;
    std::vector<Edge> edges, follows;
    MinimumCut graph(nodes);
    for (int i = 0; i < nodes; ++i) {
      node.push_back({cost() - 3, cost()});
      graph.node(i, node.back()[0], node.back()[1]);
    }
    for (int k = 0; k < 14; ++k) {
      const int a = int(random() % nodes), b = int(random() % nodes);
      if (a == b) continue;
      edges.push_back({a, b, cost()});
      graph.edge(a, b, edges.back().cost);
    }
    for (int k = 0; k < 3; ++k) {
      const int a = int(random() % nodes), b = int(random() % nodes);
      if (a == b) continue;
      follows.push_back({a, b, 0});
      graph.follow(a, b);
    }
    const auto sum = [&](auto in) {
      double total = 0;
      for (int i = 0; i < nodes; ++i) total += double(node[std::size_t(i)][in(i) ? 0 : 1]);
      for (const Edge& e : edges) total += in(e.a) != in(e.b) ? double(e.cost) : 0;
      for (const Edge& e : follows) total += in(e.a) && !in(e.b) ? 1e6 : 0;
      return total;
    };
    double least = 1e9;
    for (int labels = 0; labels < 1 << nodes; ++labels)
      least = std::min(least, sum([&](int i) { return (labels >> i & 1) != 0; }));
    const std::vector<bool> found = graph.solve();
    worst(sum([&](int i) { return bool(found[std::size_t(i)]); }) - least);
  }
  record::claim("MinimumCut", "value", "all labellings of graphs of 9 nodes, with edges and implications", 1e-3,
                worst.value, graphs);
}

TEST_CASE("Superpixels: connected, of about the size that is asked, and true to a strong edge", "[twin][value]") {
  Image image(64, 48, {0.05f, 0.2f, 0.6f});
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      if (x + y / 2 > 40) image.set(x, y, {0.7f, 0.6f, 0.1f});
  const Superpixels s = superpixels(image, 8);
  CHECK(s.count > 30);
  CHECK(s.count < 80);
  std::vector<std::array<int, 2>> sides(std::size_t(s.count), {0, 0});
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) ++sides[std::size_t(s.label[std::size_t(y * 64 + x)])][x + y / 2 > 40];
  for (const auto& side : sides) {
    CHECK(side[0] + side[1] > 0);
    CHECK((side[0] == 0 || side[1] == 0));
  }
  // Each is one piece: flooding from its first pixel meets all of them.
  for (int k = 0; k < s.count; ++k) {
    std::set<int> left;
    for (int p = 0; p < 64 * 48; ++p)
      if (s.label[std::size_t(p)] == k) left.insert(p);
    std::vector<int> front{*left.begin()};
    left.erase(left.begin());
    while (!front.empty()) {
      const int p = front.back(), x = p % 64;
      front.pop_back();
      for (const int q : {x > 0 ? p - 1 : -1, x < 63 ? p + 1 : -1, p - 64, p + 64})
        if (left.erase(q)) front.push_back(q);
    }
    CHECK(left.empty());
  }
}

TEST_CASE("Star cut: a notch that looks away from the middle stays, one behind a bar is filled", "[twin][value]") {
  // Odds say: a disc of radius 14, but not a hole in it and not a wedge that opens outwards.
  constexpr int n = 48;
  Mask odds(n, n);
  const auto disc = [](int x, int y) { return std::hypot(float(x) - 23.5f, float(y) - 23.5f) < 14; };
  const auto hole = [](int x, int y) { return x > 30 && x < 34 && y > 20 && y < 28; };
  const auto wedge = [](int x, int y) { return y > 24 && std::abs(float(x) - 23.5f) < 0.5f * (float(y) - 24); };
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) odds.at(x, y) = disc(x, y) && !hole(x, y) && !wedge(x, y) ? 60.0f : -60.0f;
  Image image(n, n, {0.2f, 0.2f, 0.2f});
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      if (odds.at(x, y) > 0) image.set(x, y, {0.8f, 0.2f, 0.2f});
  const StarCut star(image, {4, 4, 44, 44});
  const std::vector<char> in = star.by_pixels(odds, std::vector<char>(n * n, 0), std::vector<char>(n * n, 1));
  int wrong = 0, filled = 0, notched = 0;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const bool inside = in[std::size_t(y * n + x)] != 0;
      if (hole(x, y)) filled += inside;
      else if (wedge(x, y) && disc(x, y) && y > 29) notched += !inside;
      else if (std::abs(std::hypot(float(x) - 23.5f, float(y) - 23.5f) - 14) > 1.5f && !wedge(x, y))
        wrong += inside != disc(x, y);
    }
  CHECK(filled == 3 * 7);
  CHECK(notched > 40);
  CHECK(wrong == 0);
  // Outside the box nothing is in, whatever the odds.
  std::fill(odds.values.begin(), odds.values.end(), 60.0f);
  const std::vector<char> all = star.by_pieces(odds, -1);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int rim = std::min({x, y, n - 1 - x, n - 1 - y});
      if (rim < 4) CHECK(!all[std::size_t(y * n + x)]);
      if (rim >= 4 + StarCut::step) CHECK(all[std::size_t(y * n + x)]);
    }
}
