# SPDX-License-Identifier: BSD-3-Clause
# The helpers every module and app uses.

function(dyslam_set_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wconversion)
  if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Of files compiled as one, each may use the names that another has for itself.
    target_compile_options(${target} PRIVATE -Wshadow=local -Wno-subobject-linkage)
  else()
    target_compile_options(${target} PRIVATE -Wshadow)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # With AVX, GCC 12 gives false alarms inside Eigen's templates (and PCL's, through them).
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-maybe-uninitialized -Wno-stringop-overflow)
  endif()
  if(DYSLAM_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

function(dyslam_use_headers_or target kind default)
  if(kind)
    dyslam_use_headers(${target} ${kind} ${ARGN})
  else()
    dyslam_use_headers(${target} ${default} ${ARGN})
  endif()
endfunction()

# dyslam_add_library(NAME <module> SOURCES <src/...> [PUBLIC <targets>] [PRIVATE <targets>]
#   [INTERNAL_HEADERS <names>] [INTERNAL] [QUICK] [HEADERS <kind>])
# Makes the library dyslam_<module> with the alias dyslam::<module>, and installs it with its headers.
# INTERNAL_HEADERS (those that include torch) are not installed; of an INTERNAL library nothing is.
# HEADERS: what is read once for all its files (DySLAMPrecompiled.cmake), `core` by default. QUICK: compiled as
# programs are, because its time is spent in other libraries.
function(dyslam_add_library)
  cmake_parse_arguments(ARG "INTERNAL;QUICK" "NAME;HEADERS" "SOURCES;PUBLIC;PRIVATE;INTERNAL_HEADERS" ${ARGN})
  set(target dyslam_${ARG_NAME})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(dyslam::${ARG_NAME} ALIAS ${target})
  target_include_directories(${target}
    PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
  target_compile_features(${target} PUBLIC cxx_std_17)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${ARG_NAME})
  dyslam_set_warnings(${target})
  if(ARG_QUICK)
    dyslam_use_headers_or(${target} "${ARG_HEADERS}" core QUICK)
  else()
    dyslam_use_headers_or(${target} "${ARG_HEADERS}" core)
  endif()
  if(ARG_INTERNAL)
    return()
  endif()
  set_property(GLOBAL APPEND PROPERTY DYSLAM_INSTALLED ${ARG_NAME})
  install(TARGETS ${target} EXPORT dyslamTargets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  set(left_out)
  foreach(header IN LISTS ARG_INTERNAL_HEADERS)
    list(APPEND left_out PATTERN ${header} EXCLUDE)
  endforeach()
  install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development ${left_out})
endfunction()

# The module `networks` is built with a target that may load it while it runs.
function(dyslam_may_load_networks target networks)
  if(networks AND DYSLAM_HAVE_TORCH)
    add_dependencies(${target} dyslam_networks)
    target_compile_definitions(${target} PRIVATE DYSLAM_HAVE_TORCH)
  endif()
endfunction()

# The module `ros2` is built with a target that may load it while it runs.
function(dyslam_may_load_ros2 target)
  if(DYSLAM_HAVE_FASTDDS)
    add_dependencies(${target} dyslam_ros2_module)
  endif()
endfunction()

# dyslam_add_app(NAME <app-name> LIBRARIES <targets> [SOURCES <files in apps/<app-name>>] [NETWORKS])
# Builds apps/<app-name>/main.cpp and the other sources given, with apps/common's dyslam_appcommon. NETWORKS:
# it may ask for a network.
function(dyslam_add_app)
  cmake_parse_arguments(ARG "NETWORKS" "NAME;HEADERS" "LIBRARIES;SOURCES" ${ARGN})
  list(TRANSFORM ARG_SOURCES PREPEND ${ARG_NAME}/)
  add_executable(${ARG_NAME} ${ARG_NAME}/main.cpp ${ARG_SOURCES})
  target_link_libraries(${ARG_NAME} PRIVATE dyslam_appcommon ${ARG_LIBRARIES})
  dyslam_set_warnings(${ARG_NAME})
  dyslam_use_headers_or(${ARG_NAME} "${ARG_HEADERS}" apps QUICK)
  dyslam_may_load_networks(${ARG_NAME} ${ARG_NETWORKS})
  set_property(GLOBAL APPEND PROPERTY DYSLAM_APPS ${ARG_NAME})
  install(TARGETS ${ARG_NAME} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
endfunction()
