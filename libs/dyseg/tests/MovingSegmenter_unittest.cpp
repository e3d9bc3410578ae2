// SPDX-License-Identifier: BSD-3-Clause
// One contract for every segmenter, and the decision of what moves.
#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/dyseg/MovingSegmenter.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace dyslam
{
namespace
{
constexpr float sensor_height = 1.8F;

/** Ground, two walls, trees before them, and a car-sized box at `x` ahead on the left, seen from a
 * standing sensor. Without the trees the box alone would show the motion along the walls. */
Frame streetWith(float x, std::size_t index, unsigned seed)
{
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0, 0.01F);
  Frame frame;
  frame.index = index;
  frame.scan.stamp = 0.1 * static_cast<double>(index);
  frame.scan.T_vehicle_lidar.translation().z() = static_cast<double>(sensor_height);
  const auto put = [&](float px, float py, float pz)
  { frame.cloud.points.emplace_back(px + noise(random), py + noise(random), pz + noise(random)); };
  for (float a = -25; a < 25; a += 0.2F)
  {
    for (float b = -7.5F; b < 7.6F; b += 0.3F)
    {
      put(a, b, 0);
    }
    for (float h = 0.2F; h < 4; h += 0.2F)
    {
      put(a, 8, h);
      put(a, -8, h);
    }
  }
  for (const float tree : {-21.F, -12.5F, -7.F, 3.F, 9.5F, 19.F})
  {
    const float side = tree < -10 || tree > 5 ? 6.5F : -6.5F;
    for (float h = 0.2F; h < 4; h += 0.1F)
    {
      for (float angle = 0; angle < 6.2F; angle += 0.6F)
      {
        put(tree + 0.2F * std::cos(angle), side + 0.2F * std::sin(angle), h);
      }
    }
  }
  for (float h = 0.2F; h < 1.5F; h += 0.05F)
  {
    for (float w = 0; w < 1.8F; w += 0.05F)
    {
      put(x, 2.5F + w, h);
      put(x + 2 * w, 2.5F, h);
    }
  }
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    frame.cloud.source.push_back(static_cast<std::uint32_t>(i));
  }
  return frame;
}

class EverySegmenter : public testing::TestWithParam<std::string>
{
 protected:
  std::unique_ptr<MovingSegmenter> make()
  {
    const Config config;
    ConfigLoader loader(config);
    return makeSegmenter(GetParam(), loader, pool_);
  }
  static void expectProbabilities(const Frame& frame)
  {
    ASSERT_EQ(frame.moving_probability.size(), frame.cloud.size());
    for (const float p : frame.moving_probability)
    {
      ASSERT_GE(p, 0.0F);
      ASSERT_LE(p, 1.0F);
    }
  }

  ThreadPool pool_{2};
};

TEST_P(EverySegmenter, KnowsItsName)
{
  EXPECT_EQ(make()->name(), GetParam());
}

TEST_P(EverySegmenter, TheFirstScanIsStatic)
{
  const auto segmenter = make();
  Frame frame = streetWith(8, 0, 1);
  segmenter->segment(frame);
  expectProbabilities(frame);
  decideMoving(frame, 0.5);
  EXPECT_EQ(std::count(frame.moving.begin(), frame.moving.end(), true), 0);
  EXPECT_FALSE(frame.segmenter_motion) << "there is nothing to have moved from";
}

TEST_P(EverySegmenter, AStandingSceneHasNoMovers)
{
  const auto segmenter = make();
  for (std::size_t i = 0; i < 10; ++i)
  {
    Frame frame = streetWith(8, i, static_cast<unsigned>(i));
    segmenter->segment(frame);
    expectProbabilities(frame);
    decideMoving(frame, 0.5);
    EXPECT_LT(std::count(frame.moving.begin(), frame.moving.end(), true), 20) << i;
  }
}

TEST_P(EverySegmenter, FindsAVehicleThatDrives)
{
  const auto segmenter = make();
  std::ptrdiff_t found = 0;
  std::ptrdiff_t false_alarms = 0;
  std::ptrdiff_t moving_points = 0;
  for (std::size_t i = 0; i < 12; ++i)
  {
    const float x = 14 - 0.8F * static_cast<float>(i);
    Frame frame = streetWith(x, i, static_cast<unsigned>(i));
    segmenter->segment(frame);
    expectProbabilities(frame);
    decideMoving(frame, 0.5);
    for (std::size_t k = 0; i == 11 && k < frame.cloud.size(); ++k)
    {
      const Eigen::Vector3f& p = frame.cloud.points[k];
      const bool on_vehicle =
          p.x() > x - 0.1F && p.x() < x + 3.8F && p.y() > 2.4F && p.y() < 4.4F && p.z() > 0.4F;
      const bool beside = p.z() > 0.4F && !on_vehicle;
      moving_points += on_vehicle ? 1 : 0;
      found += on_vehicle && frame.moving[k] ? 1 : 0;
      false_alarms += beside && frame.moving[k] ? 1 : 0;
    }
  }
  EXPECT_GT(found, moving_points / 2);
  EXPECT_LT(false_alarms, moving_points / 10);
}

