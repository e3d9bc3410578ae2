// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/GeoreferenceFile.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mapbuilder/MapRun.h>
#include <dyslam/mrpt/Geodesy.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "BoxWorld.h"
#include "MapTest.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

class MapRun : public MapTest
{
};

TEST_F(MapRun, WritesEveryOutput)
{
  for (const char* name : {"m.ply", "m.pcd", "m.bt", "m.simplemap", "m.3Dscene", "m.png"})
  {
    outputs.maps.push_back(folder.file(name));
  }
  outputs.picture = folder.file("picture.png");
  outputs.comparison = folder.file("comparison.png");
  const MapReport report = build();
  EXPECT_EQ(8U, report.scans);
  EXPECT_EQ(0U, report.skipped);
  EXPECT_EQ(8U, report.keyframes);
  EXPECT_EQ(0.2, report.voxel_size);
  EXPECT_EQ("", report.problem);
  EXPECT_EQ(report.points, readCloud(folder.file("m.ply")).points.size());
  for (const std::string& file :
       {outputs.maps[2], outputs.maps[3], outputs.maps[4], outputs.maps[5], folder.file("m.yaml"),
        outputs.picture, outputs.comparison})
  {
    EXPECT_GT(fs::file_size(file), 0U) << file;
  }
  EXPECT_EQ(outputs.settings.toIni(), folder.read("m.effective.ini"));
  EXPECT_EQ(
      (std::vector<std::string>{
          "reading ", "finished 8", "writing m.ply m.pcd, keyframes", "finished 8",
          "writing m.bt, keyframes", "finished 8", "writing m.simplemap, keyframes", "finished 8",
          "writing m.3Dscene, keyframes", "finished 8", "writing m.png, keyframes", "finished 8"}),
      listener.log);
  EXPECT_TRUE(listener.warnings.empty());
  EXPECT_TRUE(listener.in_range);
}

TEST_F(MapRun, AStoppedOneLeavesNoPartOfAFile)
{
  outputs.maps = {folder.file("m.png"), folder.file("m.ply"), folder.file("m.bt")};
  const auto files = [this]
  {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder.path()))
    {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  };
  const std::vector<std::string> before = files();
  listener.stop_at = "reading ";
  EXPECT_THROW((void)build(), MapStopped);
  EXPECT_EQ(before, files());
  listener.stop_at = "writing m.bt, keyframes";
  EXPECT_THROW((void)build(), MapStopped);
  std::vector<std::string> after{"m.ply", "m.png", "m.yaml"};
  after.insert(after.end(), before.begin(), before.end());
  std::sort(after.begin(), after.end());
  EXPECT_EQ(after, files()) << "clouds are written first, and the settings after the maps";
}

TEST_F(MapRun, AMapWithoutPointsIsWrittenWithAWarning)
{
  outputs.maps = {folder.file("m.ply"), folder.file("m.png"), folder.file("m.bt")};
  options.map.min_range = 79.99;
  EXPECT_EQ(0U, build().points);
  EXPECT_TRUE(readCloud(folder.file("m.ply")).points.empty());
  ASSERT_EQ(1U, listener.warnings.size());
  EXPECT_TRUE(contains(listener.warnings[0], "the map has no points")) << listener.warnings[0];
}

TEST_F(MapRun, TilesAreCountedAndTheScansAreRemoved)
{
  outputs.maps = {folder.file("t.las")};
  outputs.exports.tile_size = 10;
  const MapReport report = build();
  EXPECT_GT(report.points, 1000U);
  EXPECT_EQ("writing t.las, tiles", listener.log.at(2));
  EXPECT_TRUE(fs::exists(folder.file("t.las.tiles.yaml")));
  EXPECT_FALSE(fs::exists(folder.file("t.las.scans.tmp")));
  const auto isTile = [](const auto& entry) { return entry.path().extension() == ".las"; };
  const auto files =
      std::count_if(fs::directory_iterator(folder.path()), fs::directory_iterator(), isTile);
  EXPECT_EQ("finished " + std::to_string(files), listener.log.at(3));
}

TEST_F(MapRun, TilesThatCannotBeWrittenAreNoMapWithoutPoints)
{
  fs::create_directories(folder.file("t_0_0.las"));
  outputs.maps = {folder.file("t.las")};
  outputs.exports.tile_size = 10;
  const MapReport report = build();
  EXPECT_TRUE(contains(report.problem, "t_0_0.las: is a folder")) << report.problem;
  EXPECT_TRUE(listener.warnings.empty()) << listener.warnings.front();
}

