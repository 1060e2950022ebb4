# tests/register/can_fail.cmake -- register.cmake finds every kind of function without a check, and passes what has one
# SPDX-License-Identifier: Apache-2.0
#
# cmake -D register=<register.cmake> -D work=<a scratch folder> -P can_fail.cmake
cmake_minimum_required(VERSION 3.22)
function(expect message checked header text)
  file(REMOVE_RECURSE ${work})
  file(WRITE ${work}/burnish/${header} "// a header\nnamespace burnish {\n${text}\n}  // namespace burnish\n")
  file(WRITE ${work}/record/test_floor.tsv
    "${checked}\tgradient\tdifferences\t1e-07\t1e-10\t1000\nother\tvalue\tx\t1\t0\t1\n")
  execute_process(COMMAND ${CMAKE_COMMAND} -D include=${work} -D record=${work}/record -D scratch=ON -P ${register}
    RESULT_VARIABLE result ERROR_VARIABLE error OUTPUT_QUIET)
  string(REGEX REPLACE "[ \n]+" " " error "${error}")
  if(message STREQUAL "" AND NOT result EQUAL 0)
    message(SEND_ERROR "a checked function was refused: ${text}: ${error}")
  elseif(NOT message STREQUAL "" AND (result EQUAL 0 OR NOT error MATCHES "${message}"))
    message(SEND_ERROR "expected '${message}' of ${text}, found '${error}'")
  endif()
endfunction()

set(glow "template <class T> constexpr vec3<T> glow(const T& c) {\n  return vec3<T>(c)\;\n}")
expect("shade/a.h: no gradient of 'glow' was checked" "glue" shade/a.h "${glow}")
expect("tests/shade/: differences::holds" "other" shade/a.h "${glow}")
expect("" "glow" shade/a.h "${glow}")
expect("" "gloom, glow, glue" shade/a.h "${glow}")
expect("" "glue" shade/a.h "namespace detail {\n${glow}\n}")
expect("'glow'" "glue" shade/a.h "namespace detail {\n${glow}\n}\n${glow}")
expect("'glow'" "glue" ad/a.h "template <Number T>\nconstexpr T glow(const T& c, const same<T>& d)\;")
expect("'glow'" "glue" light/a.h
  "template <int K = 0, template <class> class Sky, class T>\nconstexpr vec3<T>\nglow(const Sky<T>& s)\;")
expect("'glow'" "glue" math/a.h
  "template <int N, class T> constexpr std::array<T, std::size_t(n(N))> glow(const T& d)\;")
expect("'Glow'" "glue" nodes/a.h
  "template <class T> struct Glow {\n  T operator()(const T& c) const { return c\; }\n}\;")
expect("'Glow'" "glue" nodes/a.h "BURNISH_BLEND(Glow, return fg\;)")
expect("'op::Glow'" "glue" ad/a.h "namespace op {\nstruct Glow : Operation<1> {\n}\;\n}")
expect("'op::Glow'" "glue" nodes/a.h
  "namespace op {\ntemplate <int N> struct Glow {\n  static constexpr int inputs = 2\;\n}\;\n}")
expect("tests/fit/: " "glue" fit/loss.h "inline double glow(const Image& image, double weight, Image& d_image) {\n}")
expect("'glow'" "" shade/a.h "${glow}")
expect("braces do not pair" "glow" shade/a.h "${glow}\n{")
expect("" "glue" scene/a.h "${glow}")
