// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mapexport/MapExport.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "ReadGrid.h"
#include "TestFolder.h"
#include "TestMap.h"
#include "TestRoom.h"

namespace dyslam
{
namespace
{
/** A wall along its direction, 0.07 m beside the origin: not between two rows of voxels. */
struct Wall
{
  explicit Wall(double angle) : along(std::cos(angle), std::sin(angle)) {}

  [[nodiscard]] double across(const Eigen::Vector2d& p) const
  {
    return normal().dot(p) - beside_origin;
  }
  [[nodiscard]] Eigen::Vector2d normal() const { return {-along.y(), along.x()}; }
  /** The point of the wall at a distance along it [m]. */
  [[nodiscard]] Eigen::Vector2d at(double t) const { return t * along + beside_origin * normal(); }

  static constexpr double beside_origin = 0.07;  // [m]
  Eigen::Vector2d along;
};

constexpr double half_length = 8;  // of the wall [m]

/** A floor of 20 m by 20 m with a wall 1.5 m high, seen from three places, and through: rays to the
 * floor behind it cross the wall. */
test::TestMap mapOf(const Wall& wall)
{
  StaticMapOptions options;
  options.visibility = false;
  test::TestMap map(options);
  for (std::size_t k = 0; k < 3; ++k)
  {
    Frame frame;
    frame.index = k;
    frame.scan.T_vehicle_lidar.translation().z() = 1.7;
    frame.T_odom_vehicle = poseFromYpr(static_cast<double>(k) - 1, -6, 0, 0.2, 0, 0);
    const Pose T_vehicle_map = frame.T_odom_vehicle.inverse();
    const auto add = [&](double x, double y, double z)
    {
      frame.cloud.points.push_back((T_vehicle_map * Eigen::Vector3d(x, y, z)).cast<float>());
      frame.cloud.source.push_back(0);
    };
    for (int i = 0; i < 40000; ++i)
    {
      add(0.1 * (i % 200) - 9.95, 0.1 * (i / 200) - 9.95, 0.02);
    }
    for (double t = -half_length + 0.02 * static_cast<double>(k); t < half_length; t += 0.07)
    {
      for (double z = 0.35; z < 1.5; z += 0.1)
      {
        add(wall.at(t).x(), wall.at(t).y(), z);
      }
    }
    map.insert(frame);
  }
  return map;
}

/** Adds points to a cloud: x, y, z in the vehicle frame [m]. */
auto additionTo(Cloud& cloud)
{
  return [&cloud](double x, double y, double z)
  {
    cloud.points.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
    cloud.source.push_back(0);
  };
}

class OccupancyGrid : public testing::Test
{
 protected:
  void write(const test::TestMap& map)
  {
    const std::string path = folder.file("m.png");
    writeOccupancyGrid(map.map, path, options);
    image = cv::imread(path, cv::IMREAD_UNCHANGED);
    low = test::originIn(folder.read("m.yaml"));
  }
  /** Middle of a cell. */
  [[nodiscard]] Eigen::Vector2d placeOf(const cv::Point& c) const
  {
    return low + options.grid_resolution * Eigen::Vector2d(c.x + 0.5, image.rows - c.y - 0.5);
  }
  [[nodiscard]] cv::Point cellOf(const Eigen::Vector2d& p) const
  {
    const Eigen::Vector2d c = (p - low) / options.grid_resolution;
    return {static_cast<int>(c.x()), image.rows - 1 - static_cast<int>(c.y())};
  }
  [[nodiscard]] bool isOccupied(const cv::Point& c) const { return image.at<std::uint8_t>(c) == 0; }

  /** Whether a path from one side of the wall to the other, also by diagonal steps, passes between
   * occupied cells, away from the wall's ends. */
  [[nodiscard]] bool hasGap(const Wall& wall) const
  {
    const cv::Point start = cellOf(Eigen::Vector2d(wall.along.y(), -wall.along.x()));
    cv::Mat seen = cv::Mat::zeros(image.size(), CV_8U);
    std::vector<cv::Point> next{start};
    while (!next.empty())
    {
      const cv::Point c = next.back();
      next.pop_back();
      const bool inside = c.x >= 0 && c.y >= 0 && c.x < image.cols && c.y < image.rows;
      if (!inside || seen.at<std::uint8_t>(c) != 0 || isOccupied(c) ||
          std::abs(placeOf(c).dot(wall.along)) > half_length - 1)
      {
        continue;
      }
      if (wall.across(placeOf(c)) > 0.5)
      {
        return true;
      }
      seen.at<std::uint8_t>(c) = 1;
      for (int i = 0; i < 9; ++i)
      {
        next.emplace_back(c.x + i % 3 - 1, c.y + i / 3 - 1);
      }
    }
    return false;
  }

