// examples/cards.h -- pictures on white, side by side, with a name and a line of text under each
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/io/report.h>

struct Card {
  burnish::Image image;  // linear RGB, all of one size
  std::string name, text;
};
/// Linear RGB. A name that is too long for its picture is cut.
inline burnish::Image card_sheet(const std::vector<Card>& cards, int columns) {
  using namespace burnish;
  constexpr int gap = 14;
  const int w = cards.front().image.width, h = cards.front().image.height;
  const int large = w < 200 ? 11 : 16, small = w < 200 ? 10 : 14, bar = large + small + 14;
  const int across = std::min(columns, int(cards.size())), rows = (int(cards.size()) + across - 1) / across;
  Image out(across * (w + gap) + gap, rows * (h + bar + gap) + gap, {1, 1, 1});
  const auto place = [&](int i) { return std::pair(gap + i % across * (w + gap), gap + i / across * (h + bar + gap)); };
  for (int i = 0; i < int(cards.size()); ++i) {
    const auto [left, top] = place(i);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) out.set(left + x, top + y, cards[std::size_t(i)].image.at(x, y));
    for (int x = 0; x < w; ++x) out.set(left + x, top + h + bar - 2, vec3<float>(0.75f));
  }
  OIIO::ImageBuf b = detail::buffer_of(out);
  const auto fitting = [&](std::string s, int size) {
    const std::size_t most = std::size_t(double(w) / (0.6 * size));
    return s.size() > most ? s.substr(0, most - 1) + "." : s;
  };
  for (int i = 0; i < int(cards.size()); ++i) {
    const auto [left, top] = place(i);
    const Card& c = cards[std::size_t(i)];
    detail::write_on(b, left, top + h + large + 2, fitting(c.name, large), large, 0.02f);
    detail::write_on(b, left, top + h + large + small + 7, fitting(c.text, small), small, 0.2f);
  }
  return detail::image_of(b);
}
