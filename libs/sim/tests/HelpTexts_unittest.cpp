// SPDX-License-Identifier: BSD-3-Clause
#include "HelpTexts.h"

#include <dyslam/sim/ClipGenerator.h>
#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
TEST(HelpTexts, ThoseOfTheSimulatorReadAlone)
{
  Config config;
  save(sim::ClipOptions(), config, "simulator");
  EXPECT_EQ(std::vector<std::string>(), unclearHelpTexts(config.toIni()));
  EXPECT_EQ(std::vector<std::string>(), longNumbers(config.toIni()));
}
}  // namespace
}  // namespace dyslam
