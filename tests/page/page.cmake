# tests/page/page.cmake -- tests/README.md, made from what the tests recorded, or compared with it
# SPDX-License-Identifier: Apache-2.0
#
# cmake -D page=<tests/README.md> -D record=<folder> -D programs=test_ad,test_math,... -D partial=test_io,...
#   -D machine=<text> [-D check=ON] -P page.cmake
#
# programs: those of this build; partial: those that lack a file, as its packages are missing. check: the page has the
# rows that were recorded, each with its tolerance; figures and numbers of points differ from machine to machine.
cmake_minimum_required(VERSION 3.22)
string(REPLACE "," ";" programs "${programs}")
string(REPLACE "," ";" partial "${partial}")
set(order ad math nodes scene shade light fit io)

# The rows of a program as a list, `;` and `[ ]` within them coded: those mean something in lists.
function(read_lines file pattern result)
  file(READ ${file} text)
  string(REPLACE "&" "&a" text "${text}")
  string(REPLACE ";" "&s" text "${text}")
  string(REPLACE "[" "&o" text "${text}")
  string(REPLACE "]" "&c" text "${text}")
  string(REPLACE "\\" "&b" text "${text}")
  string(REPLACE "\n" ";" lines "${text}")
  if(pattern)
    list(FILTER lines INCLUDE REGEX "${pattern}")
  endif()
  set(${result} "${lines}" PARENT_SCOPE)
endfunction()
function(decode text result)
  string(REPLACE "&b" "\\" text "${text}")
  string(REPLACE "&c" "]" text "${text}")
  string(REPLACE "&o" "[" text "${text}")
  string(REPLACE "&s" ";" text "${text}")
  string(REPLACE "&a" "&" text "${text}")
  set(${result} "${text}" PARENT_SCOPE)
endfunction()

set(floors "")
foreach(program IN LISTS programs)
  string(REGEX REPLACE "^test_" "" floor ${program})
  if(NOT EXISTS ${record}/${program}.tsv)
    continue()  # it claims nothing; that it ran is another test's business
  endif()
  list(APPEND floors ${floor})
  read_lines(${record}/${program}.tsv "\t" lines)
  set(rows_${floor} "")
  foreach(line IN LISTS lines)
    string(REPLACE "|" "&b|" line "${line}")
    string(REPLACE "\t" " | " line "${line}")
    list(APPEND rows_${floor} "| ${line} |")
  endforeach()
endforeach()

if(check)
  set(mend "To write the page anew: cmake --build --preset release --target tests_readme")
  if(NOT EXISTS ${page})
    message(FATAL_ERROR "there is no ${page}. ${mend}")
  endif()
  read_lines(${page} "" lines)
  set(floor "")
  set(left_out "")
  foreach(line IN LISTS lines)
    if(line MATCHES "^## (.*)/$")
      set(floor ${CMAKE_MATCH_1})
    elseif(floor AND line MATCHES "^\\| " AND NOT line MATCHES "^\\| (what \\||---)")
      list(APPEND page_${floor} "${line}")
      list(APPEND pages ${floor})
    endif()
  endforeach()
  set(both ${floors} ${pages})
  list(REMOVE_DUPLICATES both)
  # What a row claims: all but figure and points.
  foreach(floor IN LISTS both)
    foreach(kind IN ITEMS rows page)
      string(REGEX REPLACE " \\| [^|;]* \\| [^|;]* \\|(;|$)" "\\1" claims_${kind} "${${kind}_${floor}}")
    endforeach()
    foreach(claim IN LISTS claims_rows)
      if(NOT claim IN_LIST claims_page)
        decode("${claim}" claim)
        message(SEND_ERROR "tests/README.md lacks what ${floor}/ recorded: ${claim}\n${mend}")
      endif()
    endforeach()
    if(NOT "test_${floor}" IN_LIST programs OR "test_${floor}" IN_LIST partial)
      continue()  # rows of files that this build has not
    endif()
    foreach(claim IN LISTS claims_page)
      if(NOT claim IN_LIST claims_rows)
        decode("${claim}" claim)
        message(SEND_ERROR "tests/README.md names what ${floor}/ no longer records: ${claim}\n${mend}")
      endif()
    endforeach()
  endforeach()
  return()
endif()

if(partial)
  message(WARNING "the page will lack rows of ${partial}: packages are missing in this build")
endif()
set(text "# What the tests checked

Written by the tests themselves; to write it anew: `cmake --build --preset release --target tests_readme`. A test fails
when this page names other claims or tolerances than the tests make.

Every row is a claim that a test made and that held: `figure` is the worst that was found over that many `points`, and
it was at most `tolerance`. Of rows of the kind `gradient` the figure is the largest error of a slope, as a part of
the slope, against differences in double, at random points off the function's edges; the same lines of the tests hold
float, double, both packets, Var, Dual and the replayed recording to one value. Of the kind `hard places` it is the
number of places at which a value or slope is no number (NaN, infinite), in float, double or any player, or a slope is
that of neither side. Where a function has an edge, and what slope is given there, stands at the function in its
header; the tests name the edges that their random points keep off.

    ./tests/run.sh             # everything, 1,000 random points a function
    ./tests/run.sh --thorough  # the same with 10,000

Every public differentiable function of `ad/`, `math/`, `nodes/`, `shade/`, `light/` and every loss has its `gradient`
row: `register/register.cmake` reads the headers and fails for one that has none.

The figures below: ${machine}.
")
foreach(floor IN LISTS floors)
  if(NOT floor IN_LIST order)
    list(APPEND order ${floor})
  endif()
endforeach()
foreach(floor IN LISTS order)
  if(NOT floor IN_LIST floors)
    continue()
  endif()
  string(APPEND text "\n## ${floor}/\n\n| what | kind | against | tolerance | figure | points |\n"
    "| --- | --- | --- | --- | --- | --- |\n")
  foreach(row IN LISTS rows_${floor})
    decode("${row}" row)
    string(APPEND text "${row}\n")
  endforeach()
endforeach()
file(WRITE ${page} "${text}")
message(STATUS "written: ${page}")
