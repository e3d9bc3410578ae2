// SPDX-License-Identifier: BSD-3-Clause
// Tracking and speeds on a small synthetic folder in KITTI's layout.
#include <dyslam/base/Error.h>
#include <dyslam/base/Options.h>
#include <dyslam/benchmarks/KittiMot.h>
#include <dyslam/benchmarks/KittiSlam.h>
#include <dyslam/benchmarks/KittiSpeeds.h>
#include <dyslam/eval/TrackMetrics.h>
#include <dyslam/formats/KittiTracks.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "KittiScene.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

class KittiMot : public ::testing::Test
{
 protected:
  KittiMot()
  {
    writeKittiScene(folder_.path());
    setup_.data = folder_.path();
    setup_.detections = folder_.file("det_pointrcnn");
    Config config = Config::fromFile(std::string(DYSLAM_SOURCE_DIR) +
                                     "/share/dyslam/config_files/kitti_mot.ini");
    load(setup_.tracker, config, "tracker");
    load(setup_.noise, config, "detection_noise");
  }

  /** Error message of tracking. */
  std::string refusal() const
  {
    return messageOfError<UserError>([&] { (void)runKittiMot(setup_, {"0000"}, "Car"); });
  }

  TestFolder folder_;
  KittiMotSetup setup_;
};
}  // namespace

TEST_F(KittiMot, WrittenTracksScoreAsThoseTracked)
{
  const std::vector<std::string> types{"Car", "Pedestrian"};
  std::vector<KittiMotRun> runs;
  NamedKittiMotScores scores;
  for (const std::string& type : types)
  {
    runs.push_back(runKittiMot(setup_, {"0000"}, type));
    scores.emplace_back(type, kittiMotScores(runs.back(), TrackRules::kitti(type)));
  }
  writeKittiMot(folder_.file("tracks"), folder_.path(), {"0000"}, runs);
  const auto json = nlohmann::json::parse(kittiMotJson(scores));
  const Pose T_cam_velo = readKittiCalib(folder_.file("calib/0000.txt")).T_cam_velo;
  TrackSequence sequence;
  sequence.frames = kitti_scene_frames;
  sequence.reference = readKittiTracking(folder_.file("label_02/0000.txt"), T_cam_velo, true);
  sequence.estimate = readKittiTracking(folder_.file("tracks/0000.txt"), T_cam_velo);
  ASSERT_GT(sequence.estimate.size(), 100u);
  std::set<std::pair<int, int>> seen;
  int last_frame = 0;
  for (const LabelledBox& box : sequence.estimate)
  {
    EXPECT_TRUE(seen.emplace(box.frame, box.id).second) << "id twice in frame " << box.frame;
    EXPECT_GE(box.frame, last_frame);
    last_frame = box.frame;
  }
  for (const std::string& type : types)
  {
    const TrackRules rules = TrackRules::kitti(type);
    const RecallAverages averages = averagesOverRecall({sequence}, rules);
    EXPECT_GT(averages.samota, 0.5) << type;
    EXPECT_NEAR(averages.samota, json[type]["samota"].get<double>(), 1e-12) << type;
    EXPECT_NEAR(averages.amotp, json[type]["amotp"].get<double>(), 1e-9) << type;
    EXPECT_NEAR(averages.best.mota, json[type]["mota"].get<double>(), 1e-12) << type;
    EXPECT_NEAR(hota(tracksAbove({sequence}, averages.best.threshold), rules).hota,
                json[type]["hota"].get<double>(), 1e-9)
        << type;
  }
}

TEST_F(KittiMot, AveragesOfFewBoxesAreNull)
{
  const NamedKittiMotScores scores{
      {"Cyclist",
       kittiMotScores(runKittiMot(setup_, {"0000"}, "Cyclist"), TrackRules::kitti("Cyclist"))}};
  const auto cyclists = nlohmann::json::parse(kittiMotJson(scores))["Cyclist"];
  EXPECT_EQ(cyclists["references"], 0);
  EXPECT_TRUE(cyclists["samota"].is_null());
  EXPECT_TRUE(cyclists["mota"].is_null());
  EXPECT_FALSE(contains(kittiMotTable(scores, "chosen", false).toText(), "sAMOTA"));
}

TEST_F(KittiMot, AClassWithoutTracksIsExplained)
{
  const auto warning = [&](const std::string& type)
  { return kittiMotWarning(setup_, runKittiMot(setup_, {"0000"}, type), type); };
  EXPECT_EQ(warning("Car"), "");
  EXPECT_EQ(warning("Cyclist"),
            setup_.detections + ": has no detections of the class Cyclist in these sequences");
  setup_.tracker.vehicle.birth_score = 50;
  EXPECT_TRUE(runKittiMot(setup_, {"0000"}, "Car").sequences[0].estimate.empty());
  EXPECT_TRUE(contains(warning("Car"),
                       ": no score of a Car reaches tracker.vehicle_birth_score = "
                       "50 (the highest is "))
      << warning("Car");
}

