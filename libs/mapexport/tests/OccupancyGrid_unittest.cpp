// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mapexport/MapExport.h>
#include <gtest/gtest.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <vector>

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

class OccupancyGrid : public testing::Test
{
 protected:
  void write(const test::TestMap& map)
  {
    const std::string path = folder.file("m.png");
    writeOccupancyGrid(map.map, path, options);
    image = cv::imread(path, cv::IMREAD_UNCHANGED);
    const std::string yaml = folder.read("m.yaml");
    ASSERT_EQ(2, std::sscanf(yaml.c_str() + yaml.find("origin:"), "origin: [%lf, %lf", &low.x(),
                             &low.y()));
  }
  /** The grid in m.gridmap, as MRPT reads it. */
  [[nodiscard]] mrpt::maps::COccupancyGridMap2D readGridmap() const
  {
    mrpt::io::CFileGZInputStream file(folder.file("m.gridmap"));
    auto archive = mrpt::serialization::archiveFrom(file);
    mrpt::maps::COccupancyGridMap2D grid;
    archive >> grid;
    return grid;
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
  const auto add = [&](double x, double y, double z)
  {
    frame.cloud.points.emplace_back(static_cast<float>(x), static_cast<float>(y),
                                    static_cast<float>(z));
    frame.cloud.source.push_back(0);
  };
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

TEST_F(OccupancyGrid, TheYamlNamesItsImage)
{
  const test::TestMap empty;
  for (const std::string name : {"grid", "a: b #1", "#1"})
  {
    const std::string image_path = folder.file(name + ".png");
    EXPECT_FALSE(isGridImage(image_path));
    writeOccupancyGrid(empty.map, image_path, options);
    EXPECT_TRUE(isGridImage(image_path)) << folder.read(name + ".yaml");
  }
  EXPECT_TRUE(contains(folder.read("grid.yaml"), "image: grid.png\nmode: trinary\n"));
  EXPECT_TRUE(contains(folder.read("#1.yaml"), "image: \"#1.png\"\nmode: trinary\n"));
  folder.write("other.png", "");
  EXPECT_FALSE(isGridImage(folder.file("other.png"))) << "no yaml";
  folder.write("other.yaml", "image: grid.png\n");
  EXPECT_FALSE(isGridImage(folder.file("other.png"))) << "of another image";
}

TEST_F(OccupancyGrid, GridmapIsWhatMrptReads)
{
  const test::TestMap held = test::room();
  writeOccupancyGrid(held.map, folder.file("m.gridmap"), {});
  const auto grid = readGridmap();
  EXPECT_FLOAT_EQ(grid.getResolution(), 0.1F);
  writeOccupancyGrid(held.map, folder.file("m.png"), {});
  const cv::Mat image = cv::imread(folder.file("m.png"), cv::IMREAD_UNCHANGED);
  const std::string yaml = folder.read("m.yaml");
  double x0 = 0;
  double y0 = 0;
  ASSERT_EQ(std::sscanf(yaml.c_str() + yaml.find("origin:"), "origin: [%lf, %lf", &x0, &y0), 2);
  std::size_t occupied = 0;
  for (int row = 0; row < image.rows; ++row)
  {
    for (int column = 0; column < image.cols; ++column)
    {
      const double x = x0 + (column + 0.5) * 0.1;
      const double y = y0 + (image.rows - row - 0.5) * 0.1;
      const float free = grid.getPos(static_cast<float>(x), static_cast<float>(y));
      const int cell = image.at<std::uint8_t>(row, column);
      ASSERT_NEAR(free, cell == 0 ? 0.02F : cell == 254 ? 0.98F : 0.5F, 0.01F) << x << " " << y;
      occupied += free < 0.1F ? 1 : 0;
    }
  }
  EXPECT_GT(occupied, 80U);
}

TEST_F(OccupancyGrid, GridIsWhatMapServersRead)
{
  const test::TestMap held = test::room();
  const StaticMap& map = held.map;
  writeOccupancyGrid(map, folder.file("m.png"), {});
  const cv::Mat grid = cv::imread(folder.file("m.png"), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(grid.type(), CV_8UC1);
  const std::string yaml = folder.read("m.yaml");
  EXPECT_NE(yaml.find("image: m.png\n"), std::string::npos) << yaml;
  EXPECT_NE(yaml.find("resolution: 0.1\n"), std::string::npos) << yaml;
  double x0 = 0;
  double y0 = 0;
  ASSERT_EQ(std::sscanf(yaml.c_str() + yaml.find("origin:"), "origin: [%lf, %lf", &x0, &y0), 2);
  const auto at = [&](double x, double y)
  {
    const int column = static_cast<int>(std::floor((x - x0) / 0.1));
    const int row = grid.rows - 1 - static_cast<int>(std::floor((y - y0) / 0.1));
    return static_cast<int>(grid.at<std::uint8_t>(row, column));
  };
  EXPECT_EQ(at(2.0, 1.0), 254);
  EXPECT_EQ(at(7.0, -3.0), 254);
  int occupied = 0;
  for (double y = -9; y < 9; y += 0.1)
  {
    occupied += at(8.05, y) == 0 ? 1 : 0;
  }
  EXPECT_GT(occupied, 80);
  for (double y = -9; y < 9; y += 0.1)
  {
    for (double x = -9; x < 7.5; x += 0.1)
    {
      ASSERT_NE(at(x, y), 0) << x << " " << y;
    }
  }
}

/** One keyframe sees a post 1 m high at x = 3, all of them one at x = 5. */
test::TestMap twoPosts(std::size_t keyframes)
{
  test::TestMap map;
  for (std::size_t k = 0; k < keyframes; ++k)
  {
    Frame frame;
    frame.index = k;
    frame.scan.T_vehicle_lidar.translation().z() = 1.7;
    const auto add = [&](float x, float y, float z)
    {
      frame.cloud.points.emplace_back(x, y, z);
      frame.cloud.intensity.push_back(0.25F);
      frame.cloud.source.push_back(0);
    };
    for (int i = 0; i < 6400; ++i)  // floor of 8 m by 8 m
    {
      add(0.1F * static_cast<float>(i % 80) + 0.05F, 0.1F * static_cast<float>(i / 80) - 3.95F,
          0.02F);
    }
    for (float z = 0.5F; z < 1; z += 0.1F)
    {
      add(5.05F, 0.05F, z);
      if (k == 0)
      {
        add(3.05F, 0.05F, z);
      }
    }
    map.insert(frame);
  }
  return map;
}

TEST_F(OccupancyGrid, ObstaclesOfTheGridAreSeenByTwoKeyframes)
{
  const auto occupied = [&](std::size_t keyframes, int min_hits, double x)
  {
    MapExportOptions options;
    options.obstacle_min_hits = min_hits;
    writeOccupancyGrid(twoPosts(keyframes).map, folder.file("m.gridmap"), options);
    const auto grid = readGridmap();
    return grid.getPos(static_cast<float>(x), 0.05F) < 0.4F;
  };
  EXPECT_TRUE(occupied(3, 1, 3.05));
  EXPECT_FALSE(occupied(3, 2, 3.05)) << "seen once";
  EXPECT_TRUE(occupied(3, 2, 5.05));
  EXPECT_TRUE(occupied(1, 2, 3.05)) << "there is but one keyframe";
}

/** Multipath echoes lie below the road; a quarter of the columns with one is no obstacle. */
TEST_F(OccupancyGrid, EchoesBelowTheRoadLeaveItFree)
{
  test::TestMap map;
  for (std::size_t k = 0; k < 3; ++k)
  {
    Frame frame;
    frame.index = k;
    frame.scan.T_vehicle_lidar.translation().z() = 1.7;
    const auto add = [&](double x, double y, double z)
    {
      frame.cloud.points.emplace_back(static_cast<float>(x), static_cast<float>(y),
                                      static_cast<float>(z));
      frame.cloud.source.push_back(0);
    };
    for (int i = 0; i < 6400; ++i)  // road of 8 m by 8 m
    {
      add(0.1 * (i % 80) + 0.05, 0.1 * (i / 80) - 3.95, 0.02);
    }
    for (int i = 0; k == 1 && i < 64; ++i)  // an echo in every second column, seen once
    {
      if (i % 2 == 0)
      {
        add(i % 8 + 0.55, i / 8 - 3.45, -0.8);
      }
    }
    map.insert(frame);
  }
  writeOccupancyGrid(map.map, folder.file("m.gridmap"), MapExportOptions());
  const auto grid = readGridmap();
  for (float x = 0.55F; x < 7.5F; x += 0.1F)
  {
    EXPECT_GT(grid.getPos(x, 0.05F), 0.4F) << x;
  }
}

/** A ramp of 12 degrees with a box on it. */
TEST_F(OccupancyGrid, RampsAreFreeAndWhatStandsOnThemIsNot)
{
  test::TestMap map;
  for (std::size_t k = 0; k < 3; ++k)
  {
    Frame frame;
    frame.index = k;
    frame.scan.T_vehicle_lidar.translation().z() = 1.7;
    const auto add = [&](double x, double y, double height)
    {
      frame.cloud.points.emplace_back(static_cast<float>(x), static_cast<float>(y),
                                      static_cast<float>(std::tan(12 * M_PI / 180) * x + height));
      frame.cloud.source.push_back(0);
    };
    for (int i = 0; i < 10000; ++i)  // 10 m by 10 m
    {
      add(3.05 + 0.1 * (i % 100), 0.1 * (i / 100) - 4.95, 0);
    }
    for (double y = 1.05; y < 2; y += 0.1)
    {
      for (double height = 0.2; height < 1; height += 0.1)
      {
        add(7.05, y, height);
      }
    }
    map.insert(frame);
  }
  writeOccupancyGrid(map.map, folder.file("m.gridmap"), MapExportOptions());
  const auto grid = readGridmap();
  int occupied = 0;
  for (float y = -4.45F; y < 4.5F; y += 0.1F)
  {
    for (float x = 3.55F; x < 12.5F; x += 0.1F)
    {
      const bool is_box = std::abs(x - 7.05F) < 0.3F && std::abs(y - 1.5F) < 0.7F;
      const bool is_occupied = grid.getPos(x, y) < 0.4F;
      EXPECT_TRUE(is_box || !is_occupied) << x << " " << y;
      occupied += is_occupied ? 1 : 0;
    }
  }
  EXPECT_GE(occupied, 4);
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

TEST_F(OccupancyGrid, LargeGridsGetCoarserCells)
{
  MapExportOptions options;
  EXPECT_EQ(writeOccupancyGrid(test::room().map, folder.file("m.png"), options), 0.1);
  options.grid_max_cells = 5000;
  EXPECT_EQ(writeOccupancyGrid(test::room().map, folder.file("m.png"), options), 0.4);
  const cv::Mat grid = cv::imread(folder.file("m.png"), cv::IMREAD_UNCHANGED);
  EXPECT_LE(grid.rows * grid.cols, 5000);
  EXPECT_NE(folder.read("m.yaml").find("resolution: 0.4"), std::string::npos)
      << folder.read("m.yaml");
}
}  // namespace
}  // namespace dyslam
