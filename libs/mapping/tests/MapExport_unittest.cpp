// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/mapping/MapExport.h>
#include <gtest/gtest.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/maps/registerAllClasses.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <octomap/OcTree.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "FullDisk.h"
#include "TestMap.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

class MapExport : public testing::Test
{
 protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("dyslam_map_export_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const
  {
    return (folder_ / name).string();
  }

  [[nodiscard]] static std::string bytes(const std::string& file)
  {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
  }

  /** A flat floor of 20 m by 20 m with a wall 1.5 m high at x = 8, seen from three places. */
  [[nodiscard]] static test::TestMap room()
  {
    test::TestMap map;
    for (std::size_t k = 0; k < 3; ++k)
    {
      Frame frame;
      frame.index = 10 * k;
      frame.scan.stamp = 1000 + static_cast<double>(k);
      frame.scan.T_vehicle_lidar.translation().z() = 1.7;
      frame.T_odom_vehicle = poseFromYpr(static_cast<double>(k), 0, 0, 0.2, 0, 0);
      const Pose T_vehicle_map = frame.T_odom_vehicle.inverse();
      const auto add = [&](double x, double y, double z)
      {
        frame.cloud.points.push_back((T_vehicle_map * Eigen::Vector3d(x, y, z)).cast<float>());
        frame.cloud.intensity.push_back(0.25F);
        frame.cloud.source.push_back(0);
      };
      for (double y = -9.95; y < 10; y += 0.1)
      {
        for (double x = -9.95; x < 8; x += 0.1)
        {
          add(x, y, 0.02);
        }
        for (double z = 0.05; z < 1.5; z += 0.1)
        {
          add(8.05, y, z);
        }
      }
      map.insert(frame);
    }
    return map;
  }

  fs::path folder_;
};

TEST_F(MapExport, CloudsRoundTrip)
{
  const auto points = room().map.points();
  ASSERT_GT(points.size(), 1000U);
  for (const std::string name : {"m.pcd", "m.ply"})
  {
    writeMapCloud(points, path(name));
    const Scan back = readCloud(path(name));
    ASSERT_EQ(back.size(), points.size());
    EXPECT_EQ(back.points, points.points);
    EXPECT_EQ(back.intensity, points.intensity);
    const auto first = bytes(path(name));
    writeMapCloud(points, path(name));
    EXPECT_EQ(bytes(path(name)), first);
  }
  EXPECT_THROW(writeMapCloud(points, path("m.xyz")), UserError);
}

TEST_F(MapExport, SimplemapHoldsPosesAndClouds)
{
  const test::TestMap held = room();
  const StaticMap& map = held.map;
  writeSimplemap(map, path("m.simplemap"));
  const auto first = bytes(path("m.simplemap"));
  writeSimplemap(map, path("m.simplemap"));
  EXPECT_EQ(bytes(path("m.simplemap")), first);

  mrpt::maps::registerAllClasses_mrpt_maps();
  mrpt::maps::CSimpleMap back;
  ASSERT_TRUE(back.loadFromFile(path("m.simplemap")));
  ASSERT_EQ(back.size(), 3U);
  std::size_t points = 0;
  for (std::size_t k = 0; k < back.size(); ++k)
  {
    const auto [pose, frame] = back.getAsPair(k);
    const auto mean = pose->getMeanVal();
    EXPECT_NEAR(mean.x(), static_cast<double>(k), 1e-9);
    EXPECT_NEAR(mean.yaw(), 0.2, 1e-9);
    const auto cloud = frame->getObservationByClass<mrpt::obs::CObservationPointCloud>();
    ASSERT_TRUE(cloud);
    EXPECT_EQ(cloud->sensorLabel, "lidar");
    points += cloud->pointcloud->size();
  }
  EXPECT_EQ(points, held.pointCount());
}

TEST_F(MapExport, OctomapKnowsOccupiedAndFree)
{
  const test::TestMap held = room();
  const StaticMap& map = held.map;
  for (const std::string name : {"m.bt", "m.ot"})
  {
    writeOctomap(map, path(name), {});
    const auto first = bytes(path(name));
    writeOctomap(map, path(name), {});
    EXPECT_EQ(bytes(path(name)), first);
  }
  octomap::OcTree tree(0.2);
  ASSERT_TRUE(tree.readBinary(path("m.bt")));
  const auto* wall = tree.search(8.05, 0, 1.0);
  ASSERT_NE(wall, nullptr);
  EXPECT_TRUE(tree.isNodeOccupied(wall));
  const auto* air = tree.search(4.0, 0, 1.3);
  ASSERT_NE(air, nullptr);
  EXPECT_FALSE(tree.isNodeOccupied(air));
  EXPECT_EQ(tree.search(12.0, 0, 1.0), nullptr);
  EXPECT_THROW(writeOctomap(map, path("m.oct"), {}), UserError);
}

TEST_F(MapExport, GridIsWhatMapServersRead)
{
  const test::TestMap held = room();
  const StaticMap& map = held.map;
  writeOccupancyGrid(map, path("m.png"), {});
  const cv::Mat grid = cv::imread(path("m.png"), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(grid.type(), CV_8UC1);
  const std::string yaml = bytes(path("m.yaml"));
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

TEST_F(MapExport, LargeGridsGetCoarserCells)
{
  MapExportOptions options;
  options.grid_max_cells = 5000;
  writeOccupancyGrid(room().map, path("m.png"), options);
  const cv::Mat grid = cv::imread(path("m.png"), cv::IMREAD_UNCHANGED);
  EXPECT_LE(grid.rows * grid.cols, 5000);
  EXPECT_NE(bytes(path("m.yaml")).find("resolution: 0.4"), std::string::npos)
      << bytes(path("m.yaml"));
}

TEST_F(MapExport, EmptyMapGivesValidFiles)
{
  const test::TestMap held;
  const StaticMap& map = held.map;
  writeMapCloud(map.points(), path("e.ply"));
  EXPECT_EQ(readCloud(path("e.ply")).size(), 0U);
  writeMapCloud(map.points(), path("e.pcd"));
  EXPECT_EQ(readCloud(path("e.pcd")).size(), 0U);
  writeSimplemap(map, path("e.simplemap"));
  mrpt::maps::CSimpleMap back;
  EXPECT_TRUE(back.loadFromFile(path("e.simplemap")));
  EXPECT_EQ(back.size(), 0U);
  writeOctomap(map, path("e.bt"), {});
  octomap::OcTree tree(0.2);
  EXPECT_TRUE(tree.readBinary(path("e.bt")));
  EXPECT_EQ(tree.size(), 0U);
  writeOccupancyGrid(map, path("e.png"), {});
  EXPECT_EQ(cv::imread(path("e.png"), cv::IMREAD_UNCHANGED).total(), 1U);
}

TEST_F(MapExport, AFullDiskLeavesTheEarlierSimplemap)
{
  std::ofstream(path("f.simplemap")) << "an earlier one";
  const test::FullDisk full_disk;
  // Few bytes: they are written by the close only.
  EXPECT_THROW(writeSimplemap(test::TestMap().map, path("f.simplemap")), UserError);
  EXPECT_EQ(bytes(path("f.simplemap")), "an earlier one");
}

TEST_F(MapExport, UnwritableFoldersAndBadEndings)
{
  const test::TestMap held = room();
  const StaticMap& map = held.map;
  const std::string nowhere = path("no/such/folder/m");
  EXPECT_THROW(writeMapCloud(map.points(), nowhere + ".ply"), UserError);
  EXPECT_THROW(writeSimplemap(map, nowhere + ".simplemap"), UserError);
  EXPECT_THROW(writeOctomap(map, nowhere + ".bt", {}), UserError);
  EXPECT_THROW(writeOccupancyGrid(map, nowhere + ".png", {}), UserError);
  try
  {
    (void)mapFormatOf("map.3dscene");
    FAIL() << "a bad ending was accepted";
  }
  catch (const UserError& error)
  {
    EXPECT_NE(std::string(error.what()).find("did you mean .3Dscene"), std::string::npos)
        << error.what();
  }
}
}  // namespace
}  // namespace dyslam
