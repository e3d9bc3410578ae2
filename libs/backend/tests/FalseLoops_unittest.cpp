// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/factors/LocalisationFactor.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <utility>

#include "NoisyDrive.h"

namespace dyslam
{
namespace
{
using test::LoopMeasurement;
using test::NoisyDrive;

double uniform(std::mt19937& rng, double low, double high)
{
  return std::uniform_real_distribution<double>(low, high)(rng);
}

/** A shift in the plane of a length within [low, high] and a turn by up to `turn`, at least a third
 * of it. */
Pose wrongBy(std::mt19937& rng, double low, double high, double turn)
{
  const double direction = uniform(rng, -M_PI, M_PI);
  const double length = uniform(rng, low, high);
  const double sign = uniform(rng, -1, 1) < 0 ? -1 : 1;
  return poseFromYpr(length * std::cos(direction), length * std::sin(direction), 0,
                     sign * uniform(rng, turn / 3, turn), 0, 0);
}

/** \param count loops between random keyframes of the two rounds, each wrong in its own way. */
std::vector<LoopMeasurement> randomLoops(NoisyDrive& drive, int count)
{
  std::vector<LoopMeasurement> loops;
  for (int i = 0; i < count; ++i)
  {
    const auto from = static_cast<std::size_t>(uniform(drive.rng, 0, 149));
    const auto to = static_cast<std::size_t>(uniform(drive.rng, 150, 299));
    LoopMeasurement loop = drive.trueLoop(from, to);
    loop.T_from_to = loop.T_from_to * wrongBy(drive.rng, 2, 20, 1);
    loops.push_back(loop);
  }
  return loops;
}

/** Five loops of neighbouring keyframes that agree on one wrong motion, and five random ones. */
std::vector<LoopMeasurement> agreeingLoops(NoisyDrive& drive)
{
  std::vector<LoopMeasurement> loops = randomLoops(drive, 5);
  const auto from = static_cast<std::size_t>(uniform(drive.rng, 0, 140));
  const auto to = static_cast<std::size_t>(uniform(drive.rng, 150, 290));
  const Pose wrong = wrongBy(drive.rng, 3, 10, 0.6);
  for (std::size_t i = 0; i < 5; ++i)
  {
    // Wrong in the frame of the first keyframe: all agree.
    const Pose T_first_from = drive.truth[from].inverse() * drive.truth[from + i];
    LoopMeasurement loop = drive.trueLoop(from + i, to + i);
    loop.T_from_to = T_first_from.inverse() * wrong * T_first_from * loop.T_from_to;
    loops.push_back(loop);
  }
  return loops;
}

/** Loops at places that are really revisited, one of them a little beside. */
std::vector<LoopMeasurement> oneSlightlyWrong(NoisyDrive& drive)
{
  std::vector<LoopMeasurement> loops;
  for (std::size_t i = 0; i < 8; ++i)
  {
    loops.push_back(drive.trueLoop(18 * i, 18 * i + 150));
  }
  LoopMeasurement wrong = drive.trueLoop(45, 195);
  wrong.T_from_to = wrong.T_from_to * wrongBy(drive.rng, 0.5, 1, 0);
  loops.push_back(wrong);
  return loops;
}

/** \return the largest shift of a keyframe by the false loops, of all seeds [m] */
double worstShift(const std::function<std::vector<LoopMeasurement>(NoisyDrive&)>& false_loops)
{
  double worst = 0;
  for (unsigned seed = 1; seed <= 12; ++seed)
  {
    NoisyDrive drive(seed);
    std::vector<LoopMeasurement> loops = drive.threeTrueLoops();
    FactorGraph clean = drive.graph(loops);
    const OptimisationResult expected = clean.optimise({});
    for (const LoopMeasurement& loop : false_loops(drive))
    {
      loops.push_back(loop);
    }
    FactorGraph graph = drive.graph(loops);
    const double drift = test::largestError(graph, drive.truth);
    const OptimisationResult result = graph.optimise({});
    const double shift = test::largestShift(clean, graph);
    std::printf("seed %u: drift %.2f m, error %.3f m clean, shifted by %.4f m; %d and %d steps\n",
                seed, drift, test::largestError(clean, drive.truth), shift, expected.iterations,
                result.iterations);
    worst = std::max(worst, shift);
  }
  return worst;
}

TEST(FalseLoops, TenRandomOnesDoNotBendTheTrajectory)
{
  EXPECT_LT(worstShift([](NoisyDrive& drive) { return randomLoops(drive, 10); }), 0.01);
}

TEST(FalseLoops, FiveThatAgreeDoNotBendTheTrajectory)
{
  EXPECT_LT(worstShift(agreeingLoops), 0.01);
}

/** The step from keyframe 100 on was predicted, 63 m and 60 degrees off: its covariance says so. */
TEST(FalseLoops, AcrossAGapTrueOnesAreKeptAndFalseOnesLeftOut)
{
  for (unsigned seed = 1; seed <= 12; ++seed)
  {
    NoisyDrive drive(seed);
    drive.steps[100] = drive.steps[100] * poseFromYpr(60, -20, 1, 1.05, 0, 0);
    drive.weak_steps[100] = test::diagonalInformation(30, 0.5);
    std::vector<LoopMeasurement> loops = drive.threeTrueLoops();
    loops.push_back(drive.trueLoop(30, 181));
    FactorGraph clean = drive.graph(loops);
    EXPECT_EQ(clean.optimise({}).false_loops, 0U) << seed;
    EXPECT_LT(test::largestError(clean, drive.truth), 1) << seed;
    for (const LoopMeasurement& loop : randomLoops(drive, 5))
    {
      loops.push_back(loop);
    }
    FactorGraph graph = drive.graph(loops);
    EXPECT_EQ(graph.optimise({}).false_loops, 5U) << seed;
    EXPECT_LT(test::largestShift(clean, graph), 0.01) << seed;
  }
}

/** The first loop after a gap is no contradiction, however far it moves what comes after. */
TEST(FalseLoops, TheOnlyLoopAcrossAGapIsKept)
{
  for (const double far : {20.0, 60.0, 200.0})
  {
    NoisyDrive drive(1);
    drive.steps[100] = drive.steps[100] * poseFromYpr(far, 0, 0, 0.5, 0, 0);
    drive.weak_steps[100] = test::diagonalInformation(30, 0.5);
    FactorGraph graph =
        drive.graph({drive.trueLoop(120, 270), drive.trueLoop(124, 274), drive.trueLoop(30, 181)});
    EXPECT_EQ(graph.optimise({}).false_loops, 0U) << far;
    EXPECT_LT(test::largestError(graph, drive.truth), 1) << far;
  }
}

TEST(FalseLoops, OneSlightlyWrongAmongTrueOnesIsLeftOut)
{
  for (const double scale : {1.0, 3.0})
  {
    for (unsigned seed = 1; seed <= 12; ++seed)
    {
      NoisyDrive drive(seed);
      std::vector<LoopMeasurement> loops = oneSlightlyWrong(drive);
      FactorGraphOptions options;
      options.odometry_sigma_scale = scale;
      FactorGraph graph = drive.graph(loops);
      const OptimisationResult result = graph.optimise(options);
      loops.pop_back();
      FactorGraph clean = drive.graph(loops);
      const OptimisationResult expected = clean.optimise(options);
      EXPECT_LT(test::largestShift(clean, graph), 0.01) << scale << " " << seed;
      EXPECT_EQ(result.false_loops, expected.false_loops + 1) << scale << " " << seed;
    }
  }
}

/** The drive, localised in a prior map at every keyframe with a sigma of 0.4 m, and loops with one
 * of 1 cm: a false loop can shift the localisations until it fits itself. */
FactorGraph localisedDrive(NoisyDrive& drive, const std::vector<LoopMeasurement>& loops)
{
  FactorGraph graph = drive.graph({});
  graph.addPose(Key::priorMap(), Pose::Identity());
  graph.setFixed(Key::priorMap(), true);
  graph.setFixed(Key::ego(0), false);
  std::mt19937 rng(7);
  std::swap(rng, drive.rng);  // the same localisations whatever was drawn before
  for (std::size_t k = 0; k < drive.truth.size(); ++k)
  {
    graph.add(std::make_unique<LocalisationFactor>(k, drive.noisy(drive.truth[k], 0.4, 0.02),
                                                   test::diagonalInformation(0.4, 0.02)));
  }
  std::swap(rng, drive.rng);
  for (const LoopMeasurement& loop : loops)
  {
    graph.add(std::make_unique<LoopFactor>(loop.from, loop.to, loop.T_from_to,
                                           test::diagonalInformation(0.01, 0.001)));
  }
  return graph;
}

TEST(FalseLoops, LocalisationsInAPriorMapContradictThem)
{
  for (const std::size_t true_loops : {0U, 2U})
  {
    for (unsigned seed = 1; seed <= 4; ++seed)
    {
      NoisyDrive drive(seed);
      std::vector<LoopMeasurement> loops;
      for (std::size_t i = 0; i < true_loops; ++i)
      {
        const std::size_t from = 10 + 100 * i;
        const Pose T = drive.truth[from].inverse() * drive.truth[from + 150];
        loops.push_back({from, from + 150, drive.noisy(T, 0.01, 0.001)});
      }
      FactorGraph clean = localisedDrive(drive, loops);
      EXPECT_EQ(clean.optimise({}).false_loops, 0U) << true_loops << " " << seed;
      LoopMeasurement wrong = drive.trueLoop(60, 210);
      wrong.T_from_to = wrong.T_from_to * wrongBy(drive.rng, 1.5, 1.6, 0);
      loops.push_back(wrong);
      FactorGraph graph = localisedDrive(drive, loops);
      EXPECT_EQ(graph.optimise({}).false_loops, 1U) << true_loops << " " << seed;
      EXPECT_LT(test::largestShift(clean, graph), 0.05) << true_loops << " " << seed;
    }
  }
}
}  // namespace
}  // namespace dyslam
