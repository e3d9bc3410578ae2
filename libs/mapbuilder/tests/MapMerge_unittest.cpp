// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/GeoreferenceFile.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mapbuilder/MapRun.h>
#include <dyslam/mrpt/Geodesy.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "BoxWorld.h"
#include "MapTest.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

class MapMerge : public MapTest
{
};

TEST_F(MapMerge, RunsWithoutAPlaceInCommonAreNotMerged)
{
  for (const char* name : {"a", "b"})
  {
    test::writeRunFolder(folder.file(name), recording.rawlog, drive, 4);
  }
  outputs.maps = {folder.file("m.ply")};
  const auto runs = readRunFolders({folder.file("a"), folder.file("b")}, 0.01);
  RunMergerConfig merger;
  merger.loops.by_appearance.min_support = 10;  // more than two keyframes can give
  merger.loops.support_window = 10;
  const std::string said =
      messageOfError<UserError>([&] { (void)mergeMaps(runs, merger, options, outputs, listener); });
  EXPECT_TRUE(contains(said, folder.file("b") + ": no place in common with " + folder.file("a")))
      << said;
  EXPECT_TRUE(contains(said, "nothing was written"));
  EXPECT_FALSE(fs::exists(folder.file("m.ply")));
}

/** A run of scans along these poses, each a keyframe. */
RunFolder wholeRun(const TestFolder& folder,
                   const std::string& name,
                   const test::BoxWorld& world,
                   const std::vector<Pose>& poses,
                   unsigned seed)
{
  RunFolder run;
  run.folder = run.name = name;
  run.rawlog = folder.file(name + ".rawlog");
  RawlogWriter writer(run.rawlog);
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    Scan scan;
    scan.stamp = test::start_time + test::period * static_cast<double>(i);
    scan.points = world.scan(poses[i], seed + static_cast<unsigned>(i));
    writer.write(scan);
    run.trajectory.push_back(scan.stamp, poses.front().inverse() * poses[i]);
    run.keyframe_stamps.push_back(scan.stamp);
  }
  writer.close();
  run.graph = test::graphOf(run.trajectory, 1);
  run.scans = test::asRecorded();
  return run;
}

/** The same, whose recording has lost its last tenth. */
RunFolder damagedRun(const TestFolder& folder,
                     const std::string& name,
                     const test::BoxWorld& world,
                     const std::vector<Pose>& poses,
                     unsigned seed)
{
  RunFolder run = wholeRun(folder, name, world, poses, seed);
  const std::string whole = folder.read(name + ".rawlog");
  folder.write(name + ".rawlog", whole.substr(0, whole.size() / 10 * 9));
  return run;
}

TEST_F(MapMerge, OfMergedRunsEveryDamagedRecordingIsNamed)
{
  const test::BoxWorld world(13, 30, 20);
  std::vector<Pose> poses = test::driveAround(30, 20, 90, 1.5);
  RunFolder whole = damagedRun(folder, "monday", world, poses, 5000);
  poses.resize(30);
  RunFolder part = damagedRun(folder, "tuesday", world, poses, 6000);
  outputs.maps = {folder.file("m.ply")};
  const MergeReport report =
      mergeMaps(test::listOf(std::move(whole), std::move(part)), {}, options, outputs, listener);
  EXPECT_EQ(2U, report.joined);
  const std::size_t first = report.problem.find("monday.rawlog");
  const std::size_t second = report.problem.find("; ", first);
  EXPECT_NE(std::string::npos, first) << report.problem;
  EXPECT_NE(std::string::npos, report.problem.find("tuesday.rawlog", second)) << report.problem;
  EXPECT_TRUE(contains(report.problem, "; the map of the rest was written")) << report.problem;
}

