# SPDX-License-Identifier: BSD-3-Clause
# DySeg's network. A library of its own: the DySeg stage needs no other network.
dyslam_add_library(NAME nets_dyseg
  SOURCES
    src/BevOps.cpp
    src/BevScan.cpp
    src/DysegFile.cpp
    src/DysegModel.cpp
    src/DysegNet.cpp
    src/FlowUpdate.cpp
    src/RigidFlow.cpp
  PUBLIC dyslam::core
  PRIVATE ${TORCH_LIBRARIES})

dyslam_add_test(NAME nets_dyseg
  SOURCES
    tests/BevOps_unittest.cpp
    tests/BevScan_unittest.cpp
    tests/DysegNet_unittest.cpp
    tests/FlowUpdate_unittest.cpp
    tests/RigidFlow_unittest.cpp
  LIBRARIES dyslam::nets_dyseg ${TORCH_LIBRARIES})
