// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/train/TrainDyseg.h>
#include <gtest/gtest.h>

#include "HelpTexts.h"

namespace dyslam
{
namespace
{
TEST(HelpTexts, ThoseOfTheTrainingOfDysegReadAlone)
{
  const Config config = dysegTrainDefaults();
  EXPECT_EQ(std::vector<std::string>(), unclearHelpTexts(config.toIni()));
  EXPECT_EQ(std::vector<std::string>(), longNumbers(config.toIni()));
}
}  // namespace
}  // namespace dyslam