TEST_F(KittiMot, DropsFramesAndAddsNoiseOfItsSeed)
{
  const auto scores = [&](int every, double noise, int seed)
  {
    KittiMotSetup setup = setup_;
    setup.every = every;
    setup.added_noise = noise;
    setup.seed = seed;
    return kittiMotScores(fastestKittiMot(setup, {"0000"}, "Car", 2), TrackRules::kitti("Car"));
  };
  const KittiMotScores all = scores(1, 0, 1);
  EXPECT_EQ(all.frames, kitti_scene_frames);
  EXPECT_GT(all.frames_per_second, 0);
  EXPECT_EQ(scores(3, 0, 1).frames, kitti_scene_frames / 3);
  const KittiMotScores noisy = scores(1, 0.3, 5);
  EXPECT_EQ(noisy.averages.best.motp, scores(1, 0.3, 5).averages.best.motp);
  EXPECT_NE(noisy.averages.best.motp, scores(1, 0.3, 6).averages.best.motp);
  EXPECT_LT(noisy.averages.best.motp, all.averages.best.motp);
}

TEST_F(KittiMot, WrittenFramesHaveTheNumbersOfTheData)
{
  setup_.every = 3;
  writeKittiMot(folder_.file("every"), folder_.path(), {"0000"},
                {runKittiMot(setup_, {"0000"}, "Car")});
  const Pose T_cam_velo = readKittiCalib(folder_.file("calib/0000.txt")).T_cam_velo;
  int last_frame = 0;
  for (const LabelledBox& box : readKittiTracking(folder_.file("every/0000.txt"), T_cam_velo))
  {
    EXPECT_EQ(box.frame % 3, 0) << box.frame;
    last_frame = std::max(last_frame, box.frame);
  }
  EXPECT_GT(last_frame, kitti_scene_frames / 3);
}

TEST_F(KittiMot, TimesComeFromTheirFileAndAreChecked)
{
  folder_.write("times/0000.txt", "0\n0.1\n0.2\n");
  EXPECT_TRUE(contains(refusal(), "times/0000.txt: has 3 times; oxts has 60 frames"));
  folder_.write("times/0000.txt", "0\n0.1\n0.1\n");
  EXPECT_TRUE(contains(refusal(), "0000.txt:3: the time does not come after"));
}

TEST_F(KittiMot, DetectionsWithoutScoreAreAnError)
{
  folder_.write("other/0000.txt", "0 1 Car 0 0 0.3 100 150 200 250 1.5 1.8 4.0 0.5 1.6 20 -1.5\n");
  setup_.detections = folder_.file("other");
  EXPECT_TRUE(contains(refusal(), "other/0000.txt:1: has no score"));
}

TEST_F(KittiMot, MissingDetectionsNameBothLayouts)
{
  folder_.write("ab3dmot/pointrcnn_Car_val/0000.txt", "");
  setup_.detections = folder_.file("ab3dmot");
  EXPECT_TRUE(contains(refusal(), "ab3dmot: has neither 0000.txt nor Car/0000.txt")) << refusal();
}

TEST_F(KittiMot, PublishedFiguresAreShownIfAskedFor)
{
  const NamedKittiMotScores scores{{"Car", {}}, {"Pedestrian", {}}};
  EXPECT_EQ(kittiMotTable(scores, "chosen", false).rows(), 2U);
  const Table both = kittiMotTable(scores, "validation", true);
  EXPECT_EQ(both.rows(), 6U);
  EXPECT_TRUE(contains(both.toText(), "AB3DMOT, published"));
  EXPECT_TRUE(contains(both.toText(), "93.34"));
}

TEST_F(KittiMot, SpeedsCountTheFramesOfTheirError)
{
  fs::create_directories(folder_.file("det_pointrcnn/Car"));
  fs::copy_file(folder_.file("det_pointrcnn/0000.txt"), folder_.file("det_pointrcnn/Car/0000.txt"));
  KittiSpeedSources sources;
  sources.data = folder_.path();
  sources.sequence = "0000";
  sources.track = 1;
  // The labels of the car give true speeds for about the frames 5 to 35.
  sources.series.emplace_back(
      "given", folder_.write("series.csv", "time,speed\n1.036,3\n2.072,3\n51.8,3\n"));
  const std::vector<NamedSpeeds> speeds = kittiSpeeds(sources);
  ASSERT_EQ(speeds.size(), 5U);
  EXPECT_EQ(speeds.back().name, "labels");
  EXPECT_NEAR(speeds.back().speeds.at(10), 3, 0.01) << "of the car that comes nearer";
  const std::string csv = speedReport(sources, speeds).table.toCsv();
  const std::size_t row = csv.find("\ngiven,");
  ASSERT_NE(row, std::string::npos) << csv;
  const std::string given = csv.substr(row + 1, csv.find('\n', row + 1) - row - 1);
  EXPECT_EQ(given.substr(given.rfind(',') + 1), "2") << given;
  EXPECT_FALSE(contains(csv, "labels"));

  // Also a series with the name of the labels.
  sources.series.front().first = "labels";
  EXPECT_TRUE(contains(speedReport(sources, kittiSpeeds(sources)).table.toCsv(), "\nlabels,"));

  sources.series = {{"other", folder_.write("other.csv", "speed,time\n1,2\n")}};
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)kittiSpeeds(sources); }),
                       "the first line must be time,speed"));
}

TEST(KittiSlam, ErrorsOfNoVehicleAreNotZero)
{
  const KittiObjectErrors errors = kittiObjectErrors({}, {}, {});
  EXPECT_EQ(errors.count, 0U);
  EXPECT_TRUE(std::isnan(errors.smoothed_position));
  EXPECT_TRUE(std::isnan(errors.tracked_speed));
}
}  // namespace dyslam
