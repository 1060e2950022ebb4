// tests/io/tensors.cpp -- NPY, NPZ and safetensors: files of NumPy and of the safetensors package, and damaged ones
// SPDX-License-Identifier: Apache-2.0
#include <random>
#include <burnish_test.h>
#include "files.h"
#include <burnish/io/npy.h>
#include <burnish/io/safetensors.h>

using namespace burnish;
using files::error_of;

namespace {
std::string bytes(const std::string& hex) {
  std::string out;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) out += char(std::stoi(hex.substr(i, 2), nullptr, 16));
  return out;
}
/// NumPy 2's .npy with that header and these numbers.
std::string npy(std::string header, const std::string& numbers_in_hex) {
  header.resize(117, ' ');
  return bytes("934e554d505901007600") + header + "\n" + bytes(numbers_in_hex);
}
// np.savez_compressed(file, names=np.array(['a', 'bc']), vectors=np.array([[1, 2], [3, 4]], 'f2')), NumPy 2.4
const char* const deflated =
    "504b03042d00000008000000210070476d96ffffffffffffffff090014006e616d65732e6e70790100100090000000000000004d00000000"
    "0000009bec17ea1b10c9c850c650ad9e925a9c5ca46ea5a06e136aa4aea3a09e965f54529498179f5f94920a12774bcc294e058a17672416"
    "a402f91a463a9a3a0ab50a1400ae4406084802e264200600504b03042d000000080000002100accb4748ffffffffffffffff0b0014007665"
    "63746f72732e6e70790100100088000000000000004e000000000000009bec17ea1b10c9c850c650ad9e925a9c5ca46ea5a06e9366a4aea3"
    "a09e965f54529498179f5f94920a12774bcc294e058a17672416a402f91a463a0a469a3a0ab50a64032e061b06070627061700504b01022d"
    "032d00000008000000210070476d964d000000900000000900000000000000000000008001000000006e616d65732e6e7079504b01022d03"
    "2d000000080000002100accb47484e000000880000000b0000000000000000000000800188000000766563746f72732e6e7079504b050600"
    "0000000200020070000000130100000000";
// np.savez(file, x=np.array([7], 'u1'))
const char* const stored =
    "504b03042d0000000000000021004e17c529ffffffffffffffff05001400782e6e7079010010008100000000000000810000000000000093"
    "4e554d5059010076007b276465736372273a20277c7531272c2027666f727472616e5f6f72646572273a2046616c73652c20277368617065"
    "273a2028312c292c207d20202020202020202020202020202020202020202020202020202020202020202020202020202020202020202020"
    "20202020202020202020202020200a07504b01022d032d0000000000000021004e17c5298100000081000000050000000000000000000000"
    "800100000000782e6e7079504b0506000000000100010033000000b80000000000";
/// safetensors.numpy.save of a: int64, b: float16, c: bfloat16; version 0.8
std::string safetensors() {
  return bytes("c800000000000000") +
         R"({"__metadata__":{"names":"x\ny"},"a":{"dtype":"I64","shape":[1,3],"data_offsets":[0,24]},"c":{"dtype":)"
         R"("BF16","shape":[1],"data_offsets":[24,26]},"b":{"dtype":"F16","shape":[2],"data_offsets":[26,30]}})" +
         bytes("0100000000000000020000000000000003000000000000004940003e00c0");
}
std::string safetensors(std::string header, const std::string& numbers) {
  std::uint64_t length = header.size();
  return std::string(reinterpret_cast<const char*>(&length), 8) + header + numbers;
}
using Shape = std::vector<std::size_t>;
using Values = std::vector<float>;

/// Every beginning of a file, and the file with some bytes changed: read, or one line that names it. What is read is
/// not larger than `most` numbers. spare: the last bytes that the format can do without.
template <class Read>
void survives(const files::Folder& folder, const std::string& good, std::size_t most, Read read, int spare = 0) {
  std::mt19937 random(1);
  int refused = 0;
  const auto attempt = [&](const std::string& damaged) {
    const std::string path = folder.write("damaged", damaged);
    try {
      if (read(path) > most) FAIL("read more than the file can hold");
    } catch (const Error& e) {
      const std::string text = e.what();
      ++refused;
      if (text.rfind(path + ": ", 0) != 0 || text.find('\n') != text.npos) FAIL("not one line that names it: " << text);
    }
  };
  for (std::size_t n = 0; n < good.size(); ++n) attempt(good.substr(0, n));
  CHECK(refused >= int(good.size()) - spare);
  for (int k = 0; k < 1000; ++k) {
    std::string damaged = good;
    const int changes = 1 + int(random() % 4);
    for (int c = 0; c < changes; ++c) {
      char& at = damaged[random() % damaged.size()];
      const char odd[] = {'0', '9', '[', '"', '\\', '\n', '\0', '\xff', char(at + 1), char(random())};
      at = odd[random() % sizeof odd];
    }
    attempt(damaged);
  }
}
}  // namespace

