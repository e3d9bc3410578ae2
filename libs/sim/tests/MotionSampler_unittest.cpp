// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "TestScans.h"

namespace
{
using namespace dyslam;
using namespace dyslam::sim;

/** Options of a drive without sensor noise and with few rays. */
SimulatorOptions sampledDrive(WorldKind world, EgoKind ego = EgoKind::automatic)
{
  SimulatorOptions options = small(world, 0);
  options.sensor = SensorKind::vlp16;
  options.columns = 16;
  options.stops = false;
  options.noise = false;
  options.ego = ego;
  options.imu = true;
  options.wheels = ego != EgoKind::handheld;
  return options;
}

std::vector<SimulatedScan> simulated(const SimulatorOptions& options, int count, int threads = 1)
{
  Simulator simulator(options, threads);
  std::vector<SimulatedScan> scans;
  for (int i = 0; i < count; ++i)
  {
    scans.push_back(simulator.next());
  }
  return scans;
}

template <typename Sample>
std::vector<Sample> samplesOf(const std::vector<SimulatedScan>& scans,
                              std::vector<Sample> SimulatedScan::*member)
{
  std::vector<Sample> all;
  for (const SimulatedScan& scan : scans)
  {
    all.insert(all.end(), (scan.*member).begin(), (scan.*member).end());
  }
  return all;
}

bool sameSamples(const std::vector<ImuSample>& a, const std::vector<ImuSample>& b)
{
  bool same = a.size() == b.size();
  for (std::size_t i = 0; same && i < a.size(); ++i)
  {
    same = a[i].stamp == b[i].stamp && a[i].angular_velocity == b[i].angular_velocity &&
           a[i].acceleration == b[i].acceleration;
  }
  return same;
}

bool sameSamples(const std::vector<WheelSample>& a, const std::vector<WheelSample>& b)
{
  bool same = a.size() == b.size();
  for (std::size_t i = 0; same && i < a.size(); ++i)
  {
    same = a[i].stamp == b[i].stamp && a[i].forward_speed == b[i].forward_speed &&
           a[i].yaw_rate == b[i].yaw_rate;
  }
  return same;
}

/** Checks that the samples of one sensor lie after the previous scan's stamp, up to this one's. */
template <typename Sample>
void expectToFill(const std::vector<Sample>& samples,
                  std::size_t count,
                  double previous_stamp,
                  double stamp)
{
  ASSERT_EQ(count, samples.size());
  for (const Sample& sample : samples)
  {
    EXPECT_NEAR(sample.stamp - previous_stamp, 0.1 / static_cast<double>(count), 1e-6);
    previous_stamp = sample.stamp;
  }
  EXPECT_EQ(stamp, samples.back().stamp);
}

TEST(MotionSampler, SamplesFillTheTimeBetweenScans)
{
  const std::vector<SimulatedScan> scans = simulated(sampledDrive(WorldKind::campus), 4);
  EXPECT_TRUE(scans[0].imu.empty());
  EXPECT_TRUE(scans[0].wheels.empty());
  for (std::size_t i = 1; i < scans.size(); ++i)
  {
    const double before = scans[i - 1].scan.stamp, now = scans[i].scan.stamp;
    expectToFill(scans[i].imu, 10, before, now);
    expectToFill(scans[i].wheels, 5, before, now);
  }
}

// Samples are means over one step. Where the yaw rate jumps by 0.2 rad/s, at a vertex of the ego's
// path, the first and the last sample of an interval add an error of up to 7e-4 rad each.
TEST(MotionSampler, AngularVelocityAddsUpToTheRotation)
{
  for (const SimulatorOptions& options :
       {sampledDrive(WorldKind::urban), sampledDrive(WorldKind::campus),
        sampledDrive(WorldKind::campus, EgoKind::handheld)})
  {
    const std::vector<SimulatedScan> scans = simulated(options, 100);
    ImuSample last = scans[1].imu.back();
    Eigen::Matrix3d all = Eigen::Matrix3d::Identity();
    double turned = 0;
    for (std::size_t i = 2; i < scans.size(); ++i)
    {
      Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
      for (const ImuSample& sample : scans[i].imu)
      {
        rotation *= expSO3(0.5 * (last.angular_velocity + sample.angular_velocity) *
                           (sample.stamp - last.stamp));
        last = sample;
      }
      const Eigen::Matrix3d truth =
          scans[i - 1].T_map_vehicle.linear().transpose() * scans[i].T_map_vehicle.linear();
      EXPECT_LT(logSO3(rotation.transpose() * truth).norm(), 2e-3) << "scan " << i;
      turned += logSO3(truth).norm();
      all *= rotation;
    }
    const Eigen::Matrix3d truth =
        scans[1].T_map_vehicle.linear().transpose() * scans.back().T_map_vehicle.linear();
    EXPECT_GT(turned, 0.1);
    EXPECT_LT(logSO3(all.transpose() * truth).norm(), 2e-3);
  }
}

/** Change of velocity over all scans but the outermost ones, divided by its duration. */
Eigen::Vector3d meanAcceleration(const std::vector<SimulatedScan>& scans)
{
  const auto velocity = [&](std::size_t i) -> Eigen::Vector3d
  {
    return (scans[i + 1].T_map_vehicle.translation() - scans[i - 1].T_map_vehicle.translation()) /
           (scans[i + 1].scan.stamp - scans[i - 1].scan.stamp);
  };
  const std::size_t last = scans.size() - 2;
  return (velocity(last) - velocity(1)) / (scans[last].scan.stamp - scans[1].scan.stamp);
}

TEST(MotionSampler, AccelerationIsThatOfTheMotionAndGravity)
{
  for (const SimulatorOptions& options :
       {sampledDrive(WorldKind::urban), sampledDrive(WorldKind::campus, EgoKind::handheld)})
  {
    const std::vector<SimulatedScan> scans = simulated(options, 100);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0;
    for (std::size_t i = 2; i + 1 < scans.size(); ++i)
    {
      const double before = scans[i - 1].scan.stamp, period = scans[i].scan.stamp - before;
      for (const ImuSample& sample : scans[i].imu)
      {
        const Pose T_map_vehicle = interpolate(scans[i - 1].T_map_vehicle, scans[i].T_map_vehicle,
                                               (sample.stamp - before) / period);
        ASSERT_TRUE(sample.acceleration.has_value());
        sum += T_map_vehicle.linear() * *sample.acceleration;
        ++count;
      }
    }
    const Eigen::Vector3d error =
        sum / count - Eigen::Vector3d(0, 0, 9.81) - meanAcceleration(scans);
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 0.1) << error.transpose();
  }
}

