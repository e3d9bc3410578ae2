// SPDX-License-Identifier: BSD-3-Clause
#include "../src/GroundHeights.h"

#include <gtest/gtest.h>

#include "../src/GroundPlanes.h"

namespace dyslam
{
namespace
{
constexpr float kerb = 0.15F;  // height of the pavement, from y = 1 on [m]

float groundAt(float y)
{
  return y < 1 ? 0 : kerb;
}

/** Returns of the ground every 0.1 m from 0 to 4 m in x and y, or of a body's lower edge 0.25 m
 * above the ground between `from` and `to` in x [m]. */
std::vector<Eigen::Vector3f> returns(float from, float to)
{
  std::vector<Eigen::Vector3f> points;
  for (int ix = 0; ix < 40; ++ix)
  {
    for (int iy = 0; iy < 40; ++iy)
    {
      const float x = 0.1F * static_cast<float>(ix) + 0.05F;
      const float y = 0.1F * static_cast<float>(iy) + 0.05F;
      const bool covered = x > from && x < to;
      points.emplace_back(x, y, groundAt(y) + (covered ? 0.25F : 0.0F));
    }
  }
  return points;
}

/** Heights over the ground of three scans without the body and one with it. */
class Kerb : public ::testing::Test
{
 protected:
  Kerb()
  {
    for (const auto& points : {returns(0, 0), returns(0, 0), returns(0, 0), returns(2, 3)})
    {
      scans_.emplace_back(points, Eigen::Isometry3f::Identity());
    }
  }

  using Scans = std::vector<const LowestReturns*>;

  [[nodiscard]] Scans scans(std::size_t first, std::size_t count) const
  {
    Scans chosen;
    for (std::size_t i = first; i < first + count; ++i)
    {
      chosen.push_back(&scans_[i]);
    }
    return chosen;
  }

  static float height(const Scans& scans, const Eigen::Vector3f& p)
  {
    return heightsOverGround(scans, {p}, {})[0];
  }
  static float fineHeight(const Scans& scans, const Eigen::Vector3f& p)
  {
    return fineHeightsOverGround(scans, {p}, {height(scans, p)})[0];
  }

  std::vector<LowestReturns> scans_;
};

TEST_F(Kerb, IsHigherThanTheLargeSquareButNotThanTheSmallOne)
{
  const Eigen::Vector3f on_pavement(0.75F, 1.75F, kerb);
  const Scans all = scans(0, 4);
  EXPECT_NEAR(height(all, on_pavement), kerb, 1e-5F);
  EXPECT_NEAR(fineHeight(all, on_pavement), 0, 1e-5F);
  const Eigen::Vector3f foot = on_pavement + Eigen::Vector3f(0, 0, 0.12F);
  EXPECT_NEAR(fineHeight(all, foot), 0.12F, 1e-5F);
}

TEST_F(Kerb, ABodyThatCoversTheGroundInOneScanIsNotTheGround)
{
  const Eigen::Vector3f edge(2.5F, 0.5F, 0.25F);
  EXPECT_NEAR(fineHeight(scans(0, 4), edge), 0.25F, 1e-5F);
  // No scan knows the ground of these small squares: the height over the large square stays.
  EXPECT_NEAR(fineHeight(scans(3, 1), edge), 0.25F, 1e-5F);
}

TEST_F(Kerb, WhereNothingIsKnownTheHeightIsTheGivenOne)
{
  const Eigen::Vector3f far(30, 30, 1);
  EXPECT_EQ(height(scans(0, 4), far), 0) << "the point itself is the ground";
  EXPECT_EQ(fineHeightsOverGround(scans(0, 4), {far}, {0.7F})[0], 0.7F);
}

TEST_F(Kerb, OtherPointsOfACallDoNotMatter)
{
  const std::vector<Eigen::Vector3f> points{{0.75F, 1.75F, 1}, {3.5F, 3.5F, 2}, {30, 30, 1},
                                            {2.5F, 0.5F, 3},   {4.5F, 1, 1},    {0.75F, 1.75F, 0}};
  const std::vector<float> heights = heightsOverGround(scans(0, 4), points, {});
  const std::vector<float> fine = fineHeightsOverGround(scans(0, 4), points, heights);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    EXPECT_EQ(heights[i], height(scans(0, 4), points[i])) << i;
    EXPECT_EQ(fine[i], fineHeight(scans(0, 4), points[i])) << i;
  }
  // The ground of its own square is unknown: at most 0.3 m above the upper median of the two
  // squares beside it.
  EXPECT_NEAR(heights[4], 1 - (kerb + 0.3F), 1e-5F);
}

TEST(GroundHeights, ARoofIsNoGround)
{
  std::vector<Eigen::Vector3f> points;
  for (int ix = 0; ix < 5; ++ix)
  {
    for (int iy = 0; iy < 5; ++iy)
    {
      const bool roof = ix == 2 && iy == 2;
      points.insert(
          points.end(), 3,
          {2 * static_cast<float>(ix) + 1, 2 * static_cast<float>(iy) + 1, roof ? 1.5F : 0.0F});
    }
  }
  const LowestReturns scan(points, Eigen::Isometry3f::Identity());
  EXPECT_FLOAT_EQ(heightsOverGround({&scan}, {{5, 5, 1.5F}}, {})[0], 1.2F);
}
}  // namespace
}  // namespace dyslam