TEST_CASE("NPY: every type, order and shape that NumPy writes is read", "[io][agreement]") {
  const files::Folder folder;
  const auto read = [&](const std::string& header, const std::string& hex) {
    return read_npy(folder.write("a.npy", npy(header, hex)));
  };
  const std::string rows = "'fortran_order': False, 'shape': ";
  // np.asfortranarray(np.arange(6, dtype='<f4').reshape(2, 3) + .5)
  Tensor t = read("{'descr': '<f4', 'fortran_order': True, 'shape': (2, 3), }",
                  "0000003f000060400000c03f00009040000020400000b040");
  CHECK(t.shape == Shape{2, 3});
  CHECK(t.values == Values{0.5f, 1.5f, 2.5f, 3.5f, 4.5f, 5.5f});
  CHECK(t(1, 2) == 5.5f);
  t = read("{'descr': '>i2', " + rows + "(3,), }", "0001fffe012c");
  CHECK(t.shape == Shape{3});
  CHECK(t.values == Values{1, -2, 300});
  t = read("{'descr': '<f8', " + rows + "(), }", "9a9999999999b93f");
  CHECK(t.shape.empty());
  CHECK(t.values == Values{0.1f});
  CHECK(read("{'descr': '|b1', " + rows + "(2, 1), }", "0100").values == Values{1, 0});
  CHECK(read("{'descr': '<f2', " + rows + "(5,), }", "003c00c05535010000fc").values ==
        Values{1, -2, 0.333251953125f, std::ldexp(1.0f, -24), -HUGE_VALF});
  CHECK(read("{'descr': '|i1', " + rows + "(1,), }", "ff").values == Values{-1});
  CHECK(read("{'descr': '<u4', " + rows + "(1,), }", "00000001").values == Values{16777216});
  t = read("{'descr': '<i8', " + rows + "(0, 5), }", "");
  CHECK(t.shape == Shape{0, 5});
  CHECK(t.size() == 0);
  // Three indices in Fortran's order, against the rule of the format: the first index is the fastest.
  std::string numbers;
  for (char k = 0; k < 24; ++k) numbers += k;
  t = read_npy(
      folder.write("a.npy", npy("{'descr': '|u1', 'fortran_order': True, 'shape': (2, 3, 4), }", "") + numbers));
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 4; ++k) CHECK(t(i, j, k) == float(i + 2 * (j + 3 * k)));
}

TEST_CASE("NPY: what is wrong is said in one line", "[io][limit]") {
  const files::Folder folder;
  const auto error = [&](const std::string& content) {
    const std::string path = folder.write("a.npy", content);
    return error_of([&] { read_npy(path); }).substr(path.size());
  };
  const std::string rows = "'fortran_order': False, 'shape': (2,), }";
  CHECK(error("no numbers at all") == ": not a .npy file");
  CHECK(error(npy("{'descr': '|u1', " + rows, "61")) == ": 1 bytes of numbers, expected 1 for each of the shape [2]");
  CHECK(error(npy("{'descr': '<c8', " + rows, "6161")) == ": type 'c8', expected b1, f2, f4, f8, u1 .. i8, U or S");
  CHECK(error(npy("{'descr': '|O', " + rows, "6161")) ==
        ": a type that is not of plain numbers, expected one such as '<f4'");
  CHECK(error(npy("{'descr': [('x', '<f4')], " + rows, "")).find("not of plain numbers") != std::string::npos);
  CHECK(error(npy("{'descr': '|u1', 'shape': (2,), }", "6161")) == ": no fortran_order in its header");
  CHECK(error(npy("{'descr': '|u1', 'fortran_order': False, 'shape': (99999999999999999999, 8), }", "6161"))
            .find(": 2 bytes of numbers") == 0);
  CHECK(error(npy("{'descr': '|u1', 'fortran_order': False, 'shape': (-2,), }", "6161")) ==
        ": a shape that is no list of whole numbers");
  CHECK(error(npy("{'descr': '<i4', " + rows, "0000000001000001")) ==
        ": the integer 16777217, expected at most 2^24, which floats hold exactly");
  CHECK(error(npy("{'descr': '<U1', " + rows, "6100000062000000")) == ": an array of strings, expected numbers");
  CHECK(error_of([&] { read_npy(folder / "none.npy"); }) == (folder / "none.npy") + ": no such file");
  survives(folder, npy("{'descr': '<f4', 'fortran_order': True, 'shape': (2, 3), }", std::string(48, '3')), 24,
           [](const std::string& path) { return read_npy(path).size(); });
}

