// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Deskew.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace dyslam
{
namespace
{
TEST(SweepMotion, TakesPointsAlongTheScrewAndBack)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int run = 0; run < 200; ++run)
  {
    Vector6 twist;
    for (Eigen::Index k = 0; k < 6; ++k)
    {
      twist[k] = u(random) * (k < 3 ? 3.0 : 0.12);
    }
    Eigen::Vector3d p;
    for (Eigen::Index k = 0; k < 3; ++k)
    {
      p[k] = 40 * u(random);
    }
    const double reference = 0.5 + 0.5 * u(random);
    const double fraction = 0.5 + 0.5 * u(random);
    const SweepMotion motion(expSE3(twist), reference);
    const Eigen::Vector3f told = motion.toReference(p.cast<float>(), static_cast<float>(fraction));
    const Eigen::Vector3d truth = expSE3((fraction - reference) * twist) * p;
    EXPECT_LT((told.cast<double>() - truth).norm(), 1e-3);
    // From the reference back to the moment of the measurement.
    const SweepMotion back(expSE3(twist), fraction);
    EXPECT_LT((back.toReference(told, static_cast<float>(reference)).cast<double>() - p).norm(),
              2e-3);
    EXPECT_EQ(motion.toReference(told, static_cast<float>(reference)), told);
  }
}

TEST(SweepModel, FractionRunsOnceRoundInItsDirection)
{
  for (const int direction : {-1, 1})
  {
    SweepModel model;
    model.direction = direction;
    model.start_azimuth = 0.7;
    for (int i = 0; i < 100; ++i)
    {
      const double share = (i + 0.5) / 100;
      const double azimuth = model.start_azimuth + direction * 2 * M_PI * share;
      const Eigen::Vector3d p(9 * std::cos(azimuth), 9 * std::sin(azimuth), 1);
      EXPECT_NEAR(static_cast<double>(sweepFraction(p.cast<float>(), model)), share, 1e-4);
    }
  }
}
}  // namespace
}  // namespace dyslam
