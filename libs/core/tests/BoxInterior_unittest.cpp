// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/BoxInterior.h>
#include <gtest/gtest.h>

#include <cmath>

namespace dyslam
{
namespace
{
TEST(BoxInterior, TheBoxIsTurnedAndItsMarginsDiffer)
{
  Box box;
  box.centre = {10, 5, 1};
  box.size = {4, 2, 1.5};
  box.yaw = 1.5707963267948966;  // its length is along y
  const Eigen::Vector3d margin(0.3, 0.2, 0.1);
  const BoxInterior<double> interior(box, margin);
  const auto isInside = [&](double x, double y, double z)
  { return interior.contains(box.centre + Eigen::Vector3d(x, y, z)); };
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

TEST(BoxInterior, TheGroundIsCutFromTheBottomOfTheBox)
{
  Box box;
  box.centre = {10, 5, 0.75};
  box.size = {4, 2, 1.5};
  const BoxInterior<float> interior =
      BoxInterior<float>(box, Eigen::Vector3f::Constant(0.1F)).aboveGround(0.25F);
  EXPECT_FALSE(interior.contains({10, 5, 0.24F}));
  EXPECT_TRUE(interior.contains({10, 5, 0.26F}));
  EXPECT_TRUE(interior.contains({10, 5, 1.59F}));
  EXPECT_FALSE(interior.contains({10, 5, 1.61F}));
  EXPECT_FALSE(interior.contains({std::nanf(""), 5, 1}));
}
}  // namespace
}  // namespace dyslam