TEST(MotionSampler, WheelSpeedAddsUpToTheForwardMotion)
{
  for (const WorldKind world : {WorldKind::urban, WorldKind::campus})
  {
    const std::vector<SimulatedScan> scans = simulated(sampledDrive(world), 100);
    WheelSample last = scans[1].wheels.back();
    double driven = 0, measured = 0;
    for (std::size_t i = 2; i < scans.size(); ++i)
    {
      double forward = 0;
      for (const WheelSample& sample : scans[i].wheels)
      {
        forward += 0.5 * (last.forward_speed + sample.forward_speed) * (sample.stamp - last.stamp);
        last = sample;
      }
      const Pose &before = scans[i - 1].T_map_vehicle, &now = scans[i].T_map_vehicle;
      const Eigen::Vector3d axis = (before.linear().col(0) + now.linear().col(0)).normalized();
      const double truth = axis.dot(now.translation() - before.translation());
      EXPECT_NEAR(forward, truth, 0.001 + 0.002 * truth) << toString(world) << " scan " << i;
      driven += truth;
      measured += forward;
    }
    EXPECT_GT(driven, 5) << toString(world);
    EXPECT_NEAR(measured, driven, 0.002 + 0.001 * driven) << toString(world);
  }
}

TEST(MotionSampler, YawRateOfTheWheelsIsThatOfTheImu)
{
  const std::vector<SimulatedScan> scans = simulated(sampledDrive(WorldKind::urban), 20);
  const auto imu = samplesOf(scans, &SimulatedScan::imu);
  const auto wheels = samplesOf(scans, &SimulatedScan::wheels);
  ASSERT_EQ(imu.size(), 2 * wheels.size());
  for (std::size_t i = 0; i < wheels.size(); ++i)
  {
    EXPECT_NEAR(wheels[i].yaw_rate, imu[2 * i + 1].angular_velocity.z(), 1e-9);
  }
}

struct Spread
{
  double mean = 0;
  double sigma = 0;
};

Spread spreadOf(const std::vector<double>& values)
{
  Spread spread;
  const auto count = static_cast<double>(values.size());
  for (const double value : values)
  {
    spread.mean += value / count;
  }
  for (const double value : values)
  {
    spread.sigma += (value - spread.mean) * (value - spread.mean) / count;
  }
  spread.sigma = std::sqrt(spread.sigma);
  return spread;
}

/** Checks for a constant bias below 3.5 standard deviations, and for white noise. */
void expectErrors(const std::vector<double>& errors, double bias, double noise)
{
  const Spread spread = spreadOf(errors);
  EXPECT_LT(std::abs(spread.mean), 3.5 * bias);
  EXPECT_GT(std::abs(spread.mean), 0.1 * bias);
  EXPECT_NEAR(spread.sigma, noise, 0.15 * noise);
}

