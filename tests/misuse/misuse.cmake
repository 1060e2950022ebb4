# tests/misuse/misuse.cmake -- a program that is wrong is refused by the compiler, with a message that names the mend
# SPDX-License-Identifier: Apache-2.0
#
# Each program says on lines of its own what the compiler's message must contain:   // expect: text
# or that it must compile, so that the others fail for the reason they name:        // compiles
cmake_minimum_required(VERSION 3.22)
file(STRINGS ${program} lines REGEX "^// (expect: |compiles)")
list(TRANSFORM lines REPLACE "^// expect: " "")
if(NOT lines)
  message(FATAL_ERROR "${program}: no line '// expect: text'")
endif()
execute_process(COMMAND ${compiler} -std=c++20 -fsyntax-only -I${include} ${program}
  RESULT_VARIABLE result ERROR_VARIABLE error)
if("// compiles" IN_LIST lines)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${program} must compile:\n${error}")
  endif()
  return()
endif()
if(result EQUAL 0)
  message(FATAL_ERROR "${program} compiles, and must not")
endif()
foreach(text IN LISTS lines)
  string(FIND "${error}" "${text}" found)
  if(found EQUAL -1)
    message(SEND_ERROR "${program}: the compiler's message lacks '${text}':\n${error}")
  endif()
endforeach()
