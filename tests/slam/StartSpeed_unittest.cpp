// SPDX-License-Identifier: BSD-3-Clause
// Recordings that begin in motion.
#include <dyslam/pipeline/StartSpeed.h>
#include <gtest/gtest.h>

#include <vector>

#include "SimulatedFrames.h"

namespace dyslam
{
namespace
{
struct Beginning
{
  std::vector<Frame> frames;
  double speed = 0;  //!< speed at the first scan [m/s]
};

Beginning simulate(const sim::SimulatorOptions& options)
{
  Beginning result;
  result.frames = test::simulatedFrames(options, 10);
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

sim::SimulatorOptions uniformHighway()
{
  sim::SimulatorOptions options;
  options.world = sim::WorldKind::highway;
  options.sensor = sim::SensorKind::os1_64;
  options.columns = 1024;
  options.traffic = 0.3;
  options.seed = 21;
  return options;
}

TEST(StartSpeed, IsFoundOnAHighwayThatLooksAlikeAllAlong)
{
  const Beginning highway = simulate(uniformHighway());
  ASSERT_GT(highway.speed, 20);
  const auto speed = findStartSpeed(highway.frames, withoutNetwork());
  ASSERT_TRUE(speed);
  EXPECT_NEAR(*speed, highway.speed, 2);
}

TEST(StartSpeed, IsSearchedForWhereTheWheelsBeginLater)
{
  sim::SimulatorOptions options = uniformHighway();
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
