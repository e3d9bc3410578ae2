// SPDX-License-Identifier: BSD-3-Clause
// Recordings of dyslam-sim as stock MRPT reads them.
#include <gtest/gtest.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CRawlog.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "InterruptProgram.h"
#include "RunProgram.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** The observations of one class. */
template <typename Observation>
std::vector<std::shared_ptr<Observation>> ofClass(
    const std::vector<mrpt::obs::CObservation::Ptr>& observations)
{
  std::vector<std::shared_ptr<Observation>> found;
  for (const auto& observation : observations)
  {
    if (const auto one = std::dynamic_pointer_cast<Observation>(observation))
    {
      found.push_back(one);
    }
  }
  return found;
}

class SimRecording : public testing::Test
{
 protected:
  /** Simulates five scans, or other seconds. */
  [[nodiscard]] std::vector<mrpt::obs::CObservation::Ptr> recorded(
      const std::string& flags, const std::string& seconds = "0.5") const
  {
    const std::string path = folder_.file("x.rawlog");
    const Outcome outcome = runProgram("dyslam-sim",
                                       "--world campus --sensor VLP16 --columns 100 --loop 200 "
                                       "--no-flow -q --force --seconds " +
                                           seconds + " -o " + path + " " + flags,
                                       folder_.path());
    EXPECT_EQ(0, outcome.code) << outcome.err;
    mrpt::obs::CRawlog rawlog;
    EXPECT_TRUE(rawlog.loadFromRawLogFile(path));
    std::vector<mrpt::obs::CObservation::Ptr> observations;
    for (std::size_t i = 0; i < rawlog.size(); ++i)
    {
      observations.push_back(rawlog.getAsObservation(i));
    }
    return observations;
  }

  TestFolder folder_;
};

TEST_F(SimRecording, HasTheSamplesBetweenTheScansInOrderOfTime)
{
  const auto observations = recorded("--imu --wheels");
  EXPECT_TRUE(std::is_sorted(observations.begin(), observations.end(),
                             [](const auto& a, const auto& b)
                             { return a->timestamp < b->timestamp; }));
  const auto imu = ofClass<mrpt::obs::CObservationIMU>(observations);
  ASSERT_EQ(40U, imu.size());
  for (const auto& sample : imu)
  {
    EXPECT_TRUE(sample->has(mrpt::obs::IMU_WX));
    EXPECT_TRUE(sample->has(mrpt::obs::IMU_Z_ACC));
  }
  const auto wheels = ofClass<mrpt::obs::CObservationOdometry>(observations);
  ASSERT_EQ(20U, wheels.size());
  EXPECT_TRUE(wheels.front()->hasVelocities);
  const auto clouds = ofClass<mrpt::obs::CObservationPointCloud>(observations);
  ASSERT_FALSE(clouds.empty());
  EXPECT_EQ(clouds.back()->timestamp, imu.back()->timestamp);
  EXPECT_EQ(clouds.back()->timestamp, wheels.back()->timestamp);
  EXPECT_EQ(clouds.back(), observations.back());
}

TEST_F(SimRecording, HasThePositionsInOrderOfTime)
{
  const auto observations = recorded("--imu --wheels --gnss", "1.2");
  EXPECT_EQ(2U, ofClass<mrpt::obs::CObservationGPS>(observations).size());
  EXPECT_TRUE(std::is_sorted(observations.begin(), observations.end(),
                             [](const auto& a, const auto& b)
                             { return a->timestamp < b->timestamp; }));
}

TEST_F(SimRecording, HasOneScanAtLeast)
{
  EXPECT_FALSE(recorded("", "0.01").empty());
  const std::string poses = folder_.read("x.gt/poses_tum.txt");
  EXPECT_EQ(1, std::count(poses.begin(), poses.end(), '\n')) << poses;
}

TEST_F(SimRecording, OfABenchmarkSetOnlyFlagsThatApplyAreAccepted)
{
  for (const std::string flags : {"--gnss", "--only jam_empty --shard 2/3"})
  {
    const Outcome outcome =
        runProgram("dyslam-sim", flags + " --benchmark " + folder_.file("set"), folder_.path());
    EXPECT_NE(0, outcome.code) << flags;
    EXPECT_NE(std::string::npos, outcome.err.find("excludes")) << outcome.err;
  }
}

