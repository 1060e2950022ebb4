// tests/io/library.cpp -- folders become a library: what is found, refused, gone on with, overruled and survived
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include <sys/mman.h>
#include <minizip/zip.h>
#include "files.h"
#include <burnish/io/build_library.h>
#include <burnish/io/embeddings.h>
#include <burnish/twin/search.h>

using namespace burnish;
using files::error_of;

namespace {
/// A box of a car as OBJ, `high` metres; materials: how many of paint, glass, tyre are told apart. backwards: faces in
/// another order, each box's corners its own.
std::string car(double high, int materials = 3, bool backwards = false) {
  struct Box {
    int material;
    double x0, x1, y0, y1, z0, z1;
  };
  std::vector<Box> boxes = {{0, -2, 2, 0.2, 1, -0.8, 0.8}, {1, -1, 1, 1, high, -0.7, 0.7}};
  for (const double x : {-1.3, 1.3})
    for (const double z : {-0.8, 0.6}) boxes.push_back({2, x - 0.35, x + 0.35, 0, 0.6, z, z + 0.2});
  if (backwards) std::reverse(boxes.begin(), boxes.end());
  std::ostringstream s;
  s << "mtllib car.mtl\n";
  for (const Box& b : boxes) {
    s << "usemtl " << std::array{"paint", "glass", "tire"}[std::size_t(std::min(b.material, materials - 1))] << "\n";
    for (const double x : {b.x0, b.x1})
      for (const double y : {b.y0, b.y1})
        for (const double z : {b.z0, b.z1}) s << "v " << x << " " << y << " " << z << "\n";
    s << "f -8 -7 -5 -6\nf -4 -2 -1 -3\nf -8 -4 -3 -7\nf -6 -5 -1 -2\nf -8 -6 -2 -4\nf -7 -3 -1 -5\n";
  }
  return s.str();
}
const char* const colors = "newmtl paint\nKd 0.6 0.1 0.1\nnewmtl glass\nKd 0.1 0.1 0.1\nd 0.3\nnewmtl tire\nKd 0 0 0\n";

void zip(const std::string& path, const std::vector<std::pair<std::string, std::string>>& entries) {
  const zipFile z = zipOpen64(path.c_str(), APPEND_STATUS_CREATE);
  for (const auto& [name, text] : entries) {
    zipOpenNewFileInZip64(z, name.c_str(), nullptr, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED, 1, 0);
    zipWriteInFileInZip(z, text.data(), unsigned(text.size()));
    zipCloseFileInZip(z);
  }
  zipClose(z, nullptr);
}
const ViewOptions few{4, {0.1f, 0.3f}, 2.5f, 160};
LibraryBuild build(const std::string& index, const std::vector<std::string>& folders,
                   const std::vector<LibraryRule>& rules = {}, int stop_after = 1000) {
  LibraryOptions options;
  options.workers = 2, options.save_every = 0, options.views = few;
  int told = 0;
  return build_library(
      index, folders, rules, options, [&](int done, int of, double) { CHECK((done == ++told && done <= of)); },
      [&] { return told >= stop_after; });
}
const LibraryEntry& at(const Library& l, const std::string& end) {
  for (const LibraryEntry& e : l.entries)
    if (e.path.size() >= end.size() && e.path.compare(e.path.size() - end.size(), end.size(), end) == 0) return e;
  FAIL("no entry " << end);
  return l.entries[0];
}
bool has(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }
}  // namespace

