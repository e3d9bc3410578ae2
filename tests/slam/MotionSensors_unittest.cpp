// SPDX-License-Identifier: BSD-3-Clause
// Gyroscope and wheel odometry on simulated drives.
#include <dyslam/pipeline/Pipeline.h>
#include <gtest/gtest.h>
#include <mrpt/system/CTimeLogger.h>

#include <string>
#include <vector>

#include "SimulatedFrames.h"

namespace dyslam
{
namespace
{
struct Outcome
{
  double error = 0;  //!< position error at the end, divided by the distance driven
  std::vector<std::string> warnings;
};

Outcome run(const std::vector<Frame>& frames)
{
  Config config = Config::fromText("[dyseg]\nmethod = none\n", "test");
  config.set("pipeline.tracking=false");
  config.set("pipeline.mapping=false");
  config.set("labels.hindsight=false");
  ConfigLoader loader(config);
  mrpt::system::CTimeLogger times(false);
  Pipeline pipeline(loader, times);
  Pose T_odom_vehicle = Pose::Identity();
  for (Frame frame : frames)
  {
    pipeline.process(frame);
    T_odom_vehicle = frame.T_odom_vehicle;
  }
  const Pose truth =
      frames.front().T_world_vehicle_truth->inverse() * *frames.back().T_world_vehicle_truth;
  const double error = (truth.translation() - T_odom_vehicle.translation()).norm();
  return {error / truth.translation().norm(), pipeline.warnings()};
}

void removeSamples(std::vector<Frame>& frames)
{
  for (Frame& frame : frames)
  {
    frame.wheels.clear();
    frame.imu.clear();
  }
}

sim::SimulatorOptions vlp16In(sim::WorldKind world, int seed)
{
  sim::SimulatorOptions options;
  options.world = world;
  options.sensor = sim::SensorKind::vlp16;
  options.columns = 900;
  options.traffic = 0.3;
  options.seed = seed;
  options.imu = true;
  return options;
}

TEST(MotionSensorsOnDrives, ShowTheMotionInATunnel)
{
  sim::SimulatorOptions options = vlp16In(sim::WorldKind::tunnel, 21);
  options.wheels = true;
  std::vector<Frame> frames = test::simulatedFrames(options, 20);
  EXPECT_LT(run(frames).error, 0.03);
  removeSamples(frames);
  EXPECT_GT(run(frames).error, 0.3) << "the walls alone do not show it";
}

TEST(MotionSensorsOnDrives, AnImuWithAWrongPoseDoesLittleHarm)
{
  sim::SimulatorOptions options = vlp16In(sim::WorldKind::campus, 7713);
  options.ego = sim::EgoKind::handheld;
  std::vector<Frame> frames = test::simulatedFrames(options, 60);
  const Outcome good = run(frames);
  EXPECT_TRUE(good.warnings.empty());
  for (Frame& frame : frames)
  {
    for (ImuSample& sample : frame.imu)
    {
      sample.T_vehicle_imu = poseFromYpr(0, 0, 0, 0.5 * M_PI, 0, M_PI);
    }
  }
  const Outcome wrong = run(frames);
  EXPECT_LT(wrong.error, good.error + 0.02);
  ASSERT_FALSE(wrong.warnings.empty());
  EXPECT_NE(wrong.warnings[0].find("its rotations are not those of the scans"), std::string::npos)
      << wrong.warnings[0];
}
}  // namespace
}  // namespace dyslam
