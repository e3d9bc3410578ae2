// SPDX-License-Identifier: BSD-3-Clause
#include "../src/outputs/FrameRouting.h"

#include <gtest/gtest.h>

#include <vector>

namespace dyslam
{
namespace
{
using Kinds = std::vector<FrameKind>;

/** The frames that each of several outputs gets. */
Kinds kindsFor(const std::vector<WantedFrames>& wanted, FrameKind objects)
{
  const FrameRouting routing(wanted, objects);
  Kinds kinds;
  for (const WantedFrames of_output : wanted)
  {
    kinds.push_back(routing.kindFor(of_output));
  }
  return kinds;
}

FrameParts partsFor(const std::vector<WantedFrames>& wanted, FrameKind objects)
{
  return FrameRouting(wanted, objects).finalParts();
}

constexpr FrameKind causal_frames = FrameKind::causal;
constexpr FrameKind final_frames = FrameKind::final;
constexpr WantedFrames causal = WantedFrames::causal;
constexpr WantedFrames objects = WantedFrames::final_objects;
constexpr WantedFrames points = WantedFrames::final_points;
constexpr WantedFrames scans = WantedFrames::final_scans;

TEST(FrameRouting, WithASecondTrackingAllThatAskForFinalFramesGetThem)
{
  EXPECT_EQ(kindsFor({causal, objects, points, scans}, final_frames),
            (Kinds{causal_frames, final_frames, final_frames, final_frames}));
  EXPECT_EQ(kindsFor({causal, objects, points}, final_frames),
            (Kinds{causal_frames, final_frames, final_frames}));
  EXPECT_EQ(partsFor({causal, objects}, final_frames), FrameParts::points);
  EXPECT_EQ(partsFor({points, objects}, final_frames), FrameParts::intensity);
  EXPECT_EQ(partsFor({objects, scans, points}, final_frames), FrameParts::all);
}

TEST(FrameRouting, CausalFramesDoWhereTheObjectsAreTheSame)
{
  EXPECT_EQ(kindsFor({causal, objects, points}, causal_frames),
            (Kinds{causal_frames, causal_frames, causal_frames}));
  EXPECT_EQ(partsFor({causal, objects, points}, causal_frames), FrameParts::none);
}

TEST(FrameRouting, PointsAreFinalWhereFinalScansAreHeldAnyway)
{
  EXPECT_EQ(kindsFor({causal, objects, points, scans}, causal_frames),
            (Kinds{causal_frames, causal_frames, final_frames, final_frames}));
  EXPECT_EQ(partsFor({causal, objects, points, scans}, causal_frames), FrameParts::all);
}

TEST(FrameRouting, NoFinalFramesWhereNobodyAsksForThem)
{
  for (const FrameKind of_objects : {causal_frames, final_frames})
  {
    EXPECT_EQ(kindsFor({causal, causal}, of_objects), (Kinds{causal_frames, causal_frames}));
    EXPECT_EQ(partsFor({causal, causal}, of_objects), FrameParts::none);
    EXPECT_EQ(partsFor({}, of_objects), FrameParts::none);
  }
}
}  // namespace
}  // namespace dyslam