TEST_F(MapRun, ALasHasTheDateOfTheFirstScan)
{
  constexpr double july = 1593561600;  // 1 July 2020, UNIX time [s]
  Trajectory dated;
  for (const auto& [stamp, pose] : drive)
  {
    dated.push_back(stamp - test::start_time + july, pose);
  }
  recording.rawlog = folder.file("dated.rawlog");
  test::writeRecording(recording.rawlog, dated);
  writeTum(recording.trajectory, dated);
  outputs.maps = {folder.file("m.las")};
  (void)build();
  EXPECT_EQ(std::string("\xB7\x00\xE4\x07", 4), folder.read("m.las").substr(90, 4))
      << "day 183 of 2020";
}

TEST_F(MapRun, TheSceneHasAPointPerTenCentimetresInFullResolution)
{
  outputs.maps = {folder.file("m.3Dscene"), folder.file("m.ply")};
  const MapReport voxels = build();
  const auto size = fs::file_size(outputs.maps[0]);
  options.map.voxel_size = 1;
  const MapReport coarse = build();
  EXPECT_LT(coarse.points, voxels.points / 2);
  outputs.exports.full_resolution = true;
  EXPECT_GT(build().points, voxels.points);
  EXPECT_GT(fs::file_size(outputs.maps[0]), size / 2) << "not one per voxel of 1 m";
}

TEST_F(MapRun, AnAreaLimitsEveryMap)
{
  for (const char* name : {"m.ply", "m.bt", "m.simplemap", "m.3Dscene", "m.png"})
  {
    outputs.maps.push_back(folder.file(name));
  }
  const MapReport whole = build();
  std::vector<std::uintmax_t> sizes;
  for (const std::string& path : outputs.maps)
  {
    sizes.push_back(fs::file_size(path));
  }
  outputs.exports.area = "-3 -3 6 3";
  const MapReport part = build();
  EXPECT_LT(part.points, whole.points);
  for (std::size_t i = 0; i < sizes.size(); ++i)
  {
    EXPECT_LT(fs::file_size(outputs.maps[i]), sizes[i]) << outputs.maps[i];
  }
  EXPECT_TRUE(listener.warnings.empty());
}

TEST_F(MapRun, TheLabelledMapIsWrittenAlone)
{
  std::vector<LabelledBox> boxes(1);
  boxes[0].type = "Car";
  boxes[0].box.centre = {100, 0, 0};
  recording.scans.tracks = folder.file("tracks.txt");
  writeTracks(recording.scans.tracks, boxes);
  outputs.labelled_map = folder.file("truth.ply");
  outputs.exports.tile_size = 50;  // of clouds, which are no output here
  const MapReport report = build();
  const std::size_t points = readCloud(outputs.labelled_map).points.size();
  EXPECT_GT(points, 1000U);
  EXPECT_EQ(points, readLabels(folder.file("truth.label")).size());
  EXPECT_EQ(points, report.points);
  EXPECT_EQ(0, report.voxel_size);
  EXPECT_TRUE(listener.warnings.empty()) << listener.warnings.front();
  EXPECT_EQ((std::vector<std::string>{"reading tracks", "finished 8", "reading ", "finished 8"}),
            listener.log);
}

TEST_F(MapRun, TracksOfALongerRecordingAreWarnedOf)
{
  std::vector<LabelledBox> boxes(1);
  boxes[0].frame = 20;
  boxes[0].type = "Car";
  recording.scans.tracks = folder.file("tracks.txt");
  writeTracks(recording.scans.tracks, boxes);
  outputs.maps = {folder.file("m.ply")};
  (void)build();
  ASSERT_EQ(1U, listener.warnings.size());
  EXPECT_TRUE(contains(listener.warnings[0], "boxes up to scan 20, but"));
  recording.source.only_first_n = 5;
  (void)build();
  EXPECT_EQ(1U, listener.warnings.size()) << "a part was asked for";
}

TEST_F(MapRun, OfADamagedRecordingTheScansBeforeAreMapped)
{
  const std::string whole = folder.read("r.rawlog");
  recording.rawlog = folder.write("cut.rawlog", whole.substr(0, whole.size() / 2));
  outputs.maps = {folder.file("m.ply")};
  const MapReport report = build();
  EXPECT_LT(report.scans, 8U);
  EXPECT_GT(report.points, 0U);
  EXPECT_TRUE(contains(report.problem, "cut.rawlog"));
  EXPECT_TRUE(contains(report.problem, "scans before it was written")) << report.problem;
  EXPECT_EQ(report.points, readCloud(folder.file("m.ply")).points.size());
}

TEST_F(MapRun, ATrajectoryOfAnotherRecordingIsRefused)
{
  Trajectory later;
  for (const auto& [stamp, pose] : drive)
  {
    later.push_back(stamp + 3600, pose);
  }
  writeTum(recording.trajectory, later);
  outputs.maps = {folder.file("m.ply")};
  const std::string said = messageOfError<UserError>([&] { (void)build(); });
  EXPECT_TRUE(contains(said, "has no pose for any scan of")) << said;
  EXPECT_TRUE(contains(
      said, "(scans: 1000.000 to 1000.700 s, poses: 4600.000 to 4600.700 s; another clock"))
      << said;
  EXPECT_FALSE(fs::exists(folder.file("m.ply")));
  recording.time_offset = -3600;
  EXPECT_EQ(8U, build().keyframes);
}

