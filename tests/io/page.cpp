// tests/io/page.cpp -- the page: well-formed, whole in one file, and saying what it was told
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include "files.h"
#include <burnish/io/page.h>

using namespace burnish;

namespace {
/// Every tag that is opened is closed, in order; every attribute's value stands in quotes.
std::string unbalanced(const std::string& html) {
  std::vector<std::string> open;
  for (std::size_t i = html.find('<'); i != html.npos; i = html.find('<', i + 1)) {
    const std::size_t end = html.find('>', i);
    if (end == html.npos) return "a tag that does not end";
    const std::string tag = html.substr(i + 1, end - i - 1), name = tag.substr(0, tag.find_first_of(" \n"));
    if (std::count(tag.begin(), tag.end(), '"') % 2) return "an odd quote in " + name;
    i = end;
    if (name == "!doctype" || name == "meta" || name == "img" || name == "input" || name == "br") continue;
    if (name[0] == '/') {
      if (open.empty() || open.back() != name.substr(1))
        return name + " closes " + (open.empty() ? "nothing" : open.back());
      open.pop_back();
    } else open.push_back(name);
    if (name == "script" || name == "style") i = html.find("</" + name, i) - 1;
  }
  return open.empty() ? "" : open.back() + " is not closed";
}
int count(const std::string& text, const std::string& word) {
  int n = 0;
  for (std::size_t i = text.find(word); i != text.npos; i = text.find(word, i + 1)) ++n;
  return n;
}
}  // namespace

TEST_CASE("Page: all it can hold is well-formed HTML that needs no other file", "[io][value]") {
  const files::Folder folder;
  Image image(8, 6, {0.2f, 0.4f, 0.1f});
  write_png(folder / "a.png", image);
  folder.write("car.json", "{\"a\": 1}");
  folder.write("large.glb", std::string(50, 'x'));
  const std::string nasty = "<b> & \"quotes\" 'too' </section>";
  Page page(nasty);
  page.text("before any chapter");
  for (const std::string name : {"one", "two", nasty.c_str()}) {
    page.heading(name).text(nasty).picture(folder / "a.png", nasty).picture(image, nasty);
    page.compare(image, image, nasty).turntable({jpeg_of(image), jpeg_of(image), jpeg_of(image)}, nasty);
    page.table({{"a", nasty}, {"1", "2"}}).numbers({{nasty, "3", "+- 1"}}).times({{nasty, 1}, {"rest", 3}});
    page.download(folder / "car.json", nasty).download(folder / "large.glb", "beside", 40);
  }
  page.write(folder / "page.html");
  const std::string html = read_text(folder / "page.html");
  CHECK(unbalanced(html) == "");
  CHECK(count(html, "<section") == 3);
  CHECK(count(html, "href=\"#s") == 3);
  CHECK(count(html, "<script>") == 2);
  CHECK(count(html, "width:25.000%") == 3);
  CHECK(count(html, "data:image/jpeg;base64,") == 3 * (1 + 2 + 3));
  CHECK(count(html, "data:application/octet-stream;base64,eyJhIjogMX0=") == 3);  // {"a": 1}
  // Nothing from elsewhere: what is named is in the page or beside it.
  CHECK(count(html, "src=\"") == count(html, "src=\"data:"));
  CHECK(count(html, "href=\"") ==
        count(html, "href=\"#") + count(html, "href=\"data:") + count(html, "href=\"large.glb\""));
  CHECK(count(html, "http") == 0);
  CHECK(count(html, "url(") == 0);
}

TEST_CASE("Page: without chapters there is no list of them, and no script without something to move", "[io][limit]") {
  const files::Folder folder;
  Page("empty").text("words").turntable({}, "nothing").write(folder / "page.html");
  const std::string html = read_text(folder / "page.html");
  CHECK(unbalanced(html) == "");
  CHECK(count(html, "<nav>") == 0);
  CHECK(count(html, "<script>") == 0);
  CHECK(count(html, "<p>words</p>") == 1);
  CHECK(files::error_of([&] { Page("x").picture(folder / "none.png", "none"); }) ==
        (folder / "none.png") + ": no such file");
  CHECK(files::error_of([&] { Page("x").write(folder / "none/page.html"); }).find("cannot be written") !=
        std::string::npos);
}

TEST_CASE("Page: base 64 as RFC 4648 has it", "[io][value]") {
  const char* const coded[] = {"", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"};  // chapter 10
  for (std::size_t n = 0; n <= 6; ++n) CHECK(base64(std::string("foobar").substr(0, n)) == coded[n]);
  CHECK(base64("\xff\xfe\xfd") == "//79");
}

TEST_CASE("Page: a picture comes back from its JPEG", "[io][value]") {
  const files::Folder folder;
  Image image(32, 24);
  for (int i = 0; i < 32 * 24; ++i) image.set(i % 32, i / 32, {float(i % 32) / 32, float(i / 32) / 24, 0.5f});
  const Image back = read_photo(folder.write("a.jpg", jpeg_of(image, 95)));
  REQUIRE(back.width == 32);
  for (std::size_t i = 0; i < 32 * 24; ++i)
    for (int c = 0; c < 3; ++c)
      CHECK(std::abs(detail::to_srgb(back.plane(c)[i]) - detail::to_srgb(image.plane(c)[i])) < 0.03f);
}
