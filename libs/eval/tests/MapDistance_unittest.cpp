// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/eval/MapDistance.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
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

TEST(MapDistance, ColoursAndDistancesOfAPly)
{
  using Colour = std::array<std::uint8_t, 3>;
  EXPECT_EQ((Colour{0, 64, 255}), colourOfDistance(0));
  EXPECT_EQ((Colour{230, 0, 0}), colourOfDistance(0.5F));
  EXPECT_EQ((Colour{230, 0, 0}), colourOfDistance(100));
  EXPECT_EQ((Colour{128, 128, 128}), colourOfDistance(std::numeric_limits<float>::quiet_NaN()));
  const std::string ply = distancePly(line(2, 1), {0.F, 0.7F});
  EXPECT_NE(std::string::npos, ply.find("element vertex 2\n"));
  EXPECT_NE(std::string::npos, ply.find("property float scalar_distance\n"));
  const std::string end = "end_header\n";
  ASSERT_EQ(ply.find(end) + end.size() + 2 * 19, ply.size());
  float last = 0;
  std::memcpy(&last, ply.data() + ply.size() - sizeof last, sizeof last);
  EXPECT_EQ(0.7F, last);
  EXPECT_THROW((void)distancePly(line(2, 1), {0.F}), std::invalid_argument);
}
}  // namespace dyslam
