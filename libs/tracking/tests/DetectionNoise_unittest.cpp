// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/tracking/DetectionNoise.h>
#include <gtest/gtest.h>

#include <cmath>

using namespace dyslam;

namespace
{
Box boxAt(double range, double azimuth)
{
  Box box;
  box.centre = {range * std::cos(azimuth), range * std::sin(azimuth), -0.8};
  box.yaw = 0.4;
  return box;
}
}  // namespace

TEST(DetectionNoise, AxesFollowTheBearing)
{
  const DetectionNoiseOptions options;
  const double radial = std::pow(0.08 + 0.005 * 20, 2);
  const double tangential = std::pow(0.05 + 0.0015 * 20, 2);
  const Eigen::Matrix4d ahead = detectionCovariance(boxAt(20, 0), ObjectClass::car, options);
  EXPECT_NEAR(ahead(0, 0), radial, 1e-12);
  EXPECT_NEAR(ahead(1, 1), tangential, 1e-12);
  EXPECT_NEAR(ahead(3, 3), std::pow((2 + 0.08 * 20) * M_PI / 180, 2), 1e-12);
  const Eigen::Matrix4d left = detectionCovariance(boxAt(20, M_PI / 2), ObjectClass::car, options);
  EXPECT_NEAR(left(0, 0), tangential, 1e-12);
  EXPECT_NEAR(left(1, 1), radial, 1e-12);
  const Eigen::Matrix4d oblique = detectionCovariance(boxAt(20, 0.7), ObjectClass::car, options);
  const Eigen::Vector2d sight(std::cos(0.7), std::sin(0.7));
  EXPECT_NEAR(sight.dot(oblique.topLeftCorner<2, 2>() * sight), radial, 1e-12);
  EXPECT_NEAR(oblique.trace(), ahead.trace(), 1e-12);
  EXPECT_GT(std::abs(oblique(0, 1)), 1e-3);
}

TEST(DetectionNoise, IsMeasuredFromTheSensorAndByClass)
{
  DetectionNoiseOptions options;
  options.pedestrian.radial_sigma = 0.3;
  options.sigma_scale = 2;
  const Box box = boxAt(10, 0);
  const Eigen::Matrix4d walker =
      detectionCovariance(box, ObjectClass::pedestrian, options, {10, -5});
  // Seen from the side at 5 m: radial is y.
  EXPECT_NEAR(walker(1, 1), 4 * std::pow(0.3 + 0.001 * 5, 2), 1e-12);
  EXPECT_NE(detectionCovariance(box, ObjectClass::cyclist, options)(0, 0),
            detectionCovariance(box, ObjectClass::car, options)(0, 0));
  EXPECT_TRUE(detectionCovariance(boxAt(0, 0), ObjectClass::car, options).allFinite());
}

TEST(DetectionNoise, OptionsRoundTripThroughText)
{
  DetectionNoiseOptions options;
  options.cyclist.radial_sigma = 0.123;
  options.vehicle.yaw_sigma_per_range = 0.01;
  Config config;
  save(options, config, "detection_noise");
  DetectionNoiseOptions loaded;
  load(loaded, Config::fromText(config.toIni(), "test"), "detection_noise");
  EXPECT_DOUBLE_EQ(loaded.cyclist.radial_sigma, 0.123);
  EXPECT_NEAR(loaded.vehicle.yaw_sigma_per_range, 0.01, 1e-10);
  EXPECT_DOUBLE_EQ(loaded.pedestrian.tangential_sigma, options.pedestrian.tangential_sigma);
}

TEST(DetectionNoise, ARenamedKeyIsNamed)
{
  Config config;
  config.set("detection_noise.vehicle_yaw_deg=3");
  DetectionNoiseOptions options;
  try
  {
    load(options, config, "detection_noise");
    FAIL();
  }
  catch (const UserError& error)
  {
    EXPECT_STREQ(error.what(),
                 "--set detection_noise.vehicle_yaw_deg: [detection_noise] vehicle_yaw_deg was "
                 "renamed to vehicle_yaw_sigma_deg");
  }
}
