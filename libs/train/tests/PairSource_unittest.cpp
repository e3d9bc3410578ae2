// SPDX-License-Identifier: BSD-3-Clause
// After any augmentation the true motion of a pair maps static points of the later scan to the
// earlier one.
#include <dyslam/base/Error.h>
#include <dyslam/train/RecordingPairSource.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "SimulatorPairSource.h"

namespace dyslam
{
namespace
{
using Points = std::vector<Eigen::Vector3f>;

/** Points in all directions at ranges from 5 to 40 m, no two in the same direction. */
Points world()
{
  Points points;
  for (int i = 0; i < 2000; ++i)
  {
    const double azimuth = 0.1 + 2 * M_PI * i / 2000;
    const double range = 5 + 35 * std::abs(std::sin(12.9898 * i));
    points.emplace_back(
        Eigen::Vector3d(range * std::cos(azimuth), range * std::sin(azimuth), -1.7 + 0.001 * i)
            .cast<float>());
  }
  return points;
}

Points seenFrom(const Pose& T_world_sensor, const Points& world)
{
  const Eigen::Isometry3f T = T_world_sensor.inverse().cast<float>();
  Points seen;
  for (const Eigen::Vector3f& p : world)
  {
    seen.push_back(T * p);
  }
  return seen;
}

/** Largest distance of common points of both scans under the true motion [m]. */
float apart(const TrainingPair& pair, std::size_t count)
{
  const Eigen::Isometry3f T = pair.T_2_1.cast<float>();
  float most = 0;
  std::size_t both = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    if (pair.points1[i].allFinite() && pair.points2[i].allFinite())
    {
      most = std::max(most, (T * pair.points1[i] - pair.points2[i]).norm());
      ++both;
    }
  }
  EXPECT_GT(both, count / 4);
  return most;
}

AugmentationOptions withoutNoise()
{
  AugmentationOptions options;
  options.range_noise = 0;
  options.point_dropout = 0;
  options.beam_dropout = 0;
  options.bodies = 1;
  return options;
}

AugmentationOptions none()
{
  AugmentationOptions options;
  options.translation = options.yaw = options.mirror = options.turned = options.range_noise = 0;
  options.point_dropout = options.beam_dropout = options.bodies = 0;
  return options;
}

TEST(Augmentation, TheTruthStaysTrue)
{
  const Points points = world();
  const Body body(50, Eigen::Vector3f(8, 1, -1));
  const Pose T_2_1 = poseFromYpr(1.2, 0.1, 0.02, 0.05, 0.01, -0.01);
  bool changed = false;
  bool moved = false;
  for (std::uint64_t i = 0; i < 40; ++i)
  {
    TrainingPair pair;
    pair.points1 = points;
    pair.points2 = seenFrom(T_2_1.inverse(), points);
    pair.T_2_1 = T_2_1;
    RandomDraws draws(1, i);
    augment(withoutNoise(), {body}, draws, pair);
    EXPECT_LT(apart(pair, points.size()), 1e-3F) << i;
    changed = changed || !pair.T_2_1.isApprox(T_2_1, 1e-3);
    ASSERT_EQ(pair.points1.size(), pair.points2.size());
    ASSERT_EQ(pair.points1.size(), pair.labels1.size());
    const Eigen::Isometry3f T = pair.T_2_1.cast<float>();
    for (std::size_t k = points.size(); k < pair.points1.size(); ++k)
    {
      const float off = (T * pair.points1[k] - pair.points2[k]).norm();
      if (pair.labels1[k] == PointLabel::still)
      {
        EXPECT_LT(off, 1e-3F);
      }
      else if (pair.labels1[k] == PointLabel::moving)
      {
        EXPECT_GT(off, 0.04F);
        moved = true;
      }
    }
  }
  EXPECT_TRUE(changed);
  EXPECT_TRUE(moved);
}

TEST(Augmentation, NoiseStaysAlongTheRays)
{
  const Points points = world();
  TrainingPair pair;
  pair.points1 = points;
  pair.points2 = points;
  AugmentationOptions options = none();
  options.range_noise = 0.05;
  options.point_dropout = 0.5;
  RandomDraws draws(1, 1);
  augment(options, {}, draws, pair);
  std::size_t dropped = 0;
  float off = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Eigen::Vector3f& p = pair.points1[i];
    if (!p.allFinite())
    {
      ++dropped;
      continue;
    }
    EXPECT_LT(p.normalized().cross(points[i].normalized()).norm(), 1e-5F);
    off = std::max(off, std::abs(p.norm() - points[i].norm()));
  }
  EXPECT_GT(dropped, 0U);
  EXPECT_LT(dropped, points.size() * 6 / 10);
  EXPECT_GT(off, 0);
  EXPECT_LT(off, 0.13F);
}

