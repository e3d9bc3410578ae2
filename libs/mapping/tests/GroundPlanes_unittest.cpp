// SPDX-License-Identifier: BSD-3-Clause
#include "../src/GroundPlanes.h"

#include <dyslam/base/StateArchive.h>
#include <gtest/gtest.h>

#include <cmath>

namespace dyslam
{
namespace
{
constexpr float slope = 0.05F;

/** Height of a hillside [m]. */
float hillside(float x, float y)
{
  return slope * (x - y);
}

/** Three returns in the middle of each square of 2 m in a field of 20 by 20 m, with the height of
 * `heightAt(x, y)` over the hillside; NaN: none. */
template <typename Height>
LowestReturns fieldOf(const Height& heightAt)
{
  std::vector<Eigen::Vector3f> points;
  for (int ix = 0; ix < 10; ++ix)
  {
    for (int iy = 0; iy < 10; ++iy)
    {
      const float x = 2 * static_cast<float>(ix) + 1;
      const float y = 2 * static_cast<float>(iy) + 1;
      const auto height = static_cast<float>(heightAt(x, y));
      if (!std::isnan(height))
      {
        points.insert(points.end(), 3, {x, y, hillside(x, y) + height});
      }
    }
  }
  return {points, Eigen::Isometry3f::Identity()};
}

/** A lane along x between y = 8 and 14 whose ground no return is from, only vehicles in it. */
float laneOfVehicles(float x, float y)
{
  return y < 8 || y > 14 ? 0 : std::fmod(x, 4.0F) < 2 ? NAN : 0.8F;
}

TEST(GroundPlanes, LimitTheGroundWhereOnlyVehiclesAreSeen)
{
  const LowestReturns field = fieldOf(laneOfVehicles);
  const Eigen::Vector3f door(11, 11, hillside(11, 11) + 0.8F);
  EXPECT_NEAR(heightsOverGround({&field}, {door}, {})[0], 0, 0.01F) << "the vehicle is the ground";
  GroundPlanes planes;
  planes.beginScan(0);
  planes.fit({&field}, {door});
  EXPECT_NEAR(planes.highestAt(door), hillside(11, 11) + 0.15F, 0.05F);
  EXPECT_NEAR(heightsOverGround({&field}, {door}, planes)[0], 0.65F, 0.05F);
  const Eigen::Vector3f ground(9, 5, hillside(9, 5));
  planes.fit({&field}, {ground});
  EXPECT_NEAR(heightsOverGround({&field}, {ground}, planes)[0], 0, 1e-5F);
}

TEST(GroundPlanes, EchoesBelowTheGroundAreNoGround)
{
  const LowestReturns field =
      fieldOf([](float x, float y)
              { return std::fmod(x, 10.0F) < 2 && std::fmod(y, 6.0F) < 2 ? -4.0F : 0; });
  GroundPlanes planes;
  const Eigen::Vector3f p(11, 11, 0);
  planes.fit({&field}, {p});
  EXPECT_NEAR(planes.highestAt(p), hillside(11, 11) + 0.15F, 0.1F);
}

TEST(GroundPlanes, NeedSixSquares)
{
  GroundPlanes planes;
  const Eigen::Vector3f p(11, 11, 0);
  EXPECT_EQ(planes.highestAt(p), INFINITY) << "not fitted";
  const LowestReturns five =
      fieldOf([](float x, float y) { return y == 11 && x > 6 && x < 16 ? 0 : NAN; });
  planes.fit({&five}, {p});
  EXPECT_EQ(planes.highestAt(p), INFINITY);
}

TEST(GroundPlanes, PointsThatAreNotFiniteOrTooFarAwayHaveNone)
{
  const LowestReturns field = fieldOf([](float, float) { return 0; });
  const std::vector<Eigen::Vector3f> points = {{NAN, 11, 0}, {11, INFINITY, 0}, {-1e30F, 11, 0}};
  GroundPlanes planes;
  planes.fit({&field}, points);
  for (const Eigen::Vector3f& p : points)
  {
    EXPECT_EQ(planes.highestAt(p), INFINITY);
  }
}

TEST(GroundPlanes, AreReusedForTenToTwentyScansAndKeptInTheState)
{
  const LowestReturns low = fieldOf([](float, float) { return 0; });
  const LowestReturns high = fieldOf([](float, float) { return 2; });
  const Eigen::Vector3f p(11, 11, 0);
  GroundPlanes planes;
  planes.beginScan(3);
  planes.fit({&low}, {p});
  const float limit = planes.highestAt(p);
  StateArchive saved;
  planes.exchangeState(saved);
  GroundPlanes restored;
  StateArchive loaded(saved.bytes());
  restored.exchangeState(loaded);
  for (GroundPlanes* one : {&planes, &restored})
  {
    one->beginScan(12);
    one->fit({&high}, {p});
    EXPECT_EQ(one->highestAt(p), limit);
    one->beginScan(23);
    one->fit({&high}, {p});
    EXPECT_NEAR(one->highestAt(p), limit + 2, 0.01F);
  }
}
}  // namespace
}  // namespace dyslam
