// burnish/scene/words.h -- the words in names of parts and files
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cctype>
#include <string>
#include <burnish/scene/mesh.h>

namespace burnish::detail {

inline std::string lower(std::string s) {
  for (char& c : s) c = char(std::tolower(static_cast<unsigned char>(c)));
  return s;
}
/// visit(word) for every run of letters, in small letters: "myCars/oldJeep_2.obj" has my, cars, old, jeep, obj. An upper
/// case letter after a lower case one begins a word.
template <class F> void each_word(const std::string& text, F visit) {
  std::string word;
  char before = ' ';
  for (const char c : text + " ") {
    const auto u = static_cast<unsigned char>(c);
    const bool letter = std::isalpha(u) != 0;
    if (!word.empty() && (!letter || (std::isupper(u) && std::islower(static_cast<unsigned char>(before))))) {
      visit(word);
      word.clear();
    }
    if (letter) word += char(std::tolower(u));
    before = c;
  }
}
/// "wheelFrontLeft", "Wheel F-L" -> "_wheel_front_left_", "_wheel_f_l_": name and material of a part, for finding
/// words.
inline std::string words_of(const Part& p) {
  std::string s = "_";
  char before = '_';
  for (char c : p.name + " " + p.material + " ") {
    const auto u = static_cast<unsigned char>(c);
    if (std::isupper(u) && std::islower(static_cast<unsigned char>(before))) s += '_';
    s += std::isalnum(u) ? char(std::tolower(u)) : '_';
    before = c;
  }
  return s;
}

}  // namespace burnish::detail
