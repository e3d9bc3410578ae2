// SPDX-License-Identifier: BSD-3-Clause
// rawlog2bag: rawlogs and runs as ROS 2 bags.
#include <dyslam/core/Frame.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "ConvertedDrive.h"
#include "RunProgram.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
class BagExports : public test::ConvertedDrive
{
};

TEST_F(BagExports, ARawlogAsBagAndBack)
{
  {
    RawlogWriter writer(at("truth.rawlog"));
    for (std::size_t i = 0; i < test::drive_scans; ++i)
    {
      writer.write(scans_[i], poses_[i]);
    }
    writer.close();
  }
  const Outcome there = run("rawlog2bag", "-i " + at("truth.rawlog") + " -o " + at("drive.mcap"));
  EXPECT_EQ(0, there.code) << there.err;
  EXPECT_TRUE(contains(there.out, "drive.mcap: 6 scans, ")) << there.out;
  EXPECT_TRUE(contains(there.out, "; truth: 6 poses (from the rawlog)")) << there.out;
  const auto frames =
      converted("scans2rawlog",
                "-i " + at("drive.mcap") + " --base-frame base_link --truth-topic /ground_truth",
                {"scans: /points", "per-point time: field time, seconds", "ring: field ring"});
  expectOriginal(frames);
  for (std::size_t i = 0; i < test::drive_scans; ++i)
  {
    EXPECT_EQ(scans_[i].time, frames.at(i).scan.time);
    EXPECT_EQ(scans_[i].ring, frames[i].scan.ring);
    EXPECT_NEAR(scans_[i].stamp, frames[i].scan.stamp, 1e-6);
    EXPECT_TRUE(frames[i].T_world_vehicle_truth->isApprox(poses_[i], 1e-6));
  }
  const Outcome again = run("rawlog2bag", "-i " + at("truth.rawlog") + " -o " + at("drive.mcap"));
  EXPECT_EQ(1, again.code);
  EXPECT_TRUE(contains(again.err, "drive.mcap: is there already")) << again.err;
  const Outcome part = run("rawlog2bag", "--force -q --start 0.15 --end 0.45 -i " +
                                             at("truth.rawlog") + " -o " + at("drive.mcap"));
  EXPECT_TRUE(contains(part.out, "drive.mcap: 3 scans, ")) << part.out << part.err;
}

TEST_F(BagExports, WhatIsMissingIsSaid)
{
  const Outcome nothing = run("rawlog2bag", "-o " + at("never.mcap"));
  EXPECT_EQ(1, nothing.code);
  EXPECT_TRUE(contains(nothing.err, "--input or --run is required")) << nothing.err;
  const Outcome no_run = run("rawlog2bag", "--run " + at("nowhere") + " -o " + at("never.mcap"));
  EXPECT_EQ(1, no_run.code);
  EXPECT_TRUE(contains(no_run.err, "nowhere: is not a folder")) << no_run.err;
  const Outcome itself =
      run("rawlog2bag", "-i " + at("original.rawlog") + " -o " + at("original.rawlog"));
  EXPECT_EQ(1, itself.code);
  EXPECT_TRUE(contains(itself.err, "original.rawlog")) << itself.err;
  EXPECT_FALSE(std::filesystem::exists(at("never.mcap")));
}

/** Of the bundled recording of a VLP-16. */
TEST_F(BagExports, ARunAsBag)
{
  const std::string campus_rawlog = std::string(DYSLAM_SOURCE_DIR) + "/rawlog/campus16.rawlog";
  const Outcome slam_run = run("dyslam", "-i " + campus_rawlog +
                                             " --only-first-n 8 --labels --set output.replay=false"
                                             " -v ERROR -o " +
                                             at("campus"));
  ASSERT_EQ(0, slam_run.code) << slam_run.err;
  const Outcome there = run("rawlog2bag", "--run " + at("campus") + " -o " + at("campus/run.mcap"));
  EXPECT_EQ(0, there.code) << there.err;
  EXPECT_TRUE(contains(there.out, "run.mcap: 8 scans, ")) << "as in the run: " << there.out;
  EXPECT_TRUE(contains(there.out,
                       "; 8 poses (from " + at("campus/trajectory_tum.txt") + "), 8 label files"))
      << there.out;
  const Outcome list = run("scans2rawlog", "--list -i " + at("campus/run.mcap"));
  EXPECT_EQ(0, list.code) << list.err;
  for (const std::string topic : {"/tf_static ", "/tf ", "/points ", "/points_static ", "/objects ",
                                  "/odometry ", "/path ", "/map ", "/ground_truth "})
  {
    EXPECT_TRUE(contains(list.out, "\n" + topic)) << topic << "in\n" << list.out;
  }
  const Outcome part = run("rawlog2bag", "-q --no-map --static-only --only-first-n 2 --run " +
                                             at("campus") + " -o " + at("part.mcap"));
  EXPECT_TRUE(contains(part.out, "part.mcap: 2 scans, ")) << part.out << part.err;
  const Outcome of_part = run("scans2rawlog", "--list -i " + at("part.mcap"));
  EXPECT_TRUE(contains(of_part.out, "\n/points_static ")) << of_part.out;
  EXPECT_FALSE(contains(of_part.out, "\n/points ")) << of_part.out;
  EXPECT_FALSE(contains(of_part.out, "\n/map ")) << of_part.out;

  // The run's map is in the frame of its own poses.
  const Outcome along =
      run("rawlog2bag", "-q --run " + at("campus") + " --trajectory " +
                            at("campus/reference_tum.txt") + " -o " + at("along.mcap"));
  EXPECT_EQ(0, along.code) << along.err;
  EXPECT_TRUE(contains(along.err, "campus/map_static.pcd: is left out")) << along.err;
  const Outcome of_along = run("scans2rawlog", "--list -i " + at("along.mcap"));
  EXPECT_FALSE(contains(of_along.out, "\n/map ")) << of_along.out;

  std::filesystem::remove_all(at("campus/labels"));
  for (const std::string map : {"campus/map_static.pcd", "campus/map_static.ply"})
  {
    std::filesystem::remove(at(map));
  }
  const Outcome less = run("rawlog2bag", "-q --run " + at("campus") + " -o " + at("less.mcap"));
  EXPECT_EQ(0, less.code) << less.err;
  EXPECT_TRUE(contains(less.err, "campus: has no labels")) << less.err;
  EXPECT_TRUE(contains(less.err, "campus: has no map_static.pcd")) << less.err;
  const Outcome none =
      run("rawlog2bag", "-q --no-scans --no-map --run " + at("campus") + " -o " + at("none.mcap"));
  EXPECT_EQ(0, none.code) << none.err;
  EXPECT_FALSE(contains(none.err, "campus: has no")) << "as asked for: " << none.err;
}
}  // namespace
}  // namespace dyslam
