# SPDX-License-Identifier: BSD-3-Clause
# The helpers every module and app uses.

function(dyslam_set_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # With AVX, GCC 12 gives false alarms inside Eigen's templates (and PCL's, through them).
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-maybe-uninitialized -Wno-stringop-overflow)
  endif()
  if(DYSLAM_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# dyslam_add_library(NAME <module> SOURCES <src/...> [PUBLIC <targets>] [PRIVATE <targets>])
# Makes the library dyslam_<module> with the alias dyslam::<module>.
function(dyslam_add_library)
  cmake_parse_arguments(ARG "" "NAME" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
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
  install(TARGETS ${target} EXPORT dyslamTargets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endfunction()

# dyslam_add_test(NAME <module> SOURCES <tests/...> [LIBRARIES <targets>])
# One GTest program per module, run by ctest as one test.
function(dyslam_add_test)
  if(NOT DYSLAM_BUILD_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "NAME" "SOURCES;LIBRARIES" ${ARGN})
  set(target ${ARG_NAME}_tests)
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE ${ARG_LIBRARIES} GTest::gtest GTest::gtest_main)
  dyslam_set_warnings(${target})
  add_test(NAME ${ARG_NAME} COMMAND ${target})
  set_tests_properties(${ARG_NAME} PROPERTIES TIMEOUT 900
    ENVIRONMENT "DYSLAM_SOURCE_DIR=${PROJECT_SOURCE_DIR}")
endfunction()

# dyslam_add_app(NAME <app-name> LIBRARIES <targets> [SOURCES <files in apps/<app-name>>])
# Builds apps/<app-name>/main.cpp and the other sources given.
function(dyslam_add_app)
  cmake_parse_arguments(ARG "" "NAME" "LIBRARIES;SOURCES" ${ARGN})
  list(TRANSFORM ARG_SOURCES PREPEND ${ARG_NAME}/)
  add_executable(${ARG_NAME} ${ARG_NAME}/main.cpp ${ARG_SOURCES})
  target_link_libraries(${ARG_NAME} PRIVATE ${ARG_LIBRARIES})
  target_compile_definitions(${ARG_NAME} PRIVATE DYSLAM_VERSION="${PROJECT_VERSION}")
  dyslam_set_warnings(${ARG_NAME})
  install(TARGETS ${ARG_NAME} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endfunction()

# dyslam_add_benchmark(NAME <name> SOURCES <...> LIBRARIES <targets>): never part of the tests.
function(dyslam_add_benchmark)
  if(NOT DYSLAM_BUILD_BENCHMARKS OR NOT benchmark_FOUND)
    return()
  endif()
  cmake_parse_arguments(ARG "" "NAME" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${ARG_NAME} ${ARG_SOURCES})
  target_link_libraries(${ARG_NAME} PRIVATE ${ARG_LIBRARIES} benchmark::benchmark)
  dyslam_set_warnings(${ARG_NAME})
endfunction()
