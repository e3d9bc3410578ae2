// SPDX-License-Identifier: BSD-3-Clause
// Recordings that begin in motion.
#include <dyslam/pipeline/StartSpeed.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>

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

Beginning simulate(const sim::SimulatorOptions& options)
{
  sim::Simulator simulator(options, 2);
  Beginning result;
  for (int i = 0; i < 10; ++i)
  {
    auto simulated = simulator.next();
    Frame frame;
    frame.index = static_cast<std::size_t>(i);
    frame.T_world_vehicle_truth = simulated.T_map_vehicle;
    frame.scan = std::move(simulated.scan);
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
