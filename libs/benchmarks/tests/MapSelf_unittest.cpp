// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/benchmarks/MapSelf.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogWriter.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
struct Warnings : MapListener
{
  std::vector<std::string> texts;
  void warn(const std::string& text) override { texts.push_back(text); }
};

/** Ten scans of a rough wall, of a lidar at rest. */
class MapSelfOf : public ::testing::Test
{
 protected:
  void SetUp() override
  {
    RawlogWriter writer(folder.file("x.rawlog"));
    for (int i = 0; i < 10; ++i)
    {
      Scan scan;
      scan.stamp = 1000 + 0.1 * i;
      for (int k = 0; k < 900; ++k)
      {
        scan.points.emplace_back(6 + 0.01F * static_cast<float>(k * 7 % 11),
                                 0.1F * static_cast<float>(k % 30),
                                 0.1F * static_cast<float>(k / 30));
      }
      writer.write(scan);
      poses.push_back(scan.stamp, Pose::Identity());
    }
    writer.close();
    arguments.rawlog = folder.file("x.rawlog");
    arguments.points = 200;
  }
  /** A file with the first poses. \param shift added to the times [s] */
  std::string trajectory(const std::string& name, std::size_t count, double shift = 0) const
  {
    Trajectory part;
    for (std::size_t i = 0; i < count; ++i)
    {
      part.push_back(poses[i].stamp + shift, poses[i].pose);
    }
    writeTum(folder.file(name), part);
    return folder.file(name);
  }
  std::vector<MapSelfScores> evaluate()
  {
    listener.texts.clear();
    return evaluateMapSelf(arguments, listener);
  }

  const TestFolder folder;
  Trajectory poses;
  MapSelfArguments arguments;
  Warnings listener;
};

TEST_F(MapSelfOf, TheClockOfATrajectoryMayBeAnother)
{
  arguments.trajectories = {{trajectory("a.txt", 10)}, {trajectory("b.txt", 10, -900)}};
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)evaluate(); }),
                       "none of its 10 scans has a pose in every trajectory"));
  arguments.trajectories[1].time_offset = 900;
  const auto scores = evaluate();
  ASSERT_EQ(scores.size(), 2U);
  EXPECT_EQ(scores[1].scans, 10U);
  EXPECT_GT(scores[0].mean.points, 100U);
  EXPECT_NEAR(scores[0].mean.mean_entropy, scores[1].mean.mean_entropy, 1e-6);
  EXPECT_TRUE(listener.texts.empty());

  writeKittiPoses(folder.file("kitti.txt"), poses);
  arguments.trajectories = {{folder.file("kitti.txt")}};
  EXPECT_EQ(evaluate().at(0).scans, 10U);
  arguments.trajectories[0].time_offset = 1;
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)evaluate(); }),
                       "kitti.txt: has no time stamps; --time-offset"));
}

TEST_F(MapSelfOf, ScansWithoutAPoseAreWarnedOf)
{
  arguments.trajectories = {{trajectory("all.txt", 10)}, {trajectory("few.txt", 5)}};
  const auto scores = evaluate();
  EXPECT_EQ(scores.at(0).scans, 5U);
  ASSERT_EQ(listener.texts.size(), 1U);
  EXPECT_TRUE(contains(listener.texts[0], "x.rawlog: 5 of 10 scans have a pose in every"));
  EXPECT_TRUE(contains(listener.texts[0], "few.txt: 1000.000 to 1000.400 s; another clock"));
}

TEST_F(MapSelfOf, NeighbourhoodsWithoutPointsAreWarnedOf)
{
  arguments.trajectories = {{trajectory("all.txt", 10)}};
  arguments.quality.radius = 0.001;
  arguments.quality.min_neighbours = 11;  // each point is measured ten times
  EXPECT_EQ(evaluate().at(0).mean.points, 0U);
  ASSERT_EQ(listener.texts.size(), 1U);
  EXPECT_TRUE(contains(listener.texts[0], "no point has 11 neighbours within 0.001 m"));
}
}  // namespace
}  // namespace dyslam