TEST_CASE("Children: what crashes, never ends, eats memory or throws ends alone, and the others are done",
          "[io][limit]") {
  const files::Folder folder;
  set_threads(3);  // a pool that a child has not
  std::vector<ChildEnd> ends(6);
  int ticks = 0;
  ChildLimits limits;
  limits.seconds = 0.4, limits.megabytes = 256;
  const bool whole = in_children(
      6, 2, limits,
      [&](int i) {
        if (i == 0) std::abort();
        if (i == 1) for (volatile int forever = 1; forever;) {}
        if (i == 2) throw std::runtime_error("no");
        if (i == 3) throw std::bad_alloc();
        if (i == 4) raise(SIGSEGV);
        std::vector<int> squares(100);
        parallel_for(100, [&](int k) { squares[std::size_t(k)] = k * k; });
        std::ofstream(folder / "left") << squares[99];
      },
      [&](int i, const ChildEnd& e) { ends[std::size_t(i)] = e; }, [&] { return ++ticks > 0; });
  CHECK(whole);
  CHECK(threads() == 3);
  CHECK(has(ends[0].text, "the reader crashed: "));
  CHECK(ends[1].text == "the reader took over 0.4 s");
  CHECK(has(ends[2].text, "gave up"));
  CHECK(ends[3].text == "too large for memory: more than 256 MB");
  CHECK(has(ends[4].text, "the reader crashed: "));
  CHECK(ends[5].done);
  CHECK(read_text(folder / "left") == "9801");
  for (int i = 0; i < 5; ++i) CHECK_FALSE(ends[std::size_t(i)].done);
  // Told to stop, it kills what runs and begins no more.
  int ended = 0;
  CHECK_FALSE(in_children(5, 2, ChildLimits{60, 256}, [](int) { pause(); }, [&](int, const ChildEnd&) { ++ended; },
                          [&, calls = 0]() mutable { return ++calls < 4; }));
  CHECK(ended == 0);
  CHECK(waitpid(-1, nullptr, WNOHANG) == -1);  // no child is left
  set_threads(int(std::max(1u, std::thread::hardware_concurrency())));
}

TEST_CASE("Children: memory beyond the limit is refused to a child", "[io][limit]") {
  if (!detail::address_space_is_ours) return;
  std::string how;
  in_children(1, 1, ChildLimits{20, 64},
              [](int) {
                std::vector<std::vector<char>> all;
                for (int i = 0; i < 1000; ++i) all.emplace_back(1 << 20, char(i));
              },
              [&](int, const ChildEnd& e) { how = e.text; }, [] { return true; });
  CHECK(how == "too large for memory: more than 64 MB");
}