TEST(MotionSampler, NoiseOfTheImu)
{
  SimulatorOptions options = sampledDrive(WorldKind::urban);
  const auto exact = samplesOf(simulated(options, 41), &SimulatedScan::imu);
  options.noise = true;
  const auto noisy = samplesOf(simulated(options, 41), &SimulatedScan::imu);
  ASSERT_EQ(exact.size(), noisy.size());
  for (int axis = 0; axis < 3; ++axis)
  {
    std::vector<double> turning, accelerating;
    for (std::size_t i = 0; i < exact.size(); ++i)
    {
      turning.push_back(noisy[i].angular_velocity[axis] - exact[i].angular_velocity[axis]);
      accelerating.push_back((*noisy[i].acceleration)[axis] - (*exact[i].acceleration)[axis]);
    }
    expectErrors(turning, 0.005, 0.002);
    expectErrors(accelerating, 0.1, 0.05);
  }
}

TEST(MotionSampler, NoiseOfTheWheels)
{
  SimulatorOptions options = sampledDrive(WorldKind::urban);
  const auto exact = samplesOf(simulated(options, 41), &SimulatedScan::wheels);
  options.noise = true;
  const auto noisy = samplesOf(simulated(options, 41), &SimulatedScan::wheels);
  ASSERT_EQ(exact.size(), noisy.size());
  double product = 0, square = 0;
  for (std::size_t i = 0; i < exact.size(); ++i)
  {
    product += exact[i].forward_speed * noisy[i].forward_speed;
    square += exact[i].forward_speed * exact[i].forward_speed;
  }
  const double scale = product / square;
  std::vector<double> speed, yaw_rate;
  for (std::size_t i = 0; i < exact.size(); ++i)
  {
    speed.push_back(noisy[i].forward_speed - scale * exact[i].forward_speed);
    yaw_rate.push_back(noisy[i].yaw_rate - exact[i].yaw_rate);
  }
  EXPECT_LT(std::abs(scale - 1), 0.035);
  EXPECT_GT(std::abs(scale - 1), 0.001);
  EXPECT_NEAR(spreadOf(speed).sigma, 0.02, 0.003);
  EXPECT_NEAR(spreadOf(yaw_rate).sigma, 0.01, 0.0015);
  EXPECT_LT(std::abs(spreadOf(yaw_rate).mean), 0.003);
}

TEST(MotionSampler, TheSeedDeterminesTheSamples)
{
  SimulatorOptions options = sampledDrive(WorldKind::urban);
  options.noise = true;
  const auto both = simulated(options, 5), on_three_threads = simulated(options, 5, 3);
  SimulatorOptions other = options;
  other.traffic_seed = 6;
  const auto of_other_seed = simulated(other, 5);
  SimulatorOptions only_imu = options, only_wheels = options;
  only_imu.wheels = false;
  only_wheels.imu = false;
  const auto imu = samplesOf(both, &SimulatedScan::imu);
  const auto wheels = samplesOf(both, &SimulatedScan::wheels);
  EXPECT_TRUE(sameSamples(imu, samplesOf(on_three_threads, &SimulatedScan::imu)));
  EXPECT_TRUE(sameSamples(wheels, samplesOf(on_three_threads, &SimulatedScan::wheels)));
  EXPECT_FALSE(sameSamples(imu, samplesOf(of_other_seed, &SimulatedScan::imu)));
  EXPECT_FALSE(sameSamples(wheels, samplesOf(of_other_seed, &SimulatedScan::wheels)));
  EXPECT_TRUE(sameSamples(imu, samplesOf(simulated(only_imu, 5), &SimulatedScan::imu)));
  EXPECT_TRUE(sameSamples(wheels, samplesOf(simulated(only_wheels, 5), &SimulatedScan::wheels)));
}

TEST(MotionSampler, ScansAreTheSameWithoutSamples)
{
  for (const WorldKind world : {WorldKind::urban, WorldKind::campus})
  {
    SimulatorOptions options = small(world, 0.6);
    const std::vector<SimulatedScan> without = simulated(options, 4);
    options.imu = true;
    options.wheels = true;
    const std::vector<SimulatedScan> with = simulated(options, 4);
    for (std::size_t i = 0; i < with.size(); ++i)
    {
      EXPECT_TRUE(sameScan(with[i], without[i])) << toString(world) << " scan " << i;
      EXPECT_EQ(with[i].scan.stamp, without[i].scan.stamp);
      EXPECT_TRUE(without[i].imu.empty() && without[i].wheels.empty());
      EXPECT_EQ(i == 0, with[i].imu.empty() || with[i].wheels.empty());
    }
  }
}

TEST(MotionSampler, AHandHeldSensorHasNoWheels)
{
  SimulatorOptions options = sampledDrive(WorldKind::campus, EgoKind::handheld);
  options.wheels = true;
  EXPECT_THROW(Simulator(options, 1), UserError);
}
}  // namespace
