// SPDX-License-Identifier: BSD-3-Clause
#include "../src/Posts.h"

#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
using Voxels = std::vector<Eigen::Vector3f>;

/** Voxels at the corners of a square of side `width`, up to a height [m]. */
void addColumn(float x, float y, float width, float height, Voxels& voxels)
{
  for (float z = 0.3F; z < height; z += 0.2F)
  {
    for (const float dx : {0.0F, width})
    {
      for (const float dy : {0.0F, width})
      {
        voxels.emplace_back(x + dx, y + dy, z);
      }
    }
  }
}

TEST(Posts, AreThinUprightAndStandByThemselves)
{
  Voxels voxels;
  addColumn(-20.3F, 7.9F, 0.1F, 3, voxels);
  EXPECT_TRUE(Posts(voxels).contain(0));
  EXPECT_TRUE(Posts(voxels).contain(voxels.size() - 1));
}

TEST(Posts, AreNotPeopleOrBollards)
{
  Voxels person;
  addColumn(5, 5, 0.35F, 1.8F, person);
  EXPECT_FALSE(Posts(person).contain(3)) << "too wide";
  Voxels bollard;
  addColumn(5, 5, 0.1F, 1.3F, bollard);
  EXPECT_FALSE(Posts(bollard).contain(0)) << "too low";
}

TEST(Posts, AreNotPartsOfLargerThings)
{
  Voxels wall;
  for (float x = 0; x < 3; x += 0.45F)  // a wall as sparse thin columns
  {
    addColumn(x, 0, 0.05F, 2.5F, wall);
  }
  EXPECT_FALSE(Posts(wall).contain(wall.size() / 2));
}

TEST(Posts, OfNoVoxelsAreNone)
{
  const Voxels one{{1, 2, 3}};
  EXPECT_FALSE(Posts(one).contain(0));
}
}  // namespace
}  // namespace dyslam
