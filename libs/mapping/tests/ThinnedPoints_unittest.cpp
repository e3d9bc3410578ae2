// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mapping/ThinnedPoints.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "TestMap.h"
#include "WalledStreet.h"

namespace dyslam
{
namespace
{
TEST(ThinnedPoints, AreAtMostAsManyAsAskedFor)
{
  test::TestMap street;
  for (std::size_t k = 0; k < 3; ++k)
  {
    street.insert(test::streetScan(k));
  }
  const MapPoints all = street.map.points();
  EXPECT_EQ(thinnedPoints(street.map, all.size()).points, all.points);
  const MapPoints few = thinnedPoints(street.map, all.size() / 3);
  EXPECT_LE(few.size(), all.size() / 3);
  EXPECT_GT(few.size(), all.size() / 8);
  EXPECT_EQ(few.intensity.size(), few.size());
  EXPECT_THROW((void)thinnedPoints(street.map, 0), std::invalid_argument);
}
}  // namespace
}  // namespace dyslam
