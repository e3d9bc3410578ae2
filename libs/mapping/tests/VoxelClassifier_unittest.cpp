// SPDX-License-Identifier: BSD-3-Clause
#include "../src/VoxelClassifier.h"

#include <gtest/gtest.h>

using namespace dyslam;

namespace
{
/** Evidence of a voxel in which rays of other scans ended and through which none passed. */
VoxelEvidence occupied()
{
  VoxelEvidence e;
  e.known = 1;
  return e;
}

/** Evidence of a voxel through which rays passed before and after. */
VoxelEvidence visited()
{
  VoxelEvidence e = occupied();
  e.free = 0.9F;
  e.change_before = 1;
  e.change_after = 1;
  return e;
}

/** A voxel of a segment 1 m long and high. */
VoxelFeatures voxel(const VoxelEvidence& own, const VoxelEvidence& segment)
{
  VoxelFeatures f;
  f.own = own;
  f.around = own;
  f.segment = segment;
  f.height = 0.7F;
  f.length = 1;
  f.segment_height = 1;
  f.voxels = 50;
  return f;
}

VoxelEvidence halfOf(const VoxelEvidence& a, const VoxelEvidence& b)
{
  VoxelEvidence e;
  e.known = 0.5F * (a.known + b.known);
  e.free = 0.5F * (a.free + b.free);
  e.change_before = 0.5F * (a.change_before + b.change_before);
  e.change_after = 0.5F * (a.change_after + b.change_after);
  e.probability = 0.5F * (a.probability + b.probability);
  e.tracked = 0.5F * (a.tracked + b.tracked);
  return e;
}

TEST(VoxelClassifier, WhatWasFreeBeforeAndAfterMoves)
{
  EXPECT_GT(movingScore(voxel(visited(), visited())), 1);
  EXPECT_LT(movingScore(voxel(occupied(), occupied())), -3);
}

TEST(VoxelClassifier, SomeoneWhoTouchesABenchDoesNotMoveIt)
{
  const VoxelEvidence both = halfOf(occupied(), visited());
  EXPECT_LT(movingScore(voxel(occupied(), both)), -1);
  EXPECT_GT(movingScore(voxel(visited(), both)), 1);
}

TEST(VoxelClassifier, WhatNoRayObservedFollowsItsSegment)
{
  VoxelFeatures hidden = voxel(VoxelEvidence(), visited());  // the far side of a vehicle
  hidden.around = halfOf(visited(), VoxelEvidence());
  EXPECT_GT(movingScore(hidden), 1);
}

TEST(VoxelClassifier, ACausalLabelOrATrackSpeaksForMotion)
{
  const VoxelEvidence both = halfOf(occupied(), visited());
  const float still = movingScore(voxel(occupied(), both));
  VoxelFeatures seen = voxel(occupied(), both);
  seen.own.probability = 0.9F;
  EXPECT_GT(movingScore(seen), still + 1);
  seen = voxel(occupied(), both);
  seen.own.tracked = 1;
  EXPECT_GT(movingScore(seen), still + 0.5F);
}

TEST(VoxelClassifier, WhatIsHigherThanVehiclesIsNotJudgedAsAWhole)
{
  VoxelFeatures house = voxel(occupied(), visited());
  house.segment_height = 6;
  EXPECT_LT(movingScore(house), movingScore(voxel(occupied(), visited())));
}

TEST(VoxelClassifier, ADistantVehicleMayBeARowOfVoxelsNearTheGround)
{
  VoxelEvidence busy = occupied();  // a lane in which one vehicle follows the other
  busy.free = 0.6F;
  busy.change_before = 0.33F;
  VoxelFeatures row = voxel(busy, busy);
  row.segment_height = 0.02F;  // hit by one ring
  row.voxels = 12;
  row.range = 25;
  EXPECT_GT(movingScore(row), 1);
  VoxelFeatures twig = row;
  twig.voxels = 1;
  EXPECT_LT(movingScore(twig), -0.5F);
  VoxelFeatures leaves = row;
  leaves.height = 2.5F;
  EXPECT_LT(movingScore(leaves), -0.5F);
  VoxelFeatures kerb = row;  // hit by several rings if it were higher
  kerb.range = 8;
  EXPECT_LT(movingScore(kerb), -0.5F);
}

TEST(VoxelClassifier, ALongThinRowThatRaysOftenMeetIsAFence)
{
  VoxelEvidence barred = occupied();  // a place between the bars of a fence
  barred.free = 0.4F;
  barred.change_before = 0.7F;
  VoxelFeatures fence = voxel(barred, barred);
  fence.length = 8;
  fence.row_length = 8;
  fence.row_width = 0.1F;
  EXPECT_LT(movingScore(fence), -1);
  VoxelFeatures car = fence;
  car.row_length = 4.2F;
  EXPECT_GT(movingScore(car), 0);
  VoxelFeatures truck = fence;
  truck.row_width = 2.5F;
  EXPECT_GT(movingScore(truck), 0);
  VoxelFeatures passing = fence;  // the side of a truck, in a place that is mostly free
  passing.segment.free = 0.8F;
  EXPECT_GT(movingScore(passing), 0);
  VoxelFeatures tracked = fence;
  tracked.segment.tracked = 1;
  EXPECT_GT(movingScore(tracked), 0);
  VoxelFeatures labelled = fence;
  labelled.segment.probability = 0.9F;
  EXPECT_GT(movingScore(labelled), 0);
}

TEST(VoxelClassifier, RaysThatStaticThingsLetPassAreDiscounted)
{
  VoxelEvidence e = visited();
  e.free = 0.6F;
  discount(e, 0.2F);
  EXPECT_FLOAT_EQ(e.free, 0.5F);
  e.free = 0.1F;
  discount(e, 0.2F);
  EXPECT_FLOAT_EQ(e.free, 0);
  VoxelFeatures f = voxel(visited(), visited());
  const float clear = movingScore(f);
  f.doubt = 1;
  EXPECT_LT(movingScore(f), clear);
}
}  // namespace