TEST(Augmentation, ABodyHidesWhatIsBehind)
{
  TrainingPair pair;
  pair.points1 = {{20, 0, 0}, {0, 20, 0}, {4, 0, 0}};
  pair.points2 = pair.points1;
  pair.labels1.assign(3, PointLabel::still);
  Body body;
  for (int i = -10; i <= 10; ++i)
  {
    body.emplace_back(8.F, 0.05F * static_cast<float>(i), 0.F);
  }
  pasteBody(body, Pose::Identity(), PointLabel::moving, pair);
  EXPECT_FALSE(pair.points1[0].allFinite());
  EXPECT_TRUE(pair.points1[1].allFinite());
  EXPECT_TRUE(pair.points1[2].allFinite()) << "nearer than the body";
  EXPECT_EQ(pair.points1.size(), 3 + body.size());
  EXPECT_EQ(pair.labels1.back(), PointLabel::moving);
}

TEST(RecordingPairSource, PairsOfDifferentScansAndTheirMotion)
{
  const Points points = world();
  for (const std::size_t scans : {2U, 3U, 9U})
  {
    Recording recording;
    for (std::size_t i = 0; i < scans; ++i)
    {
      const auto k = static_cast<double>(i);
      recording.T_world_scan.push_back(poseFromYpr(k, 0.1 * k, 0, 0.02 * k, 0, 0));
      recording.scans.push_back(seenFrom(recording.T_world_scan.back(), points));
    }
    const RecordingPairSource source({recording}, {}, none(), 5, 7);
    bool ahead = false;
    bool back = false;
    for (std::uint64_t i = 0; i < 60; ++i)
    {
      const TrainingPair pair = source.pair(i);
      EXPECT_LT(apart(pair, points.size()), 1e-3F);
      EXPECT_GT(pair.T_2_1.translation().norm(), 0.9) << "a scan with itself";
      ahead = ahead || pair.T_2_1.translation().x() > 0;
      back = back || pair.T_2_1.translation().x() < 0;
    }
    EXPECT_TRUE(ahead && back);
  }
  EXPECT_THROW(RecordingPairSource({Recording()}, {}, none(), 5, 7), UserError);
  EXPECT_THROW(RecordingPairSource({}, {}, none(), 5, 7), UserError);
}

TEST(SimulatorPairSource, ErrorsNameTheWorld)
{
  const auto said = [](const std::string& world) -> std::string
  {
    try
    {
      (void)makeSimulatorPairSource({"1;urban;VLP16;0;0;1", world}, none(), 3, {5, 9}, 1);
    }
    catch (const UserError& error)
    {
      return error.what();
    }
    return "";
  };
  const std::string field = "[data] simulator_worlds: ";
  EXPECT_EQ(said("1;campus;VLP16;900;0;1"), "");
  for (const std::string world : {"1;urban;VLP16", "0;urban;VLP16;0;0;1", "1;urban;VLP16;x;0;1"})
  {
    EXPECT_EQ(said(world).rfind(field + "'" + world + "': write share;world;sensor;", 0), 0U)
        << said(world);
  }
  EXPECT_EQ(
      said("1;urban;VLP16;9000;0;1"),
      field + "'1;urban;VLP16;9000;0;1': [clips] columns = 9000 is out of range; use 0 to 8192");
  EXPECT_EQ(said("1;urbn;VLP16;0;0;1").rfind(field + "'1;urbn;VLP16;0;0;1': unknown world", 0), 0U)
      << said("1;urbn;VLP16;0;0;1");
}

TEST(SingleScanSource, BothHalvesShowOneScan)
{
  const Points points = world();
  const SingleScanSource source({points}, {}, none(), 3);
  for (std::uint64_t i = 0; i < 5; ++i)
  {
    const TrainingPair pair = source.pair(i);
    EXPECT_GT(pair.points1.size() + pair.points2.size(), points.size());
    const Eigen::Isometry3f T = pair.T_2_1.cast<float>();
    // The earlier scan of the pair holds the scan's own points.
    for (const Eigen::Vector3f& p : pair.points2)
    {
      ASSERT_NE(std::find(points.begin(), points.end(), p), points.end());
    }
    for (std::size_t k = 0; k < pair.points1.size(); k += 50)
    {
      const Eigen::Vector3f back = T * pair.points1[k];
      EXPECT_TRUE(std::any_of(points.begin(), points.end(),
                              [&](const Eigen::Vector3f& p) { return (p - back).norm() < 1e-3F; }));
    }
  }
}
}  // namespace
}  // namespace dyslam
