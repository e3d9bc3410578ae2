// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/GeoreferenceFile.h>
#include <dyslam/mapbuilder/MapRun.h>
#include <dyslam/mapbuilder/RunFolder.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "TestFolder.h"
#include "TestRun.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

class RunFolderTest : public testing::Test
{
 protected:
  void SetUp() override
  {
    folder.write("r.rawlog", "not read here");
    for (const char* name : {"monday", "tuesday", "week2/monday"})
    {
      test::writeRunFolder(folder.file(name), folder.file("r.rawlog"), test::straightDrive(9, 1),
                           4);
    }
  }
  [[nodiscard]] std::vector<RunFolder> read(const std::vector<std::string>& names) const
  {
    std::vector<std::string> paths;
    for (const std::string& name : names)
    {
      paths.push_back(folder.file(name));
    }
    return readRunFolders(paths, 0.02);
  }
  /** What is said of monday and another folder. */
  [[nodiscard]] std::string said(const std::string& other) const
  {
    return messageOfError<UserError>([&] { (void)read({"monday", other}); });
  }

  TestFolder folder;
};

TEST_F(RunFolderTest, HasTheResultsOfTheRun)
{
  const auto runs = read({"monday", "tuesday"});
  ASSERT_EQ(2U, runs.size());
  const RunFolder& run = runs.front();
  EXPECT_EQ(folder.file("monday"), run.folder);
  EXPECT_EQ("monday", run.name);
  EXPECT_EQ(folder.file("r.rawlog"), run.rawlog);
  EXPECT_EQ(9U, run.trajectory.size());
  ASSERT_EQ(3U, run.keyframe_stamps.size());
  EXPECT_NEAR(test::start_time + 4 * test::period, run.keyframe_stamps[1], 1e-6);
  EXPECT_TRUE(run.graph.pose(Key::ego(2)).isApprox(run.trajectory[8].pose, 1e-9));
  EXPECT_EQ(DeskewMode::none, run.scans.preprocess.deskew);
  EXPECT_EQ(0.02, run.scans.tolerance);
  EXPECT_EQ("", run.scans.labels);
  EXPECT_EQ("", run.scans.tracks);
}

TEST_F(RunFolderTest, HasWhereItsMapIs)
{
  Georeference georeference;
  georeference.origin = {49, 8.4, 115};
  georeference.T_enu_map = poseFromYpr(3, 4, 5, 1, 0, 0);
  georeference.fixes = 12;
  writeGeoreference(georeference, folder.file("monday/georeference.ini"));
  const std::string report = "{\"input\": \"" + folder.file("r.rawlog") + "\", \"gravity\": ";
  folder.write("monday/report.json",
               report +
                   "{\"directions\": 7, \"map_tilt_deg\": 36.87, \"map_tilt_sigma_deg\": 0.5, "
                   "\"up_map\": [0.6, 0, 0.8], \"fused\": false, \"levelled\": true}}");
  const auto runs = read({"monday", "tuesday"});
  const RunReferences& found = runs[0].references;
  ASSERT_TRUE(found.georeference);
  EXPECT_EQ(12U, found.georeference->fixes);
  ASSERT_TRUE(found.gravity);
  EXPECT_EQ(7U, found.gravity->directions);
  EXPECT_NEAR(0.6, found.gravity->up_map.x(), 1e-12);
  EXPECT_NEAR(0.5 * M_PI / 180, found.gravity->tilt_sigma, 1e-12);
  EXPECT_FALSE(found.gravity->fused);
  EXPECT_TRUE(found.gravity->levelled);
  EXPECT_FALSE(runs[1].references.georeference);
  EXPECT_FALSE(runs[1].references.gravity);

  folder.write("tuesday/report.json", report + "{\"directions\": \"some\"}}");
  EXPECT_TRUE(contains(said("tuesday"), "report.json: gravity has no number")) << said("tuesday");
  folder.write("tuesday/report.json",
               report +
                   "{\"directions\": 7, \"map_tilt_deg\": 1, \"map_tilt_sigma_deg\": 0.5, "
                   "\"up_map\": [0, 0, 2]}}");
  EXPECT_TRUE(contains(said("tuesday"), "gravity.up_map is no unit vector")) << said("tuesday");
}