TEST_CASE("NPY: what is written comes back to the bit", "[io][agreement]") {
  const files::Folder folder;
  for (const Shape& shape : {Shape{}, Shape{3}, Shape{2, 3}, Shape{0}, Shape{1, 2, 1, 2}}) {
    Tensor t{shape, {}};
    std::size_t n = 1;
    for (const std::size_t k : shape) n *= k;
    for (std::size_t k = 0; k < n; ++k) t.values.push_back(float(k) / 3);
    write_npy(folder / "a.npy", t);
    const Tensor back = read_npy(folder / "a.npy");
    CHECK(back.shape == t.shape);
    CHECK(back.values == t.values);
  }
  // NumPy's own bytes for np.array([1, 2], 'f4'), but for the number of spaces: its header is padded to 64 bytes, too.
  write_npy(folder / "a.npy", {{2}, {1, 2}});
  CHECK(read_text(folder / "a.npy") ==
        npy("{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }", "0000803f00000040"));
  CHECK(error_of([&] {
          write_npy(folder / "b.npy", {{3}, {1, 2}});
        }) == (folder / "b.npy") + ": 2 numbers for the shape [3]");
  CHECK(folder.count() == 1);
}

TEST_CASE("NPZ: stored and deflated archives are read, strings as lines", "[io][agreement]") {
  const files::Folder folder;
  const NamedTensors a = read_npz(folder.write("a.npz", bytes(deflated)));
  REQUIRE(a.tensors.size() == 1);
  CHECK(a.tensors.at("vectors").shape == Shape{2, 2});
  CHECK(a.tensors.at("vectors").values == Values{1, 2, 3, 4});
  CHECK(a.texts == std::map<std::string, std::string>{{"names", "a\nbc\n"}});
  CHECK(read_npz(folder.write("b.npz", bytes(stored))).tensors.at("x").values == Values{7});
  CHECK(error_of([&] { read_npz(folder / "none.npz"); }) == (folder / "none.npz") + ": no such file");
  CHECK(error_of([&] { read_npz(folder.write("c.npz", "no archive")); }).find("not a zip archive") !=
        std::string::npos);
  for (const char* file : {deflated, stored})
    survives(
        folder, bytes(file), 24,
        [](const std::string& path) {
          std::size_t n = 0;
          for (const auto& [name, t] : read_npz(path).tensors) n += t.size();
          return n;
        },
        10);
}

TEST_CASE("safetensors: a file of the safetensors package is read", "[io][agreement]") {
  const files::Folder folder;
  const NamedTensors named = read_safetensors(folder.write("a", safetensors()));
  CHECK(named.texts == std::map<std::string, std::string>{{"names", "x\ny"}});
  REQUIRE(named.tensors.size() == 3);
  CHECK(named.tensors.at("a").shape == Shape{1, 3});
  CHECK(named.tensors.at("a").values == Values{1, 2, 3});
  CHECK(named.tensors.at("b").values == Values{1.5f, -2});
  CHECK(named.tensors.at("c").values == Values{3.140625f});
}

TEST_CASE("safetensors: what is written comes back to the bit, aligned as the package has it", "[io][agreement]") {
  const files::Folder folder;
  NamedTensors named;
  named.tensors["weights"] = {{2, 2}, {1.0f / 3, -0.0f, 1e-42f, 3e38f}};
  named.tensors["a \"name\""] = {{}, {4}};
  named.tensors["none"] = {{0, 7}, {}};
  named.texts["made"] =
      "by a test\nof K\xc3\xa4"
      "fer";
  write_safetensors(folder / "a", named);
  const std::string file = read_text(folder / "a");
  CHECK(static_cast<unsigned char>(file[0]) % 8 == 0);
  const NamedTensors back = read_safetensors(folder / "a");
  CHECK(back.texts == named.texts);
  REQUIRE(back.tensors.size() == 3);
  for (const auto& [name, t] : named.tensors) {
    CHECK(back.tensors.at(name).shape == t.shape);
    for (std::size_t i = 0; i < t.size(); ++i)
      CHECK(std::bit_cast<unsigned>(back.tensors.at(name).values[i]) == std::bit_cast<unsigned>(t.values[i]));
  }
  named.tensors["none"].shape = {3};
  CHECK(error_of([&] { write_safetensors(folder / "b", named); }) ==
        (folder / "b") + ": tensor none: 0 numbers for the shape [3]");
  CHECK(folder.count() == 1);
}