TEST_F(MapMerge, AMergeWritesItsTrajectoriesIfTheMapCannotBeWritten)
{
  const test::BoxWorld world(13, 30, 20);
  const std::vector<Pose> poses = test::driveAround(30, 20, 90, 1.5);
  const auto runs =
      test::listOf(wholeRun(folder, "monday", world, poses, 5000),
                   wholeRun(folder, "tuesday", world, {poses.begin(), poses.begin() + 30}, 6000));
  fs::create_directories(folder.file("m.ply"));
  fs::create_directories(folder.file("m_monday_tum.txt"));
  outputs.maps = {folder.file("m.ply")};
  const MergeReport report = mergeMaps(runs, {}, options, outputs, listener);
  EXPECT_EQ(2U, report.joined);
  EXPECT_TRUE(contains(report.problem, folder.file("m.ply") + ": is a folder")) << report.problem;
  EXPECT_TRUE(contains(report.problem, folder.file("m_monday_tum.txt") + ": is a folder"))
      << report.problem;
  for (const char* file : {"m_monday_kitti.txt", "m_tuesday_tum.txt", "m_merge.csv"})
  {
    EXPECT_GT(fs::file_size(folder.file(file)), 0U) << file;
  }
  EXPECT_FALSE(report.table.empty());
}

TEST_F(MapMerge, AMergedMapIsWrittenInAGivenFrame)
{
  const test::BoxWorld world(13, 30, 20);
  const std::vector<Pose> poses = test::driveAround(30, 20, 90, 1.5);
  const auto runs =
      test::listOf(wholeRun(folder, "monday", world, poses, 5000),
                   wholeRun(folder, "tuesday", world, {poses.begin(), poses.begin() + 30}, 6000));
  outputs.maps = {folder.file("own.ply")};
  EXPECT_EQ(2U, mergeMaps(runs, {}, options, outputs, listener).joined);
  outputs.maps = {folder.file("fixed.ply")};
  outputs.T_fixed_map = poseFromYpr(1000, -200, 40, 0, 0, 0);
  EXPECT_EQ(2U, mergeMaps(runs, {}, options, outputs, listener).joined);
  const auto own = boundsOf(folder.file("own.ply"));
  const auto fixed = boundsOf(folder.file("fixed.ply"));
  EXPECT_NEAR(1000 + own.min().x(), fixed.min().x(), 0.05);
  EXPECT_NEAR(-200 + own.max().y(), fixed.max().y(), 0.05);
  EXPECT_NEAR(40 + own.min().z(), fixed.min().z(), 0.05);
  const Trajectory monday = readTum(folder.file("fixed_monday_tum.txt"));
  EXPECT_NEAR(1000, monday[0].pose.translation().x(), 0.05);
  EXPECT_NEAR(40, monday[0].pose.translation().z(), 0.05);
}

TEST_F(MapMerge, ARunThatIsNotMergedHasNoTrajectoryOfAnEarlierMerge)
{
  const test::BoxWorld world(13, 30, 20);
  const std::vector<Pose> poses = test::driveAround(30, 20, 90, 1.5);
  const auto runs =
      test::listOf(wholeRun(folder, "monday", world, poses, 5000),
                   wholeRun(folder, "tuesday", world, {poses.begin(), poses.begin() + 30}, 6000),
                   wholeRun(folder, "short", world, {poses.begin(), poses.begin() + 2}, 7000));
  for (const char* file : {"m_short_tum.txt", "m_short_kitti.txt"})
  {
    folder.write(file, "of an earlier merge");
  }
  outputs.maps = {folder.file("m.ply")};
  const MergeReport report = mergeMaps(runs, {}, options, outputs, listener);
  EXPECT_EQ(2U, report.joined);
  EXPECT_TRUE(contains(report.problem, "short: no place in common with monday")) << report.problem;
  EXPECT_TRUE(fs::exists(folder.file("m_tuesday_tum.txt")));
  EXPECT_FALSE(fs::exists(folder.file("m_short_tum.txt")));
  EXPECT_FALSE(fs::exists(folder.file("m_short_kitti.txt")));
}

/** Two runs of one place, of which the second knows where it is on the earth and its vertical. */
std::vector<RunFolder> runsOnTheEarth(const TestFolder& folder, double east_of_first = 0)
{
  const test::BoxWorld world(13, 30, 20);
  const std::vector<Pose> poses = test::driveAround(30, 20, 90, 1.5);
  auto runs =
      test::listOf(wholeRun(folder, "monday", world, poses, 5000),
                   wholeRun(folder, "tuesday", world, {poses.begin(), poses.begin() + 30}, 6000));
  Georeference georeference;
  georeference.origin = {49, 8.4, 115};
  georeference.T_enu_map = poses.front();
  georeference.fixes = 12;
  runs[1].references.georeference = georeference;
  Gravity gravity;
  gravity.tilt_sigma = 0.01;
  gravity.directions = 5;
  runs[1].references.gravity = gravity;
  if (east_of_first != 0)
  {
    georeference.T_enu_map = Eigen::Translation3d(east_of_first, 0, 0) * poses.front();
    runs[0].references.georeference = georeference;
  }
  return runs;
}

