// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/DyloNetworkOptions.h>
#include <dyslam/train/Augmentation.h>
#include <dyslam/train/DyloLoss.h>
#include <gtest/gtest.h>

#include "DyloTrainOptions.h"
#include "HelpTexts.h"

namespace dyslam
{
namespace
{
TEST(HelpTexts, ThoseOfTheTrainingOfDyloReadAlone)
{
  Config config;
  save(TrainOptions(), config, "train");
  save(DataOptions(), config, "data");
  save(DyloNetworkOptions(), config, "network");
  save(DyloLossOptions(), config, "loss");
  save(AugmentationOptions(), config, "augmentation");
  EXPECT_EQ(std::vector<std::string>(), unclearHelpTexts(config.toIni()));
  EXPECT_EQ(std::vector<std::string>(), longNumbers(config.toIni()));
}
}  // namespace
}  // namespace dyslam
