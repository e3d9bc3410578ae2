// SPDX-License-Identifier: BSD-3-Clause
#include "DysegCrop.h"

#include <gtest/gtest.h>

namespace
{
constexpr double farthest = 26;  // largest distance of a crop's centre [m]

dyslam::BevOptions gridOf(int cells)
{
  dyslam::BevOptions grid;
  grid.cells = cells;
  return grid;
}

/** How many of 200 crops contain a point; all of them are within the reach. */
int cropsAround(const Eigen::Vector2f& point, const dyslam::DysegSample& sample)
{
  const auto crop = gridOf(256);
  int containing = 0;
  for (std::uint64_t i = 0; i < 200; ++i)
  {
    dyslam::RandomDraws draws(5, i);
    const auto centre = dyslam::drawCentre(sample, gridOf(1024), crop, farthest, draws);
    EXPECT_LE(centre.cwiseAbs().maxCoeff(), farthest);
    containing += (point - centre).cwiseAbs().maxCoeff() < crop.halfExtent() ? 1 : 0;
  }
  return containing;
}

TEST(DysegCrop, MostContainAMovingObject)
{
  dyslam::DysegSample sample;
  sample.movers = {{48, 3}, {80, 0}, {-30, 110}};
  const int containing = cropsAround(sample.movers[0], sample);
  EXPECT_GT(containing, 145);
  EXPECT_LT(containing, 195) << "some are anywhere";
}

TEST(DysegCrop, ObjectsThatNoCropContainsDoNotCount)
{
  dyslam::DysegSample beyond;
  beyond.movers = {{80, 0}};
  for (std::uint64_t i = 0; i < 50; ++i)
  {
    dyslam::RandomDraws a(6, i);
    dyslam::RandomDraws b(6, i);
    EXPECT_EQ(dyslam::drawCentre(beyond, gridOf(1024), gridOf(256), farthest, a),
              dyslam::drawCentre({}, gridOf(1024), gridOf(256), farthest, b));
  }
}
}  // namespace
