// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/FiringOrder.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace dyslam
{
namespace
{
/** Points of a sensor with 16 lasers at different ranges, in the order of firing. */
struct Revolution
{
  double turns = 1;
  int direction = -1;
  double start = 0.1;          //!< [turns]
  double laser_offset = 0;     //!< of the azimuth, up to this to each side [turns]
  int columns = 1800;          //!< of `turns`
  std::vector<float> share{};  //!< of a turn, when each point was fired

  std::vector<Eigen::Vector3f> points()
  {
    std::mt19937 generator(1);
    std::uniform_real_distribution<float> range(2, 80);
    std::vector<Eigen::Vector3f> points;
    share.clear();
    for (int c = 0; c < columns; ++c)
    {
      const double turned = turns * c / columns;
      for (int laser = 0; laser < 16; ++laser)
      {
        const double offset = laser_offset * ((laser % 4) / 1.5 - 1);
        const double azimuth = 2 * M_PI * (start + direction * turned + offset);
        points.push_back(range(generator) *
                         Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0.03 * laser - 0.25)
                             .cast<float>());
        share.push_back(static_cast<float>(turned));
      }
    }
    return points;
  }
};

/** Largest difference from the true fractions; infinite where there are none. */
float worstError(const std::vector<float>& found, const std::vector<float>& truth)
{
  float worst = found.size() == truth.size() ? 0 : std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < std::min(found.size(), truth.size()); ++i)
  {
    worst = std::max(worst, std::abs(found[i] - truth[i]));
  }
  return worst;
}
}  // namespace

TEST(FiringOrder, ShowsWhenPointsWereMeasured)
{
  for (const int direction : {-1, 1})
  {
    for (const double start : {0.1, 0.499, -0.3})
    {
      for (const double turns : {0.8, 1.0, 1.03})
      {
        Revolution r;
        r.direction = direction;
        r.start = start;
        r.turns = turns;
        const std::vector<Eigen::Vector3f> points = r.points();
        EXPECT_LT(worstError(firingFractions(points), r.share), 0.002F)
            << direction << ' ' << start << ' ' << turns;
      }
    }
  }
}

TEST(FiringOrder, LasersMayLookAside)
{
  Revolution r;
  r.laser_offset = 7.0 / 360;  // as those of an HDL-64E
  const std::vector<Eigen::Vector3f> points = r.points();
  EXPECT_LT(worstError(firingFractions(points), r.share), 0.022F);
}

TEST(FiringOrder, PointsWithoutReturnAreInTheOrder)
{
  Revolution r;
  std::vector<Eigen::Vector3f> points = r.points();
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const bool hidden = i > points.size() / 4 && i < points.size() / 3;  // a wall of glass
    if (hidden || i % 3 == 0)
    {
      points[i] = i % 2 == 0 ? Eigen::Vector3f::Zero().eval()
                             : Eigen::Vector3f::Constant(std::nanf("")).eval();
    }
  }
  EXPECT_LT(worstError(firingFractions(points), r.share), 0.004F) << "half a block";
}

TEST(FiringOrder, IsNotSeenInOtherOrders)
{
  Revolution r;
  const std::vector<Eigen::Vector3f> fired = r.points();
  std::vector<Eigen::Vector3f> by_ring;
  for (std::size_t laser = 0; laser < 16; ++laser)
  {
    for (std::size_t i = laser; i < fired.size(); i += 16)
    {
      by_ring.push_back(fired[i]);
    }
  }
  EXPECT_TRUE(firingFractions(by_ring).empty());
  std::vector<Eigen::Vector3f> shuffled = fired;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(2));
  EXPECT_TRUE(firingFractions(shuffled).empty());
  std::vector<Eigen::Vector3f> twice = fired;  // two returns, one after the other
  twice.insert(twice.end(), fired.begin(), fired.end());
  EXPECT_TRUE(firingFractions(twice).empty());
  r.turns = 0.5;
  EXPECT_TRUE(firingFractions(r.points()).empty());
  r = Revolution();
  r.columns = 10;
  EXPECT_TRUE(firingFractions(r.points()).empty());
  EXPECT_TRUE(firingFractions({}).empty());
  EXPECT_TRUE(firingFractions(std::vector<Eigen::Vector3f>(5000, Eigen::Vector3f::Zero())).empty());
}
}  // namespace dyslam
