// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/train/ChangedSettings.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "TestFolder.h"

namespace dyslam
{
TEST(ChangedSettings, ThoseThatChangeTheResultAreNamed)
{
  const TestFolder folder;
  const std::string began =
      "[train]\nsteps = 40\nlearning_rate = 0.0015 // of the optimiser\n"
      "[data]\nrecordings = a;b|c;d\nmax_gap = 5\n";
  const std::string ini = folder.write("effective.ini", began);
  const Config same = Config::fromText(began, "same.ini");
  EXPECT_TRUE(changedSettings(ini, same).empty());
  EXPECT_EQ(changedSettingsNote(ini, same), "");

  Config other = same;
  other.set("train.steps=60");
  EXPECT_TRUE(changedSettings(ini, other).empty()) << "a longer training";
  other.set("train.learning_rate=0.1");
  other.set("data.max_gap=3");
  other.set("data.new_setting=1");
  EXPECT_EQ(changedSettings(ini, other),
            (std::vector<std::string>{"[data] max_gap = 3 (before: 5)",
                                      "[train] learning_rate = 0.1 (before: 0.0015)"}));
  EXPECT_EQ(changedSettingsNote(ini, other),
            "note: goes on with other settings than it began with: [data] max_gap = 3 (before: 5), "
            "[train] learning_rate = 0.1 (before: 0.0015)");
  EXPECT_TRUE(changedSettings(folder.file("none.ini"), other).empty()) << "a checkpoint alone";
}
}  // namespace dyslam
