// SPDX-License-Identifier: BSD-3-Clause
// The octree of a map, as octomap reads it.
#include <dyslam/base/Error.h>
#include <dyslam/mapexport/MapExport.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <array>
#include <cstddef>
#include <iterator>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "TestFolder.h"
#include "TestMap.h"
#include "TestRoom.h"

namespace dyslam
{
namespace
{
TEST(OctreeExport, OctomapIsWhatItsOwnInsertionMakesButRaysDoNotClearThePointsOfTheMap)
{
  const TestFolder folder;
  const test::TestMap held = test::room();
  MapExportOptions options;
  options.octree_range = 6.0;  // some rays are cut off
  writeOctomap(held.map, folder.file("m.ot"), options);
  octomap::OcTree tree(options.octree_resolution);
  std::vector<octomap::Pointcloud> scans;
  octomap::KeySet is_static;
  const auto toOctomap = [&](std::size_t k, const Eigen::Vector3f& p)
  {
    const Eigen::Vector3f q = (held.map.poses()[k] * p.cast<double>()).cast<float>();
    return octomap::point3d(q.x(), q.y(), q.z());
  };
  held.map.forEachStaticCloud(
      [&](std::size_t k, const KeyframeCloud& cloud)
      {
        octomap::Pointcloud& points = scans.emplace_back();
        for (const auto& p : cloud.points)
        {
          points.push_back(toOctomap(k, p));
          is_static.insert(tree.coordToKey(toOctomap(k, p)));
        }
      });
  for (std::size_t k = 0; k < scans.size(); ++k)
  {
    octomap::KeySet free;
    octomap::KeySet occupied;
    tree.computeDiscreteUpdate(scans[k], toOctomap(k, held.map.keyframes()[k].sensor), free,
                               occupied, options.octree_range);
    for (const octomap::OcTreeKey& key : free)
    {
      if (is_static.count(key) == 0)
      {
        tree.updateNode(key, false, true);
      }
    }
    for (const octomap::OcTreeKey& key : occupied)
    {
      tree.updateNode(key, true, true);
    }
  }
  tree.updateInnerOccupancy();
  std::ostringstream expected;
  ASSERT_TRUE(tree.write(expected));
  EXPECT_EQ(folder.read("m.ot"), expected.str());
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  writeOctomap(held.map, folder.file("m.bt"), options);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  std::ostringstream binary;
  ASSERT_TRUE(tree.writeBinary(binary));
  EXPECT_EQ(folder.read("m.bt"), binary.str());
}

TEST(OctreeExport, OctomapBeyondItsKeysIsAnError)
{
  const TestFolder folder;
  test::TestMap map;
  Frame frame;
  frame.T_odom_vehicle = poseFromYpr(6540, 0, 0, 0, 0, 0);
  for (int i = 0; i < 100; ++i)
  {
    frame.cloud.points.emplace_back(5.0F + 0.3F * static_cast<float>(i), 0.0F, 0.0F);
    frame.cloud.source.push_back(0);
  }
  map.insert(frame);
  try
  {
    writeOctomap(map.map, folder.file("m.bt"), {});
    FAIL() << "points were lost";
  }
  catch (const UserError& error)
  {
    EXPECT_NE(std::string(error.what()).find("octree_resolution=0.2; take 0.4"), std::string::npos)
        << error.what();
  }
  MapExportOptions coarser;
  coarser.octree_resolution = 0.4;
  writeOctomap(map.map, folder.file("m.bt"), coarser);
  octomap::OcTree tree(0.4);
  ASSERT_TRUE(tree.readBinary(folder.file("m.bt")));
  EXPECT_NE(tree.search(6540 + 20, 0, 0), nullptr);
}

TEST(OctreeExport, OctomapKnowsOccupiedAndFree)
{
  const TestFolder folder;
  const test::TestMap held = test::room();
  const StaticMap& map = held.map;
  for (const std::string name : {"m.bt", "m.ot"})
  {
    writeOctomap(map, folder.file(name), {});
    const auto first = folder.read(name);
    writeOctomap(map, folder.file(name), {});
    EXPECT_EQ(folder.read(name), first);
  }
  octomap::OcTree tree(0.2);
  ASSERT_TRUE(tree.readBinary(folder.file("m.bt")));
  const auto* wall = tree.search(8.05, 0, 1.0);
  ASSERT_NE(wall, nullptr);
  EXPECT_TRUE(tree.isNodeOccupied(wall));
  const auto* air = tree.search(4.0, 0, 1.3);
  ASSERT_NE(air, nullptr);
  EXPECT_FALSE(tree.isNodeOccupied(air));
  EXPECT_EQ(tree.search(12.0, 0, 1.0), nullptr);
  EXPECT_THROW(writeOctomap(map, folder.file("m.oct"), {}), UserError);
}

/** Cells of a `.ot` file: log-odds by the place of the centre. */
std::map<std::array<double, 3>, float> cellsOf(const std::string& path)
{
  const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(path));
  auto* tree = dynamic_cast<octomap::OcTree*>(read.get());
  std::map<std::array<double, 3>, float> cells;
  if (tree != nullptr)
  {
    tree->expand();
    for (auto leaf = tree->begin_leafs(); leaf != tree->end_leafs(); ++leaf)
    {
      cells[{leaf.getX(), leaf.getY(), leaf.getZ()}] = leaf->getLogOdds();
    }
  }
  return cells;
}

TEST(OctreeExport, OctomapOfAnAreaIsThatPartOfTheWhole)
{
  const TestFolder folder;
  const test::TestMap held = test::room();
  MapExportOptions options;
  writeOctomap(held.map, folder.file("whole.ot"), options);
  options.area = "1003 1998 1008.2 2005";  // around a part of the wall; the lidars are outside
  const Eigen::Vector3d origin(1000, 2000, 0);
  writeOctomap(held.map, folder.file("part.ot"), options, origin);
  auto expected = cellsOf(folder.file("whole.ot"));
  const std::size_t all = expected.size();
  const MapRegion area = areaOf(options, origin);
  for (auto cell = expected.begin(); cell != expected.end();)
  {
    const auto& [x, y, z] = cell->first;
    cell = area.contains({x, y, z}) ? std::next(cell) : expected.erase(cell);
  }
  EXPECT_GT(expected.size(), 100U);
  EXPECT_LT(expected.size(), all / 2);
  EXPECT_EQ(cellsOf(folder.file("part.ot")), expected);

  options.area = "-50 -50 -40 -40";
  writeOctomap(held.map, folder.file("none.bt"), options);
  octomap::OcTree none(options.octree_resolution);
  EXPECT_TRUE(none.readBinary(folder.file("none.bt")));
  EXPECT_EQ(none.size(), 0U);
}

/** From later places there are only rays past the post: its voxel has all points that it keeps. */
TEST(OctreeExport, OctomapKeepsAThinPostThatManyRaysPass)
{
  const TestFolder folder;
  StaticMapOptions options;
  options.visibility = false;
  test::TestMap held(options);
  const Eigen::Vector3d post(5.1, 0.1, 1.1);
  for (std::size_t k = 0; k < 20; ++k)
  {
    Frame frame;
    frame.index = k;
    frame.T_odom_vehicle = poseFromYpr(0, -0.4 * static_cast<double>(k), 1.1, 0, 0, 0);
    const Eigen::Vector3d sensor = frame.T_odom_vehicle.translation();
    const Eigen::Vector3d wall = sensor + 9.1 / 5.1 * (post - sensor);
    for (const Eigen::Vector3d& p : {post, wall})
    {
      frame.cloud.points.push_back((frame.T_odom_vehicle.inverse() * p).cast<float>());
      frame.cloud.intensity.push_back(0.25F);
      frame.cloud.source.push_back(0);
    }
    held.insert(frame);
  }
  writeOctomap(held.map, folder.file("m.bt"), {});
  octomap::OcTree tree(0.2);
  ASSERT_TRUE(tree.readBinary(folder.file("m.bt")));
  const auto* cell = tree.search(post.x(), post.y(), post.z());
  ASSERT_NE(cell, nullptr);
  EXPECT_TRUE(tree.isNodeOccupied(cell));
  const auto* air = tree.search(2.5, -0.1, 1.1);
  ASSERT_NE(air, nullptr);
  EXPECT_FALSE(tree.isNodeOccupied(air));
}

TEST(OctreeExport, OctomapHasTheRaysOfEachLidar)
{
  const TestFolder folder;
  writeOctomap(test::seenByTwoLidars().map, folder.file("m.ot"), {});
  const std::unique_ptr<octomap::AbstractOcTree> read(
      octomap::AbstractOcTree::read(folder.file("m.ot")));
  const auto* tree = dynamic_cast<const octomap::OcTree*>(read.get());
  ASSERT_NE(tree, nullptr);
  const auto* air = tree->search(4.1, 5.15, 1.1);
  ASSERT_NE(air, nullptr) << "before the second lidar";
  EXPECT_FALSE(tree->isNodeOccupied(air));
  const auto* thing = tree->search(8.1, 5.15, 1.1);
  ASSERT_NE(thing, nullptr);
  EXPECT_FLOAT_EQ(thing->getLogOdds(), tree->getProbHitLog()) << "a miss of the other lidar";
}
}  // namespace
}  // namespace dyslam
