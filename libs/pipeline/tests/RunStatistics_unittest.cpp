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

/** One threshold and one wording for console, report.json and report.html. */
TEST(RunStatistics, TheVerdictFitsWarningsAndFailure)
{
  const auto statisticsOf = [](int failures, int restarts)
  {
    RunStatistics statistics;
    for (int i = 0; i < 30; ++i)
    {
      Frame frame = failed(i < restarts, "no overlap");
      frame.motion.converged = i >= failures;
      statistics.add(frame);
    }
    return statistics;
  };
  const RunStatistics few = statisticsOf(6, 0);
  EXPECT_EQ(few.verdict(), "usable");
  EXPECT_FALSE(hasWarning(few, "check trajectory and map"));
  const RunStatistics many = statisticsOf(10, 2);
  EXPECT_EQ(many.verdict(), "doubtful");
  EXPECT_EQ(many.failure(false), "");
  EXPECT_TRUE(hasWarning(many,
                         "10 of 30 scans could not be registered: check trajectory and map; most "
                         "often because: no overlap"));
  EXPECT_EQ(statisticsOf(15, 0).verdict(), "doubtful");
  const RunStatistics restarted = statisticsOf(5, 1);
  EXPECT_EQ(restarted.verdict(), "doubtful");
  EXPECT_TRUE(hasWarning(restarted, "check trajectory and map"));
  const RunStatistics most = statisticsOf(16, 0);
  EXPECT_EQ(most.verdict(), "unusable");
  EXPECT_EQ(most.failure(false).find(
                "16 of 30 scans could not be registered: do not trust trajectory and map"),
            0U);
  EXPECT_FALSE(hasWarning(most, "check trajectory and map"));
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
