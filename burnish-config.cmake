# burnish-config.cmake -- what find_package(burnish) and find_package(burnish COMPONENTS raycast io vision) read
# SPDX-License-Identifier: Apache-2.0
#
# burnish::burnish  the headers; nothing besides threads
# raycast           burnish::raycast, with Embree 4 or 3: burnish/scene/raycast.h
# io                burnish::io, with OpenImageIO, Assimp, nlohmann_json and minizip: burnish/io/
# vision            burnish::vision, with OpenCV's core, imgproc and dnn: burnish/twin/segment.h, burnish/io/network.h
#
# A component whose packages are missing has no target, and burnish_<component>_NOT_FOUND_MESSAGE says what it wants.
# The library's own CMakeLists.txt reads this file too, so what a component is made of is said only here.

cmake_policy(VERSION 3.22)
include(CMakeFindDependencyMacro)
find_dependency(Threads)
if(NOT TARGET burnish::burnish)
  include("${CMAKE_CURRENT_LIST_DIR}/burnish-targets.cmake")
endif()

if("raycast" IN_LIST burnish_FIND_COMPONENTS AND NOT TARGET burnish::raycast)
  find_package(embree 4 CONFIG QUIET)
  if(NOT embree_FOUND)
    find_package(embree 3 CONFIG QUIET)
  endif()
  if(embree_FOUND)
    add_library(burnish::raycast INTERFACE IMPORTED)
    set_property(TARGET burnish::raycast PROPERTY INTERFACE_LINK_LIBRARIES burnish::burnish embree)
  else()
    set(burnish_raycast_NOT_FOUND_MESSAGE "burnish::raycast wants Embree 4 or 3 (Debian, Ubuntu: libembree-dev)")
  endif()
endif()

if("io" IN_LIST burnish_FIND_COMPONENTS AND NOT TARGET burnish::io)
  find_package(OpenImageIO 2.4 CONFIG QUIET)
  find_package(assimp CONFIG QUIET)
  find_package(nlohmann_json CONFIG QUIET)
  find_path(burnish_MINIZIP_INCLUDE_DIR minizip/unzip.h)
  find_library(burnish_MINIZIP_LIBRARY minizip)
  mark_as_advanced(burnish_MINIZIP_INCLUDE_DIR burnish_MINIZIP_LIBRARY)
  if(OpenImageIO_FOUND AND assimp_FOUND AND nlohmann_json_FOUND AND burnish_MINIZIP_INCLUDE_DIR
      AND burnish_MINIZIP_LIBRARY)
    # Debian and Ubuntu's OpenImageIO names the folder of OpenCV's headers, needs none and does not install it.
    get_target_property(burnish_dirs OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
    foreach(burnish_dir IN LISTS burnish_dirs)
      if(IS_ABSOLUTE "${burnish_dir}" AND NOT EXISTS "${burnish_dir}")
        list(REMOVE_ITEM burnish_dirs "${burnish_dir}")
      endif()
    endforeach()
    set_property(TARGET OpenImageIO::OpenImageIO PROPERTY INTERFACE_INCLUDE_DIRECTORIES "${burnish_dirs}")
    unset(burnish_dirs)
    add_library(burnish::io INTERFACE IMPORTED)
    set_property(TARGET burnish::io PROPERTY INTERFACE_LINK_LIBRARIES
      burnish::burnish OpenImageIO::OpenImageIO assimp::assimp nlohmann_json::nlohmann_json
      ${burnish_MINIZIP_LIBRARY})
    set_property(TARGET burnish::io PROPERTY INTERFACE_INCLUDE_DIRECTORIES ${burnish_MINIZIP_INCLUDE_DIR})
  else()
    set(burnish_io_NOT_FOUND_MESSAGE "burnish::io wants OpenImageIO, Assimp, nlohmann_json and minizip (Debian, \
Ubuntu: libopenimageio-dev openimageio-tools libassimp-dev zlib1g-dev nlohmann-json3-dev libminizip-dev)")
  endif()
endif()

if("vision" IN_LIST burnish_FIND_COMPONENTS AND NOT TARGET burnish::vision)
  # By its files: the package file of Debian and Ubuntu comes only with all that OpenCV has, windows and film included.
  find_path(burnish_OPENCV_INCLUDE_DIR opencv2/dnn.hpp PATH_SUFFIXES opencv4)
  set(burnish_opencv "")
  foreach(burnish_module IN ITEMS dnn imgproc core)
    find_library(burnish_OPENCV_${burnish_module} opencv_${burnish_module})
    mark_as_advanced(burnish_OPENCV_${burnish_module})
    list(APPEND burnish_opencv ${burnish_OPENCV_${burnish_module}})
  endforeach()
  mark_as_advanced(burnish_OPENCV_INCLUDE_DIR)
  if(burnish_OPENCV_INCLUDE_DIR AND NOT burnish_opencv MATCHES "NOTFOUND")
    add_library(burnish::vision INTERFACE IMPORTED)
    set_property(TARGET burnish::vision PROPERTY INTERFACE_LINK_LIBRARIES burnish::burnish ${burnish_opencv})
    set_property(TARGET burnish::vision PROPERTY INTERFACE_INCLUDE_DIRECTORIES ${burnish_OPENCV_INCLUDE_DIR})
  else()
    set(burnish_vision_NOT_FOUND_MESSAGE "burnish::vision wants OpenCV 4 with core, imgproc and dnn (Debian, Ubuntu: \
libopencv-core-dev libopencv-imgproc-dev libopencv-dnn-dev)")
  endif()
  unset(burnish_opencv)
endif()

set(burnish_FOUND TRUE)
foreach(burnish_component IN LISTS burnish_FIND_COMPONENTS)
  set(burnish_${burnish_component}_FOUND FALSE)
  if(TARGET burnish::${burnish_component})
    set(burnish_${burnish_component}_FOUND TRUE)
  elseif(burnish_FIND_REQUIRED_${burnish_component})
    set(burnish_FOUND FALSE)
    set(burnish_NOT_FOUND_MESSAGE "${burnish_${burnish_component}_NOT_FOUND_MESSAGE}")
    if(NOT burnish_NOT_FOUND_MESSAGE)
      set(burnish_NOT_FOUND_MESSAGE "burnish has no component ${burnish_component}: raycast, io and vision are those it has")
    endif()
  endif()
endforeach()
unset(burnish_component)
