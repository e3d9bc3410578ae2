# SPDX-License-Identifier: BSD-3-Clause
# Common parts of both networks.
dyslam_add_library(NAME nets_common HEADERS torch
  SOURCES
    src/Devices.cpp
    src/PointLinear.cpp
    src/TensorFile.cpp
    src/Threads.cpp
  PUBLIC dyslam::core
  PRIVATE ${TORCH_LIBRARIES} ${OpenMP_CXX_LIBRARIES} $<BUILD_INTERFACE:nlohmann_json::nlohmann_json>
  INTERNAL_HEADERS ${torch_headers})
# Only this file is compiled with OpenMP: elsewhere Eigen would start threads of its own.
separate_arguments(openmp_flags NATIVE_COMMAND "${OpenMP_CXX_FLAGS}")
set_source_files_properties(src/Threads.cpp PROPERTIES COMPILE_OPTIONS "${openmp_flags}")

# DySeg's network, a separate library because the DySeg stage needs no other network.
dyslam_add_library(NAME nets_dyseg HEADERS torch
  SOURCES
    src/BevOps.cpp
    src/BevScan.cpp
    src/CellLayers.cpp
    src/CellPyramid.cpp
    src/DysegFile.cpp
    src/DysegModel.cpp
    src/DysegNet.cpp
    src/FlowUpdate.cpp
    src/MotionSearch.cpp
    src/OccupiedProducts.cpp
    src/RigidFlow.cpp
    src/StaticMotionMatcher.cpp
  PUBLIC dyslam::core dyslam::nets_common
  PRIVATE ${TORCH_LIBRARIES}
  INTERNAL_HEADERS ${torch_headers})

dyslam_add_test(NAME nets_dyseg HEADERS torch
  SOURCES
    tests/BevOps_unittest.cpp
    tests/BevScan_unittest.cpp
    tests/CellLayers_unittest.cpp
    tests/DysegNet_unittest.cpp
    tests/FlowUpdate_unittest.cpp
    tests/MotionSearch_unittest.cpp
    tests/RigidFlow_unittest.cpp
    tests/TensorFile_unittest.cpp
  LIBRARIES dyslam::nets_dyseg ${TORCH_LIBRARIES})
if(TARGET nets_dyseg_tests)
  target_include_directories(nets_dyseg_tests PRIVATE src)
endif()

if(DYSLAM_BUILD_BENCHMARKS)
  add_executable(dyseg_benchmark benchmarks/dyseg_benchmark.cpp)
  target_link_libraries(dyseg_benchmark PRIVATE dyslam::nets_dyseg dyslam::formats)
  dyslam_set_warnings(dyseg_benchmark)
endif()
