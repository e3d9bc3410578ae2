// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
TEST(Angle, WrapsToHalfATurnOnEitherSide)
{
  for (const double angle : {0.0, 1.0, -3.0, M_PI, -M_PI})
  {
    EXPECT_EQ(wrapAngle(angle), angle);
    for (const int turns : {-3, -1, 1, 2})
    {
      const double wrapped = wrapAngle(angle + turns * 2 * M_PI);
      EXPECT_LE(std::abs(wrapped), M_PI);
      EXPECT_NEAR(std::cos(wrapped), std::cos(angle), 1e-14) << angle << " " << turns;
      EXPECT_NEAR(std::sin(wrapped), std::sin(angle), 1e-14) << angle << " " << turns;
    }
  }
  EXPECT_TRUE(std::isnan(wrapAngle(std::nan(""))));
}

TEST(Angle, HalfATurnHas180Degrees)
{
  EXPECT_DOUBLE_EQ(180 * radians_per_degree, M_PI);
  EXPECT_DOUBLE_EQ(M_PI * degrees_per_radian, 180);
}
}  // namespace
}  // namespace dyslam
