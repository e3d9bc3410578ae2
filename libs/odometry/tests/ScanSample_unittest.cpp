// SPDX-License-Identifier: BSD-3-Clause
#include "../src/local_map/ScanSample.h"

#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
/** A frame whose cloud has the given points of its scan, 1 m apart. */
Frame frameOf(const std::vector<std::uint32_t>& source)
{
  Frame frame;
  frame.scan.points.resize(6, Eigen::Vector3f::Zero());
  for (const std::uint32_t i : source)
  {
    frame.cloud.points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
    frame.cloud.source.push_back(i);
  }
  return frame;
}

TEST(ScanSample, WeightsAreOfTheirPointsAfterOthersWereInserted)
{
  ThreadPool pool(1);
  Frame frame = frameOf({1, 3, 4});
  frame.moving_probability = {0.1F, 0.3F, 0.4F};
  ScanSample sample;
  sample.ingest(frame, 0.5, pool);
  ASSERT_EQ(3U, sample.scan.size());
  const std::vector<float> before = sample.scan.weight;

  frame = frameOf({0, 1, 2, 3, 4, 5});
  frame.moving_probability = {0.999F, 0.1F, 0.999F, 0.3F, 0.4F, 0.999F};
  sample.updateWeights(frame);
  EXPECT_EQ(before, sample.scan.weight);
  EXPECT_GT(before[0], before[1]);
  EXPECT_GT(before[1], before[2]);
}

TEST(ScanSample, KnowsTheLidarOfEachPoint)
{
  ThreadPool pool(1);
  Frame frame = frameOf({1, 3, 4});
  ScanSample sample;
  sample.ingest(frame, 0.5, pool);
  EXPECT_TRUE(sample.scan.lidar.empty()) << "there is only one";

  frame.scan.parts.resize(1);
  frame.scan.parts[0].begin = 3;
  sample.ingest(frame, 0.5, pool);
  EXPECT_EQ(sample.scan.lidar, (std::vector<std::uint8_t>{0, 1, 1}));
  sample.draw(0.1, 2);
  EXPECT_EQ(sample.sample.lidar, (std::vector<std::uint8_t>{0, 1}));
}
}  // namespace
}  // namespace dyslam
