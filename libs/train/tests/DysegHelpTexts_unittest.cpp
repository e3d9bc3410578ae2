// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/BevScan.h>
#include <dyslam/nets/DysegOptions.h>
#include <dyslam/train/DysegData.h>
#include <dyslam/train/DysegLossOptions.h>
#include <dyslam/train/DysegTrainer.h>
#include <gtest/gtest.h>

#include "HelpTexts.h"

namespace dyslam
{
namespace
{
TEST(HelpTexts, ThoseOfTheTrainingOfDysegReadAlone)
{
  Config config;
  save(DysegTrainerOptions(), config, "train");
  save(DysegNetworkOptions(), config, "network");
  save(BevOptions(), config, "grid");
  save(DysegAugmentOptions(), config, "augmentation");
  save(DysegLossOptions(), config, "loss");
  EXPECT_EQ(std::vector<std::string>(), unclearHelpTexts(config.toIni()));
  EXPECT_EQ(std::vector<std::string>(), longNumbers(config.toIni()));
}
}  // namespace
}  // namespace dyslam
