// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/eval/MapDistance.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace dyslam
{
namespace
{
using Points = std::vector<Eigen::Vector3f>;

/** \param count points on the x axis, 1 m apart */
Points line(int count, float y)
{
  Points points;
  for (int i = 0; i < count; ++i)
  {
    points.emplace_back(static_cast<float>(i), y, 0.F);
  }
  return points;
}
}  // namespace

TEST(MapDistance, OfAShiftedPartIsTheShift)
{
  Points estimate = line(100, 0.15F);
  estimate.resize(95);
  for (int i = 0; i < 5; ++i)
  {
    estimate.emplace_back(static_cast<float>(i), -3.F, 4.F);  // something new, 5 m away
  }
  const MapDistance result = mapDistance(line(100, 0), estimate);
  const DistanceSummary& e = result.estimate;
  EXPECT_EQ(100U, e.count);
  EXPECT_NEAR(0.95 * 0.15 + 0.05 * 5, e.mean, 1e-6);
  EXPECT_NEAR(0.15, e.median, 1e-6);
  EXPECT_NEAR(std::sqrt(0.95 * 0.15 * 0.15 + 0.05 * 25), e.rmse, 1e-6);
  EXPECT_NEAR(0.15, e.quantile95, 1e-6);
  EXPECT_NEAR(5, e.max, 1e-6);
  EXPECT_EQ(0, e.shares[0]);
  EXPECT_NEAR(0.95, e.shares[1], 1e-12);
  EXPECT_NEAR(0.95, e.shares[2], 1e-12);
  EXPECT_NEAR(0.15F, result.of_estimate[10], 1e-6);
  EXPECT_NEAR(5, result.of_estimate[99], 1e-6);
  // The end of the reference is missing in the estimate.
  const DistanceSummary& r = result.reference;
  EXPECT_NEAR(std::hypot(5, 0.15), r.max, 1e-5);
  EXPECT_NEAR(0.95, r.shares[2], 1e-12);
}

TEST(MapDistance, IsThatOfAFullSearchWithAnyNumberOfThreads)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<float> coordinate(-5, 5);
  const auto cloud = [&](int count)
  {
    Points points;
    for (int i = 0; i < count; ++i)
    {
      points.emplace_back(coordinate(random), coordinate(random), coordinate(random));
    }
    return points;
  };
  const Points reference = cloud(500);
  Points estimate = cloud(300);
  estimate[7].x() = std::numeric_limits<float>::quiet_NaN();
  const MapDistance one = mapDistance(reference, estimate, 1);
  const MapDistance four = mapDistance(reference, estimate, 4);
  EXPECT_EQ(299U, one.estimate.count);
  EXPECT_EQ(one.estimate.mean, four.estimate.mean);
  EXPECT_EQ(one.reference.rmse, four.reference.rmse);
  EXPECT_TRUE(std::isnan(one.of_estimate[7]));
  for (std::size_t i = 0; i < estimate.size(); ++i)
  {
    float nearest = std::numeric_limits<float>::infinity();
    for (const Eigen::Vector3f& point : reference)
    {
      const float distance = (point - estimate[i]).norm();
      nearest = distance < nearest ? distance : nearest;
    }
    if (i != 7)
    {
      EXPECT_NEAR(nearest, one.of_estimate[i], 1e-5);
      EXPECT_EQ(one.of_estimate[i], four.of_estimate[i]);
    }
  }
}

TEST(MapDistance, OfTheSameMapIsNothing)
{
  const MapDistance same = mapDistance(line(9, 0), line(9, 0));
  EXPECT_EQ(0, same.estimate.max);
  EXPECT_EQ(1, same.reference.shares[0]);
  EXPECT_THROW((void)mapDistance(line(9, 0), {}), std::invalid_argument);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW((void)mapDistance({{nan, 0, 0}}, line(9, 0)), std::invalid_argument);
}
}  // namespace dyslam
