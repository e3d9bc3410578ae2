// SPDX-License-Identifier: BSD-3-Clause
#include "../src/PlaceClassifier.h"

#include <gtest/gtest.h>

using namespace dyslam;

namespace
{
/** Rays of other scans ended there, none passed. */
PlaceEvidence occupied()
{
  PlaceEvidence e;
  e.known = 1;
  return e;
}

/** Rays passed through before and after. */
PlaceEvidence visited()
{
  PlaceEvidence e = occupied();
  e.free = 0.9F;
  e.change_before = 1;
  e.change_after = 1;
  return e;
}

/** A place of something 1 m long and high. */
PlaceFeatures place(const PlaceEvidence& own, const PlaceEvidence& segment)
{
  PlaceFeatures f;
  f.own = own;
  f.around = own;
  f.segment = segment;
  f.height = 0.7F;
  f.length = 1;
  f.segment_height = 1;
  f.places = 50;
  return f;
}

PlaceEvidence halfOf(const PlaceEvidence& a, const PlaceEvidence& b)
{
  PlaceEvidence e;
  e.known = 0.5F * (a.known + b.known);
  e.free = 0.5F * (a.free + b.free);
  e.change_before = 0.5F * (a.change_before + b.change_before);
  e.change_after = 0.5F * (a.change_after + b.change_after);
  e.probability = 0.5F * (a.probability + b.probability);
  e.tracked = 0.5F * (a.tracked + b.tracked);
  return e;
}

TEST(PlaceClassifier, WhatWasFreeBeforeAndAfterMoves)
{
  EXPECT_GT(movingScore(place(visited(), visited())), 1);
  EXPECT_LT(movingScore(place(occupied(), occupied())), -3);
}

TEST(PlaceClassifier, SomeoneWhoTouchesABenchDoesNotMoveIt)
{
  const PlaceEvidence both = halfOf(occupied(), visited());
  EXPECT_LT(movingScore(place(occupied(), both)), -1);
  EXPECT_GT(movingScore(place(visited(), both)), 1);
}

TEST(PlaceClassifier, WhatNoRayObservedFollowsItsSegment)
{
  PlaceFeatures hidden = place(PlaceEvidence(), visited());  // the far side of a vehicle
  hidden.around = halfOf(visited(), PlaceEvidence());
  EXPECT_GT(movingScore(hidden), 1);
}

TEST(PlaceClassifier, ACausalLabelOrATrackSpeaksForMotion)
{
  const PlaceEvidence both = halfOf(occupied(), visited());
  const float still = movingScore(place(occupied(), both));
  PlaceFeatures seen = place(occupied(), both);
  seen.own.probability = 0.9F;
  EXPECT_GT(movingScore(seen), still + 1);
  seen = place(occupied(), both);
  seen.own.tracked = 1;
  EXPECT_GT(movingScore(seen), still + 0.5F);
}

TEST(PlaceClassifier, WhatIsHigherThanVehiclesIsNotJudgedAsAWhole)
{
  PlaceFeatures house = place(occupied(), visited());
  house.segment_height = 6;
  EXPECT_LT(movingScore(house), movingScore(place(occupied(), visited())));
}

TEST(PlaceClassifier, RaysThatStaticThingsLetPassAreDiscounted)
{
  PlaceEvidence e = visited();
  e.free = 0.6F;
  discount(e, 0.2F);
  EXPECT_FLOAT_EQ(e.free, 0.5F);
  e.free = 0.1F;
  discount(e, 0.2F);
  EXPECT_FLOAT_EQ(e.free, 0);
  PlaceFeatures f = place(visited(), visited());
  const float clear = movingScore(f);
  f.doubt = 1;
  EXPECT_LT(movingScore(f), clear);
}
}  // namespace