TEST_F(SimRecording, HasNoSamplesUnlessRequested)
{
  const auto observations = recorded("");
  EXPECT_TRUE(ofClass<mrpt::obs::CObservationIMU>(observations).empty());
  EXPECT_TRUE(ofClass<mrpt::obs::CObservationOdometry>(observations).empty());
}

TEST_F(SimRecording, OptionsAreInTheGroundTruth)
{
  (void)recorded("--imu");
  const std::string ini = folder_.read("x.gt/simulator.ini");
  EXPECT_NE(std::string::npos, ini.find("imu = true")) << ini;
  EXPECT_NE(std::string::npos, ini.find("wheels = false")) << ini;
}

TEST_F(SimRecording, InterruptedItLeavesTheEarlierOne)
{
  (void)recorded("--seed 1");
  const std::vector<std::string> files{"x.rawlog", "x.gt/simulator.ini", "x.gt/poses_tum.txt",
                                       "x.gt/labels/000000.label"};
  std::vector<std::string> earlier;
  for (const std::string& file : files)
  {
    earlier.push_back(folder_.read(file));
    EXPECT_FALSE(earlier.back().empty()) << file;
  }
  for (const std::string name : {"x", "new"})
  {
    const int code = interrupted({std::string(DYSLAM_BIN_DIR) + "/dyslam-sim", "--world", "campus",
                                  "--sensor", "VLP16", "--seed", "2", "--seconds", "10000", "-q",
                                  "--force", "-o", folder_.file(name + ".rawlog")},
                                 folder_.file("err.txt"), folder_.file(name + ".rawlog.tmp"));
    const std::string said = folder_.read("err.txt");
    EXPECT_EQ(1, code) << said;
    EXPECT_NE(std::string::npos, said.find(name + ".rawlog was not written")) << said;
    for (const char* ending : {".rawlog.tmp", ".gt.tmp"})
    {
      EXPECT_FALSE(std::filesystem::exists(folder_.file(name + ending))) << ending;
    }
  }
  for (std::size_t i = 0; i < files.size(); ++i)
  {
    EXPECT_TRUE(earlier[i] == folder_.read(files[i])) << files[i];
  }
  EXPECT_FALSE(std::filesystem::exists(folder_.file("new.rawlog")));
  EXPECT_FALSE(std::filesystem::exists(folder_.file("new.gt")));
}

TEST_F(SimRecording, AnInterruptedSeriesIsContinued)
{
  const std::string words =
      "--sensor VLP16 --columns 100 --loop 200 --seconds 0.1 --seed 4 -q -o " +
      folder_.file("series") + " --count ";
  ASSERT_EQ(0, runProgram("dyslam-sim", words + "1", folder_.path()).code);
  const std::string first = folder_.file("series/urban_VLP16_4.rawlog");
  const std::string second = folder_.file("series/urban_VLP16_5.rawlog");
  folder_.write("series/urban_VLP16_4.rawlog", "mine");
  const Outcome rest = runProgram("dyslam-sim", words + "2", folder_.path());
  EXPECT_EQ(0, rest.code) << rest.err;
  EXPECT_EQ(0U, rest.out.find(first + ": there already\n" + second + ": 1 scan, ")) << rest.out;
  EXPECT_EQ("mine", contentOf(first));

  const Outcome anew = runProgram("dyslam-sim", words + "1 --force", folder_.path());
  EXPECT_EQ(0U, anew.out.find(first + ": 1 scan, ")) << anew.out << anew.err;
  EXPECT_NE("mine", contentOf(first));
}

TEST_F(SimRecording, NumbersOutOfRangeNameTheFlag)
{
  for (const std::string flag : {"--traffic 7", "--seed -3", "--traffic-seed -3", "--speed 99",
                                 "--loop 1", "--start 3", "--start-time -1", "--columns 9999999",
                                 "--max-range 1000", "--mounting 181 0", "--mounting 0 -91"})
  {
    const Outcome outcome =
        runProgram("dyslam-sim", flag + " -o " + folder_.file("x.rawlog"), folder_.path());
    EXPECT_EQ(1, outcome.code) << flag;
    EXPECT_NE(std::string::npos, outcome.err.find(flag.substr(0, flag.find(' ')) + ":"))
        << outcome.err;
  }
}
}  // namespace
}  // namespace dyslam
