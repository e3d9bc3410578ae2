// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/PointTimeFiles.h>
#include <gtest/gtest.h>

#include <cmath>

#include "TestFolder.h"

namespace dyslam
{
TEST(PointTimeFiles, AreReadAsTheyWereWritten)
{
  const TestFolder folder;
  const std::string path = folder.file("a.time");
  writePointTimes(path, {-0.05F, 0.F, std::nanf(""), 0.0499F});
  const std::vector<float> times = readPointTimes(path, 4);
  ASSERT_EQ(4U, times.size());
  EXPECT_EQ(-0.05F, times[0]);
  EXPECT_EQ(0.F, times[1]);
  EXPECT_TRUE(std::isnan(times[2]));
  EXPECT_EQ(0.0499F, times[3]);

  writePointTimes(path, {});
  EXPECT_TRUE(readPointTimes(path, 0).empty());
}

TEST(PointTimeFiles, MustHaveATimeForEachPoint)
{
  const TestFolder folder;
  const std::string path = folder.write("a.time", std::string(8, '\0'));
  EXPECT_EQ(2U, readPointTimes(path, 2).size());
  for (const std::size_t points : {1U, 3U})
  {
    const auto message = messageOfError<UserError>([&] { (void)readPointTimes(path, points); });
    EXPECT_TRUE(contains(message, "a.time: has 8 bytes")) << message;
  }
  folder.write("a.time", std::string(7, '\0'));
  EXPECT_THROW((void)readPointTimes(path, 2), UserError);
  EXPECT_THROW((void)readPointTimes(folder.file("none.time"), 2), UserError);
}
}  // namespace dyslam
