# tests/register/register.cmake -- the tests of this run checked a gradient of every public differentiable function
# SPDX-License-Identifier: Apache-2.0
#
# cmake -D include=<the folder above burnish/> -D record=<the folder of the programs' records> [-D scratch=ON]
#   -P register.cmake
# scratch: the headers are not all of the library's, so exemptions may be left over.
#
# The headers are read as text: what counts is a template over a number T at the level of namespace burnish (a
# function, a struct), an operation, a loss, and what the macros BURNISH_PLAIN and BURNISH_BLEND make. Its name must
# stand in the first column of a row of kind `gradient`.
cmake_minimum_required(VERSION 3.22)

set(floors ad math nodes shade light)
# What is no differentiable function of its own, and why.
set(exempt
  apply                           # the door to the operations, each of which has a row
  repeat List                     # a loop and what it runs over, without numbers of its own; tests/fit has all players
  rebind Resource Dual            # around numbers: what a struct becomes in another, data, a number itself
  whole to_int to_real gather     # between numbers and integers
  LightIrradiance SunVisibility   # of a surfel's index only, which has no slopes
)

set(records "")
file(GLOB files ${record}/*.tsv)
if(NOT files)
  message(FATAL_ERROR "no record in ${record}: run the floors' tests first (ctest does)")
endif()
foreach(file IN LISTS files)
  file(STRINGS ${file} lines REGEX "^[^\t]*\tgradient\t")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "\t.*" "" names "${line}")
    string(REPLACE ", " ";" names "${names}")
    list(APPEND records ${names})
  endforeach()
endforeach()

# Number of characters `which` in text.
function(count text which result)
  string(REGEX REPLACE "[^${which}]" "" text "${text}")
  string(LENGTH "${text}" length)
  set(${result} ${length} PARENT_SCOPE)
endfunction()
set(found "")
function(wanted name header)
  list(APPEND found ${name})
  set(found ${found} PARENT_SCOPE)
  if(NOT name IN_LIST records AND NOT name IN_LIST exempt)
    string(REGEX REPLACE "/.*" "" floor ${header})
    message(SEND_ERROR "${header}: no gradient of '${name}' was checked. Add a line to tests/${floor}/: "
      "differences::holds(\"${name}\", ...), see tests/differences.h. (If it has no slopes by its nature, name it and "
      "the reason in tests/register/register.cmake.)")
  endif()
endfunction()

set(headers "")
foreach(floor IN LISTS floors)
  file(GLOB more RELATIVE ${include}/burnish ${include}/burnish/${floor}/*.h)
  list(APPEND headers ${more})
endforeach()
if(EXISTS ${include}/burnish/fit/loss.h)
  list(APPEND headers fit/loss.h)
endif()
foreach(header IN LISTS headers)
  file(READ ${include}/burnish/${header} text)
  string(REGEX REPLACE "//[^\n]*" "" text "${text}")
  # What macros make is named where they are used.
  string(REGEX REPLACE "#define[^\n]*(\\\\\n[^\n]*)*" "" text "${text}")
  string(REGEX REPLACE "std::size_t\\([^()]*(\\([^()]*\\))?\\)" "" text "${text}")
  string(REPLACE ";" "," text "${text}")  # lists of CMake
  string(REPLACE "[" "(" text "${text}")
  string(REPLACE "]" ")" text "${text}")
  string(REGEX REPLACE "\\\\" "" text "${text}")
  # A template is on one line with its name.
  string(REGEX REPLACE ">[ \n]+(constexpr|struct|inline)" "> \\1" text "${text}")
  string(REGEX REPLACE "(constexpr|inline)([^\n(){},]*)\n *" "\\1\\2 " text "${text}")
  string(REPLACE "\n" ";" lines "${text}")
  set(depth 0)
  set(hidden -1)  # the depth outside of namespace detail, while inside
  set(op -1)
  set(last "")
  foreach(line IN LISTS lines)
    set(top FALSE)
    set(prefix "")
    if(hidden EQUAL -1)
      if(line MATCHES "^namespace detail")
        set(hidden ${depth})
      elseif(line MATCHES "^namespace op")
        set(op ${depth})
      elseif(depth EQUAL 1)
        set(top TRUE)
      endif()
      if(NOT op EQUAL -1)
        set(prefix "op::")
      endif()
      if(line MATCHES "^ *(template <[^>]*> )?struct ([A-Za-z0-9]+)")
        set(last ${prefix}${CMAKE_MATCH_2})
      endif()
      if(line MATCHES "^struct [A-Za-z0-9]+ : Operation<" OR line MATCHES "^  static constexpr int inputs = [A-Z0-9]")
        if(NOT line MATCHES "inputs = N,")  # Operation itself
          wanted(${last} ${header})
        endif()
      endif()
      if(header STREQUAL "fit/loss.h" AND line MATCHES "^inline double ([a-z_0-9]+)\\(.*weight")
        wanted(${CMAKE_MATCH_1} ${header})
      endif()
      if(line MATCHES "^BURNISH_(PLAIN|BLEND)\\(([A-Za-z0-9]+)")
        wanted(${CMAKE_MATCH_2} ${header})
      elseif(top AND line MATCHES "^template <.*(class|Number|Plain) T[,> ]")
        if(line MATCHES "> struct ([A-Za-z0-9]+)")
          wanted(${CMAKE_MATCH_1} ${header})
        elseif(line MATCHES "> (\\(\\(.*\\)\\) )?(inline |constexpr )*[A-Za-z0-9_:<>, ]+[ &]([a-z][a-z0-9_]*)\\(")
          wanted(${CMAKE_MATCH_3} ${header})
        endif()
      endif()
    endif()
    count("${line}" "{" opened)
    count("${line}" "}" closed)
    math(EXPR depth "${depth} + ${opened} - ${closed}")
    if(depth EQUAL hidden)
      set(hidden -1)
    endif()
    if(depth EQUAL op)
      set(op -1)
    endif()
  endforeach()
  if(NOT depth EQUAL 0)
    message(SEND_ERROR "${header}: braces do not pair; register.cmake lost its way")
  endif()
endforeach()
foreach(name IN LISTS exempt)
  if(NOT name IN_LIST found AND NOT scratch)
    message(SEND_ERROR "register.cmake exempts '${name}', which no header has")
  endif()
endforeach()
list(LENGTH found number)
message(STATUS "${number} names found in the headers")
