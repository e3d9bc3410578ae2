// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/train/TrainDylo.h>
#include <gtest/gtest.h>

#include "HelpTexts.h"

namespace dyslam
{
namespace
{
TEST(HelpTexts, ThoseOfTheTrainingOfDyloReadAlone)
{
  const Config config = dyloTrainDefaults();
  EXPECT_EQ(std::vector<std::string>(), unclearHelpTexts(config.toIni()));
  EXPECT_EQ(std::vector<std::string>(), longNumbers(config.toIni()));
}
}  // namespace
}  // namespace dyslam