TEST_F(MapRun, PosesWithoutTimesHaveNoOtherClock)
{
  recording.trajectory = folder.file("kitti.txt");
  writeKittiPoses(recording.trajectory, drive);
  outputs.maps = {folder.file("m.ply")};
  EXPECT_EQ(8U, build().keyframes);
  recording.time_offset = 1;
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)build(); }),
                       "kitti.txt: has no time stamps; --time-offset"));
}

TEST_F(MapRun, TheMapIsWrittenInAGivenFrame)
{
  outputs.maps = {folder.file("own.ply")};
  (void)build();
  outputs.maps = {folder.file("fixed.ply"), folder.file("fixed.png")};
  outputs.T_fixed_map = poseFromYpr(100, 200, 5, std::acos(0.0), 0, 0);
  (void)build();
  const auto own = boundsOf(folder.file("own.ply"));
  const auto fixed = boundsOf(folder.file("fixed.ply"));
  // A quarter turn to the left: x of the map is y.
  EXPECT_NEAR(100 - own.max().y(), fixed.min().x(), 0.05);
  EXPECT_NEAR(100 - own.min().y(), fixed.max().x(), 0.05);
  EXPECT_NEAR(200 + own.min().x(), fixed.min().y(), 0.05);
  EXPECT_NEAR(200 + own.max().x(), fixed.max().y(), 0.05);
  EXPECT_NEAR(5 + own.min().z(), fixed.min().z(), 0.05);
  EXPECT_FALSE(fs::exists(folder.file("own_tum.txt")));
  const Trajectory poses = readTum(folder.file("fixed_tum.txt"));
  ASSERT_EQ(8U, poses.size());
  EXPECT_NEAR(drive[7].stamp, poses[7].stamp, 1e-6);
  EXPECT_NEAR(100, poses[7].pose.translation().x(), 1e-6);
  EXPECT_NEAR(207, poses[7].pose.translation().y(), 1e-6);
  EXPECT_TRUE(listener.warnings.empty()) << listener.warnings.front();
}

TEST_F(MapRun, ScansWithoutAPoseAreWarnedOf)
{
  Trajectory first;
  for (std::size_t i = 0; i < 4; ++i)
  {
    first.push_back(drive[i].stamp, drive[i].pose);
  }
  writeTum(recording.trajectory, first);
  outputs.maps = {folder.file("m.ply")};
  EXPECT_EQ(4U, build().skipped);
  recording.unfinished = true;
  EXPECT_EQ(4U, build().skipped);
  ASSERT_EQ(2U, listener.warnings.size());
  const std::string missing = recording.trajectory +
                              ": has no pose for 4 of 8 scans, which are "
                              "not in the map; ";
  EXPECT_EQ(missing + "is it of " + recording.rawlog +
                "? (scans: 1000.000 to 1000.700 s, poses: 1000.000 to 1000.300 s; another clock: "
                "--time-offset; poses more than 0.5 s apart are not interpolated: --tolerance)",
            listener.warnings[0]);
  EXPECT_EQ(missing + "the run is unfinished", listener.warnings[1]);
}

TEST_F(MapRun, FilesWithCoordinatesOfTheirOwnAreWarnedOf)
{
  Trajectory far;
  for (const auto& [stamp, pose] : drive)
  {
    far.push_back(stamp, Eigen::Translation3d(20500, 0, 0) * pose);
  }
  writeTum(recording.trajectory, far);
  outputs.maps = {folder.file("m.ply"), folder.file("m.pcd")};
  (void)build();
  ASSERT_EQ(1U, listener.warnings.size());
  EXPECT_EQ(folder.file("m.pcd") +
                ": coordinates so far from zero would be rounded: the map is relative to 20000 0 0",
            listener.warnings[0]);
}

TEST_F(MapRun, ALabelledMapFarFromZeroIsWarnedOfByItsOwnName)
{
  Trajectory far;
  for (const auto& [stamp, pose] : drive)
  {
    far.push_back(stamp, Eigen::Translation3d(20500, 0, 0) * pose);
  }
  writeTum(recording.trajectory, far);
  outputs.labelled_map = folder.file("truth.ply");
  (void)build();
  ASSERT_EQ(1U, listener.warnings.size());
  EXPECT_TRUE(contains(listener.warnings[0], "truth.ply: coordinates so far from zero"))
      << listener.warnings[0];
}