TEST_F(MapMerge, AMergeWithSatellitePositionsIsGeoreferenced)
{
  const auto runs = runsOnTheEarth(folder);
  outputs.maps = {folder.file("m.las")};
  const MergeReport report = mergeMaps(runs, {}, options, outputs, listener);
  EXPECT_EQ("", report.problem);
  EXPECT_TRUE(contains(report.references, "satellite receivers: 12 positions, "))
      << report.references;
  EXPECT_TRUE(contains(report.references, "z of the merged map is 0.")) << report.references;
  const Georeference found = readGeoreference(folder.file("m_georeference.ini"));
  EXPECT_EQ(32632, found.epsg);
  EXPECT_EQ(49, found.origin.latitude);
  EXPECT_TRUE(found.T_enu_map.translation().isApprox(
      runs[1].references.georeference->T_enu_map.translation(), 0.02));
  EXPECT_TRUE(contains(folder.read("m_merge_references.csv"), "tuesday,12,"));
  const Trajectory monday = readTum(folder.file("m_monday_tum.txt"));
  const Trajectory in_utm = readTum(folder.file("m_monday_utm.txt"));
  ASSERT_EQ(monday.size(), in_utm.size());
  const Trajectory expected = inUtm(monday, found);
  EXPECT_LT((in_utm[59].pose.translation() - expected[59].pose.translation()).norm(), 0.01);
  const auto eastOfLas = [&]
  {
    double east = 0;
    folder.read("m.las").copy(reinterpret_cast<char*>(&east), sizeof east, 187);
    return east;
  };
  EXPECT_LT(std::abs(eastOfLas()), 200) << "in the map frame";

  fs::remove(folder.file("m_merge_references.csv"));
  folder.write("m_merge_references.csv/in_the_way", "");
  outputs.utm = true;
  const MergeReport incomplete = mergeMaps(runs, {}, options, outputs, listener);
  EXPECT_TRUE(contains(incomplete.problem, "m_merge_references.csv: is a folder"))
      << incomplete.problem;
  EXPECT_EQ(report.references, incomplete.references);
  EXPECT_TRUE(fs::exists(folder.file("m_georeference.ini")));
  EXPECT_TRUE(fs::exists(folder.file("m_monday_utm.txt")));
  fs::remove_all(folder.file("m_merge_references.csv"));
  EXPECT_NEAR(in_utm[0].pose.translation().x(), eastOfLas(), 200);
  EXPECT_TRUE(contains(folder.read("m.las").substr(0, 2000), "LASF_Projection"));
  const Config settings = Config::fromFile(folder.file("m.effective.ini"));
  EXPECT_EQ("32632", settings.text("map_export", "epsg"));
  EXPECT_TRUE(settings.has("map", "voxel_size"));

  outputs.utm = false;
  RunMergerConfig without;
  without.merge.gnss = without.merge.gravity = false;
  EXPECT_EQ("", mergeMaps(runs, without, options, outputs, listener).references);
  for (const char* name : {"m_georeference.ini", "m_monday_utm.txt", "m_merge_references.csv"})
  {
    EXPECT_FALSE(fs::exists(folder.file(name))) << name << " is of the merge before";
  }
}

TEST_F(MapMerge, AMergeThatContradictsSatellitePositionsIsRefused)
{
  const auto runs = runsOnTheEarth(folder, 105);
  outputs.maps = {folder.file("m.ply")};
  const std::string said =
      messageOfError<UserError>([&] { (void)mergeMaps(runs, {}, options, outputs, listener); });
  EXPECT_TRUE(contains(said, "tuesday: loops place it 10")) << said;
  EXPECT_TRUE(contains(said, "positions do, by those of monday")) << said;
  EXPECT_TRUE(contains(said, "merge.gnss=false")) << said;
  EXPECT_FALSE(fs::exists(folder.file("m.ply")));
}
}  // namespace
}  // namespace dyslam
