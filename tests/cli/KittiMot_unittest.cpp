// SPDX-License-Identifier: BSD-3-Clause
// dyslam-eval kitti-mot and speeds on a small folder of KITTI's layout made up here.
#include <dyslam/eval/TrackMetrics.h>
#include <dyslam/formats/KittiTracks.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
constexpr int frame_count = 60;
constexpr double frame_time = 0.1036;  // [s]
constexpr double ego_speed = 10;       // eastwards, as the vehicle is heading [m/s]

struct Actor
{
  ObjectClass object_class;
  Eigen::Vector2d start;  // in the first scan [m]
  Eigen::Vector2d velocity;
  Eigen::Vector3d size;
};

std::string contentOf(const fs::path& path)
{
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

class KittiMot : public ::testing::Test
{
 protected:
  static void SetUpTestSuite()
  {
    folder_ = fs::temp_directory_path() / ("dyslam_kitti_mot_" + std::to_string(::getpid()));
    for (const char* sub : {"calib", "oxts", "label_02", "det_pointrcnn"})
    {
      fs::create_directories(folder_ / sub);
    }
    std::ofstream(folder_ / "calib/0000.txt")
        << "P2: 700 0 600 0 0 700 180 0 0 0 1 0\nR_rect 1 0 0 0 1 0 0 0 1\n"
           "Tr_velo_cam 0 -1 0 0 0 0 -1 0 1 0 0 0\nTr_imu_velo 1 0 0 0 0 1 0 0 0 0 1 0\n";
    std::ofstream oxts(folder_ / "oxts/0000.txt");
    oxts.precision(15);
    for (int f = 0; f < frame_count; ++f)
    {
      const double east = ego_speed * frame_time * f;
      oxts << "0 " << east / 6378137.0 * 180 / M_PI << " 100 0 0 0 0 " << ego_speed << " "
           << ego_speed;
      for (int column = 9; column < 30; ++column)
      {
        oxts << " 0";
      }
      oxts << "\n";
    }
    writeScene();
  }
  static void TearDownTestSuite()
  {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  /** Labels, and detections with noise, misses and false alarms. */
  static void writeScene()
  {
    const std::vector<Actor> actors{
        {ObjectClass::car, {12, 3}, {10, 0}, {4.2, 1.8, 1.5}},
        {ObjectClass::car, {60, -4}, {-3, 0}, {3.9, 1.7, 1.5}},
        {ObjectClass::car, {40, 8}, {0, 0}, {4.4, 1.8, 1.6}},
        {ObjectClass::pedestrian, {50, -7}, {1.2, 0.2}, {0.7, 0.6, 1.8}}};
    std::mt19937 generator(11);
    std::normal_distribution<double> noise(0, 0.06);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<LabelledBox> labels;
    std::vector<LabelledBox> detections;
    for (int f = 0; f < frame_count; ++f)
    {
      const double t = f * frame_time;
      for (std::size_t i = 0; i < actors.size(); ++i)
      {
        LabelledBox box;
        box.frame = f;
        box.id = static_cast<int>(i);
        box.object_class = actors[i].object_class;
        const Eigen::Vector2d at =
            actors[i].start + t * (actors[i].velocity - Eigen::Vector2d(ego_speed, 0));
        if (at.x() < 5)
        {
          continue;
        }
        box.box.center = {at.x(), at.y(), -0.9};
        box.box.size = actors[i].size;
        box.image_box = {100.0 * static_cast<double>(i), 100, 100.0 * static_cast<double>(i) + 90,
                         200};
        labels.push_back(box);
        if (uniform(generator) < 0.1)
        {
          continue;
        }
        box.box.center += Eigen::Vector3d(noise(generator), noise(generator), 0);
        box.score = 4 + uniform(generator);
        detections.push_back(box);
      }
      if (f % 3 == 0)
      {
        LabelledBox box = labels.back();
        box.object_class = ObjectClass::car;
        box.box.center = {10 + 40 * uniform(generator), 20 * uniform(generator) - 10, -0.9};
        box.box.size = actors[0].size;
        box.score = 0.5 + uniform(generator);
        detections.push_back(box);
      }
    }
    const Pose T_cam_velo = readKittiCalib((folder_ / "calib/0000.txt").string()).T_cam_velo;
    writeKittiTracks((folder_ / "label_02/0000.txt").string(), labels, T_cam_velo);
    writeKittiTracks((folder_ / "det_pointrcnn/0000.txt").string(), detections, T_cam_velo);
  }

  /** Exit code of the command with `arguments`; what it says goes to the file `says`. */
  static int run(const std::string& arguments)
  {
    return evaluate("kitti-mot --data " + folder_.string() +
                    " --sequences 0000 --repeats 1 --class Car Pedestrian " + arguments);
  }

  /** Exit code of any of the program's commands; what it says goes to the file `says`. */
  static int evaluate(const std::string& arguments)
  {
    const std::string command = std::string(DYSLAM_BIN_DIR) + "/dyslam-eval " + arguments + " > " +
                                (folder_ / "says").string() + " 2>&1";
    return WEXITSTATUS(std::system(command.c_str()));
  }

  static inline fs::path folder_;
};
}  // namespace

TEST_F(KittiMot, WrittenTracksScoreAsThoseTracked)
{
  ASSERT_EQ(run("--tracks " + (folder_ / "tracks").string() + " --json " +
                (folder_ / "scores.json").string()),
            0)
      << contentOf(folder_ / "says");
  const auto json = nlohmann::json::parse(contentOf(folder_ / "scores.json"));
  const Pose T_cam_velo = readKittiCalib((folder_ / "calib/0000.txt").string()).T_cam_velo;
  TrackSequence sequence;
  sequence.frames = frame_count;
  sequence.reference =
      readKittiTracking((folder_ / "label_02/0000.txt").string(), T_cam_velo, true);
  sequence.estimate = readKittiTracking((folder_ / "tracks/0000.txt").string(), T_cam_velo);
  ASSERT_GT(sequence.estimate.size(), 100u);
  std::set<std::pair<int, int>> seen;
  int last_frame = 0;
  for (const LabelledBox& box : sequence.estimate)
  {
    EXPECT_TRUE(seen.emplace(box.frame, box.id).second) << "id twice in frame " << box.frame;
    EXPECT_GE(box.frame, last_frame);
    last_frame = box.frame;
  }
  for (const std::string type : {"Car", "Pedestrian"})
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

TEST_F(KittiMot, WrittenTracksReplaceNoInput)
{
  const std::string before = contentOf(folder_ / "det_pointrcnn/0000.txt");
  for (const char* input : {"det_pointrcnn", "label_02"})
  {
    EXPECT_EQ(run("--tracks " + (folder_ / input).string()), 1);
    EXPECT_NE(contentOf(folder_ / "says").find(": has the files that are read; choose another"),
              std::string::npos)
        << contentOf(folder_ / "says");
  }
  EXPECT_EQ(before, contentOf(folder_ / "det_pointrcnn/0000.txt"));
}

TEST_F(KittiMot, DropsFramesAndAddsNoiseOfItsSeed)
{
  const auto scores = [](const std::string& arguments)
  {
    EXPECT_EQ(run(arguments + " --json " + (folder_ / "s.json").string()), 0)
        << contentOf(folder_ / "says");
    auto json = nlohmann::json::parse(contentOf(folder_ / "s.json"));
    json["Car"].erase("frames_per_second");
    json["Pedestrian"].erase("frames_per_second");
    return json;
  };
  const auto all = scores("");
  EXPECT_EQ(all["Car"]["frames"], frame_count);
  EXPECT_EQ(scores("--every 3")["Car"]["frames"], frame_count / 3);
  const auto noisy = scores("--noise 0.3 --seed 5");
  EXPECT_EQ(noisy, scores("--noise 0.3 --seed 5"));
  EXPECT_NE(noisy, scores("--noise 0.3 --seed 6"));
  EXPECT_LT(noisy["Car"]["motp"].get<double>(), all["Car"]["motp"].get<double>());
}

TEST_F(KittiMot, TimesComeFromTheirFileAndAreChecked)
{
  fs::create_directories(folder_ / "times");
  std::ofstream(folder_ / "times/0000.txt") << "0\n0.1\n0.2\n";
  EXPECT_EQ(run(""), 1);
  EXPECT_NE(contentOf(folder_ / "says").find("times/0000.txt: has 3 times; oxts has 60 frames"),
            std::string::npos)
      << contentOf(folder_ / "says");
  std::ofstream(folder_ / "times/0000.txt") << "0\n0.1\n0.1\n";
  EXPECT_EQ(run(""), 1);
  EXPECT_NE(contentOf(folder_ / "says").find("0000.txt:3: the time does not come after"),
            std::string::npos);
  fs::remove_all(folder_ / "times");
}

TEST_F(KittiMot, PublishedFiguresAreOfPointRcnnsDetectionsOnly)
{
  const fs::path all = folder_ / "validation";
  for (const std::string name :
       {"0001", "0006", "0008", "0010", "0012", "0013", "0014", "0015", "0016", "0018", "0019"})
  {
    for (const char* sub : {"calib", "oxts", "label_02", "det_pointrcnn"})
    {
      fs::create_directories(all / sub);
      fs::copy_file(folder_ / sub / "0000.txt", all / sub / (name + ".txt"));
    }
  }
  const std::string command = "kitti-mot --repeats 1 --class Car --data " + all.string();
  ASSERT_EQ(evaluate(command), 0) << contentOf(folder_ / "says");
  EXPECT_NE(contentOf(folder_ / "says").find("AB3DMOT, published"), std::string::npos);
  const std::string given = command + " --detections " + (all / "det_pointrcnn").string();
  ASSERT_EQ(evaluate(given), 0) << contentOf(folder_ / "says");
  EXPECT_EQ(contentOf(folder_ / "says").find("AB3DMOT"), std::string::npos);
}

TEST_F(KittiMot, SpeedsCountTheFramesOfTheirError)
{
  const fs::path data = folder_ / "speeds";
  for (const char* sub : {"calib", "oxts", "label_02"})
  {
    fs::create_directories(data / sub);
    fs::copy_file(folder_ / sub / "0000.txt", data / sub / "0000.txt");
  }
  fs::create_directories(data / "det_pointrcnn/Car");
  fs::copy_file(folder_ / "det_pointrcnn/0000.txt", data / "det_pointrcnn/Car/0000.txt");
  // The labels of the car give true speeds of frames 5 to 35 or so.
  std::ofstream(data / "series.csv") << "time,speed\n1.036,3\n2.072,3\n51.8,3\n";
  ASSERT_EQ(evaluate("speeds --sequence 0000 --track 1 --data " + data.string() +
                     " --series given=" + (data / "series.csv").string() + " --csv " +
                     (data / "table.csv").string()),
            0)
      << contentOf(folder_ / "says");
  std::istringstream rows(contentOf(data / "table.csv"));
  std::string row;
  while (std::getline(rows, row) && row.rfind("given,", 0) != 0)
  {
  }
  EXPECT_EQ(row.substr(row.rfind(',') + 1), "2") << row;
}

TEST_F(KittiMot, DetectionsWithoutScoreAreAnError)
{
  fs::create_directories(folder_ / "other");
  std::ofstream(folder_ / "other/0000.txt")
      << "0 1 Car 0 0 0.3 100 150 200 250 1.5 1.8 4.0 0.5 1.6 20 -1.5\n";
  EXPECT_EQ(run("--detections " + (folder_ / "other").string()), 1);
  EXPECT_NE(contentOf(folder_ / "says").find("other/0000.txt:1: has no score"), std::string::npos)
      << contentOf(folder_ / "says");
}
}  // namespace dyslam