TEST_CASE("Library of files: each is indexed or refused with the reason, and no broken one stops it", "[io][value]") {
  const files::Folder folder;
  std::filesystem::create_directories(folder / "cars/deep");
  folder.write("cars/car.mtl", colors), folder.write("cars/deep/car.mtl", colors);
  folder.write("cars/a.obj", car(1.4));
  folder.write("cars/deep/b.obj", car(1.4, 3, true));
  folder.write("cars/deep/scene.obj", car(1.6));
  folder.write("cars/one.obj", car(1.5, 1));
  folder.write("cars/empty.obj", ""), folder.write("cars/broken.glb", "no mesh"),
      folder.write("cars/notes.txt", "no mesh");
  folder.write("cars/flat.obj", "v 0 0 0\nv 4 0 0\nv 4 0 2\nv 0 0.1 2\nf 1 2 3\nf 1 3 4\n");
  folder.write("cars/front_wheel.obj", car(1.7)), folder.write("cars/fake.zip", "no archive");
  zip(folder / "cars/things.sh3f",
      {{"PluginFurnitureCatalog.properties",
        "id#1=x\nname#1=My "
        "Suv\nmodel#1=/x/model.obj\ncategory#1=Vehicles\nname#2=Chair\nmodel#2=/x/car.obj\ncategory#2=Seats\n"},
       {"x/model.obj", car(1.9)},
       {"x/car.obj", car(1.4)},
       {"x/car.mtl", colors}});
  zip(folder / "cars/more.zip", {{"red/van.obj", car(2.2)}, {"red/table.obj", car(1.4)}, {"red/car.mtl", colors}});
  const std::string index = folder / "index";
  const LibraryBuild b = build(index, {folder / "cars"});
  const Library& l = b.vehicles;
  CHECK(b.done == 10);
  CHECK(b.left == 0);
  CHECK(l.entries.size() == 10);
  CHECK(at(l, "cars/a.obj").status == LibraryStatus::indexed);
  CHECK(at(l, "cars/a.obj").materials == 3);
  CHECK(at(l, "cars/a.obj").triangles == 72);
  CHECK(at(l, "cars/a.obj").size.x == Approx(4));
  CHECK(at(l, "cars/a.obj").size.y == Approx(1.4));
  CHECK(at(l, "deep/b.obj").status == LibraryStatus::duplicate);
  CHECK(at(l, "deep/b.obj").reason == "same as " + (folder / "cars/a.obj"));
  CHECK(at(l, "deep/scene.obj").status == LibraryStatus::indexed);
  CHECK(at(l, "deep/scene.obj").name == "deep");
  CHECK(has(at(l, "one.obj").reason, "one material"));
  CHECK(at(l, "one.obj").status == LibraryStatus::refused);
  for (const char* broken : {"empty.obj", "broken.glb"}) {
    CHECK(at(l, broken).status == LibraryStatus::failed);
    CHECK(has(at(l, broken).reason, "not a mesh that can be read"));
  }
  CHECK(has(at(l, "flat.obj").reason, "no vehicle by its proportions"));
  CHECK(at(l, "front_wheel.obj").reason == "by its name no whole vehicle: wheel");
  CHECK(at(l, "things.sh3f:x/model.obj").name == "My Suv");
  CHECK(at(l, "things.sh3f:x/model.obj").status == LibraryStatus::indexed);
  CHECK(at(l, "more.zip:red/van.obj").status == LibraryStatus::indexed);
  std::string notes;
  for (const std::string& n : b.notes) notes += n + "\n";
  CHECK(has(notes, "things.sh3f: 1 vehicles by its catalogue, 1 other models passed over"));
  CHECK(has(notes, "more.zip: 1 vehicles by their names, 1 other models passed over"));
  CHECK(has(notes, "fake.zip: not a zip archive"));
  // Rows and thumbnails are those of what is indexed, and describe it.
  const LibrarySpace& views = l.spaces.at("views");
  CHECK(views.rows() == 4 * 8);
  CHECK(views.values.size() == std::size_t(views.rows() * view_numbers));
  CHECK(l.thumbnail_of.size() == 4);
  const DescribedViews again = describe_views(Raycaster(read_vehicle(folder / "cars/a.obj")), few);
  const int first = first_rows(l, views)[std::size_t(l.find(folder / "cars/a.obj"))];
  float worst = 0;
  for (int i = 0; i < again.size() * view_numbers; ++i)
    worst = std::max(worst, std::abs(again.rows[std::size_t(i)] - views.values[std::size_t(first * view_numbers + i)]));
  CHECK(worst < 5e-4f);  // kept as 16-bit floats
  CHECK(worst > 0);

  // What was written is what is read, and written again the same bytes.
  const std::string bytes = read_text(index);
  const Library read = read_library(index);
  write_library(index, read);
  CHECK((read_text(index) == bytes));
  CHECK((read.spaces.at("views").values == views.values));
  CHECK((read.thumbnails == l.thumbnails));
}