/** For example where a receiver has not found its position when the trajectory begins. */
TEST_F(MapRun, AFirstPoseFarFromTheOthersIsWarnedOf)
{
  Trajectory far;
  far.push_back(drive[0].stamp - 5, Pose::Identity());
  for (const auto& [stamp, pose] : drive)
  {
    far.push_back(stamp, Eigen::Translation3d(0, 5400000, 0) * pose);
  }
  writeTum(recording.trajectory, far);
  outputs.maps = {folder.file("m.ply"), folder.file("m.las")};
  const MapReport report = build();
  ASSERT_EQ(1U, listener.warnings.size());
  EXPECT_EQ(
      "the map reaches 5400 km from its origin, where coordinates are rounded to 0.5 m; are all "
      "poses of the trajectory right?",
      listener.warnings[0]);
  EXPECT_TRUE(contains(report.problem, "m.las: the format reaches 2147 km")) << report.problem;
}

TEST_F(MapRun, CoarserCellsOfAGridAreWarnedOf)
{
  outputs.maps = {folder.file("m.png")};
  outputs.exports.grid_max_cells = 100;
  (void)build();
  ASSERT_EQ(1U, listener.warnings.size());
  EXPECT_TRUE(contains(listener.warnings[0],
                       "instead of map_export.grid_resolution=0.1, of which there would be more "
                       "than map_export.grid_max_cells=100"))
      << listener.warnings[0];
}

TEST_F(MapRun, AFileThatCannotBeWrittenDoesNotKeepTheOthersFromBeingWritten)
{
  fs::create_directories(folder.file("m.bt"));
  outputs.maps = {folder.file("m.bt"), folder.file("m.png")};
  outputs.picture = folder.file("picture.png");
  const MapReport report = build();
  EXPECT_TRUE(contains(report.problem, folder.file("m.bt") + ": is a folder")) << report.problem;
  EXPECT_EQ(8U, report.keyframes);
  for (const char* file : {"m.png", "m.yaml", "picture.png", "m.effective.ini"})
  {
    EXPECT_GT(fs::file_size(folder.file(file)), 0U) << file;
  }
}

TEST_F(MapRun, WhatNoRunShowsIsRefusedBeforeAnythingIsRead)
{
  std::vector<RunFolder> runs(2);  // without a recording
  outputs.maps = {folder.file("m.las")};
  RunMergerConfig merger;
  const auto said = [&]
  {
    return messageOfError<UserError>(
        [&] { (void)mergeMaps(runs, merger, options, outputs, listener); });
  };
  outputs.utm = true;
  EXPECT_TRUE(contains(said(), "--utm: no run has a georeference.ini")) << said();
  outputs.utm = false;
  outputs.exports.epsg = 32632;
  EXPECT_TRUE(contains(said(), "map_export.epsg: the merged map is in the map frame")) << said();
  outputs.exports.epsg = 0;
  merger.merge.level_map = true;
  EXPECT_TRUE(contains(said(), "merge.level_map: no run has found the vertical")) << said();
  EXPECT_TRUE(listener.log.empty());
}

TEST_F(MapRun, TilesThatAreTooSmallAreRefusedBeforeAnythingIsRead)
{
  outputs.maps = {folder.file("t.las")};
  outputs.exports.tile_size = 0.01;
  recording.rawlog = folder.file("none.rawlog");
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)build(); }), "tile_size"));
  const std::vector<RunFolder> runs(2);  // without a recording
  EXPECT_TRUE(contains(
      messageOfError<UserError>([&] { (void)mergeMaps(runs, {}, options, outputs, listener); }),
      "tile_size"));
  EXPECT_TRUE(listener.log.empty());
}

TEST_F(MapRun, HeightsOfObstaclesInTheWrongOrderAreRefusedBeforeAnythingIsRead)
{
  outputs.maps = {folder.file("m.png")};
  outputs.exports.obstacle_min_height = outputs.exports.obstacle_max_height;
  recording.rawlog = folder.file("none.rawlog");
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)build(); }),
                       "[map_export] obstacle_min_height must be below obstacle_max_height"));
  EXPECT_TRUE(listener.log.empty());
}

TEST_F(MapRun, NormalsOfTilesNeedANeighbourhoodWithinTheirMarginBeforeAnythingIsRead)
{
  outputs.maps = {folder.file("t.las")};
  outputs.exports.tile_size = 10;
  outputs.exports.normal_radius = 2.1;
  const std::string rawlog = std::exchange(recording.rawlog, folder.file("none.rawlog"));
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)build(); }), "normal_radius = 2.1"));
  EXPECT_TRUE(listener.log.empty());
  recording.rawlog = rawlog;
  outputs.exports.normals = false;
  EXPECT_GT(build().points, 1000U);
}
}  // namespace
}  // namespace dyslam
