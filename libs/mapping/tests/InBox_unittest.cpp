// SPDX-License-Identifier: BSD-3-Clause
#include "../src/InBox.h"

#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
TEST(InBox, TheBoxIsTurnedAndItsMarginsDiffer)
{
  Box box;
  box.center = {10, 5, 1};
  box.size = {4, 2, 1.5};
  box.yaw = 1.5707963267948966;  // its length is along y
  const Eigen::Vector3d margin(0.3, 0.2, 0.1);
  const auto isInside = [&](double x, double y, double z)
  { return isInBox(box, box.center + Eigen::Vector3d(x, y, z), margin); };
  EXPECT_TRUE(isInside(0, 0, 0));
  for (const double side : {-1.0, 1.0})
  {
    EXPECT_TRUE(isInside(0, side * 2.29, 0));
    EXPECT_FALSE(isInside(0, side * 2.31, 0));
    EXPECT_TRUE(isInside(side * 1.19, 0, 0));
    EXPECT_FALSE(isInside(side * 1.21, 0, 0));
    EXPECT_TRUE(isInside(0, 0, side * 0.84));
    EXPECT_FALSE(isInside(0, 0, side * 0.86));
  }
}
}  // namespace
}  // namespace dyslam
