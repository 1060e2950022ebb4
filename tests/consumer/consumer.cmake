# tests/consumer/consumer.cmake -- a project of someone else's finds burnish: installed, or as a folder of its own tree
# SPDX-License-Identifier: Apache-2.0
cmake_minimum_required(VERSION 3.22)
file(REMOVE_RECURSE ${work})
if(way STREQUAL "installed")
  execute_process(COMMAND ${CMAKE_COMMAND} --install ${build} --prefix ${work}/prefix OUTPUT_QUIET
    COMMAND_ERROR_IS_FATAL ANY)
  set(where -D CMAKE_PREFIX_PATH=${work}/prefix)
else()
  set(where -D burnish_source=${source})
endif()
file(REAL_PATH ${CMAKE_CURRENT_LIST_DIR} consumer)
execute_process(COMMAND ${CMAKE_COMMAND} -S ${consumer} -B ${work}/build -G ${generator} ${where}
  -D CMAKE_CXX_COMPILER=${compiler} -D "components=${components}" COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${work}/build COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${work}/build/consumer COMMAND_ERROR_IS_FATAL ANY)