TEST_CASE("Library of files: a second run goes on where the first was stopped, and does what has changed",
          "[io][agreement]") {
  const files::Folder folder;
  std::filesystem::create_directory(folder / "cars");
  folder.write("cars/car.mtl", colors);
  folder.write("cars/a.obj", car(1.4)), folder.write("cars/b.obj", car(1.4, 3, true)),
      folder.write("cars/c.obj", car(1.5, 1));
  const std::string index = folder / "index", whole = folder / "whole";
  const std::vector<std::string> cars = {folder / "cars"};
  CHECK(build(whole, cars).done == 3);
  const LibraryBuild stopped = build(index, cars, {}, 1);
  CHECK(stopped.done >= 1);
  CHECK(stopped.left >= 1);
  CHECK(read_library(index).entries.size() == std::size_t(stopped.done));
  CHECK(build(index, cars).done == 3 - stopped.done);
  const auto same = [&] {
    const Library x = read_library(index), y = read_library(whole);
    REQUIRE(x.entries.size() == y.entries.size());
    for (std::size_t i = 0; i < x.entries.size(); ++i) {
      CHECK(x.entries[i].path == y.entries[i].path);
      CHECK(x.entries[i].status == y.entries[i].status);
      CHECK(x.entries[i].reason == y.entries[i].reason);
    }
    CHECK((x.spaces.at("views").values == y.spaces.at("views").values));
  };
  same();
  const auto written = std::filesystem::last_write_time(index);
  const LibraryBuild none = build(index, cars);
  CHECK(std::filesystem::last_write_time(index) == written);  // nothing new, nothing written
  CHECK(none.done == 0);
  CHECK(none.found == 3);
  same();
  // A file that changed; one that is gone, of which another was a duplicate; a new one; an entry from elsewhere stays.
  folder.write("cars/c.obj", car(1.5));
  CHECK(build(index, cars).done == 1);
  CHECK(at(read_library(index), "c.obj").status == LibraryStatus::indexed);
  std::filesystem::remove(folder / "cars/a.obj");
  const LibraryBuild without = build(index, cars);
  CHECK(without.done == 1);
  CHECK(without.gone == 1);
  CHECK(at(without.vehicles, "b.obj").status == LibraryStatus::indexed);
  CHECK(without.vehicles.spaces.at("views").rows() == 2 * 8);
  std::filesystem::create_directory(folder / "vans");
  folder.write("vans/car.mtl", colors), folder.write("vans/d.obj", car(2.0));
  const LibraryBuild more = build(index, {folder / "vans"});
  CHECK(more.done == 1);
  CHECK(more.vehicles.entries.size() == 3);
  CHECK(folder.count() == 4);  // cars, vans and two indices: nothing is left beside them
}

TEST_CASE("Library of files: rules overrule what was found, last one first, and are remembered", "[io][value]") {
  const files::Folder folder;
  std::filesystem::create_directory(folder / "cars");
  folder.write("cars/car.mtl", colors), folder.write("cars/one.obj", car(1.4, 1)),
      folder.write("cars/two.obj", car(1.6, 2));
  const std::string index = folder / "index";
  const std::vector<std::string> cars = {folder / "cars"};
  CHECK(build(index, cars).vehicles.count(LibraryStatus::indexed) == 1);
  const LibraryBuild accepted = build(index, cars, {{"one*", true}});
  CHECK(accepted.done == 1);
  CHECK(accepted.vehicles.count(LibraryStatus::indexed) == 2);
  CHECK(has(at(accepted.vehicles, "one.obj").reason, "accepted by hand though: one material"));
  const LibraryBuild later = build(index, cars);
  CHECK(later.done == 0);
  CHECK(later.vehicles.count(LibraryStatus::indexed) == 2);
  const LibraryBuild refused = build(index, cars, {{"*.obj", false}});
  CHECK(refused.done == 0);
  CHECK(refused.vehicles.count(LibraryStatus::indexed) == 0);
  CHECK(at(refused.vehicles, "two.obj").reason == "refused by hand: *.obj");
  CHECK(refused.vehicles.spaces.empty());
  const LibraryBuild back = build(index, cars, {{"two", true}});
  CHECK(back.done == 1);
  CHECK(back.vehicles.count(LibraryStatus::indexed) == 1);
  CHECK(back.vehicles.rules.size() == 3);
}

