// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/io/GroundTruth.h>
#include <dyslam/io/TrajectoryFiles.h>

#include "TestFolder.h"

namespace dyslam
{
TEST(TrajectoryFiles, TumRoundTrip)
{
  const TestFolder folder;
  Trajectory trajectory;
  for (int i = 0; i < 20; ++i)
  {
    trajectory.push_back(1317384506.123456 + 0.1 * i,
                         poseFromYpr(1000.123456789 + i, -2e-7 * i, 3, 0.3 * i, 0.1, -0.2));
  }
  writeTum(folder.file("a.txt"), trajectory);
  const Trajectory read = readTum(folder.file("a.txt"));
  ASSERT_EQ(trajectory.size(), read.size());
  for (std::size_t i = 0; i < read.size(); ++i)
  {
    EXPECT_EQ(trajectory[i].stamp, read[i].stamp);
    EXPECT_TRUE(trajectory[i].pose.matrix().isApprox(read[i].pose.matrix(), 1e-11));
  }
}
}  // namespace dyslam
