// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/eval/MapMetrics.h>
#include <dyslam/eval/SegmentationMetrics.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace dyslam
{
namespace
{
TEST(Segmentation, MatchesTheBenchmarksDefinition)
{
  SegmentationEvaluator evaluator;
  // moving car found, moving person missed, parked car estimated as moving, road, unlabelled
  evaluator.add({252U | (7U << 16U), 254, 10, 40, 0, 1}, {251, 9, 252, 40, 252, 252});
  evaluator.add({259, 9}, {0, 0});
  const auto& s = evaluator.scores();
  EXPECT_EQ(s.true_positives, 1U);
  EXPECT_EQ(s.false_negatives, 2U);
  EXPECT_EQ(s.false_positives, 1U);
  EXPECT_EQ(s.true_negatives, 2U);
  EXPECT_EQ(s.ignored, 2U);
  EXPECT_DOUBLE_EQ(*s.iou(), 0.25);
  EXPECT_DOUBLE_EQ(*s.precision(), 0.5);
  EXPECT_DOUBLE_EQ(*s.recall(), 1.0 / 3);
  EXPECT_DOUBLE_EQ(*s.staticIou(), 0.4);
  EXPECT_DOUBLE_EQ(*s.labelledShare(), 0.75) << "six of eight";
  EXPECT_EQ(evaluator.scans(), 2U);
  EXPECT_EQ(evaluator.perClass().at(252).called_moving, 1U);
  EXPECT_EQ(evaluator.perClass().at(254).called_moving, 0U);
  EXPECT_EQ(evaluator.perClass().at(10).called_moving, 1U);
  EXPECT_EQ(evaluator.perClass().count(0), 0U);
}

TEST(Segmentation, EmptyAndMismatch)
{
  SegmentationEvaluator evaluator;
  evaluator.add({}, {});
  EXPECT_FALSE(evaluator.scores().iou());
  EXPECT_FALSE(evaluator.scores().precision());
  EXPECT_FALSE(evaluator.scores().recall());
  EXPECT_FALSE(evaluator.scores().labelledShare());
  EXPECT_THROW(evaluator.add({1}, {}), std::invalid_argument);
  EXPECT_EQ(semanticKittiName(252), "moving-car");
  EXPECT_EQ(semanticKittiName(1234), "class 1234");
  EXPECT_TRUE(isSemanticKittiClass(0));
  EXPECT_TRUE(isSemanticKittiClass(259));
  EXPECT_FALSE(isSemanticKittiClass(2));
  EXPECT_FALSE(isSemanticKittiClass(1234));
}

TEST(MapMetrics, KnownMap)
{
  const std::vector<Eigen::Vector3f> reference{{0, 0, 0}, {1, 0, 0}, {2, 0, 0},
                                               {3, 0, 0}, {4, 0, 0}, {5, 0, 0}};
  const std::vector<std::uint32_t> labels{9, 9, 252, 252, 252, 0};
  // preserves one of two static points, rejects two of three dynamic ones; NaN is ignored
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto e = evaluateMap(reference, labels, {{0.01F, 0, 0}, {2.05F, 0, 0}, {nan, 0, 0}});
  EXPECT_DOUBLE_EQ(*e.points.preservation(), 0.5);
  EXPECT_DOUBLE_EQ(*e.points.rejection(), 2.0 / 3);
  EXPECT_EQ(e.points.unlabelled, 1U);
  EXPECT_DOUBLE_EQ(*e.voxels.preservation(), 0.5);
  EXPECT_DOUBLE_EQ(*e.voxels.rejection(), 2.0 / 3);
  EXPECT_DOUBLE_EQ(*harmonicMean(0.5, 1.0), 2.0 / 3);
  EXPECT_DOUBLE_EQ(*geometricMean(0.25, 1.0), 0.5);
  EXPECT_DOUBLE_EQ(*harmonicMean(0.0, 0.0), 0.0);
  EXPECT_FALSE(harmonicMean(std::nullopt, 1.0));
}

TEST(MapMetrics, VoxelWithStaticAndDynamicPointsIsStatic)
{
  const auto e = evaluateMap({{0.05F, 0.05F, 0.05F}, {0.1F, 0.1F, 0.1F}}, {252, 9}, {});
  EXPECT_EQ(e.voxels.static_total, 1U);
  EXPECT_EQ(e.voxels.dynamic_total, 0U);
  EXPECT_DOUBLE_EQ(*e.voxels.preservation(), 0.0);
}

TEST(MapMetrics, UnlabelledAndOutlierPointsAreIgnored)
{
  const auto e =
      evaluateMap({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {9, 0, 1U | (7U << 16U), 251}, {});
  for (const MapScores& scores : {e.points, e.voxels})
  {
    EXPECT_EQ(scores.unlabelled, 2U);
    EXPECT_EQ(scores.static_total, 1U);
    EXPECT_EQ(scores.dynamic_total, 1U);
  }
}

TEST(MapMetrics, PointsTooFarAwayToCountVoxels)
{
  const std::vector<Eigen::Vector3f> points{{1, 2, 3}, {1e30F, -1e30F, 3e38F}, {-3e38F, 1e9F, 0}};
  const MapEvaluation same = evaluateMap(points, {9, 9, 9}, points, {});
  EXPECT_EQ(same.points.static_total, 3U);
  EXPECT_EQ(same.points.static_preserved, 3U);
  EXPECT_EQ(same.voxels.static_preserved, 3U);
}

TEST(MapMetrics, EmptyAndBadInput)
{
  const auto e = evaluateMap({}, {}, {});
  EXPECT_FALSE(e.points.preservation());
  EXPECT_FALSE(e.points.rejection());
  EXPECT_THROW((void)evaluateMap({{0, 0, 0}}, {}, {}), std::invalid_argument);
  EXPECT_THROW((void)evaluateMap({}, {}, {}, {0.0, 0.2}), std::invalid_argument);
}

TEST(MapMetrics, RadiusSearchMatchesBruteForce)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-3, 3);
  const auto cloud = [&](std::size_t n)
  {
    std::vector<Eigen::Vector3f> points;
    for (std::size_t i = 0; i < n; ++i)
    {
      points.emplace_back(place(random), place(random), place(random));
    }
    return points;
  };
  const auto reference = cloud(600);
  const auto estimate = cloud(800);
  const std::vector<std::uint32_t> labels(reference.size(), 9);
  std::size_t kept = 0;
  for (const auto& p : reference)
  {
    for (const auto& q : estimate)
    {
      if ((p - q).cast<double>().norm() <= 0.3)
      {
        ++kept;
        break;
      }
    }
  }
  const auto e = evaluateMap(reference, labels, estimate, {0.3, 0.2});
  EXPECT_EQ(e.points.static_preserved, kept);
  EXPECT_GT(kept, 100U);
  EXPECT_LT(kept, 600U);
}
}  // namespace
}  // namespace dyslam
