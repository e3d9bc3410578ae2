// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/mapping/FullResolution.h>
#include <dyslam/mapping/MapTiles.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <tuple>
#include <utility>

#include "TestMap.h"
#include "WalledStreet.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

using Place = std::tuple<float, float, float, float, std::uint32_t>;

std::vector<Place> placesOf(const MapPoints& points)
{
  std::vector<Place> places;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const auto& p = points.points[i];
    places.emplace_back(p.x(), p.y(), p.z(), points.intensity[i], points.hits[i]);
  }
  return places;
}

/** streetScan() by two lidars; the second one, on the left, measured the points on the left. Every
 * second point of the scan is in no cloud. */
Frame twoLidarScan(std::size_t k)
{
  const Frame all = test::streetScan(k);
  Frame frame = all;
  frame.cloud.points.clear();
  frame.cloud.intensity.clear();
  frame.cloud.source.clear();
  frame.cloud.phase.clear();
  frame.moving.clear();
  ScanPart part;
  part.T_scan_lidar.translation() = Eigen::Vector3d(-1, 4, -1.2);
  for (const bool of_second : {false, true})
  {
    part.begin = 2 * frame.cloud.size();
    for (std::size_t i = 0; i < all.cloud.size(); ++i)
    {
      if ((all.cloud.points[i].y() > 0) == of_second)
      {
        frame.cloud.source.push_back(static_cast<std::uint32_t>(2 * frame.cloud.size() + 1));
        frame.cloud.points.push_back(all.cloud.points[i]);
        frame.cloud.intensity.push_back(all.cloud.intensity[i]);
        frame.cloud.phase.push_back(all.cloud.phase[i]);
        frame.moving.push_back(all.moving[i]);
      }
    }
  }
  frame.scan.parts = {part};
  return frame;
}

class MapTiles : public testing::Test
{
 protected:
  void SetUp() override
  {
    options_.max_range = 30;
    options_.visibility_range = 30;
    file_ = (fs::temp_directory_path() / ("dyslam_tiles_" + std::to_string(getpid()))).string();
  }

  StaticMapOptions options_;
  std::string file_;
  static constexpr std::size_t scans_ = 20;
};

TEST_F(MapTiles, TogetherAreTheWholeMap)
{
  for (Frame (*scanOf)(std::size_t) : {&test::streetScan, &twoLidarScan})
  {
    test::TestMap whole(options_);
    ScanStore store(file_, options_);
    for (std::size_t k = 0; k < scans_; ++k)
    {
      const Frame frame = scanOf(k);
      whole.insert(frame);
      store.add(frame);
    }
    std::vector<Place> expected = placesOf(whole.map.points());
    std::vector<Place> found;
    const auto tiles = tilesOf(store, options_, 16.0);
    for (const MapTile& tile : tiles)
    {
      const TileMap part(store, options_, tile.region);
      EXPECT_LT(part.map.voxelCount(), whole.map.voxelCount() / 2);
      const auto places = placesOf(pointsWithin(part.map.points(), tile.region));
      found.insert(found.end(), places.begin(), places.end());
    }
    ASSERT_GT(tiles.size(), 8U);
    ASSERT_GT(expected.size(), 5000U);
    std::sort(expected.begin(), expected.end());
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected);
  }
}

/** A voxel that is larger than the margin for normals lies in up to four tiles, one of which has
 * its point. */
TEST_F(MapTiles, OfLargeVoxelsAreTheWholeMap)
{
  options_.voxel_size = 8;
  options_.points_per_voxel = 1000;
  test::TestMap whole(options_);
  ScanStore store(file_, options_);
  for (std::size_t k = 0; k < scans_; ++k)
  {
    whole.insert(test::streetScan(k));
    store.add(test::streetScan(k));
  }
  std::vector<Place> expected = placesOf(whole.map.points());
  std::vector<Place> found;
  for (const MapTile& tile : tilesOf(store, options_, 19.0))
  {
    const TileMap part(store, options_, tile.region);
    const auto places = placesOf(pointsWithin(part.map.points(), tile.region));
    found.insert(found.end(), places.begin(), places.end());
  }
  ASSERT_GT(expected.size(), 15U);
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, expected);
}

