// SPDX-License-Identifier: BSD-3-Clause
#include "DysegPairs.h"

#include <dyslam/base/Error.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

namespace
{
dyslam::DysegTrainerOptions simulatedOnly()
{
  dyslam::DysegTrainerOptions options;
  options.simulated_share = 1;
  options.few_beams_share = 1;
  options.campus_share = 0;
  options.highway_share = 1;  // simulated fastest
  options.same_scan_share = 0;
  return options;
}

/** Tenths of a second between the scans of some pairs. */
std::multiset<int> gapsOf(const dyslam::DysegPairs& pairs)
{
  std::multiset<int> gaps;
  for (std::uint64_t i = 0; i < 20; ++i)
  {
    dyslam::RandomDraws draws(1, i);
    gaps.insert(static_cast<int>(pairs.draw(draws).elapsed * 10 + 0.5));
  }
  return gaps;
}

TEST(DysegPairs, AShareIsAsFarApartAsInTheApplication)
{
  auto options = simulatedOnly();
  options.gap_share = 1;
  dyslam::DysegPairs all(options);
  EXPECT_EQ(all.summary(), "simulated clips");
  all.prepare(0);
  EXPECT_EQ(gapsOf(all).count(8), 20U);

  options.gap_share = 0;
  dyslam::DysegPairs any(options);
  any.prepare(0);
  const auto gaps = gapsOf(any);
  EXPECT_LT(gaps.count(8), 10U);
  EXPECT_GE(*gaps.begin(), 1);
  EXPECT_LE(*gaps.rbegin(), 10);
}

TEST(DysegPairs, WithoutDataIsAnErrorBeforeTheTraining)
{
  auto options = simulatedOnly();
  options.simulated_share = 0;
  EXPECT_THROW(dyslam::DysegPairs{options}, dyslam::UserError);
}

/** Scenes of a training's first clips, by world. */
std::map<dyslam::sim::WorldKind, std::vector<dyslam::DysegClipScene>> scenes(
    const dyslam::DysegTrainerOptions& options, std::uint64_t count)
{
  std::map<dyslam::sim::WorldKind, std::vector<dyslam::DysegClipScene>> by_world;
  for (std::uint64_t i = 0; i < count; ++i)
  {
    const auto scene = dyslam::trainingScene(i, options);
    by_world[scene.world].push_back(scene);
  }
  return by_world;
}

TEST(TrainingScene, WorldsHaveTheirShares)
{
  dyslam::DysegTrainerOptions options;
  options.campus_share = 0.3;
  options.highway_share = 0.4;
  const auto by_world = scenes(options, 4000);
  using dyslam::sim::WorldKind;
  EXPECT_NEAR(static_cast<double>(by_world.at(WorldKind::campus).size()), 0.3 * 4000, 120);
  EXPECT_NEAR(static_cast<double>(by_world.at(WorldKind::highway).size()), 0.7 * 0.4 * 4000, 120);
}

TEST(TrainingScene, CityCentresReplaceTheirShareOfTheStreets)
{
  dyslam::DysegTrainerOptions options;
  options.campus_share = 0.2;
  options.highway_share = 0.25;
  using dyslam::sim::WorldKind;
  const auto before = scenes(options, 4000);
  EXPECT_EQ(before.count(WorldKind::downtown), 0U);
  options.downtown_share = 0.5;
  const auto after = scenes(options, 4000);
  for (const auto world : {WorldKind::campus, WorldKind::highway})
  {
    ASSERT_EQ(after.at(world).size(), before.at(world).size());
    for (std::size_t i = 0; i < after.at(world).size(); ++i)
    {
      EXPECT_EQ(after.at(world)[i].traffic, before.at(world)[i].traffic);
      EXPECT_EQ(after.at(world)[i].ego_speed, before.at(world)[i].ego_speed);
      EXPECT_EQ(after.at(world)[i].columns, before.at(world)[i].columns);
    }
  }
  EXPECT_EQ(after.at(WorldKind::urban).size() + after.at(WorldKind::downtown).size(),
            before.at(WorldKind::urban).size());
  EXPECT_NEAR(static_cast<double>(after.at(WorldKind::downtown).size()), 0.8 * 0.75 * 0.5 * 4000,
              120);
  for (const auto& scene : after.at(WorldKind::downtown))
  {
    EXPECT_TRUE(scene.traffic >= 0.2 && scene.traffic <= 1) << scene.traffic;
    EXPECT_TRUE(scene.ego_speed >= 3 && scene.ego_speed <= 13) << scene.ego_speed;
    EXPECT_EQ(scene.ego, dyslam::sim::EgoKind::automatic);
  }
}

TEST(TrainingScene, OtherSensorsReplaceTheirShareOfTheHdl64)
{
  dyslam::DysegTrainerOptions options;
  options.few_beams_share = 0.25;
  const auto before = scenes(options, 4000);
  options.other_sensors_share = 0.4;
  const auto after = scenes(options, 4000);
  std::map<dyslam::sim::SensorKind, int> by_sensor;
  for (const auto& [world, of_world] : after)
  {
    ASSERT_EQ(of_world.size(), before.at(world).size());
    for (std::size_t i = 0; i < of_world.size(); ++i)
    {
      ++by_sensor[of_world[i].sensor];
      // The rest of the scene, and scenes with 16 beams, are as without other sensors.
      EXPECT_EQ(of_world[i].columns, before.at(world)[i].columns);
      EXPECT_EQ(of_world[i].ego_speed, before.at(world)[i].ego_speed);
      EXPECT_EQ(of_world[i].sensor == dyslam::sim::SensorKind::vlp16,
                before.at(world)[i].sensor == dyslam::sim::SensorKind::vlp16);
    }
  }
  using dyslam::sim::SensorKind;
  EXPECT_NEAR(by_sensor[SensorKind::vlp16], 1000, 120);
  EXPECT_NEAR(by_sensor[SensorKind::hdl64e], 1800, 150);
  for (const SensorKind other : {SensorKind::os1_64, SensorKind::os1_128, SensorKind::pandar64})
  {
    EXPECT_NEAR(by_sensor[other], 400, 80);
  }
}

TEST(TrainingScene, OtherSensorsAreThoseOfTheOption)
{
  dyslam::DysegTrainerOptions options;
  options.other_sensors_share = 0.5;
  options.other_sensors = "vls128";
  using dyslam::sim::SensorKind;
  std::set<SensorKind> sensors;
  for (const auto& [world, of_world] : scenes(options, 200))
  {
    for (const auto& scene : of_world)
    {
      sensors.insert(scene.sensor);
    }
  }
  EXPECT_EQ(sensors, (std::set{SensorKind::hdl64e, SensorKind::vlp16, SensorKind::vls128}));
  for (const char* wrong : {"OS1-65", ""})
  {
    options.other_sensors = wrong;
    options.data.clear();
    try
    {
      const dyslam::DysegPairs pairs(options);
      ADD_FAILURE() << "no error for \"" << wrong << '"';
    }
    catch (const dyslam::UserError& error)
    {
      EXPECT_EQ(std::string(error.what()).rfind("[train] other_sensors: ", 0), 0U) << error.what();
    }
  }
}

TEST(TrainingScene, HalfOfTheClipsHaveFewerColumns)
{
  dyslam::DysegTrainerOptions options;
  options.campus_share = 0.5;
  options.few_beams_share = 0.5;
  int full = 0;
  std::set<int> of_few;
  std::set<int> of_many;
  for (std::uint64_t i = 0; i < 4000; ++i)
  {
    const auto scene = dyslam::trainingScene(i, options);
    full += scene.columns == 0 ? 1 : 0;
    (scene.sensor == dyslam::sim::SensorKind::vlp16 ? of_few : of_many).insert(scene.columns);
  }
  EXPECT_NEAR(full, 2000, 150);
  EXPECT_EQ(of_few, (std::set<int>{0, 900}));
  ASSERT_GT(of_many.size(), 300U);
  EXPECT_GE(*std::next(of_many.begin()), 400);
  EXPECT_LT(*std::next(of_many.begin()), 420);
  EXPECT_LE(*of_many.rbegin(), 1024);
  EXPECT_GT(*of_many.rbegin(), 1004);
}

TEST(TrainingScene, TrafficAndSpeedSuitTheWorld)
{
  dyslam::DysegTrainerOptions options;
  options.campus_share = 0.3;
  options.highway_share = 0.5;
  const auto by_world = scenes(options, 3000);
  using dyslam::sim::EgoKind;
  using dyslam::sim::WorldKind;
  int light = 0;
  for (const auto& scene : by_world.at(WorldKind::urban))
  {
    EXPECT_TRUE(scene.traffic >= 0.03 && scene.traffic <= 1) << scene.traffic;
    EXPECT_TRUE(scene.ego_speed >= 5 && scene.ego_speed <= 15) << scene.ego_speed;
    EXPECT_EQ(scene.ego, EgoKind::automatic);
    light += scene.traffic < 0.3 ? 1 : 0;
  }
  EXPECT_GT(light, static_cast<int>(by_world.at(WorldKind::urban).size() * 45 / 100));
  for (const auto& scene : by_world.at(WorldKind::highway))
  {
    EXPECT_TRUE(scene.traffic >= 0.05 && scene.traffic <= 1) << scene.traffic;
    EXPECT_TRUE(scene.ego_speed >= 15 && scene.ego_speed <= 32) << scene.ego_speed;
  }
  int handheld = 0;
  for (const auto& scene : by_world.at(WorldKind::campus))
  {
    const bool carried = scene.ego == EgoKind::handheld;
    EXPECT_TRUE(scene.traffic >= 0.3 && scene.traffic <= 1) << scene.traffic;
    EXPECT_TRUE(scene.ego_speed >= 1 && scene.ego_speed <= (carried ? 2 : 5)) << scene.ego_speed;
    handheld += carried ? 1 : 0;
  }
  const auto campuses = static_cast<int>(by_world.at(WorldKind::campus).size());
  EXPECT_GT(handheld, campuses / 5);
  EXPECT_LT(handheld, campuses * 2 / 5);
}

TEST(DysegPairs, ClipsOfAStepDoNotDependOnTheStepsBefore)
{
  auto options = simulatedOnly();
  options.simulated_pool = 2;
  options.simulate_every = 1;
  dyslam::DysegPairs going(options);
  for (int step = 0; step <= 3; ++step)
  {
    going.prepare(step);
  }
  dyslam::DysegPairs resumed(options);
  resumed.prepare(3);
  for (std::uint64_t i = 0; i < 5; ++i)
  {
    dyslam::RandomDraws a(1, i);
    dyslam::RandomDraws b(1, i);
    EXPECT_TRUE(going.draw(a).current == resumed.draw(b).current);
  }
}
}  // namespace
