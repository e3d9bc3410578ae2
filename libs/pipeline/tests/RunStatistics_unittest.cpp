// SPDX-License-Identifier: BSD-3-Clause
#include "../src/RunStatistics.h"

#include <dyslam/core/StateArchive.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace dyslam
{
namespace
{
Frame failed(bool map_restarted, const std::string& reason)
{
  Frame frame;
  frame.motion.map_restarted = map_restarted;
  frame.motion.reason = reason;
  return frame;
}

bool hasWarning(const RunStatistics& statistics, const std::string& part)
{
  const auto warnings = statistics.warnings(false);
  return std::any_of(warnings.begin(), warnings.end(),
                     [&part](const std::string& warning)
                     { return warning.find(part) != std::string::npos; });
}

TEST(RunStatistics, CountsMapRestartsWhateverTheReasonsSay)
{
  RunStatistics statistics;
  statistics.add(failed(false, "no overlap; the map is restarted"));
  EXPECT_FALSE(hasWarning(statistics, "restarted"));
  statistics.add(failed(true, "no overlap"));
  EXPECT_TRUE(hasWarning(statistics, "the local map was restarted once"));
  statistics.add(failed(true, ""));
  EXPECT_TRUE(hasWarning(statistics, "the local map was restarted 2 times"));
}

TEST(RunStatistics, AdvisesByTheMostFrequentReason)
{
  const auto failureOf = [](const std::string& reason)
  {
    RunStatistics statistics;
    statistics.add(failed(false, "another reason"));
    statistics.add(failed(false, reason));
    statistics.add(failed(false, reason));
    return statistics.failure(true);
  };
  const auto has = [](const std::string& text, const std::string& part)
  { return text.find(part) != std::string::npos; };
  const std::string motion = failureOf("inlier ratio 0.21, the limit is 0.3");
  EXPECT_TRUE(has(motion, "; try the settings that fit the sensor (no -c), -c handheld.ini"));
  EXPECT_TRUE(has(motion, "odometry.start_speed")) << motion;
  for (const char* reason : {"the scan has only 0 returns", "the scan has no points"})
  {
    const std::string few = failureOf(reason);
    EXPECT_TRUE(has(few, reason)) << few;
    EXPECT_TRUE(has(few, "; check the recording, and how it was converted")) << few;
    EXPECT_FALSE(has(few, "start_speed") || has(few, "handheld")) << few;
  }
  const std::string range = failureOf(
      "only 3 of 900 points are left after preprocess.min_range, own_vehicle_range and max_range");
  EXPECT_TRUE(has(range, "; change these settings, or check that the points are in metres"));
  EXPECT_FALSE(has(range, "start_speed")) << range;
}

TEST(RunStatistics, KeepsMapRestartsWhenARunIsResumed)
{
  RunStatistics statistics;
  statistics.add(failed(true, "no overlap"));
  StateArchive saved;
  saved(statistics);
  RunStatistics resumed;
  StateArchive archive(saved.bytes());
  archive(resumed);
  archive.requireEnd();
  resumed.add(failed(true, "no overlap"));
  EXPECT_TRUE(hasWarning(resumed, "the local map was restarted 2 times"));
  EXPECT_EQ(resumed.registration_failures.total(), 2U);
}
}  // namespace
}  // namespace dyslam
