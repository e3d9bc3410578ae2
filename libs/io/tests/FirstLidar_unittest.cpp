// SPDX-License-Identifier: BSD-3-Clause
#include "../src/recording/FirstLidar.h"

#include <dyslam/base/Error.h>
#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
const FurtherLidars none("", true, 0);
const FurtherLidars rear("rear", true, 0);

TEST(FirstLidar, IsTheFirstInTheFileThatIsNotAFurtherOne)
{
  FirstLidar first("");
  EXPECT_FALSE(first.takes("rear", rear));
  EXPECT_EQ(first.label(), "");
  EXPECT_TRUE(first.takes("front", rear));
  EXPECT_FALSE(first.takes("roof", rear));
  EXPECT_TRUE(first.mayBe("roof", rear));
  EXPECT_TRUE(first.takes("front", rear));
  EXPECT_EQ(first.label(), "front");
}

TEST(FirstLidar, IsThatOfTheOption)
{
  FirstLidar first("roof|rear");
  EXPECT_FALSE(first.takes("front", none));
  EXPECT_TRUE(first.takes("rear", rear));
  EXPECT_FALSE(first.takes("roof", rear));
  EXPECT_EQ(first.label(), "rear");
  EXPECT_THROW(FirstLidar("("), UserError);
}

TEST(FirstLidar, OwnsTimesAndRingsOfItsLabelAndBeforeItsFirstScanOfAnyButFurtherOnes)
{
  FirstLidar first("");
  EXPECT_TRUE(first.mayOwnTimeRing("front", rear));
  EXPECT_FALSE(first.mayOwnTimeRing("rear", rear));
  EXPECT_TRUE(first.takes("front", rear));
  EXPECT_TRUE(first.mayOwnTimeRing("front", rear));
  EXPECT_FALSE(first.mayOwnTimeRing("roof", rear));
}

TEST(FirstLidar, SaysWhyThereIsNone)
{
  FirstLidar any("");
  EXPECT_EQ(any.reasonForNone(none), "");
  EXPECT_FALSE(any.takes("rear", rear));
  EXPECT_EQ(
      any.reasonForNone(rear),
      "further_lidars = rear selects every lidar of the file, 'rear'; name the first one with "
      "sensor_label");
  FirstLidar named("top");
  EXPECT_FALSE(named.takes("rear", none));
  EXPECT_FALSE(named.takes("front", none));
  EXPECT_EQ(named.reasonForNone(none),
            "no 3D scan has a label like 'top'; the file has 'front', 'rear'");
}
}  // namespace
}  // namespace dyslam