TEST_CASE("Library of files: vectors from elsewhere are a space that outlives the next build", "[io][agreement]") {
  const files::Folder folder;
  std::filesystem::create_directories(folder / "cars/van");
  folder.write("cars/car.mtl", colors), folder.write("cars/van/car.mtl", colors);
  folder.write("cars/a.obj", car(1.4)), folder.write("cars/van/scene.obj", car(2.1)),
      folder.write("cars/one.obj", car(1.4, 1));
  const std::string index = folder / "index";
  Library l = build(index, {folder / "cars"}).vehicles;
  Embeddings e{{"van/scene.obj", "a", "one", "who"}, {{4, 3}, {0, 3, 4, 1, 0, 0, 0, 0, 2, 5, 5, 5}}};
  CHECK(add_space(l, "clip", e, "e") == 2);  // one.obj is refused, who is not there
  write_library(index, l);
  // The first entry changes and goes; the other's vector stays.
  folder.write("cars/a.obj", car(1.45));
  const Library after = build(index, {folder / "cars"}).vehicles;
  REQUIRE(after.spaces.count("clip") == 1);
  const LibrarySpace& s = after.spaces.at("clip");
  CHECK(s.columns == 3);
  CHECK(s.entry == std::vector{after.find(folder / "cars/van/scene.obj")});
  for (int k = 0; k < 3; ++k)
    CHECK(s.values[std::size_t(k)] == Approx(std::array{0.0, 0.6, 0.8}[std::size_t(k)]).margin(1e-3));
  const std::vector<float> query = {0, 0.6f, 0.8f};
  const auto found = nearest_models(s.values, 3, first_rows(after, s), query, 5);
  REQUIRE(found.size() == 1);
  CHECK(found[0].model == s.entry[0]);
  CHECK(found[0].cosine == Approx(1).margin(1e-3));

  e.names.back() = e.names[0];
  CHECK(has(error_of([&] { add_space(l, "views", e, "e"); }), "other than views"));
  CHECK(has(error_of([&] { add_space(l, "clip", {{"who"}, {{1, 1}, {1}}}, "e"); }), "e: no row has the name"));
  // As NPY with names beside, and as safetensors.
  write_npy(folder / "e.npy", e.vectors);
  folder.write("e.txt", "van\r\nb\nc\nd\n");
  CHECK(read_embeddings(folder / "e.npy").names == std::vector<std::string>{"van", "b", "c", "d"});
  CHECK(read_embeddings(folder / "e.npy").vectors.values == e.vectors.values);
  folder.write("e.txt", "a\nb\n");
  CHECK(has(error_of([&] { read_embeddings(folder / "e.npy"); }), "2 names, 4 rows"));
  write_safetensors(folder / "e.safetensors", {{{"x", {{2}, {1, 2}}}}, {{"names", "a"}}});
  CHECK(read_embeddings(folder / "e.safetensors").vectors.shape[1] == 2);
  CHECK(has(error_of([&] { read_embeddings(folder / "e.txt"); }), "expected a .npy"));
}

TEST_CASE("Library file: a damaged one is refused in one line, and so is a folder that is not there", "[io][limit]") {
  const files::Folder folder;
  std::filesystem::create_directory(folder / "cars");
  folder.write("cars/car.mtl", colors), folder.write("cars/a.obj", car(1.4));
  const std::string index = folder / "index";
  build(index, {folder / "cars"});
  const std::string good = read_text(index);
  std::vector<std::string> bad = {"", "short", std::string(100, '\xff'), good.substr(0, good.size() / 2),
                                  good.substr(0, 60), good + "x"};
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string s = good;
    const std::size_t i = s.find(from);
    REQUIRE(i != std::string::npos);
    REQUIRE(from.size() == to.size());
    bad.push_back(s.replace(i, from.size(), to));
  };
  changed("burnish_library\":\"1", "burnish_library\":\"7");
  changed("\\\"status\\\":\\\"indexed", "\\\"status\\\":\\\"indaxed");
  changed("\\\"triangles\\\"", "\\\"tringales\\\"");
  changed("views.entry", "views.antry");
  changed("\"views\"", "\"vi.ws\"");
  for (const std::string& b : bad) {
    folder.write("index", b);
    const std::string error = error_of([&] { build(index, {folder / "cars"}); });
    INFO(error);
    CHECK(error.rfind(index + ": no usable library index: ", 0) == 0);
    CHECK(error.find('\n') == std::string::npos);
    CHECK((read_text(index) == b));
  }
  CHECK(has(error_of([&] { build(folder / "other", {folder / "none"}); }), "none: no such folder"));
  CHECK_FALSE(std::filesystem::exists(folder / "other"));
}
