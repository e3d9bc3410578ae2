# SPDX-License-Identifier: BSD-3-Clause
# Training of DySeg's network.
dyslam_add_library(NAME train_dyseg INTERNAL HEADERS torch
  SOURCES
    src/DysegBodies.cpp
    src/DysegCrop.cpp
    src/DysegData.cpp
    src/DysegLosses.cpp
    src/DysegPairLoss.cpp
    src/DysegPairs.cpp
    src/DysegScores.cpp
    src/DysegSources.cpp
    src/DysegTrainer.cpp
    src/DysegTrainerOptions.cpp
    src/DysegValidation.cpp
    src/LabelledRun.cpp
  PUBLIC dyslam::core dyslam::nets_dyseg dyslam::sim dyslam::train_common
  PRIVATE dyslam::formats ${TORCH_LIBRARIES})

dyslam_add_test(NAME train_dyseg COST 30 HEADERS torch
  SOURCES
    tests/DysegCrop_unittest.cpp
    tests/DysegData_unittest.cpp
    tests/DysegHelpTexts_unittest.cpp
    tests/DysegLosses_unittest.cpp
    tests/DysegPairs_unittest.cpp
    tests/DysegTrainer_unittest.cpp
    tests/DysegValidation_unittest.cpp
    tests/LabelledRun_unittest.cpp
  LIBRARIES dyslam::formats dyslam::train_dyseg ${TORCH_LIBRARIES})
if(TARGET train_dyseg_tests)
  target_include_directories(train_dyseg_tests PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
endif()
