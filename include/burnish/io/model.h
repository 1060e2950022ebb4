// burnish/io/model.h -- models and the state of a fit as JSON, read back to the same bits
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <burnish/fit/fit.h>
#include <burnish/io/file.h>

namespace burnish {

/// {"base_color.x": 0.5, ...}: every number by its dotted name, in order. Images are not written.
template <class M> nlohmann::ordered_json to_json(const M& model) {
  nlohmann::ordered_json j = nlohmann::ordered_json::object();
  for_each_parameter(model, [&]<class X>(const std::string& name, const X& x, Range) {
    if constexpr (Plain<X>) j[name] = x;
  });
  return j;
}
/// Numbers that the file does not name stay as they are. Error for an unknown name, for what is no number and for one out
/// of its range; `file` stands in the message.
template <class M> void from_json(const nlohmann::ordered_json& j, M& model, const std::string& file) {
  if (!j.is_object()) throw Error(file + ": expected an object of named numbers");
  std::size_t found = 0;
  for_each_parameter(model, [&]<class X>(const std::string& name, X& x, Range range) {
    if constexpr (Plain<X>) {
      const auto at = j.find(name);
      if (at == j.end()) return;
      ++found;
      if (!at->is_number()) throw Error(file + ": \"" + name + "\" is " + at->dump() + ", expected a number");
      const float v = at->template get<float>();
      const bool open = range.low <= anything.low && range.high >= anything.high;
      if (!std::isfinite(v) || (!open && !(v >= range.low && v <= range.high))) {
        std::ostringstream s;
        s << file << ": \"" << name << "\" is " << v << ", expected " << range.low << " to " << range.high;
        throw Error(s.str());
      }
      x = X(v);
    }
  });
  if (found == j.size()) return;
  for (const auto& [name, value] : j.items()) {
    bool known = false;
    for_each_parameter(model, [&](const std::string& n, auto&, Range) { known |= n == name; });
    if (!known) throw Error(file + ": \"" + name + "\" is no parameter of this model");
  }
}
inline nlohmann::ordered_json parse_json(const std::string& path) {
  try {
    return nlohmann::ordered_json::parse(read_text(path));
  } catch (const nlohmann::json::exception& e) {
    throw Error(path + ": not JSON: " + e.what());
  }
}
template <class M> void write_model(const std::string& path, const M& model) { write_text(path, to_json(model).dump(2) + "\n"); }
template <class M> M read_model(const std::string& path, M start = {}) {
  from_json(parse_json(path), start, path);
  return start;
}

/// All of a fit's state; floats carry enough digits to come back as they were.
template <class M> nlohmann::ordered_json to_json(const FitState<M>& s) {
  return {{"model", to_json(s.model)},       {"best", to_json(s.best)},       {"best_loss", s.best_loss},
          {"losses", s.losses},              {"steps", s.adam.steps},         {"rate", s.adam.rate},
          {"beta1", s.adam.beta1},           {"beta2", s.adam.beta2},         {"epsilon", s.adam.epsilon},
          {"first_moment", s.adam.first},    {"second_moment", s.adam.second}};
}
template <class M> void from_json(const nlohmann::ordered_json& j, FitState<M>& s, const std::string& file) {
  try {
    from_json(j.at("model"), s.model, file);
    from_json(j.at("best"), s.best, file);
    s.best_loss = j.at("best_loss").is_null() ? std::numeric_limits<double>::infinity() : j.at("best_loss").get<double>();
    s.losses = j.at("losses").get<std::vector<double>>();
    s.adam.steps = j.at("steps").get<int>();
    s.adam.rate = j.at("rate").get<float>(), s.adam.epsilon = j.at("epsilon").get<float>();
    s.adam.beta1 = j.at("beta1").get<float>(), s.adam.beta2 = j.at("beta2").get<float>();
    s.adam.first = j.at("first_moment").get<std::vector<float>>();
    s.adam.second = j.at("second_moment").get<std::vector<float>>();
  } catch (const nlohmann::json::exception& e) {
    throw Error(file + ": not the state of a fit: " + e.what());
  }
  std::size_t numbers = 0;
  for_each_parameter(s.model, [&]<class X>(const std::string&, const X&, Range) { numbers += Plain<X>; });
  const auto fits = [&](const std::vector<float>& moment) { return moment.size() == (s.step() > 0 ? numbers : 0); };
  if (j.at("model").size() != numbers || j.at("best").size() != numbers || s.adam.steps != s.step() || !fits(s.adam.first) || !fits(s.adam.second))
    throw Error(file + ": the state of another model's fit, or a part is missing");
}

}  // namespace burnish
