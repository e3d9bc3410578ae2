// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/KeyframeStore.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <random>
#include <stdexcept>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

TEST(PackedCloud, RoundTripKeepOnlyAndBadPoints)
{
  KeyframeCloud cloud;
  cloud.points = {{1.234F, -56.7F, 8.9F}, {nan, 0, 0}, {0, 101, 0}, {-99.99F, 0, 3}};
  cloud.intensity = {0.5F, 0, 0, nan};
  cloud.is_static = {1, 1, 1, 0};
  cloud.lidar = {0, 0, 1, 2};
  PackedCloud packed(cloud, 100);
  ASSERT_EQ(packed.size(), 2U);
  const KeyframeCloud back = packed.unpacked();
  EXPECT_LT((back.points[0] - cloud.points[0]).norm(), 0.004F);
  EXPECT_LT((back.points[1] - cloud.points[3]).norm(), 0.004F);
  EXPECT_NEAR(back.intensity[0], 0.5F, 0.002F);
  EXPECT_EQ(back.intensity[1], 0.0F);
  EXPECT_EQ(back.is_static[1], 0);
  packed.keepOnly({false, true});
  ASSERT_EQ(packed.size(), 1U);
  EXPECT_LT((packed.unpacked().points[0] - cloud.points[3]).norm(), 0.004F);
  EXPECT_EQ(packed.unpacked().is_static[0], 0);
  EXPECT_EQ(PackedCloud::fromBytes(packed.toBytes()).unpacked().lidar,
            std::vector<std::uint8_t>{2});
  EXPECT_THROW(packed.keepOnly({true, true}), std::invalid_argument);
}

TEST(PackedCloud, PointsAloneAndPackingAgainChangesNothing)
{
  KeyframeCloud cloud;
  cloud.points = {{1.234F, -56.7F, 8.9F}, {0.001F, 0, 99}};
  const PackedCloud packed(cloud, 100);
  const KeyframeCloud back = packed.unpacked();
  EXPECT_TRUE(back.intensity.empty());
  EXPECT_TRUE(back.is_static.empty());
  EXPECT_EQ(PackedCloud(back, 100).unpacked().points, back.points);
  EXPECT_EQ(PackedCloud().unpacked().size(), 0U);
}

TEST(PackedCloud, ContractIsChecked)
{
  KeyframeCloud uneven;
  uneven.points = {{0, 0, 0}, {1, 0, 0}};
  uneven.intensity = {0};
  EXPECT_THROW(PackedCloud(uneven, 100), std::invalid_argument);
  EXPECT_THROW(PackedCloud({}, 0), std::invalid_argument);
  EXPECT_THROW(PackedCloud({}, std::numeric_limits<double>::infinity()), std::invalid_argument);
}

TEST(KeyframeStore, NumbersKeyframesAndCorrectsTheirPoses)
{
  KeyframeStore store;
  EXPECT_TRUE(store.empty());
  Frame frame;
  frame.index = 7;
  frame.scan.stamp = 12.5;
  frame.scan.T_vehicle_lidar.translation().z() = 1.7;
  frame.T_odom_vehicle = poseFromYpr(1, 0, 0, 0, 0, 0);
  frame.T_map_odom = poseFromYpr(0, 2, 0, 0, 0, 0);
  EXPECT_EQ(store.add(keyframeOf(frame)), 0U);
  EXPECT_EQ(store.add(keyframeOf(frame)), 1U);
  EXPECT_EQ(store[1].frame, 7U);
  EXPECT_EQ(store[1].stamp, 12.5);
  EXPECT_EQ(store[1].sensor.z(), 1.7F);
  EXPECT_EQ(store[1].T_map_vehicle.translation(), Eigen::Vector3d(1, 2, 0));
  EXPECT_EQ(store.revision(), 0U);
  const Pose moved = poseFromYpr(5, 0, 0, 0.1, 0, 0);
  store.correct({Pose::Identity(), moved});
  EXPECT_EQ(store.revision(), 1U);
  EXPECT_EQ(store.back().T_map_vehicle.matrix(), moved.matrix());
  ASSERT_EQ(store.poses().size(), 2U);
  EXPECT_EQ(store.poses()[0].matrix(), Pose::Identity().matrix());
  EXPECT_EQ(store.poses()[1].matrix(), moved.matrix());
  EXPECT_THROW(store.correct({moved}), std::invalid_argument);
}

TEST(KeyframeStore, CloudsOnDiskAreTheSame)
{
  const TestFolder folder;
  MemoryLimit memory;
  memory.file = std::make_shared<SwapFile>(folder.path());
  memory.bytes = 1;
  KeyframeStore on_disk(memory);
  KeyframeStore in_memory;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> coordinate(-90, 90);
  for (std::size_t k = 0; k < 50; ++k)
  {
    KeyframeCloud cloud;
    for (std::size_t i = 0; i < 10 * k; ++i)
    {
      cloud.points.emplace_back(coordinate(random), coordinate(random), coordinate(random));
      cloud.intensity.push_back(0.25F);
      cloud.is_static.push_back(static_cast<std::uint8_t>(i % 2));
    }
    for (KeyframeStore* store : {&on_disk, &in_memory})
    {
      store->add({});
      store->editMapCloud(k) = PackedCloud(cloud, 100);
      KeyframeCloud points;
      points.points = cloud.points;
      store->setLoopCloud(k, PackedCloud(points, 100));
    }
  }
  for (std::size_t k = 0; k < 50; ++k)
  {
    const KeyframeCloud a = on_disk.mapCloud(k).unpacked();
    const KeyframeCloud b = in_memory.mapCloud(k).unpacked();
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.intensity, b.intensity);
    EXPECT_EQ(a.is_static, b.is_static);
    EXPECT_EQ(on_disk.loopCloud(k).unpacked().points, in_memory.loopCloud(k).unpacked().points);
  }
  EXPECT_GT(memory.file->size(), 100000U);
}
}  // namespace
}  // namespace dyslam
