// SPDX-License-Identifier: BSD-3-Clause
// The files of an occupancy grid, as map servers and MRPT read them.
#include <dyslam/mapexport/MapExport.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "ReadGrid.h"
#include "TestFolder.h"
#include "TestMap.h"
#include "TestRoom.h"

namespace dyslam
{
namespace
{
TEST(GridFiles, TheYamlNamesItsImage)
{
  const TestFolder folder;
  const test::TestMap empty;
  for (const std::string name : {"grid", "a: b #1", "#1"})
  {
    const std::string image_path = folder.file(name + ".png");
    EXPECT_FALSE(isGridImage(image_path));
    writeOccupancyGrid(empty.map, image_path, {});
    EXPECT_TRUE(isGridImage(image_path)) << folder.read(name + ".yaml");
  }
  EXPECT_TRUE(contains(folder.read("grid.yaml"), "image: grid.png\nmode: trinary\n"));
  EXPECT_TRUE(contains(folder.read("#1.yaml"), "image: \"#1.png\"\nmode: trinary\n"));
  folder.write("other.png", "");
  EXPECT_FALSE(isGridImage(folder.file("other.png"))) << "no yaml";
  folder.write("other.yaml", "image: grid.png\n");
  EXPECT_FALSE(isGridImage(folder.file("other.png"))) << "of another image";
}

TEST(GridFiles, GridmapIsWhatMrptReads)
{
  const TestFolder folder;
  const test::TestMap held = test::room();
  writeOccupancyGrid(held.map, folder.file("m.gridmap"), {});
  const auto grid = test::readGridmap(folder.file("m.gridmap"));
  EXPECT_FLOAT_EQ(grid.getResolution(), 0.1F);
  writeOccupancyGrid(held.map, folder.file("m.png"), {});
  const cv::Mat image = cv::imread(folder.file("m.png"), cv::IMREAD_UNCHANGED);
  const Eigen::Vector2d low = test::originIn(folder.read("m.yaml"));
  std::size_t occupied = 0;
  for (int row = 0; row < image.rows; ++row)
  {
    for (int column = 0; column < image.cols; ++column)
    {
      const double x = low.x() + (column + 0.5) * 0.1;
      const double y = low.y() + (image.rows - row - 0.5) * 0.1;
      const float free = grid.getPos(static_cast<float>(x), static_cast<float>(y));
      const int cell = image.at<std::uint8_t>(row, column);
      ASSERT_NEAR(free, cell == 0 ? 0.02F : cell == 254 ? 0.98F : 0.5F, 0.01F) << x << " " << y;
      occupied += free < 0.1F ? 1 : 0;
    }
  }
  EXPECT_GT(occupied, 80U);
}

TEST(GridFiles, GridIsWhatMapServersRead)
{
  const TestFolder folder;
  const test::TestMap held = test::room();
  const StaticMap& map = held.map;
  writeOccupancyGrid(map, folder.file("m.png"), {});
  const cv::Mat grid = cv::imread(folder.file("m.png"), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(grid.type(), CV_8UC1);
  const std::string yaml = folder.read("m.yaml");
  EXPECT_NE(yaml.find("image: m.png\n"), std::string::npos) << yaml;
  EXPECT_NE(yaml.find("resolution: 0.1\n"), std::string::npos) << yaml;
  const Eigen::Vector2d low = test::originIn(yaml);
  const auto at = [&](double x, double y)
  {
    const int column = static_cast<int>(std::floor((x - low.x()) / 0.1));
    const int row = grid.rows - 1 - static_cast<int>(std::floor((y - low.y()) / 0.1));
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

TEST(GridFiles, LargeGridsGetCoarserCells)
{
  const TestFolder folder;
  MapExportOptions options;
  EXPECT_EQ(writeOccupancyGrid(test::room().map, folder.file("m.png"), options), 0.1);
  options.grid_max_cells = 5000;
  EXPECT_EQ(writeOccupancyGrid(test::room().map, folder.file("m.png"), options), 0.4);
  const cv::Mat grid = cv::imread(folder.file("m.png"), cv::IMREAD_UNCHANGED);
  EXPECT_LE(grid.rows * grid.cols, 5000);
  EXPECT_NE(folder.read("m.yaml").find("resolution: 0.4"), std::string::npos)
      << folder.read("m.yaml");
}

TEST(GridFiles, AnAreaIsTheSizeOfTheGrid)
{
  const TestFolder folder;
  const test::TestMap held = test::room();
  writeOccupancyGrid(held.map, folder.file("all.png"), {});
  const cv::Mat all = cv::imread(folder.file("all.png"), cv::IMREAD_UNCHANGED);
  const Eigen::Vector2d corner = test::originIn(folder.read("all.yaml"));
  MapExportOptions options;
  options.area = "1005.3 -6, 1012.3, 3.5";  // reaches beyond the wall
  writeOccupancyGrid(held.map, folder.file("m.png"), options, {1000, 0, 0});
  const cv::Mat grid = cv::imread(folder.file("m.png"), cv::IMREAD_UNCHANGED);
  const std::string yaml = folder.read("m.yaml");
  EXPECT_NE(yaml.find("origin: [1005.300000, -6.000000, 0.0]"), std::string::npos) << yaml;
  ASSERT_EQ(grid.cols, 70);
  ASSERT_EQ(grid.rows, 95);
  int other = 0;
  for (int row = 0; row < grid.rows; ++row)
  {
    for (int column = 0; column < grid.cols; ++column)
    {
      // The middle of the cell, in the grid of the whole map.
      const int x = static_cast<int>(std::floor((5.35 + 0.1 * column - corner.x()) / 0.1));
      const int y = static_cast<int>(std::floor((3.45 - 0.1 * row - corner.y()) / 0.1));
      const int expected =
          x < all.cols ? static_cast<int>(all.at<std::uint8_t>(all.rows - 1 - y, x)) : 205;
      other += grid.at<std::uint8_t>(row, column) != expected ? 1 : 0;
    }
  }
  EXPECT_LT(other, grid.rows * grid.cols / 100) << "triangles that OpenCV has clipped";
  EXPECT_GT(cv::countNonZero(grid == 0), 40) << "the wall";
  writeOccupancyGrid(test::TestMap().map, folder.file("m.png"), options);
  EXPECT_EQ(cv::imread(folder.file("m.png"), cv::IMREAD_UNCHANGED).cols, 70) << "of an empty map";
}

TEST(GridFiles, GridsThatAreTooLongForAPictureGetCoarserCells)
{
  const TestFolder folder;
  test::TestMap map;
  for (std::size_t k = 0; k < 2; ++k)
  {
    Frame frame;
    frame.index = k;
    frame.T_odom_vehicle.translation().x() = 120000.0 * static_cast<double>(k);
    frame.cloud.points = {{5, 0, 0}, {6, 0, 0}};
    frame.cloud.source = {0, 1};
    map.insert(frame);
  }
  EXPECT_EQ(writeOccupancyGrid(map.map, folder.file("m.png"), {}), 0.2);
  EXPECT_NEAR(cv::imread(folder.file("m.png"), cv::IMREAD_UNCHANGED).cols, 600005, 2);
}
}  // namespace
}  // namespace dyslam