TEST(TileBlocks, HoldEveryTileOnceAndAreNoLargerThanAScanReaches)
{
  for (const double size : {5.0, 16.0, 30.0, 100.0, 250.0})
  {
    std::vector<MapTile> tiles;
    for (std::int64_t x = -13; x < 12; ++x)
    {
      for (std::int64_t y = -3; y < 9; ++y)
      {
        const Eigen::Vector2d low(static_cast<double>(x) * size, static_cast<double>(y) * size);
        tiles.push_back({x, y, {low, low.array() + size}});
      }
    }
    const std::vector<TileBlock> blocks = blocksOf(tiles, size);
    EXPECT_LE(blocks.size(), size > 50 ? tiles.size() : tiles.size() / 4);
    std::set<std::pair<std::int64_t, std::int64_t>> found;
    for (const TileBlock& block : blocks)
    {
      const Eigen::Vector2d sides = block.region.high - block.region.low;
      EXPECT_LE(sides.maxCoeff(), std::max(size, std::min(100.0, 8 * size)) + 1e-9);
      for (const MapTile& tile : block.tiles)
      {
        EXPECT_TRUE(found.emplace(tile.x, tile.y).second);
        EXPECT_TRUE((tile.region.low.array() >= block.region.low.array()).all());
        EXPECT_TRUE((tile.region.high.array() <= block.region.high.array()).all());
      }
    }
    EXPECT_EQ(found.size(), tiles.size());
  }
}

/** In float32, as the files have them, these points lie on the border. */
TEST_F(MapTiles, PointsThatRoundToABorderAreInOneOfItsSides)
{
  options_.visibility = false;
  Frame frame;
  frame.T_odom_vehicle.translation().x() = -1e-9;
  for (float y = -1.95F; y < 2; y += 0.1F)
  {
    frame.cloud.points.emplace_back(16.0F, y, 1.1F);
  }
  frame.moving.assign(frame.cloud.size(), false);
  test::TestMap map(options_);
  map.insert(frame);
  const MapPoints points = map.map.points();
  const FullResolution full(map.map, options_, points);
  MapRegion below;
  below.high.x() = 16;
  MapRegion above;
  above.low.x() = 16;
  EXPECT_EQ(full.of(frame, below).size(), 0U);
  EXPECT_EQ(full.of(frame, above).size(), frame.cloud.size());
}

TEST_F(MapTiles, StoredScansKnowWhichLidarMeasuredThePoints)
{
  ScanStore store(file_, options_);
  const Frame frame = twoLidarScan(2);
  store.add(frame);
  const Frame back = store.read(0);
  EXPECT_EQ(back.cloud.points, frame.cloud.points);
  const std::vector<LidarRange> expected = lidarRanges(frame.scan, frame.cloud);
  const std::vector<LidarRange> ranges = lidarRanges(back.scan, back.cloud);
  ASSERT_EQ(ranges.size(), 2U);
  EXPECT_EQ(ranges[0].end, expected[0].end);
  EXPECT_EQ(ranges[1].begin, expected[1].begin);
  EXPECT_EQ(ranges[1].end, frame.cloud.size());
  EXPECT_EQ(ranges[1].lidar, 1U);
  EXPECT_EQ(ranges[1].sensor(), expected[1].sensor());
  const TileMap tile(store, options_, tilesOf(store, options_, 100).front().region);
  ASSERT_EQ(tile.keyframes.size(), 1U);
  EXPECT_EQ(tile.keyframes[0].sensorOf(1), expected[1].sensor());
  const std::vector<std::uint8_t> lidars = tile.keyframes.mapCloud(0).unpacked().lidar;
  EXPECT_EQ(std::count(lidars.begin(), lidars.end(), 2), 0);
  EXPECT_GT(std::count(lidars.begin(), lidars.end(), 1), 100);
  EXPECT_GT(std::count(lidars.begin(), lidars.end(), 0), 100);
}

/** Two lidars see a wall between them from either side. */
TEST_F(MapTiles, NormalsLookAtTheLidarThatMeasuredThePoint)
{
  options_.visibility = false;
  test::TestMap map(options_);
  Frame frame;
  frame.scan.T_vehicle_lidar.translation() = Eigen::Vector3d(0, -3, 1);
  ScanPart part;
  part.T_scan_lidar.translation() = Eigen::Vector3d(0, 6, 0);
  for (const bool of_second : {false, true})
  {
    part.begin = frame.cloud.size();
    for (float x = 4; x < 8; x += 0.1F)
    {
      for (float z = 0; z < 2; z += 0.1F)
      {
        frame.cloud.source.push_back(static_cast<std::uint32_t>(frame.cloud.size()));
        frame.cloud.points.emplace_back(x, of_second ? 0.02F : -0.02F, z);
      }
    }
  }
  frame.moving.assign(frame.cloud.size(), false);
  frame.scan.parts = {part};
  for (std::size_t k = 0; k < 3; ++k)
  {
    frame.index = k;
    map.insert(frame);
  }
  MapPoints points = map.map.points();
  ThreadPool pool(2);
  estimateMapNormals(points, map.map, 0.8, pool);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const float side = points.points[i].y() < 0 ? -1.0F : 1.0F;
    EXPECT_GT(side * points.normals[i].y(), 0.9F) << points.points[i].transpose();
  }
  const MapPoints of = FullResolution(map.map, options_, points).of(frame);
  ASSERT_EQ(of.size(), frame.cloud.size());
  for (std::size_t i = 0; i < of.size(); ++i)
  {
    EXPECT_GT((i < part.begin ? -1.0F : 1.0F) * of.normals[i].y(), 0.9F) << i;
  }
}

