# tests/page/can_fail.cmake -- page.cmake finds a page with rows too few, too many or other tolerances, and no other
# SPDX-License-Identifier: Apache-2.0
#
# cmake -D script=<page.cmake> -D work=<a scratch folder> -P can_fail.cmake
cmake_minimum_required(VERSION 3.22)
set(rows "glow\tgradient\tdifferences; |d| [all]\t1e-07\t2e-10\t1000\nglue\tvalue\ta table\t0.01\t0.002\t5\n")
function(run)
  execute_process(COMMAND ${CMAKE_COMMAND} -D page=${work}/README.md -D record=${work}/record "-Dmachine=a machine"
    ${ARGN} -P ${script} RESULT_VARIABLE result ERROR_VARIABLE error OUTPUT_QUIET)
  string(REGEX REPLACE "[ \n]+" " " error "${error}")
  set(result ${result} PARENT_SCOPE)
  set(error "${error}" PARENT_SCOPE)
endfunction()
# A page is written of `rows`; then others are recorded.
function(expect message recorded)
  file(REMOVE_RECURSE ${work})
  file(WRITE ${work}/record/test_shade.tsv "${rows}")
  run(-Dprograms=test_shade)
  file(WRITE ${work}/record/test_shade.tsv "${recorded}")
  run(-D check=ON ${ARGN})
  if(message STREQUAL "" AND NOT result EQUAL 0)
    message(SEND_ERROR "a right page was refused: ${error}")
  elseif(NOT message STREQUAL "" AND (result EQUAL 0 OR NOT error MATCHES "${message}"))
    message(SEND_ERROR "expected '${message}', found '${error}'")
  endif()
endfunction()

expect("" "${rows}" -Dprograms=test_shade)
string(REPLACE "2e-10\t1000" "3e-09\t10000" elsewhere "${rows}")
expect("" "${elsewhere}" -Dprograms=test_shade)
string(REPLACE "0.01" "0.02" softer "${rows}")
expect("glue .* 0.02" "${softer}" -Dprograms=test_shade)
expect("lacks what shade/ recorded: . gloom" "${rows}gloom\tgradient\tx\t1\t0\t1\n" -Dprograms=test_shade)
string(REGEX REPLACE "^[^\n]*\n" "" fewer "${rows}")
expect("no longer records: . glow . gradient . differences; " "${fewer}" -Dprograms=test_shade)
expect("target tests_readme" "${fewer}" -Dprograms=test_shade)
expect("" "${fewer}" -Dprograms=test_shade -Dpartial=test_shade)
expect("" "" -Dprograms=test_math)
