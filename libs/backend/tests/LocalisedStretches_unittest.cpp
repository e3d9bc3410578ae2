// SPDX-License-Identifier: BSD-3-Clause
#include "prior_map/LocalisedStretches.h"

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/factors/OdometryFactor.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/KeyframeStore.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

namespace dyslam
{
namespace
{
/** Keyframes along a straight line, 1 m apart, and their places by odometry. */
struct StretchedLine
{
  /** \param slip of the odometry from keyframe 59 to 60 */
  explicit StretchedLine(const Pose& slip)
  {
    graph.addPose(Key::priorMap(), Pose::Identity());
    graph.setFixed(Key::priorMap(), true);
    const Pose step = poseFromYpr(1, 0, 0, 0, 0, 0);
    for (std::size_t k = 0; k < 150; ++k)
    {
      truth.push_back(poseFromYpr(static_cast<double>(k), 0, 0, 0, 0, 0));
      const Pose measured = k == 60 ? Pose(step * slip) : step;
      Keyframe keyframe;
      keyframe.path_length = static_cast<double>(k);
      keyframe.T_map_vehicle = k == 0 ? truth[0] : Pose(keyframes.back().T_map_vehicle * measured);
      keyframes.add(keyframe);
      graph.addPose(Key::ego(k), keyframe.T_map_vehicle);
      if (k > 0)
      {
        graph.add(std::make_unique<OdometryFactor>(k - 1, k, measured, information));
      }
    }
  }

  /** Fixes of keyframes [begin, end), every second one. \param wrong their error, frame of the map
   */
  [[nodiscard]] std::vector<MapFix> fixes(std::size_t begin,
                                          std::size_t end,
                                          const Pose& wrong = Pose::Identity()) const
  {
    std::vector<MapFix> result;
    for (std::size_t k = begin; k < end; k += 2)
    {
      result.push_back({k, wrong * truth[k], information, 0.02, false});
    }
    return result;
  }

  /** Largest error of the position of a keyframe that is not near the slip [m]. */
  [[nodiscard]] double error() const
  {
    double worst = 0;
    for (std::size_t k = 0; k < truth.size(); ++k)
    {
      const Eigen::Vector3d at = graph.pose(Key::ego(k)).translation();
      worst = std::max(worst, k < 50 || k >= 70 ? (at - truth[k].translation()).norm() : 0);
    }
    return worst;
  }

  /** Information of the odometry to a keyframe, of its x [1/m^2]. */
  [[nodiscard]] double odometryAt(std::size_t keyframe) const
  {
    double found = 0;
    for (const FactorGraph::FactorId id : graph.factorsOf(Key::ego(keyframe)))
    {
      const Factor& factor = graph.factor(id);
      const bool is_to = factor.is<OdometryFactor>() && factor.keys()[1] == Key::ego(keyframe);
      found = is_to ? factor.information()(0, 0) : found;
    }
    return found;
  }

