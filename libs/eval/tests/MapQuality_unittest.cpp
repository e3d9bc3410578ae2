// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/eval/MapQuality.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace dyslam
{
namespace
{
using Points = std::vector<Eigen::Vector3f>;

/** The eight corners of a box around the origin: variances are the squares of its half sides. */
Points corners(double x, double y, double z)
{
  Points points;
  for (int k = 0; k < 8; ++k)
  {
    points.push_back(Eigen::Vector3d(k & 1 ? x : -x, k & 2 ? y : -y, k & 4 ? z : -z).cast<float>());
  }
  return points;
}

TEST(MapQuality, OfABoxIsExact)
{
  MapQuality quality({{0, 0, 0}}, {0.5, 8});
  quality.add(corners(0.25, 0.125, 0.0625));
  quality.add({{0, 0, 0.51F}, {5, 5, 5}});  // beyond the radius
  const auto sharpness = quality.sharpness();
  ASSERT_TRUE(sharpness[0].has_value());
  EXPECT_EQ(sharpness[0]->neighbours, 8U);
  EXPECT_DOUBLE_EQ(sharpness[0]->plane_variance, 0.0625 * 0.0625);
  const double determinant = std::pow(0.25 * 0.125 * 0.0625, 2);
  EXPECT_NEAR(sharpness[0]->entropy, 0.5 * std::log(std::pow(2 * M_PI * M_E, 3) * determinant),
              1e-12);
}

/** A disc of radius r in a plane with Gaussian noise of sigma: eigenvalues r^2/4, r^2/4, sigma^2.
 */
TEST(MapQuality, OfANoisyPlaneIsItsNoise)
{
  constexpr double sigma = 0.02;
  constexpr double radius = 0.5;
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, sigma);
  std::uniform_real_distribution<double> place(-1, 1);
  Points plane;
  for (int i = 0; i < 400000; ++i)
  {
    plane.push_back(Eigen::Vector3d(place(random), place(random), noise(random)).cast<float>());
  }
  MapQuality quality({{0, 0, 0}, {0.2F, -0.3F, 0}}, {radius, 10});
  quality.add(plane);
  const auto mean = meanSharpness({quality.sharpness()});
  ASSERT_EQ(mean[0].points, 2U);
  EXPECT_NEAR(mean[0].mean_plane_variance, sigma * sigma, 0.02 * sigma * sigma);
  const double expected = 0.5 * std::log(std::pow(2 * M_PI * M_E, 3) *
                                         std::pow(radius * radius / 4, 2) * sigma * sigma);
  EXPECT_NEAR(mean[0].mean_entropy, expected, 0.02);
}

TEST(MapQuality, IsWorseForAWallDrawnTwice)
{
  std::mt19937 random(6);
  std::normal_distribution<double> noise(0, 0.01);
  std::uniform_real_distribution<double> place(-1, 1);
  MapQuality once({{0, 0, 0}});
  MapQuality twice({{0, 0, 0}});
  for (int i = 0; i < 20000; ++i)
  {
    const Eigen::Vector3d p(place(random), place(random), noise(random));
    const Eigen::Vector3d second = p + Eigen::Vector3d(0, 0, i % 2 == 0 ? 0.1 : 0);
    once.add({p.cast<float>()});
    twice.add({second.cast<float>()});
  }
  EXPECT_NEAR(once.sharpness()[0]->plane_variance, 0.0001, 1e-5);
  EXPECT_NEAR(twice.sharpness()[0]->plane_variance, 0.0001 + 0.05 * 0.05, 2e-4);
  EXPECT_GT(twice.sharpness()[0]->entropy, once.sharpness()[0]->entropy + 1);
}

/** Against all pairs. */
TEST(MapQuality, FindsTheNeighboursThatAFullSearchFinds)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(-3, 3);
  Points map;
  for (int i = 0; i < 3000; ++i)
  {
    map.emplace_back(place(random), place(random), place(random));
  }
  const Points chosen(map.begin(), map.begin() + 200);
  MapQuality quality(chosen, {0.7, 4});
  quality.add(map);
  const auto sharpness = quality.sharpness();
  for (std::size_t i = 0; i < chosen.size(); ++i)
  {
    std::size_t count = 0;
    for (const auto& p : map)
    {
      count += (p - chosen[i]).squaredNorm() <= static_cast<float>(0.7 * 0.7) ? 1 : 0;
    }
    EXPECT_EQ(count >= 4, sharpness[i].has_value());
    EXPECT_EQ(count >= 4 ? count : 0, sharpness[i] ? sharpness[i]->neighbours : 0);
  }
}

TEST(MapQuality, LeavesOutFewAndFlatNeighbours)
{
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  MapQuality quality({{0, 0, 0}, {10, 0, 0}, {nan, 0, 0}}, {0.5, 8});
  Points points = corners(0.1, 0.1, 0);  // all in a plane
  points.emplace_back(10, 0, 0);         // alone
  points.emplace_back(nan, 0, 0);
  quality.add(points);
  for (const auto& sharpness : quality.sharpness())
  {
    EXPECT_FALSE(sharpness.has_value());
  }
  EXPECT_TRUE(std::isnan(meanSharpness({quality.sharpness()})[0].mean_entropy));
  EXPECT_TRUE(MapQuality({}).sharpness().empty());
}

TEST(MapQuality, MeansAreOverThePointsThatAllMapsHave)
{
  const PointSharpness a{-3, 0.1, 20};
  const PointSharpness b{-5, 0.3, 20};
  const auto means = meanSharpness({{a, b, std::nullopt}, {b, std::nullopt, a}});
  ASSERT_EQ(means.size(), 2U);
  EXPECT_EQ(means[0].points, 1U);
  EXPECT_DOUBLE_EQ(means[0].mean_entropy, -3);
  EXPECT_DOUBLE_EQ(means[1].mean_plane_variance, 0.3);
  EXPECT_THROW((void)meanSharpness({{a}, {a, b}}), std::invalid_argument);
}

TEST(MapQuality, RefusesOptionsThatMakeNoSense)
{
  EXPECT_THROW(MapQuality({}, {0, 10}), std::invalid_argument);
  EXPECT_THROW(MapQuality({}, {0.5, 3}), std::invalid_argument);
}
}  // namespace
}  // namespace dyslam