TEST_F(MapTiles, ScansComeBackFromDiskAndTheFileGoes)
{
  {
    ScanStore store(file_, options_);
    for (std::size_t k = 0; k < 4; ++k)
    {
      store.add(test::streetScan(k));
    }
    EXPECT_FALSE(fs::exists(file_ + ".tmp")) << "a killed program would leave it";
    for (const std::size_t k : {2U, 0U, 3U})
    {
      const Frame frame = test::streetScan(k);
      const Frame back = store.read(k);
      EXPECT_EQ(back.index, frame.index);
      EXPECT_EQ(back.cloud.points, frame.cloud.points);
      EXPECT_EQ(back.cloud.intensity, frame.cloud.intensity);
      EXPECT_EQ(back.cloud.phase, frame.cloud.phase);
      EXPECT_TRUE(back.cloud.T_sweep.isApprox(frame.cloud.T_sweep, 0));
      EXPECT_EQ(back.moving, frame.moving);
      EXPECT_TRUE(back.T_map_vehicle().isApprox(frame.T_map_vehicle(), 0));
    }
    store.add(test::streetScan(4));
    EXPECT_EQ(store.read(4).cloud.points, test::streetScan(4).cloud.points);
  }
  EXPECT_FALSE(fs::exists(file_ + ".tmp"));
  EXPECT_THROW(ScanStore("/no/such/folder/scans", options_), UserError);
}

TEST_F(MapTiles, FullResolutionKeepsEveryStaticPointAndNothingElse)
{
  test::TestMap whole(options_);
  for (std::size_t k = 0; k < scans_; ++k)
  {
    whole.insert(test::streetScan(k));
  }
  const MapPoints points = whole.map.points();
  const FullResolution full(whole.map, options_, points);
  for (const std::size_t k : {0U, 1U, 10U})
  {
    const Frame frame = test::streetScan(k);
    std::size_t expected = 0;
    for (std::size_t i = 0; i < frame.cloud.size(); ++i)
    {
      const auto range = static_cast<double>(frame.cloud.points[i].norm());
      const Eigen::Vector3d p = frame.T_map_vehicle() * frame.cloud.points[i].cast<double>();
      const bool in_box = std::abs(p.x() - 12.1) < 0.01 && std::abs(p.y() - 1) < 0.01;
      expected += !frame.moving[i] && !in_box && range >= 2.5 && range <= 30 ? 1 : 0;
    }
    const MapPoints of = full.of(frame);
    EXPECT_NEAR(static_cast<double>(of.size()), static_cast<double>(expected),
                1e-3 * static_cast<double>(expected));
    for (const auto& p : of.points)
    {
      ASSERT_FALSE(std::abs(p.x() - 12.1F) < 0.05F && std::abs(p.y() - 1) < 0.05F && p.z() > 0.6F)
          << p.transpose();
      const bool moved = std::abs(p.x() - 14.1F) < 0.05F && p.z() > 0.45F && std::abs(p.y()) < 5;
      ASSERT_FALSE(moved) << p.transpose();
    }
  }
}

TEST_F(MapTiles, NormalsLookAtTheSensor)
{
  test::TestMap whole(options_);
  for (std::size_t k = 0; k < scans_; ++k)
  {
    whole.insert(test::streetScan(k));
  }
  MapPoints points = whole.map.points();
  ThreadPool pool(2);
  estimateMapNormals(points, whole.map, 0.8, pool);
  ASSERT_EQ(points.normals.size(), points.size());
  std::size_t walls = 0;
  std::size_t ground = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const auto& p = points.points[i];
    const auto& n = points.normals[i];
    if (p.z() > 1 && std::abs(p.y()) > 6)
    {
      ++walls;
      EXPECT_GT(-n.y() * p.y() / std::abs(p.y()), 0.99F) << n.transpose();
    }
    else if (p.z() < 0.02F && std::abs(p.y()) < 4)
    {
      ++ground;
      EXPECT_GT(n.z(), 0.99F) << n.transpose();
    }
  }
  EXPECT_GT(walls, 500U);
  EXPECT_GT(ground, 500U);
}
}  // namespace
}  // namespace dyslam
