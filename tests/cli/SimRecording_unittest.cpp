// SPDX-License-Identifier: BSD-3-Clause
// Recordings of dyslam-sim as stock MRPT reads them.
#include <gtest/gtest.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CRawlog.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

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
  /** Simulates five scans. */
  [[nodiscard]] std::vector<mrpt::obs::CObservation::Ptr> recorded(const std::string& flags) const
  {
    const std::string path = folder_.file("x.rawlog");
    const Outcome outcome = runProgram("dyslam-sim",
                                       "--world campus --sensor VLP16 --columns 100 --loop 200 "
                                       "--seconds 0.5 --no-flow -q --force -o " +
                                           path + " " + flags,
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
}  // namespace
}  // namespace dyslam
