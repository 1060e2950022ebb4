// tests/io/computed.cpp -- what networks computed elsewhere, in each of the layouts
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include "files.h"
#include <burnish/io/computed.h>

using namespace burnish;
using files::error_of;

TEST_CASE("Embeddings: rows and their names come from each kind of file", "[io][value]") {
  const files::Folder folder;
  const Tensor vectors{{2, 3}, {1, 2, 3, 4, 5, 6}};
  write_safetensors(folder / "a.safetensors",
                    {{{"vectors", vectors}, {"other", {{1}, {0}}}}, {{"names", "van\npickup"}}});
  write_npy(folder / "b.npy", vectors);
  folder.write("b.txt", "van\npickup\n");
  write_npy(folder / "c.npy", vectors);
  for (const char* name : {"a.safetensors", "b.npy", "c.npy"}) {
    const Embeddings e = read_embeddings(folder / name);
    CHECK(e.vectors.shape == vectors.shape);
    CHECK(e.vectors.values == vectors.values);
    CHECK(e.names == (name[0] == 'c' ? std::vector<std::string>{"0", "1"} : std::vector<std::string>{"van", "pickup"}));
  }
  folder.write("b.txt", "van\n");
  CHECK(error_of([&] { read_embeddings(folder / "b.npy"); }) == (folder / "b.npy") + ": 1 names, 2 rows");
  write_safetensors(folder / "d.safetensors", {{{"x", vectors}, {"y", vectors}}, {}});
  CHECK(error_of([&] { read_embeddings(folder / "d.safetensors"); }) ==
        (folder / "d.safetensors") + ": 2 arrays and none called \"vectors\"");
  write_npy(folder / "e.npy", {{2, 1, 1}, {1, std::nanf("")}});
  CHECK(error_of([&] { read_embeddings(folder / "e.npy"); }) ==
        (folder / "e.npy") + ": shape [2, 1, 1], expected [N, D]");
  write_npy(folder / "e.npy", {{2, 1}, {1, std::nanf("")}});
  CHECK(error_of([&] { read_embeddings(folder / "e.npy"); }).find("row 1 is not finite") != std::string::npos);
  CHECK(error_of([&] { read_embeddings(folder / "e.csv"); }).find("expected a .npy, .npz or .safetensors file") !=
        std::string::npos);
}

TEST_CASE("Features: channels come last, however the file has them", "[io][value]") {
  const files::Folder folder;
  Tensor last{{2, 3, 4}, {}}, first{{1, 4, 2, 3}, std::vector<float>(24)};
  for (int i = 0; i < 24; ++i) last.values.push_back(float(i * i % 31));
  for (std::size_t y = 0; y < 2; ++y)
    for (std::size_t x = 0; x < 3; ++x)
      for (std::size_t c = 0; c < 4; ++c) first.values[(c * 2 + y) * 3 + x] = last(y, x, c);
  write_npy(folder / "last.npy", last);
  write_npy(folder / "first.npy", first);
  CHECK(read_features(folder / "last.npy").values == last.values);
  const Tensor turned = read_features(folder / "first.npy");
  CHECK(turned.shape == last.shape);
  CHECK(turned.values == last.values);
  write_npy(folder / "two.npy", {{2, 4, 1, 1}, std::vector<float>(8)});
  CHECK(error_of([&] { read_features(folder / "two.npy"); }).find("expected [h, w, c] or [1, c, h, w]") !=
        std::string::npos);
}

TEST_CASE("Labels: pictures, arrays and class scores give the same map, at the photo's size", "[io][agreement]") {
  const files::Folder folder;
  constexpr int w = 6, h = 4, classes = 5;
  Mask picture(w, h);
  Tensor labels{{h, w}, {}}, scores{{1, classes, h, w}, std::vector<float>(classes * h * w)};
  for (int i = 0; i < w * h; ++i) {
    const int k = i * 7 % classes;
    picture.values[std::size_t(i)] = float(k) / 255;
    labels.values.push_back(float(k));
    for (int c = 0; c < classes; ++c) scores.values[std::size_t(c * w * h + i)] = c == k ? 3.0f : 1.0f / float(1 + c);
  }
  write_png(folder / "l.png", picture);
  write_npy(folder / "l.npy", labels);
  write_safetensors(folder / "l.safetensors", {{{"scores", scores}}, {}});
  for (const char* name : {"l.png", "l.npy", "l.safetensors"}) {
    const std::vector<int> small = read_label_map(folder / name, w, h),
                           large = read_label_map(folder / name, 2 * w, 3 * h);
    REQUIRE(small.size() == w * h);
    REQUIRE(large.size() == 6 * w * h);
    for (int y = 0; y < 3 * h; ++y)
      for (int x = 0; x < 2 * w; ++x) CHECK(large[std::size_t(y * 2 * w + x)] == (y / 3 * w + x / 2) * 7 % classes);
    for (int i = 0; i < w * h; ++i) CHECK(small[std::size_t(i)] == i * 7 % classes);
  }
  labels.values[3] = 0.5f;
  write_npy(folder / "l.npy", labels);
  CHECK(error_of([&] { read_label_map(folder / "l.npy", w, h); }).find("the label 0.5") != std::string::npos);
}
