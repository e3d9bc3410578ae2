// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/LoopCloser.h>
#include <dyslam/base/Error.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "BoxWorld.h"

namespace dyslam
{
namespace
{
using test::BoxWorld;
using test::driveAround;

struct DriftingDrive
{
  std::vector<Pose> truth;
  std::vector<Pose> drifting;
};

/** The estimate of a vehicle with a bias of heading and length in every step. */
std::vector<Pose> drifted(const std::vector<Pose>& truth, double turn, double stretch)
{
  std::vector<Pose> result = {truth.front()};
  for (std::size_t i = 1; i < truth.size(); ++i)
  {
    Pose step = truth[i - 1].inverse() * truth[i];
    step.translation() *= 1 + stretch;
    result.push_back(result.back() * step * poseFromYpr(0, 0, 0, turn, 0, 0));
  }
  return result;
}

/** \param unseen path of each keyframe [m]; none: 0 */
std::vector<Loop> runThrough(const BoxWorld& world,
                             const std::vector<Pose>& truth,
                             const std::vector<Pose>& estimate,
                             const LoopCloserOptions& options = {},
                             const std::vector<double>& unseen = {})
{
  KeyframeStore keyframes;
  LoopCloser closer(options, keyframes);
  std::vector<Loop> loops;
  double path = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
  {
    path += i == 0 ? 0 : (truth[i].translation() - truth[i - 1].translation()).norm();
    Keyframe keyframe;
    keyframe.path_length = path;
    keyframe.unseen_path = unseen.empty() ? 0 : unseen[i];
    keyframe.T_map_vehicle = estimate[i];
    keyframes.add(keyframe);
    closer.add(world.scan(truth[i], static_cast<unsigned>(i)));
    const std::vector<Loop> found = closer.search();
    loops.insert(loops.end(), found.begin(), found.end());
  }
  const std::vector<Loop> rest = closer.finish();
  loops.insert(loops.end(), rest.begin(), rest.end());
  return loops;
}

std::map<std::string, int> countsOf(const std::vector<Loop>& loops)
{
  std::map<std::string, int> counts;
  for (const Loop& loop : loops)
  {
    ++counts[toString(loop.verdict)];
  }
  return counts;
}

std::string textOf(const std::vector<Loop>& loops)
{
  std::string text;
  for (const auto& [name, count] : countsOf(loops))
  {
    text += name + " " + std::to_string(count) + ", ";
  }
  return text;
}

TEST(LoopVerdicts, AreAllListedAndNamed)
{
  std::set<std::string> names;
  for (const LoopVerdict verdict : loop_verdicts)
  {
    names.insert(toString(verdict));
  }
  EXPECT_EQ(names.size(), loop_verdicts.size());
  EXPECT_EQ(names.count("unknown"), 0U);
  EXPECT_EQ(toString(static_cast<LoopVerdict>(loop_verdicts.size())), "unknown");
}

TEST(LoopCloser, FindsTheSecondRoundAndMeasuresItWell)
{
  const BoxWorld world(11, 30, 20);
  const std::vector<Pose> truth = driveAround(30, 20, 240, 1.5);
  const std::vector<Loop> loops = runThrough(world, truth, drifted(truth, 0.001, 0.01));
  int accepted = 0;
  for (const Loop& loop : loops)
  {
    if (loop.verdict == LoopVerdict::accepted)
    {
      const Pose error = (truth[loop.from].inverse() * truth[loop.to]).inverse() * loop.T_from_to;
      EXPECT_LT(error.translation().norm(), 0.15) << loop.from << " " << loop.to;
      EXPECT_LT(rotationAngle(error), 0.01);
      ++accepted;
    }
  }
  EXPECT_GT(accepted, 15) << textOf(loops);
}

TEST(LoopCloser, TriesAsManyCandidatesAsTheOptionAllows)
{
  const BoxWorld world(11, 30, 20);
  const std::vector<Pose> truth = driveAround(30, 20, 120, 1.5);
  LoopCloserOptions options;
  options.appearance = false;
  options.search_radius = options.max_search_radius;
  options.nearby.candidates = 30;
  options.nearby.max_descriptor_distance = 0;  // all of them are rejected
  std::map<std::size_t, int> tried;
  int most = 0;
  for (const Loop& loop : runThrough(world, truth, truth, options))
  {
    EXPECT_EQ(loop.verdict, LoopVerdict::dissimilar);
    most = std::max(most, ++tried[loop.to]);
  }
  EXPECT_EQ(most, 30);
}

TEST(LoopCloser, SeesTheSameStreetDrivenTheOtherWay)
{
  const BoxWorld world(12, 30, 20);
  std::vector<Pose> truth = driveAround(30, 20, 45, 1.5);
  const std::size_t outward = truth.size();
  for (std::size_t i = outward; i-- > 0;)
  {
    truth.push_back(truth[i] * poseFromYpr(0.3, -0.8, 0, M_PI, 0, 0));
  }
  LoopCloserOptions options;
  options.min_path = 20;
  const std::vector<Loop> loops = runThrough(world, truth, drifted(truth, 0.0005, 0.005), options);
  int accepted = 0;
  for (const Loop& loop : loops)
  {
    if (loop.verdict == LoopVerdict::accepted)
    {
      const Pose error = (truth[loop.from].inverse() * truth[loop.to]).inverse() * loop.T_from_to;
      EXPECT_LT(error.translation().norm(), 0.15) << loop.from << " " << loop.to;
      ++accepted;
    }
  }
  EXPECT_GT(accepted, 5) << textOf(loops);
}

struct Accepted
{
  int nearby = 0;
  int by_appearance = 0;
};

/** Counts accepted loops; each must be right. */
Accepted acceptedOf(const std::vector<Loop>& loops, const std::vector<Pose>& truth)
{
  Accepted accepted;
  for (const Loop& loop : loops)
  {
    if (loop.verdict == LoopVerdict::accepted)
    {
      const Pose error = (truth[loop.from].inverse() * truth[loop.to]).inverse() * loop.T_from_to;
      EXPECT_LT(error.translation().norm(), 0.15) << loop.from << " " << loop.to;
      ++(loop.by_appearance ? accepted.by_appearance : accepted.nearby);
    }
  }
  return accepted;
}

TEST(LoopCloser, FindsByAppearanceWhatDriftHasTakenOutOfReach)
{
  const BoxWorld world(11, 30, 20);
  const std::vector<Pose> truth = driveAround(30, 20, 240, 1.5);
  const std::vector<Pose> estimate = drifted(truth, 0.006, 0.02);
  LoopCloserOptions options;
  options.appearance = false;
  Accepted accepted = acceptedOf(runThrough(world, truth, estimate, options), truth);
  EXPECT_EQ(accepted.nearby + accepted.by_appearance, 0);
  options.appearance = true;
  const std::vector<Loop> loops = runThrough(world, truth, estimate, options);
  accepted = acceptedOf(loops, truth);
  EXPECT_EQ(accepted.nearby, 0);
  EXPECT_GT(accepted.by_appearance, 6) << textOf(loops);
}

TEST(LoopCloser, FindsByAppearanceTheOtherLaneAndTheOtherDirection)
{
  const BoxWorld world(12, 30, 20);
  std::vector<Pose> truth = driveAround(30, 20, 80, 1.5);
  for (std::size_t i = truth.size(); i-- > 0;)
  {
    truth.push_back(truth[i] * poseFromYpr(0.3, -3, 0, M_PI, 0, 0));
  }
  const std::vector<Loop> loops = runThrough(world, truth, drifted(truth, 0.006, 0));
  const Accepted accepted = acceptedOf(loops, truth);
  EXPECT_GT(accepted.by_appearance, 3) << textOf(loops);
}

TEST(LoopCloser, OfPlacesThatLookAlikeNoneIsAccepted)
{
  const BoxWorld world = BoxWorld::square(14, 30);
  const std::vector<Pose> truth = driveAround(30, 30, 215, 1.5);  // not quite round
  LoopCloserOptions options;
  const std::vector<Loop> loops = runThrough(world, truth, drifted(truth, 0.001, 0.02), options);
  std::map<std::string, int> counts = countsOf(loops);
  EXPECT_EQ(counts["accepted"], 0) << textOf(loops);
  // It is the verification that rejects them, not a lack of candidates.
  EXPECT_GT(counts["ambiguous"] + counts["inconsistent"], 10) << textOf(loops);
  EXPECT_GT(counts["ambiguous"], 5) << textOf(loops);
}

TEST(LoopCloser, AcceptsNothingWhereNothingIsSeenAgain)
{
  // A straight street whose estimate is bent into a circle: every place seems to be revisited.
  const BoxWorld world(13, 120, 20);
  std::vector<Pose> truth;
  for (int i = 0; i < 120; ++i)
  {
    truth.push_back(poseFromYpr(-90 + 1.5 * i, -20, 1.7, 0, 0, 0));
  }
  const std::vector<Pose> bent = drifted(truth, 2 * M_PI / 50, 0);
  LoopCloserOptions options;
  options.nearby.max_descriptor_distance = 1;  // leave it all to the verification
  const std::vector<Loop> loops = runThrough(world, truth, bent, options);
  EXPECT_GT(loops.size(), 20U);
  for (const Loop& loop : loops)
  {
    EXPECT_NE(loop.verdict, LoopVerdict::accepted)
        << loop.from << " " << loop.to << " overlap " << loop.overlap << " rmse " << loop.rmse;
  }
}

/** The poses from keyframe `gap` on, moved by T_wrong in the frame of the first one: a drive that
 * was not measured there. */
std::vector<Pose> wrongAfter(std::vector<Pose> poses, std::size_t gap, const Pose& T_wrong)
{
  const Pose T = poses.front() * T_wrong * poses.front().inverse();
  for (std::size_t i = gap; i < poses.size(); ++i)
  {
    poses[i] = T * poses[i];
  }
  return poses;
}

std::vector<double> unseenAfter(std::size_t count, std::size_t gap, double unseen)
{
  std::vector<double> result(count, 0.0);
  std::fill(result.begin() + static_cast<std::ptrdiff_t>(gap), result.end(), unseen);
  return result;
}

TEST(LoopCloser, FindsPlacesAgainAcrossAGapHoweverFarItIs)
{
  const BoxWorld world(11, 30, 20);
  const std::vector<Pose> truth = driveAround(30, 20, 240, 1.5);
  const std::vector<Pose> estimate = wrongAfter(truth, 50, poseFromYpr(150, 0, 0, 1, 0, 0));
  std::vector<Loop> loops = runThrough(world, truth, estimate);
  EXPECT_EQ(acceptedOf(loops, truth).by_appearance, 0) << "farther than odometry drifts";
  loops = runThrough(world, truth, estimate, {}, unseenAfter(truth.size(), 50, 160));
  EXPECT_GT(acceptedOf(loops, truth).by_appearance, 6) << textOf(loops);
}

TEST(LoopCloser, TheHeadingAfterAGapIsUnknown)
{
  const BoxWorld world(11, 30, 20);
  const std::vector<Pose> truth = driveAround(30, 20, 215, 1.5);
  const std::vector<Pose> estimate = wrongAfter(truth, 50, poseFromYpr(5, 0, 0, 1.1, 0, 0));
  LoopCloserOptions options;
  options.appearance = false;
  options.nearby.candidates = 4;
  std::vector<Loop> loops = runThrough(world, truth, estimate, options);
  EXPECT_EQ(acceptedOf(loops, truth).nearby, 0);
  loops = runThrough(world, truth, estimate, options, unseenAfter(truth.size(), 50, 20));
  EXPECT_GT(acceptedOf(loops, truth).nearby, 4) << textOf(loops);
}

/** The scans after a restart of the local map see the same place as those before. */
TEST(LoopCloser, ConnectsTheTwoSidesOfARestart)
{
  const BoxWorld world(12, 30, 20);
  const std::vector<Pose> truth = driveAround(30, 20, 60, 1.5);
  constexpr std::size_t restart = 25;
  const std::vector<Pose> estimate = wrongAfter(truth, restart, poseFromYpr(3, 2, 0, 0.1, 0, 0));
  LoopCloserOptions options;
  options.appearance = false;
  options.nearby.max_descriptor_distance = 1;  // leave it all to the verification
  const std::vector<Loop> loops =
      runThrough(world, truth, estimate, options, unseenAfter(truth.size(), restart, 10));
  EXPECT_GT(acceptedOf(loops, truth).nearby, 2) << textOf(loops);
  for (const Loop& loop : loops)
  {
    EXPECT_TRUE(loop.from < restart && loop.to >= restart) << loop.from << " " << loop.to;
  }
}

TEST(LoopCloser, EmptyCloudsMakeNoLoops)
{
  LoopCloserOptions options;
  options.min_path = 1;
  KeyframeStore keyframes;
  LoopCloser closer(options, keyframes);
  for (std::size_t i = 0; i < 10; ++i)
  {
    std::vector<Eigen::Vector3f> points;
    if (i % 3 == 1)
    {
      points.assign(1, Eigen::Vector3f(1, 2, 3));
    }
    if (i % 3 == 2)
    {
      points.assign(10, Eigen::Vector3f::Constant(NAN));
    }
    Keyframe keyframe;
    keyframe.path_length = static_cast<double>(i);
    keyframes.add(keyframe);
    closer.add(points);
    for (const Loop& loop : closer.search())
    {
      EXPECT_NE(loop.verdict, LoopVerdict::accepted);
    }
  }
}

TEST(LoopCloserOptions, CriteriaOfLoopsByAppearanceHaveAPrefix)
{
  Config config;
  config.set("loop.min_overlap=0.5");
  config.set("loop.appearance_min_overlap=0.7");
  LoopCloserOptions options;
  load(options, config, "loop");
  EXPECT_EQ(options.criteria(false).min_overlap, 0.5);
  EXPECT_EQ(options.criteria(true).min_overlap, 0.7);
  config.set("loop.appearance_overlap=0.7");
  try
  {
    load(options, config, "loop");
    FAIL();
  }
  catch (const UserError& error)
  {
    EXPECT_STREQ(error.what(),
                 "--set loop.appearance_overlap: [loop] appearance_overlap was renamed to "
                 "appearance_min_overlap");
  }
}

TEST(LoopCloser, ContractIsChecked)
{
  KeyframeStore keyframes;
  LoopCloser closer(LoopCloserOptions{}, keyframes);
  EXPECT_TRUE(closer.search().empty());
  EXPECT_THROW(closer.add({}), std::invalid_argument);  // no keyframe to prepare
  keyframes.add(Keyframe());
  closer.add({});
  EXPECT_THROW(closer.add({}), std::invalid_argument);  // prepared already
  keyframes.add(Keyframe());
  keyframes.add(Keyframe());
  EXPECT_THROW(closer.add({}), std::invalid_argument);  // one was passed over
  LoopCloserOptions bad;
  bad.nearby.min_overlap = 2;
  EXPECT_THROW(LoopCloser(bad, keyframes), UserError);
  LoopCloserOptions limited;
  limited.search_radius = limited.max_search_radius;
  EXPECT_NO_THROW(LoopCloser(limited, keyframes));
  limited.search_radius += 1;
  EXPECT_THROW(LoopCloser(limited, keyframes), UserError);
}

TEST(LoopCloser, TooRareSearchesForLoopsThatNeedSupportAreRefused)
{
  KeyframeStore keyframes;
  const auto refused = [&keyframes](const LoopCloserOptions& given)
  {
    try
    {
      const LoopCloser closer(given, keyframes);
    }
    catch (const UserError& error)
    {
      return std::string(error.what());
    }
    return std::string();
  };
  LoopCloserOptions options;  // three others must agree with a loop by appearance
  options.support_window = 6;
  options.interval = 3;  // keyframes 3 and 6 before and after
  EXPECT_EQ(refused(options), "");
  options.interval = 4;
  EXPECT_EQ(
      refused(options),
      "[loop] appearance_min_support = 3 cannot be reached with interval = 4 and "
      "support_window = 6; set support_window = 8 or lower interval or appearance_min_support");
  options.support_window = 8;
  EXPECT_EQ(refused(options), "");
  options.appearance = false;  // one other must agree
  options.interval = options.support_window;
  EXPECT_EQ(refused(options), "");
  ++options.interval;
  EXPECT_EQ(
      refused(options),
      "[loop] min_support = 1 cannot be reached with interval = 9 and support_window = 8; set "
      "support_window = 9 or lower interval or min_support");
  options.nearby.min_support = 0;
  EXPECT_EQ(refused(options), "");
}
}  // namespace
}  // namespace dyslam