  TestFolder folder;
  MapExportOptions options;
  cv::Mat image;
  Eigen::Vector2d low = Eigen::Vector2d::Zero();
};

TEST_F(OccupancyGrid, WallsHaveNoGapsInCellsFinerThanTheVoxels)
{
  for (const double angle : {0.0, 0.1, 0.35, M_PI / 4, 1.2})
  {
    const Wall wall(angle);
    const test::TestMap map = mapOf(wall);
    for (const double resolution : {0.05, 0.1})
    {
      options.grid_resolution = resolution;
      write(map);
      EXPECT_FALSE(hasGap(wall)) << angle << " " << resolution;
      int free = 0;
      for (int i = 0; i < image.rows * image.cols; ++i)
      {
        const cv::Point c(i % image.cols, i / image.cols);
        if (isOccupied(c))
        {
          EXPECT_LT(std::abs(wall.across(placeOf(c))), 1.5 * resolution) << "as thin as it is";
        }
        free += image.at<std::uint8_t>(c) == 254 ? 1 : 0;
      }
      EXPECT_GT(free, image.rows * image.cols / 4);
    }
  }
}

TEST_F(OccupancyGrid, WhatIsAVoxelApartIsNotConnected)
{
  test::TestMap map;
  Frame frame;
  frame.scan.T_vehicle_lidar.translation().z() = 1.7;
  const auto add = additionTo(frame.cloud);
  for (int i = 0; i < 6400; ++i)
  {
    add(0.1 * (i % 80) + 0.05, 0.1 * (i / 80) - 3.95, 0.02);
  }
  for (double z = 0.5; z < 1; z += 0.1)
  {
    add(5.12, 0.12, z);
    add(5.12, 0.52, z);  // a column of voxels lies between
    add(5.12, 0.72, z);
  }
  map.insert(frame);
  options.grid_resolution = 0.05;
  write(map);
  EXPECT_TRUE(isOccupied(cellOf({5.12, 0.12})));
  EXPECT_FALSE(isOccupied(cellOf({5.12, 0.32})));
  EXPECT_TRUE(isOccupied(cellOf({5.12, 0.52})));
  EXPECT_TRUE(isOccupied(cellOf({5.12, 0.62})));
}

TEST_F(OccupancyGrid, CoarserCellsAreThoseOfTheMapsPoints)
{
  const test::TestMap map = mapOf(Wall(0.35));
  options.grid_resolution = 0.2;
  write(map);
  cv::Mat marked = cv::Mat::zeros(image.size(), CV_8U);
  for (const auto& p : map.map.points().points)
  {
    if (p.z() > 0.3F)
    {
      marked.at<std::uint8_t>(cellOf(p.head<2>().cast<double>())) = 1;
    }
  }
  for (int i = 0; i < image.rows * image.cols; ++i)
  {
    const cv::Point c(i % image.cols, i / image.cols);
    EXPECT_TRUE(!isOccupied(c) || marked.at<std::uint8_t>(c) != 0) << c;
  }
}

TEST_F(OccupancyGrid, RaysOfEachLidarClearCells)
{
  write(test::seenByTwoLidars());
  for (const double x : {1.05, 4.05, 7.05})
  {
    EXPECT_EQ(image.at<std::uint8_t>(cellOf({x, 5.15})), 254) << "before the second lidar, " << x;
    EXPECT_EQ(image.at<std::uint8_t>(cellOf({x, 5.15 / 8.1 * x})), 254) << "the first, " << x;
    EXPECT_EQ(image.at<std::uint8_t>(cellOf({x, 5.8 + 0.1 * x})), 205) << "neither, " << x;
  }
}

/** Of what lies behind a shelf only the ceiling over it is seen. */
TEST_F(OccupancyGrid, BehindWhatHidesTheFloorCellsAreUnknown)
{
  test::TestMap map;
  Frame frame;
  frame.scan.T_vehicle_lidar.translation().z() = 1.7;
  const auto add = additionTo(frame.cloud);
  for (double y = -9.95; y < 10; y += 0.2)
  {
    for (double x = -3.95; x < 12; x += 0.2)
    {
      add(x, y, 4);
      if (x < 5)
      {
        add(x, y, 0.02);
      }
    }
    for (double z = 0.1; z < 2.5; z += 0.1)
    {
      add(5.05, y, z);
    }
  }
  map.insert(frame);
  write(map);
  for (double y = -5.95; y < 6; y += 0.4)
  {
    EXPECT_EQ(image.at<std::uint8_t>(cellOf({3.05, y})), 254) << y;
    EXPECT_TRUE(isOccupied(cellOf({5.05, y}))) << y;
    for (double x = 5.65; x < 11; x += 0.4)
    {
      EXPECT_EQ(image.at<std::uint8_t>(cellOf({x, y})), 205) << x << " " << y;
    }
  }
}

/** One scan of a circle on the floor, 20 m around the lidar. */
test::TestMap circle(int points)
{
  test::TestMap map;
  Frame frame;
  frame.scan.T_vehicle_lidar.translation().z() = 1.7;
  for (int i = 0; i < points; ++i)
  {
    const float angle =
        2 * static_cast<float>(M_PI) * static_cast<float>(i) / static_cast<float>(points);
    frame.cloud.points.emplace_back(20 * std::cos(angle), 20 * std::sin(angle), 0.0F);
    frame.cloud.source.push_back(0);
  }
  map.insert(frame);
  return map;
}

TEST_F(OccupancyGrid, BetweenRaysThatAreTwoVoxelsApartIsFreeSpace)
{
  options.grid_resolution = 0.05;
  const auto at = [&](double range, double degrees)
  {
    const double angle = degrees * M_PI / 180;
    return image.at<std::uint8_t>(
        cellOf(range * Eigen::Vector2d(std::cos(angle), std::sin(angle))));
  };
  write(circle(720));  // 0.17 m apart
  for (double degrees = 0.1; degrees < 360; degrees += 0.37)
  {
    for (const double range : {0.5, 3.0, 8.0, 15.0, 19.0})
    {
      EXPECT_EQ(at(range, degrees), 254) << range << " m, " << degrees << " deg";
    }
  }
  write(circle(180));  // 0.4 m apart at 11.5 m
  for (double degrees = 1; degrees < 360; degrees += 2)
  {
    EXPECT_EQ(at(10, degrees), 254) << degrees;
    EXPECT_EQ(at(14, degrees), 205) << degrees;
  }
}

/** Where `(high - origin) / resolution` is rounded up to a whole number, and where the origin is
 * rounded to above `low`. */
TEST_F(OccupancyGrid, EveryPointHasACellOfTheGrid)
{
  const auto freeCells =
      [&](double low, double high, double resolution, const Eigen::Vector3d& axis)
  {
    StaticMapOptions options;
    options.voxel_size = 0.5;
    options.min_range = 0;
    options.visibility = false;
    test::TestMap map(options);
    for (const double at : {low, high})
    {
      Frame frame;
      frame.T_odom_vehicle.translation() = at * axis;
      frame.cloud.points.emplace_back(0.0F, 0.0F, 0.0F);
      frame.cloud.source.push_back(0);
      map.insert(frame);
    }
    MapExportOptions exports;
    exports.grid_resolution = resolution;
    writeOccupancyGrid(map.map, folder.file("m.png"), exports);
    const cv::Mat grid = cv::imread(folder.file("m.png"), cv::IMREAD_UNCHANGED);
    return cv::countNonZero(grid == 254);
  };
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0)})
  {
    EXPECT_EQ(2, freeCells(-823.125, 28, 0.07, axis)) << axis.transpose();
    EXPECT_EQ(2, freeCells(-3.625, 5, 0.145, axis)) << axis.transpose();
  }
}
}  // namespace
}  // namespace dyslam
