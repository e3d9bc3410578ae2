// SPDX-License-Identifier: BSD-3-Clause
// Recordings that begin in motion.
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/pipeline/StartSpeed.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>
#include <mrpt/system/CTimeLogger.h>

#include <vector>

namespace dyslam
{
namespace
{
struct Beginning
{
  std::vector<Frame> frames;
  double speed = 0;  //!< at the first scan [m/s]
};

Beginning simulate(const sim::SimulatorOptions& options, int scans = 10)
{
  sim::Simulator simulator(options, 2);
  Beginning result;
  for (int i = 0; i < scans; ++i)
  {
    auto simulated = simulator.next();
    Frame frame;
    frame.index = static_cast<std::size_t>(i);
    frame.T_world_vehicle_truth = simulated.T_map_vehicle;
    frame.scan = std::move(simulated.scan);
    frame.imu = std::move(simulated.imu);
    frame.wheels = std::move(simulated.wheels);
    result.frames.push_back(std::move(frame));
  }
  const Frame& first = result.frames.front();
  const Frame& second = result.frames[1];
  const Pose motion = first.T_world_vehicle_truth->inverse() * *second.T_world_vehicle_truth;
  result.speed = motion.translation().x() / (second.scan.stamp - first.scan.stamp);
  return result;
}

Config withoutNetwork()
{
  return Config::fromText("[dyseg]\nmethod = none\n", "test");
}

TEST(StartSpeed, IsFoundOnAHighwayThatLooksAlikeAllAlong)
{
  sim::SimulatorOptions options;
  options.world = sim::WorldKind::highway;
  options.sensor = sim::SensorKind::os1_64;
  options.columns = 1024;
  options.traffic = 0.3;
  options.seed = 21;
  const Beginning highway = simulate(options);
  ASSERT_GT(highway.speed, 20);
  const auto speed = findStartSpeed(highway.frames, withoutNetwork());
  ASSERT_TRUE(speed);
  EXPECT_NEAR(*speed, highway.speed, 2);
}

/** Error at the end over the distance driven. */
double relativeError(const std::vector<Frame>& frames)
{
  Config config = withoutNetwork();
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
  return (truth.translation() - T_odom_vehicle.translation()).norm() / truth.translation().norm();
}

TEST(StartSpeed, IsMeasuredByWheelsInATunnel)
{
  sim::SimulatorOptions options;
  options.world = sim::WorldKind::tunnel;
  options.sensor = sim::SensorKind::vlp16;
  options.traffic = 0.3;
  options.seed = 21;
  options.imu = true;
  options.wheels = true;
  Beginning tunnel = simulate(options, 20);
  EXPECT_FALSE(findStartSpeed(tunnel.frames, withoutNetwork())) << "it is not searched for";
  EXPECT_LT(relativeError(tunnel.frames), 0.03);
  for (Frame& frame : tunnel.frames)
  {
    frame.wheels.clear();
    frame.imu.clear();
  }
  EXPECT_GT(relativeError(tunnel.frames), 0.3) << "the walls alone do not show it";
}

TEST(StartSpeed, IsSearchedForWhereTheWheelsBeginLater)
{
  sim::SimulatorOptions options;
  options.world = sim::WorldKind::highway;
  options.sensor = sim::SensorKind::os1_64;
  options.columns = 1024;
  options.traffic = 0.3;
  options.seed = 21;
  options.wheels = true;
  Beginning highway = simulate(options);
  EXPECT_FALSE(findStartSpeed(highway.frames, withoutNetwork())) << "the wheels measure it";
  for (std::size_t i = 0; i < 6; ++i)
  {
    highway.frames[i].wheels.clear();
  }
  EXPECT_TRUE(findStartSpeed(highway.frames, withoutNetwork()));
}

TEST(StartSpeed, IsNotSearchedForInATown)
{
  sim::SimulatorOptions options;
  options.world = sim::WorldKind::urban;
  options.columns = 1024;
  options.seed = 11;
  const Beginning town = simulate(options);
  EXPECT_FALSE(findStartSpeed(town.frames, withoutNetwork()));
}

TEST(StartSpeed, IsNotSearchedForWhereItIsKnown)
{
  Config config = withoutNetwork();
  config.set("odometry.start_speed=3");
  EXPECT_FALSE(findStartSpeed(std::vector<Frame>(20), config));
}
}  // namespace
}  // namespace dyslam
