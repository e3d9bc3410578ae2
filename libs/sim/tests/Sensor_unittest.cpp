// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace
{
using namespace dyslam;
using namespace dyslam::sim;
constexpr double kDegree = M_PI / 180;

TEST(Sensor, BeamTablesMatchTheDataSheets)
{
  const auto check = [](SensorKind kind, std::size_t beams, double lowest, double highest)
  {
    const SensorModel m = sensorModel(kind);
    ASSERT_EQ(m.beams.size(), beams) << m.name;
    EXPECT_NEAR(m.beams.front().elevation, lowest * kDegree, 0.02 * kDegree) << m.name;
    EXPECT_NEAR(m.beams.back().elevation, highest * kDegree, 0.02 * kDegree) << m.name;
    for (std::size_t i = 1; i < beams; ++i)
    {
      EXPECT_GT(m.beams[i].elevation, m.beams[i - 1].elevation) << m.name << " ring " << i;
    }
    for (const Beam& b : m.beams)
    {
      EXPECT_GE(b.fire_time, 0) << m.name;
      EXPECT_LT(b.fire_time, 1.001 * m.period / m.columns) << m.name;
    }
  };
  check(SensorKind::hdl64e, 64, -24.33, 2.0);
  check(SensorKind::hdl32e, 32, -30.67, 10.67);
  check(SensorKind::vlp16, 16, -15, 15);
  check(SensorKind::vlp32c, 32, -25, 15);
  check(SensorKind::vls128, 128, -25, 15);
  check(SensorKind::os1_64, 64, -22.5, 22.5);
  check(SensorKind::os1_32, 32, -22.5, 22.5);
  check(SensorKind::os1_128, 128, -22.5, 22.5);
  check(SensorKind::pandar64, 64, -25, 15);
  check(SensorKind::xt32, 32, -16, 15);
}

TEST(Sensor, VelodyneFiringTimesMatchTheDataSheet)
{
  // VLP-16: laser ids 0..15 have elevations -15, 1, -13, 3, ... and fire every 2.304 us.
  const SensorModel m = sensorModel(SensorKind::vlp16);
  EXPECT_NEAR(m.beams[0].fire_time, 0, 1e-12);
  EXPECT_NEAR(m.beams[8].elevation, 1 * kDegree, 1e-9);
  EXPECT_NEAR(m.beams[8].fire_time, 2.304e-6, 1e-12);
  EXPECT_NEAR(m.beams[1].fire_time, 2 * 2.304e-6, 1e-12);
  EXPECT_NEAR(m.beams[15].fire_time, 15 * 2.304e-6, 1e-12);
}

TEST(Sensor, AzimuthsOfTheLasersAreClockwiseInVelodynesTables)
{
  // VLP-32C: laser 0 at -25 degrees is 1.4 degrees ahead of the head, which turns clockwise; laser
  // 1 fires with it, laser 2 next. VLS-128: laser 0 at -11.742 degrees and 6.354 degrees ahead.
  const SensorModel m = sensorModel(SensorKind::vlp32c);
  EXPECT_NEAR(m.beams[0].azimuth_offset, -1.4 * kDegree, 1e-9);
  EXPECT_NEAR(m.beams[0].fire_time, 0, 1e-12);
  const auto beam_at = [](const SensorModel& model, double elevation)
  {
    return *std::find_if(model.beams.begin(), model.beams.end(),
                         [&](const Beam& b)
                         { return std::abs(b.elevation - elevation * kDegree) < 1e-6; });
  };
  EXPECT_NEAR(beam_at(m, -1.667).fire_time, 2.304e-6, 1e-12);
  const Beam first = beam_at(sensorModel(SensorKind::vls128), -11.742);
  EXPECT_NEAR(first.azimuth_offset, -6.354 * kDegree, 1e-9);
  EXPECT_NEAR(first.fire_time, 0, 1e-12);
}

TEST(Sensor, SweepIsClockwiseAndFacesForwardAtTheStamp)
{
  const SensorModel m = sensorModel(SensorKind::hdl64e);
  EXPECT_NEAR(m.azimuth(0), 180 * kDegree, 1e-9);
  EXPECT_NEAR(m.azimuth(0.5 * m.columns), 0, 1e-9);
  EXPECT_NEAR(m.columnTime(0.5 * m.columns), 0, 1e-12);
  EXPECT_NEAR(m.columnTime(0), -0.05, 1e-12);
  EXPECT_NEAR(m.azimuth(0.75 * m.columns), -90 * kDegree, 1e-9);
}

TEST(Sensor, NamesRoundTripAndErrorsSuggestTheNearest)
{
  for (const auto kind :
       {SensorKind::hdl64e, SensorKind::hdl32e, SensorKind::vlp16, SensorKind::vlp32c,
        SensorKind::vls128, SensorKind::os1_32, SensorKind::os1_64, SensorKind::os1_128,
        SensorKind::pandar64, SensorKind::xt32, SensorKind::avia})
  {
    EXPECT_EQ(sensorKindFromString(toString(kind)), kind);
  }
  EXPECT_EQ(sensorKindFromString("hdl64e"), SensorKind::hdl64e);
  EXPECT_THROW((void)sensorKindFromString("HDL65E"), UserError);
  EXPECT_THROW((void)worldKindFromString("town"), UserError);
  EXPECT_EQ(worldKindFromString("tunnel"), WorldKind::tunnel);
  EXPECT_EQ(worldKindFromString(toString(WorldKind::downtown)), WorldKind::downtown);
  EXPECT_EQ(worldKindFromString(toString(WorldKind::indoor)), WorldKind::indoor);
  EXPECT_EQ(egoKindFromString("robot"), EgoKind::robot);
  EXPECT_THROW((void)egoKindFromString("lorry"), UserError);
}

TEST(SimulatorOptions, RejectsValuesOutOfRange)
{
  SimulatorOptions options;
  options.traffic = 1.5;
  EXPECT_THROW(Simulator{options}, UserError);
  options.traffic = 0.5;
  options.loop_length = -1;
  EXPECT_THROW(Simulator{options}, UserError);
}

TEST(SimulatorOptions, RoundTripThroughText)
{
  SimulatorOptions options;
  options.world = WorldKind::campus;
  options.sensor = SensorKind::os1_128;
  options.traffic = 0.123456789;
  options.seed = 77;
  options.ego = EgoKind::handheld;
  options.motion_distortion = false;
  Config config;
  save(options, config, "simulator");
  SimulatorOptions again;
  load(again, Config::fromText(config.toIni(), "test"), "simulator");
  EXPECT_EQ(again.world, options.world);
  EXPECT_EQ(again.sensor, options.sensor);
  EXPECT_DOUBLE_EQ(again.traffic, options.traffic);
  EXPECT_EQ(again.seed, options.seed);
  EXPECT_EQ(again.ego, options.ego);
  EXPECT_FALSE(again.motion_distortion);
}

TEST(Sensor, PointsMatchTheirBeamAndTime)
{
  SimulatorOptions options;
  options.sensor = SensorKind::vlp16;
  options.columns = 360;
  options.traffic = 0.3;
  Simulator simulator(options);
  const SensorModel& m = simulator.sensor();
  const SimulatedScan scan = simulator.next();
  ASSERT_GT(scan.scan.size(), 1000U);
  std::set<int> rings;
  for (std::size_t i = 0; i < scan.scan.size(); ++i)
  {
    const Eigen::Vector3d p = scan.scan.points[i].cast<double>();
    const Beam& beam = m.beams[scan.scan.ring[i]];
    rings.insert(scan.scan.ring[i]);
    EXPECT_NEAR(std::atan2(p.z(), p.head<2>().norm()), beam.elevation, 0.1 * kDegree);
    // The head rotates between the column's start and this beam's firing.
    const double azimuth = -2 * 180 * kDegree * static_cast<double>(scan.scan.time[i]) / m.period;
    EXPECT_NEAR(std::remainder(std::atan2(p.y(), p.x()) - azimuth, 360 * kDegree), 0,
                0.02 * kDegree);
    EXPECT_GE(scan.scan.intensity[i], 0);
    EXPECT_LE(scan.scan.intensity[i], 1);
  }
  EXPECT_GT(rings.size(), 12U);
}

TEST(Sensor, PrismsFillTheFieldOfViewAndDoNotRepeat)
{
  SimulatorOptions options;
  options.sensor = SensorKind::avia;
  options.traffic = 0;
  Simulator simulator(options);
  const SensorModel& m = simulator.sensor();
  EXPECT_FALSE(m.spins());
  // 240000 points per second.
  EXPECT_NEAR(static_cast<double>(m.beams.size()) * m.columns / m.period, 240000, 1);
  double left = 0, up = 0, down = 0;
  for (int c = 0; c < 10 * m.columns; ++c)
  {
    const double time = m.period * c / m.columns;
    left = std::max(left, m.throughPrisms(time, m.beams[0]).azimuth);
    down = std::min(down, m.throughPrisms(time, m.beams.front()).elevation);
    up = std::max(up, m.throughPrisms(time, m.beams.back()).elevation);
  }
  EXPECT_NEAR(2 * left, 70.4 * kDegree, 0.3 * kDegree);
  EXPECT_NEAR(up - down, 77.2 * kDegree, 0.3 * kDegree);

  const RayAngles first = m.throughPrisms(0.01, m.beams[2]);
  const RayAngles later = m.throughPrisms(0.01 + m.period, m.beams[2]);
  EXPECT_GT(std::hypot(first.azimuth - later.azimuth, first.elevation - later.elevation),
            5 * kDegree);

  // Points lie in the direction of their beam at their time.
  const SimulatedScan scan = simulator.next();
  ASSERT_GT(scan.scan.size(), 5000U);
  EXPECT_TRUE(scan.scan.ring.empty());
  for (std::size_t i = 0; i < scan.scan.size(); i += 50)
  {
    const Eigen::Vector3d p = scan.scan.points[i].cast<double>().normalized();
    double nearest = 1;
    for (const Beam& beam : m.beams)
    {
      const double time = 0.5 * m.period + static_cast<double>(scan.scan.time[i]);
      const RayAngles a = m.throughPrisms(time, beam);
      const Eigen::Vector3d ray(std::cos(a.elevation) * std::cos(a.azimuth),
                                std::cos(a.elevation) * std::sin(a.azimuth), std::sin(a.elevation));
      nearest = std::min(nearest, (ray - p).norm());
    }
    EXPECT_LT(nearest, 0.05 * kDegree);
  }
}
}  // namespace