  Matrix6 information = 1e4 * Matrix6::Identity();
  KeyframeStore keyframes;
  FactorGraph graph;
  std::vector<Pose> truth;
};

TEST(LocalisedStretches, OdometryThatSlippedBetweenThemIsWeakened)
{
  StretchedLine line(poseFromYpr(15, 4, 0, 0.2, 0, 0));
  LocalisedStretches stretches(line.keyframes, line.graph);
  for (const auto& fixes : {line.fixes(0, 57), line.fixes(64, 75)})
  {
    EXPECT_TRUE(stretches.begin(fixes).empty());
    EXPECT_EQ(stretches.add(fixes).size(), fixes.size());
  }
  EXPECT_LT(line.odometryAt(60), 1e3);
  EXPECT_EQ(line.odometryAt(56), 1e4);
  EXPECT_EQ(line.odometryAt(65), 1e4);
  (void)line.graph.optimise({});
  EXPECT_LT(line.error(), 0.05);
}

TEST(LocalisedStretches, AWrongOneIsRemovedOnceTheNextFitsTheOneBefore)
{
  StretchedLine line(Pose::Identity());
  LocalisedStretches stretches(line.keyframes, line.graph);
  std::vector<MapFix> wrong = line.fixes(64, 75, poseFromYpr(-12, 3, 0, 0.1, 0, 0));
  for (MapFix& fix : wrong)
  {
    fix.rmse = 0.1;
  }
  for (const auto& fixes : {line.fixes(0, 57), wrong})
  {
    EXPECT_TRUE(stretches.begin(fixes).empty());
    (void)stretches.add(fixes);
  }
  EXPECT_LT(line.odometryAt(60), 1e3);
  (void)line.graph.optimise({});
  EXPECT_GT(line.error(), 5) << "so far the odometry counts as wrong";
  EXPECT_EQ(stretches.localisations(), 29U + wrong.size());
  EXPECT_NEAR(stretches.rmse(), std::sqrt((29 * 0.02 * 0.02 + 6 * 0.1 * 0.1) / 35), 1e-12);
  StateArchive saved;
  stretches.exchangeState(saved);
  StateArchive archive(saved.bytes());
  LocalisedStretches loaded(line.keyframes, line.graph);
  loaded.exchangeState(archive);

  const std::vector<MapFix> last = line.fixes(110, 121);
  EXPECT_EQ(loaded.begin(last).size(), wrong.size());
  (void)loaded.add(last);
  EXPECT_NEAR(line.odometryAt(60), 1e4, 1e-6);
  EXPECT_NEAR(line.odometryAt(100), 1e4, 1e-6);
  EXPECT_EQ(line.graph.factorsOf(Key::priorMap()).size(), 29U + last.size());
  EXPECT_EQ(loaded.localisations(), 29U + last.size()) << "without those that were removed";
  EXPECT_NEAR(loaded.rmse(), 0.02, 1e-12);
  (void)line.graph.optimise({});
  EXPECT_LT(line.error(), 0.05);
}

TEST(LocalisedStretches, WeakFixesOfTheTimeInBetweenAreRemovedAfterASlip)
{
  for (const double slip : {0.0, 15.0})
  {
    StretchedLine line(poseFromYpr(slip, 0, 0, 0, 0, 0));
    LocalisedStretches stretches(line.keyframes, line.graph);
    const std::vector<MapFix> before = line.fixes(0, 57);
    (void)stretches.begin(before);
    (void)stretches.add(before);
    std::vector<MapFix> weak = line.fixes(60, 67, poseFromYpr(slip, 0, 0, 0, 0, 0));
    for (MapFix& fix : weak)
    {
      fix.is_weak = true;
    }
    (void)stretches.add(weak);
    // Keyframes 64 and 66 are registered again, 60 and 62 are not.
    EXPECT_EQ(stretches.begin(line.fixes(64, 75)).size(), slip > 0 ? 4U : 2U);
    EXPECT_EQ(line.graph.factorsOf(Key::priorMap()).size(), before.size() + (slip > 0 ? 0 : 2));
    EXPECT_EQ(stretches.localisations(), before.size() + (slip > 0 ? 0 : 2));
    (void)stretches.add(line.fixes(64, 75));
    EXPECT_EQ(stretches.localisations(), line.graph.factorsOf(Key::priorMap()).size())
        << "keyframes that are registered again count once";
  }
}

/** Two slips: the stretch between them is right, though the odometry leads past it. */
TEST(LocalisedStretches, ARightOneStays)
{
  StretchedLine line(poseFromYpr(15, 0, 0, 0, 0, 0));
  LocalisedStretches stretches(line.keyframes, line.graph);
  const std::vector<MapFix> last = line.fixes(110, 121, poseFromYpr(-6, 0, 0, 0, 0, 0));
  for (const auto& fixes : {line.fixes(0, 57), line.fixes(64, 75), last})
  {
    EXPECT_TRUE(stretches.begin(fixes).empty());
    (void)stretches.add(fixes);
  }
  EXPECT_LT(line.odometryAt(60), 1e3);
  EXPECT_LT(line.odometryAt(90), 1e4);
  EXPECT_EQ(line.graph.factorsOf(Key::priorMap()).size(), 29U + 6U + last.size());
}
}  // namespace
}  // namespace dyslam
