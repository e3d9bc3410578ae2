// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mrpt/Conversions.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace dyslam
{
namespace
{
TEST(MrptConversions, PosesKeepTheirNumbers)
{
  for (const double pitch : {0.0, -0.4, M_PI_2})
  {
    const Pose pose = poseFromYpr(84.5471260811, -65.182947284, 1e6, 2.1, pitch, -0.3);
    EXPECT_EQ(pose.matrix(), toPose(toMrpt(pose)).matrix());
  }
}

TEST(MrptConversions, AnglesAreThoseOfMrpt)
{
  const mrpt::poses::CPose3D mrpt_pose(1, 2, 3, 0.3, -0.2, 0.1);
  EXPECT_TRUE(toPose(mrpt_pose).isApprox(poseFromYpr(1, 2, 3, 0.3, -0.2, 0.1), 1e-12));
  const auto back = toMrpt(toPose(mrpt_pose));
  EXPECT_NEAR(0.3, back.yaw(), 1e-12);
  EXPECT_NEAR(-0.2, back.pitch(), 1e-12);
  EXPECT_NEAR(0.1, back.roll(), 1e-12);
}

TEST(MrptConversions, APoseThatIsNotFiniteStaysSo)
{
  Pose pose = Pose::Identity();
  pose.translation().y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(toPose(toMrpt(pose)).translation().y()));
}

TEST(MrptConversions, StampsKeepTheirTicks)
{
  for (const double stamp : {0.0, 1.5, 1317014625.3627453, 1700000000.0499999, -3.25})
  {
    EXPECT_EQ(stamp, toStamp(toMrptTime(stamp)));
  }
  EXPECT_EQ(116444736000000000, toMrptTime(0).time_since_epoch().count());
  EXPECT_EQ(116444736010000000, toMrptTime(1).time_since_epoch().count());
}

TEST(MrptConversions, StampsBeyondAnyClockAreLimited)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(0, toStamp(toMrptTime(std::numeric_limits<double>::quiet_NaN())));
  EXPECT_EQ(0, toStamp(toMrptTime(infinity)));
  EXPECT_EQ(8e11, toStamp(toMrptTime(1e300)));
  EXPECT_EQ(-8e11, toStamp(toMrptTime(-1e300)));
  for (const auto ticks :
       {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()})
  {
    EXPECT_TRUE(std::isfinite(toStamp(mrpt::Clock::time_point(mrpt::Clock::duration(ticks)))));
  }
}
}  // namespace
}  // namespace dyslam