TEST_CASE("safetensors: what is wrong is said in one line", "[io][limit]") {
  const files::Folder folder;
  const auto error = [&](const std::string& header, const std::string& numbers = "12345678") {
    const std::string path = folder.write("a", safetensors(header, numbers));
    const std::string said = error_of([&] { read_safetensors(path); });
    return said.substr(std::min(path.size(), said.size()));
  };
  const std::string x = R"({"x":{"dtype":"F32","shape":[2],"data_offsets":[0,8]})";
  CHECK(error(x + "}").empty());
  CHECK(error(x).find(": its header is not JSON: ") == 0);
  CHECK(error("[1]") == ": its header is not an object, expected a safetensors file");
  CHECK(error(x + "}", "1234567") == ": tensor \"x\": offsets [0, 8], expected a range within 7 bytes");
  CHECK(error(x + "}", "123456789") == ": 9 bytes of numbers, expected 8");
  CHECK(error(R"({"x":{"dtype":"F32","shape":[3],"data_offsets":[0,8]}})") ==
        ": tensor \"x\": 8 bytes for the shape [3], expected as many as it needs");
  CHECK(error(R"({"x":{"dtype":"F32","shape":[4294967296,4294967296,2],"data_offsets":[0,8]}})")
            .find("expected as many") != std::string::npos);
  CHECK(
      error(R"({"x":{"dtype":"F8_E4M3","shape":[8],"data_offsets":[0,8]}})").find(R"(type "F8_E4M3", expected F32)") !=
      std::string::npos);
  CHECK(error(R"({"x":{"dtype":"F32","shape":[-2],"data_offsets":[0,8]}})").find("expected whole numbers") !=
        std::string::npos);
  CHECK(error(x + R"(,"y":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})") ==
        ": tensor \"y\" begins at 0, expected 8: tensors follow each other");
  CHECK(error(x + R"(,"__metadata__":{"a":1}})") == ": __metadata__ \"a\" is a number, expected a text");
  CHECK(error(R"({"x":{"dtype":"F32","shape":)" + std::string(100000, '[') + std::string(100000, ']') + "}}")
            .find("expected whole numbers") != std::string::npos);
  CHECK(error_of([&] { read_safetensors(folder / "none"); }) == (folder / "none") + ": no such file");
  survives(folder, safetensors(), 30, [](const std::string& path) {
    std::size_t n = 0;
    for (const auto& [name, t] : read_safetensors(path).tensors) n += t.size();
    return n;
  });
}

TEST_CASE("safetensors: bytes and halves are written narrow and read back", "[io][agreement]") {
  const files::Folder folder;
  const std::string path = folder / "t.safetensors";
  NamedTensors t;
  t.tensors["bytes"] = {{4}, {0, 1, 128, 255}};
  // 1 + 2^-11 and 1 + 3 * 2^-11 lie between two halves and go to the even one; the smallest half is 2^-24.
  t.tensors["halves"] = {{8}, {1, -2.5f, 1.00048828125f, 1.00146484375f, 5.9604645e-8f, 65504, 1e6f, 2e-8f}};
  write_safetensors(path, t, {{"bytes", detail::NumberType::u8}, {"halves", detail::NumberType::f16}});
  const NamedTensors back = read_safetensors(path);
  CHECK(back.tensors.at("bytes").values == t.tensors["bytes"].values);
  CHECK(back.tensors.at("halves").values ==
        std::vector<float>{1, -2.5f, 1, 1.001953125f, 5.9604645e-8f, 65504, std::numeric_limits<float>::infinity(), 0});
  CHECK(read_text(path).find("\"U8\"") != std::string::npos);
  CHECK(read_text(path).find("\"F16\"") != std::string::npos);
  for (unsigned h = 0; h < 0x7c00; ++h)
    REQUIRE(detail::to_half(detail::from_half(std::uint16_t(h))) == h);
}