TEST_P(EverySegmenter, EmptyAndInvalidFramesDoNoHarm)
{
  const auto segmenter = make();
  Frame empty;
  segmenter->segment(empty);
  EXPECT_TRUE(empty.moving_probability.empty());
  Frame one = streetWith(8, 1, 1);
  one.cloud.points[5].setConstant(std::numeric_limits<float>::quiet_NaN());
  segmenter->segment(one);
  expectProbabilities(one);
  Frame again;
  again.index = 2;
  segmenter->segment(again);
  Frame after = streetWith(8, 3, 2);
  segmenter->segment(after);
  expectProbabilities(after);
}

TEST_P(EverySegmenter, GoesOnFromItsState)
{
  const auto at = [](std::size_t i)
  { return streetWith(14 - 0.8F * static_cast<float>(i), i, static_cast<unsigned>(i)); };
  const auto segmenter = make();
  for (std::size_t i = 0; i < 9; ++i)
  {
    Frame frame = at(i);
    segmenter->segment(frame);
  }
  StateArchive saved;
  saved(*segmenter);
  const auto loaded = make();
  StateArchive archive(saved.bytes());
  archive(*loaded);
  archive.requireEnd();
  for (std::size_t i = 9; i < 12; ++i)
  {
    Frame a = at(i);
    Frame b = a;
    segmenter->segment(a);
    loaded->segment(b);
    EXPECT_EQ(a.moving_probability, b.moving_probability) << i;
    ASSERT_EQ(a.segmenter_motion.has_value(), b.segmenter_motion.has_value()) << i;
    if (a.segmenter_motion)
    {
      EXPECT_EQ(a.segmenter_motion->T_previous_current.matrix(),
                b.segmenter_motion->T_previous_current.matrix())
          << i;
    }
  }
}

std::vector<std::string> segmentersHere()
{
  std::vector<std::string> names;
  for (const std::string& name : segmenterMethods())
  {
#ifndef DYSLAM_HAVE_TORCH
    if (segmenterNeedsNetworks(name))
    {
      continue;  // throws on construction
    }
#endif
    if (name != "none")
    {
      names.push_back(name);
    }
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(Methods,
                         EverySegmenter,
                         testing::ValuesIn(segmentersHere()),
                         [](const testing::TestParamInfo<std::string>& test_info)
                         { return test_info.param; });

TEST(MakeSegmenter, NoneIsNull)
{
  ThreadPool pool(1);
  const Config config;
  ConfigLoader loader(config);
  EXPECT_EQ(makeSegmenter("none", loader, pool), nullptr);
}

TEST(MakeSegmenter, OnlyNetworkNeedsTheNetworks)
{
  for (const std::string& name : segmenterMethods())
  {
    EXPECT_EQ(segmenterNeedsNetworks(name), name == "network") << name;
  }
  EXPECT_FALSE(segmenterNeedsNetworks("unknown"));
}

TEST(MakeSegmenter, NamesTheNearest)
{
  ThreadPool pool(1);
  const Config config;
  ConfigLoader loader(config);
  try
  {
    (void)makeSegmenter("residuals", loader, pool);
    FAIL() << "an unknown name was accepted";
  }
  catch (const UserError& error)
  {
    EXPECT_NE(std::string(error.what()).find("did you mean 'residual'"), std::string::npos);
  }
}

TEST(DecideMoving, NothingMovesWhereNothingWasSegmented)
{
  Frame frame;
  frame.cloud.points.resize(3);
  frame.moving = {true};
  decideMoving(frame, 0.5);
  EXPECT_EQ(frame.moving, std::vector<bool>(3, false));
}

TEST(DecideMoving, TheThresholdItselfIsStatic)
{
  Frame frame;
  frame.cloud.points.resize(3);
  frame.moving_probability = {0.2F, 0.5F, 0.9F};
  decideMoving(frame, 0.5);
  EXPECT_EQ(frame.moving, (std::vector<bool>{false, false, true}));
  decideMoving(frame, 0.1);
  EXPECT_EQ(frame.moving, (std::vector<bool>{true, true, true}));
  EXPECT_TRUE(frame.isMoving(2));
  EXPECT_FALSE(frame.isMoving(3)) << "beyond the cloud";
}
}  // namespace
}  // namespace dyslam
