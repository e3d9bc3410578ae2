# SPDX-License-Identifier: BSD-3-Clause
# Compiler and layout settings shared by every target.
include(GNUInstallDirs)

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)

# ccache keeps precompiled headers only if told not to mind their definitions and times.
find_program(DYSLAM_CCACHE ccache)
if(DYSLAM_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${DYSLAM_CCACHE})
endif()

# What is packaged or installed runs on every x86-64: no CPU extension unless asked for. `probe`, which
# the presets use, takes AVX2 and FMA where the building machine has them.
set(DYSLAM_CPU baseline CACHE STRING "Instruction set: baseline, x86-64-v3, or probe (v3 where this machine has it)")
set_property(CACHE DYSLAM_CPU PROPERTY STRINGS baseline x86-64-v3 probe)
set(DYSLAM_INSTRUCTIONS ${DYSLAM_CPU})
if(DYSLAM_CPU STREQUAL "probe")
  include(CheckCXXSourceRuns)
  check_cxx_source_runs("int main(){return __builtin_cpu_supports(\"avx2\") && __builtin_cpu_supports(\"fma\") && __builtin_cpu_supports(\"bmi2\") ? 0 : 1;}" DYSLAM_HOST_IS_X86_64_V3)
  if(DYSLAM_HOST_IS_X86_64_V3)
    set(DYSLAM_INSTRUCTIONS x86-64-v3)
  else()
    set(DYSLAM_INSTRUCTIONS baseline)
  endif()
elseif(NOT DYSLAM_CPU MATCHES "^(baseline|x86-64-v3)$")
  message(FATAL_ERROR "DYSLAM_CPU is '${DYSLAM_CPU}': use baseline, x86-64-v3 or probe")
endif()
if(DYSLAM_INSTRUCTIONS STREQUAL "x86-64-v3")
  add_compile_options(-march=x86-64-v3)
endif()

# Eigen's memory layout is that of the packaged libraries (PCL, MRPT), built for plain x86-64. dyslam::base
# passes it on: a user built with AVX must see the same sizes of the types as the library.
set(DYSLAM_LAYOUT_DEFINITIONS EIGEN_MAX_ALIGN_BYTES=16)

if(DYSLAM_SANITIZE STREQUAL "ON")
  set(DYSLAM_SANITIZE address,undefined,float-cast-overflow)  # the last is no part of undefined
endif()
if(DYSLAM_FUZZ)
  # Counters in all code for libFuzzer; only the fuzzers have its main().
  add_compile_options(-fsanitize=fuzzer-no-link -fno-sanitize-recover=all)
  add_link_options(-fsanitize=fuzzer-no-link)
endif()
if(DYSLAM_SANITIZE)
  add_compile_options(-fsanitize=${DYSLAM_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${DYSLAM_SANITIZE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND DYSLAM_SANITIZE MATCHES "undefined")
    # They double the time to compile, and the address sanitizer finds most of what they would.
    add_compile_options(-fno-sanitize=alignment,null,object-size,pointer-overflow,vptr)
  endif()
endif()
message(STATUS "DySLAM ${PROJECT_VERSION}: ${CMAKE_BUILD_TYPE}, ${DYSLAM_INSTRUCTIONS}")
