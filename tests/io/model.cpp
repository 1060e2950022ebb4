// tests/io/model.cpp -- models and fits as JSON: back to the same bits, wrong files named
// SPDX-License-Identifier: Apache-2.0
#include <burnish_test.h>
#include "files.h"
#include <burnish/io/model.h>
#include <burnish/math/vec.h>
#include <burnish/nodes/image.h>
#include <cstring>
#include <limits>
#include <random>

using namespace burnish;
using files::error_of;

namespace {

template <class T> struct Grain {
  T size = 0.01f, amount = 0.1f;
  static constexpr auto parameters() {
    return std::tuple{Param{"size", &Grain::size, Range{0.002f, 0.2f}}, Param{"amount", &Grain::amount, unit}};
  }
};
template <class T> struct Wood {
  vec3<T> color = {0.5f, 0.3f, 0.1f};
  Grain<T> grain;
  std::array<T, 2> shift = {1.0f, -1.0f};
  int rows = 3;
  static constexpr auto parameters() {
    return std::tuple{Param{"color", &Wood::color, unit}, Param{"grain", &Wood::grain}, Param{"shift", &Wood::shift},
                      Fixed{&Wood::rows}};
  }
};
template <class M> bool same_bits(const M& a, const M& b) {
  bool same = true;
  each([&](float x, float y) { same = same && std::memcmp(&x, &y, sizeof x) == 0; }, a, b);
  return same;
}
bool has(const std::string& text, const std::string& part) {
  CAPTURE(text, part);
  CHECK(text.find(part) != std::string::npos);
  return text.find(part) != std::string::npos;
}
/// A bowl with its bottom at 0.3 of everything; one slope a number, none alike.
double bowl(const Wood<float>& w, Wood<float>& d) {
  double loss = 0;
  float weight = 1;
  each(
      [&](float x, float& slope) {
        weight *= 1.1f;
        loss += double(weight * (x - 0.3f) * (x - 0.3f));
        slope = 2 * weight * (x - 0.3f);
      },
      w, d);
  return loss;
}
bool same_bits(const FitState<Wood<float>>& a, const FitState<Wood<float>>& b) {
  return same_bits(a.model, b.model) && same_bits(a.best, b.best) && a.losses == b.losses &&
         a.best_loss == b.best_loss && a.adam.first == b.adam.first && a.adam.second == b.adam.second &&
         a.adam.steps == b.adam.steps && a.adam.rate == b.adam.rate && a.adam.beta1 == b.adam.beta1 &&
         a.adam.beta2 == b.adam.beta2 && a.adam.epsilon == b.adam.epsilon;
}

}  // namespace

