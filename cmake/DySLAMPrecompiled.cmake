# SPDX-License-Identifier: BSD-3-Clause
# Headers from outside that are read once instead of in every file: of a file that uses libtorch, half of
# the time to compile. The headers of DySLAM itself are in none of them.
option(DYSLAM_PRECOMPILED_HEADERS "Read Eigen, libtorch, CLI11 and GTest once" ON)

set(dyslam_headers_core
  <algorithm> <array> <cmath> <filesystem> <fstream> <functional> <map> <memory> <optional> <random> <sstream>
  <string> <vector> <Eigen/Dense>)
set(dyslam_headers_tests ${dyslam_headers_core} <gtest/gtest.h>)
set(dyslam_headers_torch ${dyslam_headers_core} <torch/torch.h>)
set(dyslam_headers_apps ${dyslam_headers_core} <CLI/CLI.hpp> <nlohmann/json.hpp>)

# Options and messages of the programs, and tests, spend their time in the libraries: compiling them with few
# optimisations takes 0.5 to 0.8 of the time.
set(dyslam_quick_options "")
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  set(dyslam_quick_options -O1)
endif()

# dyslam_use_headers(<target> <core|tests|torch|apps> [QUICK])
# QUICK: compiled with dyslam_quick_options. A program compiles like the libraries (-fPIC), so that they may
# share what was read.
function(dyslam_use_headers target kind)
  cmake_parse_arguments(ARG "QUICK" "" "" ${ARGN})
  set(holder dyslam_headers_${kind})
  if(ARG_QUICK AND dyslam_quick_options)
    target_compile_options(${target} PRIVATE ${dyslam_quick_options})
    string(APPEND holder _quick)  # GCC compiles what was read with the optimisations that it was read with
  endif()
  if(NOT DYSLAM_PRECOMPILED_HEADERS)
    return()
  endif()
  if(NOT TARGET ${holder})
    file(WRITE ${CMAKE_BINARY_DIR}/headers/empty.cpp "")
    add_library(${holder} OBJECT EXCLUDE_FROM_ALL ${CMAKE_BINARY_DIR}/headers/empty.cpp)
    target_compile_definitions(${holder} PRIVATE ${DYSLAM_LAYOUT_DEFINITIONS})
    set(libraries_core Eigen3::Eigen)
    set(libraries_tests Eigen3::Eigen GTest::gtest)
    set(libraries_torch Eigen3::Eigen ${TORCH_LIBRARIES})
    set(libraries_apps Eigen3::Eigen CLI11::CLI11 nlohmann_json::nlohmann_json)
    target_link_libraries(${holder} PRIVATE ${libraries_${kind}})
    if(ARG_QUICK)
      target_compile_options(${holder} PRIVATE ${dyslam_quick_options})
    endif()
    dyslam_set_warnings(${holder})  # -Wpedantic defines a macro less
    target_precompile_headers(${holder} PRIVATE ${dyslam_headers_${kind}})
  endif()
  get_target_property(type ${target} TYPE)
  if(type STREQUAL "EXECUTABLE")
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(${target} PRIVATE -fPIC)
  endif()
  target_precompile_headers(${target} REUSE_FROM ${holder})
endfunction()