TEST_F(RunFolderTest, HasTheFrameOfItsMap)
{
  const auto localise = [&](const std::string& run, const std::string& map, const char* localised)
  {
    folder.write(run + "/report.json", "{\"input\": \"" + folder.file("r.rawlog") +
                                           "\", \"prior_map\": {\"localised\": " + localised +
                                           "}}");
    folder.write(run + "/effective.ini",
                 "[input]\nskip_first_n = 0\n[preprocess]\ndeskew = none\n"
                 "[prior_map]\nfile = " +
                     map + "\n");
  };
  const auto frames = [&]
  {
    std::vector<std::string> names;
    for (const RunFolder& run : read({"monday", "tuesday", "week2/monday"}))
    {
      names.push_back(run.references.map_frame);
    }
    return names;
  };
  std::vector<std::string> found = frames();
  EXPECT_NE(found[0], found[1]);
  EXPECT_NE(found[0], found[2]);

  localise("tuesday", folder.file("monday"), "true");
  localise("week2/monday", folder.file("tuesday") + "/map_static.pcd", "true");
  found = frames();
  EXPECT_EQ(found[0], found[1]);
  EXPECT_EQ(found[0], found[2]) << "tuesday is in the frame of monday";

  localise("tuesday", folder.file("monday"), "false");
  EXPECT_NE(frames()[0], frames()[1]);
  localise("tuesday", folder.file("of_another_program.pcd"), "true");
  localise("week2/monday", folder.file("tuesday/../of_another_program.pcd"), "true");
  found = frames();
  EXPECT_NE(found[0], found[1]);
  EXPECT_EQ(found[1], found[2]);
  localise("tuesday", folder.file("tuesday"), "true");
  EXPECT_FALSE(frames()[1].empty()) << "a circle ends";
}

TEST_F(RunFolderTest, AGraphWithSatellitePositionsNeedsItsGeoreference)
{
  FactorGraph graph = test::graphOf(test::straightDrive(9, 1), 4);
  graph.addPose(Key::georeference(), Pose::Identity());
  writeFactorGraph(graph, folder.file("tuesday/factor_graph.txt"));
  EXPECT_TRUE(contains(said("tuesday"), "has no georeference.ini, which places"))
      << said("tuesday");
}

TEST_F(RunFolderTest, LabelsComeBeforeTracks)
{
  folder.write("monday/tracks.txt", "");
  folder.write("tuesday/tracks.txt", "");
  folder.write("tuesday/labels/000000.label", "");
  fs::create_directories(folder.file("monday/labels"));
  const auto runs = read({"monday", "tuesday"});
  EXPECT_EQ("", runs[0].scans.labels) << "there are none in it";
  EXPECT_EQ(folder.file("monday/tracks.txt"), runs[0].scans.tracks);
  EXPECT_EQ(folder.file("tuesday/labels"), runs[1].scans.labels);
  EXPECT_EQ("", runs[1].scans.tracks);
}

TEST_F(RunFolderTest, NamesDiffer)
{
  const auto runs = read({"monday", "tuesday", "week2/monday"});
  EXPECT_EQ(fs::path(folder.path()).filename().string() + "_monday", runs[0].name);
  EXPECT_EQ("tuesday", runs[1].name);
  EXPECT_EQ("week2_monday", runs[2].name);
}

TEST_F(RunFolderTest, AMovedRecordingIsGivenWithTheFolder)
{
  folder.write("moved.rawlog", "");
  const auto runs = read({"monday", "tuesday=" + folder.file("moved.rawlog")});
  EXPECT_EQ(folder.file("moved.rawlog"), runs[1].rawlog);
  EXPECT_EQ(folder.file("tuesday"), runs[1].folder);
  const RunArgument two_signs(folder.file("tuesday") + "=speed=10/moved.rawlog");
  EXPECT_EQ(folder.file("tuesday"), two_signs.folder);
  EXPECT_EQ("speed=10/moved.rawlog", two_signs.rawlog);
  fs::remove(folder.file("r.rawlog"));
  EXPECT_TRUE(contains(said("tuesday"), "r.rawlog: the recording of"));
}

TEST_F(RunFolderTest, WhatIsNoRunIsNamed)
{
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)read({"monday"}); }), "two runs"));
  EXPECT_TRUE(contains(said("none"), "none: is not a folder"));
  EXPECT_TRUE(contains(said("monday"), "is given twice"));
  for (const char* file :
       {"report.json", "trajectory_tum.txt", "factor_graph.txt", "motions.csv", "effective.ini"})
  {
    const std::string name = folder.file(std::string("tuesday/") + file);
    fs::rename(name, name + ".gone");
    EXPECT_TRUE(contains(said("tuesday"), std::string("has no ") + file)) << said("tuesday");
    fs::rename(name + ".gone", name);
  }
  folder.write("tuesday/effective.ini", "");
  EXPECT_TRUE(contains(messageOfError<UserError>(
                           [&] { (void)Config::fromFile(settingsOfRun(folder.file("tuesday"))); }),
                       "tuesday/effective.ini: is empty"));
  folder.write("tuesday/resume.state", "");
  fs::remove(folder.file("tuesday/motions.csv"));
  EXPECT_TRUE(contains(said("tuesday"),
                       "has no motions.csv, which has the times of the keyframes; "
                       "the run is unfinished: dyslam --resume -o "))
      << said("tuesday");
  folder.write("tuesday/report.json", "{\"input\": 7}");
  EXPECT_TRUE(contains(said("tuesday"), "does not name the recording"));
}

