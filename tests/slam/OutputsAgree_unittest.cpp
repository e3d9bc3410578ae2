// SPDX-License-Identifier: BSD-3-Clause
// All outputs of a run show the same objects: replay, tables, labels and scene.
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/run/RunSlam.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>
#include <mrpt/obs/CObservation3DScene.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CText.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
constexpr int town_scans = 40;

/** A row of tracks.csv. */
struct Row
{
  Box box;  //!< box, odometry frame
  bool vehicle = false;
  double course = 0;  //!< direction of motion, odometry frame [rad]
  double speed = 0;   //!< [m/s]
  bool dynamic = false;
  bool observed = false;
};
using Rows = std::map<int, Row>;  // rows of a frame by the object's id

std::vector<std::string> fieldsOf(const std::string& line)
{
  std::vector<std::string> fields;
  std::stringstream text(line);
  for (std::string field; std::getline(text, field, ',');)
  {
    fields.push_back(field);
  }
  return fields;
}

/** Reads tracks.csv. \return rows by frame */
std::vector<Rows> readTable(const fs::path& path)
{
  std::vector<Rows> frames(town_scans);
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line,
            "frame,stamp,id,class,x,y,z,length,width,height,yaw,vx,vy,vz,speed,dynamic,observed,"
            "score");
  while (std::getline(file, line))
  {
    const auto f = fieldsOf(line);
    const auto number = [&](std::size_t i) { return std::stod(f.at(i)); };
    Row row;
    row.box.centre = {number(4), number(5), number(6)};
    row.box.size = {number(7), number(8), number(9)};
    row.box.yaw = number(10);
    row.vehicle = isVehicle(objectClassFromString(f.at(3)));
    row.course = std::atan2(number(12), number(11));
    row.speed = number(14);
    row.dynamic = f.at(15) == "1";
    row.observed = f.at(16) == "1";
    frames.at(std::stoul(f[0]))[std::stoi(f[2])] = row;
  }
  return frames;
}

/** A box in a scan's scene in the replay. */
struct DrawnBox
{
  mrpt::math::TPose3D pose;  //!< pose, vehicle frame
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
  double speed = 0;
};

std::map<int, DrawnBox> boxesOf(const mrpt::opengl::COpenGLScene& scene)
{
  std::map<int, DrawnBox> boxes;
  mrpt::opengl::CSetOfLines::Ptr box;  // box whose text follows
  for (const auto& object : *scene.getViewport())
  {
    if (const auto lines = std::dynamic_pointer_cast<mrpt::opengl::CSetOfLines>(object))
    {
      box = lines;
    }
    const auto text = std::dynamic_pointer_cast<mrpt::opengl::CText>(object);
    char kind[32];
    int id = 0;
    DrawnBox drawn;
    if (!text ||
        std::sscanf(text->getString().c_str(), "%31s %d: %lf", kind, &id, &drawn.speed) != 3)
    {
      continue;
    }
    drawn.pose = box->getPose();
    for (const auto& line : *box)
    {
      const Eigen::Vector3d corner(line.point2.x, line.point2.y, line.point2.z);
      drawn.size = drawn.size.cwiseMax(2 * corner);
    }
    EXPECT_TRUE(boxes.emplace(id, drawn).second) << "object " << id << " is drawn twice";
  }
  return boxes;
}

/** Reads a replay. \return boxes by frame and object's id */
std::vector<std::map<int, DrawnBox>> readReplay(const fs::path& path)
{
  std::vector<std::map<int, DrawnBox>> frames;
  mrpt::obs::CRawlog rawlog;
  EXPECT_TRUE(rawlog.loadFromRawLogFile(path.string()));
  for (std::size_t i = 0; i < rawlog.size(); ++i)
  {
    const auto scene =
        std::dynamic_pointer_cast<mrpt::obs::CObservation3DScene>(rawlog.getAsObservation(i));
    if (scene)
    {
      frames.push_back(boxesOf(*scene->scene));
    }
  }
  return frames;
}

/** The instances of a .label file minus 1. */
std::set<int> idsOf(const fs::path& path)
{
  std::set<int> ids;
  for (const Label label : readLabels(path.string()))
  {
    if (instanceOf(label) > 0)
    {
      ids.insert(instanceOf(label) - 1);
    }
  }
  return ids;
}

