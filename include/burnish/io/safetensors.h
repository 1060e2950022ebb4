// burnish/io/safetensors.h -- named tensors in the safetensors format
// SPDX-License-Identifier: Apache-2.0
//
// github.com/huggingface/safetensors: the header's length, 8 bytes, little-endian; the header, JSON: {"name": {"dtype":
// "F32", "shape": [2, 3], "data_offsets": [0, 24]}, ..., "__metadata__": {"key": "text"}}; the numbers, which the
// offsets count from. They follow each other without a gap.
#pragma once
#include <nlohmann/json.hpp>
#include <burnish/io/decode.h>
#include <burnish/io/file.h>
#include <burnish/scene/tensor.h>

namespace burnish {
namespace detail {
inline std::optional<NumberType> safetensors_type(const std::string& name) {
  constexpr const char* names[] = {"BOOL", "U8",  "I8",  "U16",  "I16", "U32", "I32",
                                   "U64",  "I64", "F16", "BF16", "F32", "F64"};
  const auto* const at = std::find(std::begin(names), std::end(names), name);
  return at == std::end(names) ? std::nullopt : std::optional(NumberType(at - std::begin(names)));
}
/// Where a tensor of the file lies and what it is, checked.
struct TensorPlace {
  std::string name;
  NumberType type{};
  std::vector<std::size_t> shape;
  std::size_t begin = 0, end = 0;
};
inline TensorPlace tensor_place(const std::string& path, const std::string& name, const nlohmann::json& entry,
                                std::size_t size) {
  const std::string what = path + ": tensor " + nlohmann::json(name).dump();
  const auto numbers = [&](const char* key) {
    std::vector<std::size_t> list;
    if (!entry.is_object() || !entry.contains(key) || !entry[key].is_array())
      throw Error(what + ": no \"" + key + "\", expected a list of whole numbers");
    for (const auto& n : entry[key]) {
      if (!n.is_number_unsigned())
        throw Error(what + ": " + key + " has a " + n.type_name() + ", expected whole numbers");
      list.push_back(n.get<std::size_t>());
    }
    return list;
  };
  TensorPlace p;
  p.name = name;
  p.shape = numbers("shape");
  const std::vector<std::size_t> offsets = numbers("data_offsets");
  if (!entry.contains("dtype") || !entry["dtype"].is_string()) throw Error(what + ": no \"dtype\", expected a text");
  const auto type = safetensors_type(entry["dtype"].get<std::string>());
  if (!type)
    throw Error(what + ": type " + entry["dtype"].dump() + ", expected F32, F16, BF16, F64, BOOL or an integer");
  p.type = *type;
  if (offsets.size() != 2 || offsets[0] > offsets[1] || offsets[1] > size)
    throw Error(what + ": offsets " + shape_text(offsets) + ", expected a range within " + std::to_string(size) +
                " bytes");
  p.begin = offsets[0], p.end = offsets[1];
  const auto count = count_of(p.shape, bytes_of(p.type), size);
  if (!count || *count * bytes_of(p.type) != p.end - p.begin)
    throw Error(what + ": " + std::to_string(p.end - p.begin) + " bytes for the shape " + shape_text(p.shape) +
                ", expected as many as it needs");
  return p;
}
}  // namespace detail

/// All tensors, as decode.h has them, and "__metadata__" as texts. Error where the file is none, is cut short, or holds
/// a type that floats cannot stand for.
inline NamedTensors read_safetensors(const std::string& path) {
  if (std::filesystem::is_directory(path)) throw Error(path + ": a folder, expected a file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path + ": " + (std::filesystem::exists(path) ? "cannot be read" : "no such file"));
  const std::uintmax_t all = std::filesystem::file_size(path);
  std::uint64_t length = 0;
  if (all < 8 || !file.read(reinterpret_cast<char*>(&length), 8) || length > all - 8)
    throw Error(path + ": ends within its header, expected a safetensors file");
  std::string header(std::size_t(length), '\0');
  file.read(header.data(), std::streamsize(length));
  nlohmann::json j;
  try {
    j = nlohmann::json::parse(header);
  } catch (const nlohmann::json::exception& e) {
    throw Error(path + ": its header is not JSON: " + e.what());
  }
  if (!j.is_object()) throw Error(path + ": its header is not an object, expected a safetensors file");
  const std::size_t size = std::size_t(all - 8 - length);
  NamedTensors out;
  std::vector<detail::TensorPlace> places;
  for (const auto& [name, entry] : j.items()) {
    if (name != "__metadata__") {
      places.push_back(detail::tensor_place(path, name, entry, size));
      continue;
    }
    if (!entry.is_object()) throw Error(path + ": __metadata__ is not an object, expected texts by name");
    for (const auto& [key, text] : entry.items()) {
      if (!text.is_string())
        throw Error(path + ": __metadata__ " + nlohmann::json(key).dump() + " is a " + text.type_name() +
                    ", expected a text");
      out.texts[key] = text.get<std::string>();
    }
  }
  std::sort(places.begin(), places.end(),
            [](const auto& a, const auto& b) { return a.begin != b.begin ? a.begin < b.begin : a.end < b.end; });
  std::size_t end = 0;
  for (const detail::TensorPlace& p : places) {
    const std::string what = path + ": tensor " + nlohmann::json(p.name).dump();
    if (p.begin != end)
      throw Error(what + " begins at " + std::to_string(p.begin) + ", expected " + std::to_string(end) +
                  ": tensors follow each other");
    std::string bytes(p.end - p.begin, '\0');
    if (!file.read(bytes.data(), std::streamsize(bytes.size()))) throw Error(path + ": cannot be read to its end");
    out.tensors[p.name] = {p.shape,
                           detail::decode(p.type, bytes.data(), bytes.size() / detail::bytes_of(p.type), false, what)};
    end = p.end;
  }
  if (end != size)
    throw Error(path + ": " + std::to_string(size) + " bytes of numbers, expected " + std::to_string(end));
  return out;
}

/// All tensors, in the order of their names, as F32; those named in `narrow` as U8 (whole numbers 0 to 255) or F16
/// (rounded). Error also for a shape that does not fit its numbers.
inline void write_safetensors(const std::string& path, const NamedTensors& named,
                              const std::map<std::string, detail::NumberType>& narrow = {}) {
  using detail::NumberType;
  const auto type_of = [&](const std::string& name) {
    const auto at = narrow.find(name);
    return at == narrow.end() ? NumberType::f32 : at->second;
  };
  nlohmann::ordered_json j = nlohmann::ordered_json::object();
  if (!named.texts.empty()) j["__metadata__"] = named.texts;
  std::size_t end = 0;
  for (const auto& [name, t] : named.tensors) {
    const auto count = detail::count_of(t.shape, sizeof(float), std::size_t(-1));
    if (count != t.size())
      throw Error(path + ": tensor " + name + ": " + std::to_string(t.size()) + " numbers for the shape " +
                  detail::shape_text(t.shape));
    const std::size_t begin = end;
    const NumberType type = type_of(name);
    end += t.size() * detail::bytes_of(type);
    const char* const kind = type == NumberType::u8 ? "U8" : type == NumberType::f16 ? "F16" : "F32";
    j[name] = {{"dtype", kind}, {"shape", t.shape}, {"data_offsets", {begin, end}}};
  }
  std::string header;
  try {
    header = j.dump();
  } catch (const nlohmann::json::exception& e) {
    throw Error(path + ": a name or a text in it is not UTF-8: " + e.what());
  }
  header.resize((header.size() + 7) / 8 * 8, ' ');
  const std::uint64_t length = header.size();
  write_beside(path, [&](const std::string& partial) {
    std::ofstream file(partial, std::ios::binary);
    file.write(reinterpret_cast<const char*>(&length), 8) << header;
    const auto write = [&]<class X>(const std::vector<X>& numbers) {
      file.write(reinterpret_cast<const char*>(numbers.data()), std::streamsize(numbers.size() * sizeof(X)));
    };
    for (const auto& [name, t] : named.tensors) {
      if (const NumberType type = type_of(name); type == NumberType::u8) {
        write(std::vector<std::uint8_t>(t.values.begin(), t.values.end()));
      } else if (type == NumberType::f16) {
        std::vector<std::uint16_t> halves(t.size());
        for (std::size_t i = 0; i < t.size(); ++i) halves[i] = detail::to_half(t.values[i]);
        write(halves);
      } else {
        write(t.values);
      }
    }
    if (!file.flush()) throw Error(path + ": cannot be written: " + std::strerror(errno));
  });
}

}  // namespace burnish
