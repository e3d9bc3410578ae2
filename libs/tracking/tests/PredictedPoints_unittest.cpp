// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/tracking/Detector.h>
#include <dyslam/tracking/Tracker.h>
#include <gtest/gtest.h>

#include <algorithm>

using namespace dyslam;

namespace
{
constexpr double period = 0.1;             // of the scans [s]
constexpr double speed = 5;                // of the car [m/s]
constexpr float road = -1.7F;              // height [m]
constexpr std::size_t sides = 2 * 40 * 7;  // points of the car

/** The rear and a side of a car of 4 m x 1.8 m that drives ahead, 10 m to the front and 4 m to the
 * left at time 0, a wall beside it, and the road. */
Cloud sceneAt(double t)
{
  Cloud cloud;
  const auto x = static_cast<float>(10 + speed * t);
  for (int k = 0; k < 7; ++k)
  {
    const float z = road + 0.3F + 0.2F * static_cast<float>(k);
    for (int i = 0; i < 40; ++i)
    {
      cloud.points.emplace_back(x, 3.1F + 0.045F * static_cast<float>(i), z);
      cloud.points.emplace_back(x + 0.1F * static_cast<float>(i), 3.1F, z);
    }
  }
  for (int i = 0; i < 600; ++i)
  {
    const float along = 0.1F * static_cast<float>(i);
    cloud.points.emplace_back(along, 5.6F, road + 1);
    cloud.points.emplace_back(along, 4.0F, road);
    cloud.points.emplace_back(along, 3.0F, road);
  }
  return cloud;
}

/** What a tracker makes of the scene. */
class Drive
{
 public:
  explicit Drive(const TrackerOptions& options = {}, MovingLabels labels = MovingLabels::causal)
      : tracker_(options, labels)
  {
  }

  /** The next scan. \param share of the car's points that the segmenter finds \param missed moving
   * probability of the others, and of what is static */
  const Frame& next(double share, float missed = 0.02F)
  {
    frame_ = Frame();
    frame_.scan.stamp = pauses_ + period * static_cast<double>(scan_);
    frame_.cloud = sceneAt(frame_.scan.stamp);
    frame_.moving.assign(frame_.cloud.size(), false);
    frame_.moving_probability.assign(frame_.cloud.size(), missed);
    for (std::size_t i = 0; i < static_cast<std::size_t>(share * sides); ++i)
    {
      frame_.moving[i] = true;
      frame_.moving_probability[i] = 0.98F;
    }
    tracker_.markPredicted(frame_);
    detector_.detect(frame_);
    tracker_.update(frame_);
    ++scan_;
    return frame_;
  }
  void pass(int scans, double share)
  {
    for (int i = 0; i < scans; ++i)
    {
      next(share);
    }
  }
  /** Time without scans [s]. */
  void pause(double seconds) { pauses_ += seconds; }

 private:
  Detector detector_;
  Tracker tracker_;
  Frame frame_;
  int scan_ = 0;
  double pauses_ = 0;  //!< sum of all pauses [s]
};

std::size_t movingOf(const Frame& frame, std::size_t first, std::size_t last)
{
  return static_cast<std::size_t>(
      std::count(frame.moving.begin() + static_cast<std::ptrdiff_t>(first),
                 frame.moving.begin() + static_cast<std::ptrdiff_t>(last), true));
}
}  // namespace

TEST(PredictedPoints, ACarThatTheSegmenterMissesIsStillDetected)
{
  Drive drive;
  drive.pass(20, 1);
  for (int scan = 0; scan < 10; ++scan)
  {
    const Frame& frame = drive.next(0);
    EXPECT_GT(movingOf(frame, 0, sides), 0.8 * sides) << scan;  // not those close to the road
    EXPECT_EQ(movingOf(frame, sides, frame.cloud.size()), 0U) << scan;
    EXPECT_EQ(frame.moving, frame.moving_by_prediction);
    EXPECT_GT(frame.moving_probability[sides / 2], 0.5F);
    ASSERT_EQ(frame.objects.size(), 1U);
    EXPECT_TRUE(frame.objects.front().observed) << scan;
    EXPECT_EQ(frame.objects.front().id, 0);
    EXPECT_NEAR(frame.objects.front().velocity.x(), speed, 0.5);
  }
}

TEST(PredictedPoints, OnlyForSoManyScansInARow)
{
  TrackerOptions options;
  options.predicted_scans = 5;
  Drive drive(options);
  drive.pass(20, 1);
  drive.pass(5, 0);
  EXPECT_EQ(movingOf(drive.next(0), 0, sides), 0U);

  Drive seen_between(options);
  seen_between.pass(20, 1);
  seen_between.pass(4, 0);
  seen_between.pass(1, 1);
  seen_between.pass(4, 0);
  EXPECT_GT(movingOf(seen_between.next(0), 0, sides), 0U);

  options.predicted_scans = 0;
  Drive off(options);
  off.pass(20, 1);
  EXPECT_EQ(movingOf(off.next(0), 0, sides), 0U);
}

TEST(PredictedPoints, OfAnObjectThatIsMostlyFoundNothingIsAdded)
{
  Drive drive;
  drive.pass(20, 1);
  const Frame& frame = drive.next(0.8);
  EXPECT_EQ(movingOf(frame, 0, frame.cloud.size()), static_cast<std::size_t>(0.8 * sides));
  EXPECT_TRUE(frame.moving_by_prediction.empty());
}

TEST(PredictedPoints, ATrackThatIsNotKnownToMoveMarksNothing)
{
  Drive drive;
  drive.pass(2, 1);
  EXPECT_EQ(movingOf(drive.next(0), 0, sides), 0U);
}

TEST(PredictedPoints, AfterALongPauseNothingIsMarked)
{
  Drive drive;
  drive.pass(20, 1);
  drive.pause(1);
  EXPECT_GT(movingOf(drive.next(0), 0, sides), 0U);
  drive.pause(6);  // the car is where it is predicted
  const Frame& frame = drive.next(0);
  EXPECT_EQ(movingOf(frame, 0, frame.cloud.size()), 0U);
  EXPECT_TRUE(frame.objects.empty());
}

TEST(PredictedPoints, WhatIsCertainlyStaticWithHindsightRemainsStatic)
{
  Drive causal;
  Drive hindsight({}, MovingLabels::hindsight);
  causal.pass(20, 1);
  hindsight.pass(20, 1);
  for (const float probability : {0.02F, 0.001F})
  {
    EXPECT_GT(movingOf(causal.next(0, probability), 0, sides), 0.8 * sides) << probability;
  }
  EXPECT_GT(movingOf(hindsight.next(0, 0.02F), 0, sides), 0.8 * sides);
  const Frame& frame = hindsight.next(0, 0.001F);
  EXPECT_EQ(movingOf(frame, 0, frame.cloud.size()), 0U);
  EXPECT_TRUE(frame.moving_by_prediction.empty());
}

TEST(PredictedPoints, LowPointsAreMarkedWithHindsightWhereTheBoxHasNoOthers)
{
  Drive drive({}, MovingLabels::hindsight);
  drive.pass(20, 1);
  EXPECT_GT(movingOf(drive.next(0, 0), 0, sides), 0.8 * sides);
}