class OutputsAgree : public ::testing::Test
{
 protected:
  static void SetUpTestSuite()
  {
    folder_ = fs::temp_directory_path() / ("dyslam_outputs_agree_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    SlamRunSettings settings;
    settings.rawlog = (folder_ / "town.rawlog").string();
    settings.output_folder = (folder_ / "run").string();
    settings.labels = true;
    settings.config =
        Config::fromFile(std::string(DYSLAM_SOURCE_DIR) + "/share/dyslam/config_files/vlp16.ini");
    settings.config.set("labels.hindsight=false");    // all other outputs are causal
    settings.config.set("track_smoothing.window=0");  // the objects of the replay are causal
    writeTown(settings.rawlog);
    report_ = runSlam(settings);
    ASSERT_EQ(report_.frames, static_cast<std::size_t>(town_scans));
    table_ = readTable(folder_ / "run" / "tracks.csv");
    settings.config.set("labels.hindsight=true");
    settings.config.set("track_smoothing.window=1.5");
    settings.output_folder = (folder_ / "hindsight").string();
    ASSERT_EQ(runSlam(settings).frames, static_cast<std::size_t>(town_scans));
    settings.config.set("track_smoothing.window=0");
    settings.output_folder = (folder_ / "not_smoothed").string();
    ASSERT_EQ(runSlam(settings).frames, static_cast<std::size_t>(town_scans));
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static void writeTown(const std::string& path)
  {
    sim::SimulatorOptions options;
    options.sensor = sim::SensorKind::vlp16;
    options.columns = 900;
    options.traffic = 0.5;
    options.seed = 11;
    sim::Simulator simulator(options, 1);
    RawlogWriter writer(path);
    for (int i = 0; i < town_scans; ++i)
    {
      const auto simulated = simulator.next();
      writer.write(simulated.scan, simulated.T_map_vehicle);
    }
    writer.close();
  }

  static fs::path folder_;
  static std::vector<Rows> table_;
  static SlamRunReport report_;  //!< of the run of table_
};
fs::path OutputsAgree::folder_;
std::vector<Rows> OutputsAgree::table_;
SlamRunReport OutputsAgree::report_;

/** The last scan of each object in a table. */
std::map<int, std::size_t> lastScans(const std::vector<Rows>& table)
{
  std::map<int, std::size_t> last;
  for (std::size_t frame = 0; frame < table.size(); ++frame)
  {
    for (const auto& [id, row] : table[frame])
    {
      last[id] = frame;
    }
  }
  return last;
}

/** Every box of the replay is in the table, except those predicted after the last observation.
 * \return the number of boxes by scan. */
std::vector<std::size_t> expectInTable(const fs::path& run, const std::vector<Rows>& table)
{
  std::vector<std::size_t> boxes;
  const std::map<int, std::size_t> last = lastScans(table);
  const auto replay = readReplay(run / "replay.rawlog");
  const Trajectory odometry = readTum((run / "odometry_tum.txt").string());
  EXPECT_EQ(replay.size(), table.size());
  EXPECT_EQ(odometry.size(), table.size());
  for (std::size_t frame = 0; frame < std::min(replay.size(), table.size()); ++frame)
  {
    boxes.push_back(replay[frame].size());
    for (const auto& [id, drawn] : replay[frame])
    {
      const auto found = table[frame].find(id);
      if (found == table[frame].end())
      {
        EXPECT_TRUE(last.count(id) == 1 && last.at(id) < frame) << frame << " " << id;
        continue;
      }
      const Row& row = found->second;
      const Pose T_vehicle_odom = odometry[frame].pose.inverse();
      const Eigen::Vector3d centre = T_vehicle_odom * row.box.centre;
      const Eigen::Vector3d heading =
          T_vehicle_odom.linear() *
          Eigen::Vector3d(std::cos(row.box.yaw), std::sin(row.box.yaw), 0);
      const Eigen::Vector3d at(drawn.pose.x, drawn.pose.y, drawn.pose.z);
      EXPECT_LT((at - centre).norm(), 0.002) << frame << " " << id;
      EXPECT_NEAR(std::cos(drawn.pose.yaw - std::atan2(heading.y(), heading.x())), 1, 1e-6);
      EXPECT_LT((drawn.size - row.box.size).norm(), 0.02) << frame << " " << id;
      EXPECT_NEAR(drawn.speed, row.speed, 0.051) << frame << " " << id;
    }
  }
  return boxes;
}

TEST_F(OutputsAgree, ReplayAndTable)
{
  const std::vector<std::size_t> boxes = expectInTable(folder_ / "run", table_);
  for (std::size_t frame = 0; frame < boxes.size(); ++frame)
  {
    EXPECT_EQ(boxes[frame], table_[frame].size()) << frame;
  }
  EXPECT_GT(std::accumulate(boxes.begin(), boxes.end(), std::size_t{0}), 20U)
      << "the town has traffic";
}

// The table contains objects from their first observation to their last.
TEST_F(OutputsAgree, ReplayAndTableWithHindsight)
{
  const fs::path run = folder_ / "not_smoothed";
  const std::vector<std::size_t> boxes = expectInTable(run, readTable(run / "tracks.csv"));
  EXPECT_GT(std::accumulate(boxes.begin(), boxes.end(), std::size_t{0}), 20U);
}

TEST_F(OutputsAgree, TheTwoTables)
{
  std::size_t rows = 0;
  for (const LabelledBox& box : readTracks((folder_ / "run" / "tracks.txt").string()))
  {
    EXPECT_EQ(table_.at(static_cast<std::size_t>(box.frame)).count(box.id), 1U);
    ++rows;
  }
  std::size_t expected = 0;
  for (const Rows& frame : table_)
  {
    expected += frame.size();
  }
  EXPECT_EQ(rows, expected);
}

TEST_F(OutputsAgree, LabelsAndTable)
{
  std::size_t seen = 0;
  for (std::size_t frame = 0; frame < table_.size(); ++frame)
  {
    std::set<int> expected;
    for (const auto& [id, row] : table_[frame])
    {
      if (row.observed)
      {
        expected.insert(id);
      }
    }
    seen += expected.size();
    char name[32];
    std::snprintf(name, sizeof name, "%06zu.label", frame);
    EXPECT_EQ(idsOf(folder_ / "run" / "labels" / name), expected) << frame;
  }
  EXPECT_GT(seen, 20U);
}

// The number of moving objects is not that of the ids of the table.
TEST_F(OutputsAgree, NumbersOfObjectsAreThoseOfTheTable)
{
  std::set<int> reported;
  std::set<int> moving;
  for (const Rows& rows : table_)
  {
    for (const auto& [id, row] : rows)
    {
      reported.insert(id);
      if (row.dynamic)
      {
        moving.insert(id);
      }
    }
  }
  EXPECT_GT(moving.size(), 2U);
  EXPECT_EQ(report_.reported_tracks, reported.size());
  EXPECT_EQ(report_.tracks, moving.size());
}

// Objects of the second tracking are in all outputs from their first observation on.
TEST_F(OutputsAgree, LabelsAndTableWithHindsight)
{
  const std::vector<Rows> table = readTable(folder_ / "hindsight" / "tracks.csv");
  std::map<int, std::size_t> first;
  std::size_t seen = 0;
  std::size_t driving = 0;
  for (std::size_t frame = 0; frame < table.size(); ++frame)
  {
    std::set<int> expected;
    for (const auto& [id, row] : table[frame])
    {
      if (row.observed)
      {
        expected.insert(id);
      }
      if (first.emplace(id, frame).second)
      {
        EXPECT_TRUE(row.observed) << "object " << id;
      }
      if (row.vehicle && row.speed > 2.1)
      {
        EXPECT_GT(std::cos(row.box.yaw - row.course), 0.9) << "object " << id << ", " << frame;
        ++driving;
      }
    }
    seen += expected.size();
    char name[32];
    std::snprintf(name, sizeof name, "%06zu.label", frame);
    EXPECT_EQ(idsOf(folder_ / "hindsight" / "labels" / name), expected) << frame;
  }
  EXPECT_GT(seen, 20U);
  EXPECT_GT(driving, 5U);
}

// The outputs agree also if the tables are not smoothed.
TEST_F(OutputsAgree, TheTwoTablesWithHindsight)
{
  for (const char* run : {"hindsight", "not_smoothed"})
  {
    const std::vector<Rows> table = readTable(folder_ / run / "tracks.csv");
    std::vector<std::set<int>> expected(table.size());
    std::vector<std::set<int>> found(table.size());
    for (std::size_t frame = 0; frame < table.size(); ++frame)
    {
      for (const auto& [id, row] : table[frame])
      {
        expected[frame].insert(id);
      }
    }
    for (const LabelledBox& box : readTracks((folder_ / run / "tracks.txt").string()))
    {
      found.at(static_cast<std::size_t>(box.frame)).insert(box.id);
    }
    EXPECT_EQ(found, expected) << run;
  }
}

TEST_F(OutputsAgree, SceneAndTable)
{
  std::set<int> expected;
  for (const Rows& frame : table_)
  {
    for (const auto& [id, row] : frame)
    {
      if (row.dynamic)
      {
        expected.insert(id);
      }
    }
  }
  ASSERT_FALSE(expected.empty());
  mrpt::opengl::COpenGLScene scene;
  ASSERT_TRUE(scene.loadFromFile((folder_ / "run" / "map.3Dscene").string()));
  std::set<int> drawn;
  for (const auto& object : *scene.getViewport())
  {
    int id = 0;
    int length = 0;
    const std::string name = object->getName();
    if (std::sscanf(name.c_str(), "object %d%n", &id, &length) == 1 &&
        static_cast<std::size_t>(length) == name.size())
    {
      drawn.insert(id);
    }
  }
  EXPECT_EQ(drawn, expected);
}
}  // namespace
}  // namespace dyslam
