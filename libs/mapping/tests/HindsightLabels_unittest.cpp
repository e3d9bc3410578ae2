// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mapping/HindsightLabels.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "TestStreet.h"

namespace dyslam
{
namespace
{
using test::scanAt;

constexpr std::size_t kScans = 24;

/** Position of the car's middle at each scan [m]. */
using Path = std::function<double(std::size_t)>;

bool isOfCar(const Eigen::Vector3f& p, const Frame& frame, double car_x)
{
  const double x = static_cast<double>(p.x()) + frame.T_odom_vehicle.translation().x();
  return std::abs(x - car_x) < 2.2 && std::abs(p.y() + 3) < 1.1F && p.z() > 0.35F && p.z() < 1.6F;
}

std::vector<Frame> decided(const Path& car_x,
                           const std::function<void(Frame&)>& prepare = {},
                           int threads = 1,
                           int window = 10)
{
  HindsightOptions options;
  options.window = window;
  HindsightLabels labels(options, threads);
  std::vector<Frame> result;
  const auto use = [&](const Frame& frame) { result.push_back(frame); };
  for (std::size_t i = 0; i < kScans; ++i)
  {
    Frame frame = scanAt(i, 0.2 * static_cast<double>(i), car_x(i));
    if (prepare)
    {
      prepare(frame);
    }
    labels.add(frame, FrameParts::all, use);
    const auto ahead = static_cast<std::size_t>(window);
    EXPECT_EQ(result.size(), i + 1 > ahead ? i + 1 - ahead : 0U);
  }
  labels.finish(use);
  return result;
}

struct Shares
{
  double car = 0;     //!< share of the car's points labelled moving
  double others = 0;  //!< share of all other points labelled moving
};

Shares movingShares(const std::vector<Frame>& frames, const Path& car_x)
{
  double car = 0;
  double car_moving = 0;
  double others = 0;
  double others_moving = 0;
  for (const Frame& frame : frames)
  {
    EXPECT_EQ(frame.moving.size(), frame.cloud.size());
    for (std::size_t i = 0; i < frame.cloud.size(); ++i)
    {
      const bool of_car = isOfCar(frame.cloud.points[i], frame, car_x(frame.index));
      (of_car ? car : others) += 1;
      (of_car ? car_moving : others_moving) += frame.isMoving(i) ? 1 : 0;
    }
  }
  EXPECT_GT(car, 1000);
  return {car_moving / car, others_moving / others};
}

TEST(HindsightLabels, FindWhatTheCausalDecisionMissed)
{
  const Path passing = [](std::size_t i) { return 4.0 + static_cast<double>(i); };
  const Shares shares = movingShares(decided(passing), passing);
  EXPECT_GT(shares.car, 0.8);
  EXPECT_LT(shares.others, 0.01);
}

TEST(HindsightLabels, WhatStandsAllTheTimeIsStaticWhateverTheCausalDecision)
{
  const Path parked = [](std::size_t) { return 9.0; };
  const auto callMoving = [&](Frame& frame)
  {
    for (const Eigen::Vector3f& p : frame.cloud.points)
    {
      frame.moving.push_back(isOfCar(p, frame, 9.0));
      frame.moving_probability.push_back(frame.moving.back() ? 0.6F : 0.0F);
    }
  };
  const Shares shares = movingShares(decided(parked, callMoving), parked);
  EXPECT_LT(shares.car, 0.01);
  EXPECT_LT(shares.others, 0.01);
}

TEST(HindsightLabels, WhatDroveUpMovesWhileItStandsAsWell)
{
  // The car stops at scan 26; the windows of the scans from 40 on contain it only at rest.
  const Path arriving = [](std::size_t i)
  { return std::max(9.0, 45 - 6 * (static_cast<double>(i) - 20)); };
  const auto share = [&](int history)
  {
    HindsightOptions options;
    options.window = 8;
    options.history = history;
    HindsightLabels labels(options, 1);
    std::vector<Frame> standing;
    const auto use = [&](const Frame& frame)
    {
      if (frame.index >= 40)
      {
        standing.push_back(frame);
      }
    };
    for (std::size_t i = 0; i < 52; ++i)
    {
      labels.add(scanAt(i, 0, arriving(i)), FrameParts::all, use);
    }
    labels.finish(use);
    return movingShares(standing, arriving);
  };
  EXPECT_GT(share(400).car, 0.9);
  EXPECT_LT(share(400).others, 0.01);
  EXPECT_EQ(share(0).car, 0);
}

TEST(HindsightLabels, SameForAnyNumberOfThreads)
{
  const Path passing = [](std::size_t i) { return 4.0 + static_cast<double>(i); };
  const std::vector<Frame> one = decided(passing, {}, 1);
  const std::vector<Frame> four = decided(passing, {}, 4);
  ASSERT_EQ(one.size(), kScans);
  ASSERT_EQ(four.size(), kScans);
  for (std::size_t i = 0; i < kScans; ++i)
  {
    EXPECT_EQ(one[i].index, i) << "frames keep their order";
    EXPECT_EQ(one[i].moving, four[i].moving);
  }
}

TEST(HindsightLabels, TracksAreFollowedBackToTheirFirstDetection)
{
  const auto addObject = [](Frame& frame)
  {
    TrackedObject object;
    object.id = 7;
    object.reported = frame.index >= 5;
    object.confirmed = object.reported;
    object.dynamic = object.reported;
    frame.objects.push_back(object);
    object.id = 8;  // never reported
    object.reported = false;
    frame.objects.push_back(object);
  };
  const Path passing = [](std::size_t i) { return 4.0 + static_cast<double>(i); };
  for (const Frame& frame : decided(passing, addObject))
  {
    EXPECT_TRUE(frame.objects[0].reported) << frame.index;
    EXPECT_FALSE(frame.objects[1].reported) << frame.index;
  }
}

TEST(HindsightLabels, EmptyAndNotFiniteScansAndThoseThatNobodyWants)
{
  HindsightOptions options;
  options.window = 3;
  HindsightLabels labels(options, 1);
  std::vector<Frame> result;
  const auto use = [&](const Frame& frame) { result.push_back(frame); };
  for (std::size_t i = 0; i < 8; ++i)
  {
    Frame frame;
    frame.index = i;
    if (i % 2 == 1)
    {
      const float nan = std::numeric_limits<float>::quiet_NaN();
      frame.cloud.points = {{nan, nan, nan}, {1, 2, 3}};
      frame.cloud.source = {0, 1};
      frame.moving = {true, true};
    }
    labels.add(frame, i != 5 ? FrameParts::all : FrameParts::none, use);
  }
  labels.finish(use);
  ASSERT_EQ(result.size(), 7U);
  EXPECT_EQ(result[1].moving.size(), 2U);
  EXPECT_EQ(result[4].index, 4U);
  EXPECT_EQ(result[5].index, 6U) << "nobody wants the one before";
}
}  // namespace
}  // namespace dyslam
