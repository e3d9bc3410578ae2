// SPDX-License-Identifier: BSD-3-Clause
#include "../src/GroundHeights.h"

#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
constexpr float kerb = 0.15F;  // height of the pavement, from y = 1 on [m]

float groundAt(float y)
{
  return y < 1 ? 0 : kerb;
}

/** Returns of the ground every 0.1 m from 0 to 4 m in x and y, and of a body's lower edge 0.25 m
 * above it between `from` and `to` in x. */
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

  [[nodiscard]] GroundHeights ground(std::size_t first, std::size_t count) const
  {
    std::vector<const LowestReturns*> chosen;
    for (std::size_t i = first; i < first + count; ++i)
    {
      chosen.push_back(&scans_[i]);
    }
    return GroundHeights(chosen);
  }

  static float fineHeight(const GroundHeights& ground, const Eigen::Vector3f& p)
  {
    return ground.fineHeightOf(p, ground.heightsOf({p})[0]);
  }

  std::vector<LowestReturns> scans_;
};

TEST_F(Kerb, IsHigherThanTheLargeSquareButNotThanTheSmallOne)
{
  const Eigen::Vector3f on_pavement(0.75F, 1.75F, kerb);
  const GroundHeights all = ground(0, 4);
  EXPECT_NEAR(all.heightsOf({on_pavement})[0], kerb, 1e-5F);
  EXPECT_NEAR(fineHeight(all, on_pavement), 0, 1e-5F);
  const Eigen::Vector3f foot = on_pavement + Eigen::Vector3f(0, 0, 0.12F);
  EXPECT_NEAR(fineHeight(all, foot), 0.12F, 1e-5F);
}

TEST_F(Kerb, ABodyThatCoversTheGroundInOneScanIsNotTheGround)
{
  const Eigen::Vector3f edge(2.5F, 0.5F, 0.25F);
  EXPECT_NEAR(fineHeight(ground(0, 4), edge), 0.25F, 1e-5F);
  // Of which no scan knows the ground: the height over the large square stays.
  EXPECT_NEAR(fineHeight(ground(3, 1), edge), 0.25F, 1e-5F);
}

TEST_F(Kerb, WhereNothingIsKnownTheHeightIsTheGivenOne)
{
  EXPECT_EQ(ground(0, 4).fineHeightOf({30, 30, 1}, 0.7F), 0.7F);
}
}  // namespace
}  // namespace dyslam
