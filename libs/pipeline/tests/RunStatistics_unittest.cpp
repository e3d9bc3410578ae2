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