TEST_F(RunFolderTest, CompletesARecording)
{
  const std::string monday = folder.file("monday");
  RecordingOnTrajectory plain;
  completeFromRun(monday, plain);
  EXPECT_EQ(folder.file("r.rawlog"), plain.rawlog);
  EXPECT_EQ(folder.file("monday/trajectory_tum.txt"), plain.trajectory);
  EXPECT_EQ("", plain.scans.labels);
  EXPECT_EQ("", plain.scans.tracks);
  EXPECT_FALSE(plain.unfinished);
  folder.write("monday/labels/000000.label", "");
  folder.write("monday/tracks.txt", "");
  RecordingOnTrajectory full;
  completeFromRun(monday, full);
  EXPECT_EQ(folder.file("monday/labels"), full.scans.labels);
  EXPECT_EQ(folder.file("monday/tracks.txt"), full.scans.tracks);
  EXPECT_EQ(folder.file("monday/effective.ini"), settingsOfRun(monday));
  fs::remove(folder.file("monday/trajectory_tum.txt"));
  fs::remove(folder.file("monday/report.json"));
  RecordingOnTrajectory given;
  given.rawlog = "other.rawlog";
  given.trajectory = "other.txt";
  given.scans.labels = "other_labels";
  given.scans.tracks = "other_tracks.txt";
  completeFromRun(monday, given);
  EXPECT_EQ("other.rawlog", given.rawlog);
  EXPECT_EQ("other.txt", given.trajectory);
  EXPECT_EQ("other_labels", given.scans.labels);
  EXPECT_EQ("other_tracks.txt", given.scans.tracks);
}

TEST_F(RunFolderTest, ARecordingIsMovedWithItsFolder)
{
  folder.write("tuesday/recording.rawlog", "");
  folder.write("tuesday/report.json", "{\"input\": \"/before/tuesday/recording.rawlog\"}");
  RecordingOnTrajectory recording;
  completeFromRun(folder.file("tuesday"), recording);
  EXPECT_EQ(folder.file("tuesday/recording.rawlog"), recording.rawlog);
}

TEST_F(RunFolderTest, AnUnfinishedRunIsRecognised)
{
  folder.write("tuesday/report.json",
               "{\"input\": \"" + folder.file("r.rawlog") + "\", \"finished\": false}");
  RecordingOnTrajectory recording;
  completeFromRun(folder.file("tuesday"), recording);
  EXPECT_TRUE(recording.unfinished);
  RecordingOnTrajectory along_another;
  along_another.trajectory = "other.txt";
  completeFromRun(folder.file("tuesday"), along_another);
  EXPECT_FALSE(along_another.unfinished);
}

TEST_F(RunFolderTest, WhatARecordingLacksIsNamedWithItsFlag)
{
  const auto lacking = [&](const std::string& name)
  {
    return messageOfError<UserError>(
        [&]
        {
          RecordingOnTrajectory recording;
          completeFromRun(folder.file(name), recording);
          (void)settingsOfRun(folder.file(name));
        });
  };
  EXPECT_TRUE(contains(lacking("none"), "none: is not a folder")) << lacking("none");
  for (const auto& [file, flag] : {std::pair("report.json", "the recording with --input"),
                                   std::pair("trajectory_tum.txt", "them with --trajectory"),
                                   std::pair("effective.ini", "them with --config")})
  {
    const std::string name = folder.file(std::string("tuesday/") + file);
    fs::rename(name, name + ".gone");
    EXPECT_TRUE(contains(lacking("tuesday"), std::string("has no ") + file)) << lacking("tuesday");
    EXPECT_TRUE(contains(lacking("tuesday"), flag)) << lacking("tuesday");
    fs::rename(name + ".gone", name);
  }
  fs::remove(folder.file("r.rawlog"));
  EXPECT_TRUE(contains(lacking("monday"), "r.rawlog: the recording of")) << lacking("monday");
  EXPECT_TRUE(contains(lacking("monday"), "--input RECORDING")) << lacking("monday");
}

TEST_F(RunFolderTest, KeyframesOfAnotherRunAreNoticed)
{
  fs::copy_file(folder.file("monday/motions.csv"), folder.file("other.csv"));
  test::writeRunFolder(folder.file("tuesday"), folder.file("r.rawlog"), test::straightDrive(9, 1),
                       2);
  fs::copy_file(folder.file("other.csv"), folder.file("tuesday/motions.csv"),
                fs::copy_options::overwrite_existing);
  EXPECT_TRUE(contains(said("tuesday"), "has 3 keyframes, but factor_graph.txt has 5"));
}
}  // namespace
}  // namespace dyslam