TEST_CASE("Model file: every number by its dotted name, in order", "[io][value]") {
  const files::Folder folder;
  write_model(folder / "wood.json", Wood<float>{});
  CHECK(read_text(folder / "wood.json") ==
        "{\n  \"color.x\": 0.5,\n  \"color.y\": 0.30000001192092896,\n  \"color.z\": 0.10000000149011612,\n"
        "  \"grain.size\": 0.009999999776482582,\n  \"grain.amount\": 0.10000000149011612,\n"
        "  \"shift.0\": 1.0,\n  \"shift.1\": -1.0\n}\n");
  CHECK(folder.count() == 1);
}
TEST_CASE("Model file: any float comes back to its bits, the smallest and the largest among them", "[io][agreement]") {
  const files::Folder folder;
  using F = std::numeric_limits<float>;
  std::vector<float> all = {
      0.0f, -0.0f,       F::denorm_min(), -F::denorm_min(), 3e-40f,   F::min(),    F::epsilon(),
      0.1f, 16777217.0f, 1e30f,           -1e30f,           F::max(), F::lowest(), std::nextafter(1.0f, 2.0f)};
  std::mt19937 random(1);
  while (all.size() < 2000) {
    const std::uint32_t bits = std::uint32_t(random());
    float x;
    std::memcpy(&x, &bits, sizeof x);
    if (std::isfinite(x)) all.push_back(x);
  }
  for (const float x : all) {
    Wood<float> wood, back;
    wood.shift[1] = x;
    from_json(nlohmann::ordered_json::parse(to_json(wood).dump()), back, "text");
    CAPTURE(x);
    CHECK(same_bits(back, wood));
  }
  Wood<float> wood;
  wood.color = {0.0f, 1.0f, 3e-40f};  // both ends of a range, and what is next to nothing
  wood.grain.size = 0.2f;
  write_model(folder / "wood.json", wood);
  CHECK(same_bits(read_model<Wood<float>>(folder / "wood.json"), wood));
}
TEST_CASE("Model file: what is not named stays as it is", "[io][value]") {
  const files::Folder folder;
  Wood<float> start;
  start.color.z = 0.9f, start.rows = 7;
  const Wood<float> read = read_model(folder.write("some.json", R"({"grain.amount": 1, "color.y": 2.5e-1})"), start);
  Wood<float> expected = start;
  expected.grain.amount = 1, expected.color.y = 0.25f;
  CHECK(same_bits(read, expected));
  CHECK(read.rows == 7);
  CHECK(same_bits(read_model(folder.write("none.json", "{}"), start), start));
}
TEST_CASE("Model file: wrong ones are refused by the file's name and the number's", "[io][limit]") {
  const files::Folder folder;
  const auto error = [&](const std::string& text) {
    const std::string path = folder.write("wood.json", text), what = error_of([&] { read_model<Wood<float>>(path); });
    has(what, path + ": ");
    CHECK(what.find('\n') == std::string::npos);
    return what;
  };
  has(error(R"({"color.x": 0.5, "colour.y": 0.5})"), "\"colour.y\" is no parameter of this model");
  has(error(R"({"color": 0.5})"), "\"color\" is no parameter of this model");
  has(error(R"({"color.x": "red"})"), "\"color.x\" is \"red\", expected a number");
  has(error(R"({"color.x": true})"), "\"color.x\" is true, expected a number");
  has(error(R"({"color.x": null})"), "\"color.x\" is null, expected a number");
  has(error(R"({"color.x": [0.5]})"), "\"color.x\" is [0.5], expected a number");
  has(error(R"({"color.x": 1.001})"), "\"color.x\" is 1.001, expected 0 to 1");
  has(error(R"({"color.x": -1})"), "\"color.x\" is -1, expected 0 to 1");
  has(error(R"({"grain.size": 0.25})"), "\"grain.size\" is 0.25, expected 0.002 to 0.2");
  has(error(R"({"color.x": 1e300})"), "\"color.x\" is ");
  has(error(R"({"shift.0": 1e300})"), "\"shift.0\" is ");
  has(error(R"({"shift.2": 0})"), "\"shift.2\" is no parameter of this model");
  has(error("[1, 2]"), "expected an object of named numbers");
  has(error("{\"color.x\": 0.5"), "not JSON");
  has(error(""), "not JSON");
  CHECK(error_of([&] { read_model<Wood<float>>(folder / "none.json"); }) == (folder / "none.json") + ": no such file");
  CHECK(has(error_of([&] { read_model<Wood<float>>(folder.path.string()); }), "a folder, expected a file"));
}
TEST_CASE("Model file: what cannot be written leaves nothing", "[io][limit]") {
  const files::Folder folder;
  const std::string path = folder / "no/wood.json";
  CHECK(has(error_of([&] { write_model(path, Wood<float>{}); }), path + ": cannot be written"));
  CHECK(folder.count() == 0);
}

TEST_CASE("Fit file: written at any step and read back, a fit goes on to the same bits", "[io][agreement]") {
  const files::Folder folder;
  const Adam adam{.rate = 0.013f, .beta1 = 0.87f, .beta2 = 0.991f, .epsilon = 3e-7f};
  FitState<Wood<float>> whole(Wood<float>{}, adam);
  fit(whole, bowl, {.steps = 25});
  for (const int at : {0, 1, 11, 25}) {
    CAPTURE(at);
    FitState<Wood<float>> half(Wood<float>{}, adam);
    fit(half, bowl, {.steps = at});
    write_text(folder / "state.json", to_json(half).dump() + "\n");
    FitState<Wood<float>> rest;
    from_json(parse_json(folder / "state.json"), rest, folder / "state.json");
    CHECK(same_bits(rest, half));
    fit(rest, bowl, {.steps = 25});
    CHECK(same_bits(rest, whole));
  }
}
TEST_CASE("Fit file: wrong ones are refused by the file's name", "[io][limit]") {
  FitState<Wood<float>> state{Wood<float>{}};
  fit(state, bowl, {.steps = 3});
  const nlohmann::ordered_json good = to_json(state);
  const auto error = [&](const nlohmann::ordered_json& j) {
    FitState<Wood<float>> read;
    const std::string what = error_of([&] { from_json(j, read, "fits/wood.state.json"); });
    has(what, "fits/wood.state.json: ");
    return what;
  };
  const auto with = [&](const char* name, const nlohmann::ordered_json& value) {
    nlohmann::ordered_json j = good;
    j[name] = value;
    return error(j);
  };
  FitState<Wood<float>> read;
  CHECK(error_of([&] { from_json(good, read, "x"); }) == "");
  for (const auto& entry : good.items()) {
    CAPTURE(entry.key());
    nlohmann::ordered_json j = good;
    j.erase(entry.key());
    error(j);
    with(entry.key().c_str(), "three");
    if (entry.key() != "best_loss") with(entry.key().c_str(), nullptr);
  }
  has(with("model", {{"colour.x", 0.5}}), "\"colour.x\" is no parameter of this model");
  has(with("best", {{"color.x", 7}}), "\"color.x\" is 7, expected 0 to 1");
  with("first_moment", std::vector<float>(3));
  with("second_moment", std::vector<float>(6));
  with("second_moment", std::vector<float>{});
  with("steps", 2);
  error(nlohmann::ordered_json::array());
  error(to_json(FitState<Grain<float>>{Grain<float>{}}));
}
