// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/RunMerger.h>
#include <dyslam/backend/factors/OdometryFactor.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "BoxWorld.h"

namespace dyslam::test
{
/** A run by its own odometry: it starts at the identity and drifts with every step. */
struct TestRun
{
  TestRun(const BoxWorld& world, std::vector<Pose> poses, unsigned seed) : truth(std::move(poses))
  {
    std::mt19937 rng(seed);
    std::normal_distribution<double> n;
    Vector6 sigmas;
    sigmas << Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(0.0005);
    const Matrix6 information = sigmas.array().square().inverse().matrix().asDiagonal();
    Pose pose = Pose::Identity();
    graph.addPose(Key::ego(0), pose);
    for (std::size_t k = 1; k < truth.size(); ++k)
    {
      const Vector6 noise = sigmas.cwiseProduct(Vector6::NullaryExpr([&] { return n(rng); }));
      const Pose step = truth[k - 1].inverse() * truth[k] * expSE3(noise);
      pose = pose * step;
      graph.addPose(Key::ego(k), pose);
      graph.add(std::make_unique<OdometryFactor>(k - 1, k, step, information));
    }
    for (std::size_t k = 0; k < truth.size(); ++k)
    {
      scans.push_back(world.scan(truth[k], 1000 * seed + static_cast<unsigned>(k)));
    }
  }

  std::vector<Pose> truth;
  FactorGraph graph;
  RunReferences references;
  std::vector<std::vector<Eigen::Vector3f>> scans;
};

/** Merges runs; the map frame is that of the first. */
inline RunMerge merged(const std::vector<const TestRun*>& runs, const RunMergerConfig& config = {})
{
  RunMerger merger(config);
  for (const TestRun* run : runs)
  {
    merger.addRun(run->graph, run->references);
    for (const auto& scan : run->scans)
    {
      merger.addKeyframe(scan);
    }
  }
  return merger.merge();
}

/** Greatest error of the relative pose of keyframes of two runs that are within 5 m [m]. */
inline double errorBetween(const RunMerge& merge,
                           const std::vector<const TestRun*>& runs,
                           std::size_t a,
                           std::size_t b)
{
  double worst = 0;
  int compared = 0;
  for (std::size_t i = 0; i < merge.poses[a].size(); ++i)
  {
    for (std::size_t j = 0; j < merge.poses[b].size(); ++j)
    {
      const Pose T_true = runs[a]->truth[i].inverse() * runs[b]->truth[j];
      if (T_true.translation().norm() < 5)
      {
        const Pose T = merge.poses[a][i].inverse() * merge.poses[b][j];
        worst = std::max(worst, (T_true.inverse() * T).translation().norm());
        ++compared;
      }
    }
  }
  return compared > 0 ? worst : 1e9;
}

/** The poses with numbers in [begin, end). */
inline std::vector<Pose> part(const std::vector<Pose>& poses, std::size_t begin, std::size_t end)
{
  return {poses.begin() + static_cast<std::ptrdiff_t>(begin),
          poses.begin() + static_cast<std::ptrdiff_t>(end)};
}

/** The same street in the other lane and direction. */
inline std::vector<Pose> turnedRound(std::vector<Pose> poses)
{
  std::reverse(poses.begin(), poses.end());
  for (Pose& pose : poses)
  {
    pose = pose * poseFromYpr(0, -2.5, 0, M_PI, 0, 0);
  }
  return poses;
}

/** Two runs along parts of one drive, which overlap. */
struct OverlappingRuns
{
  OverlappingRuns() : OverlappingRuns({11, 30, 20}, driveAround(30, 20, 150, 1.5)) {}
  OverlappingRuns(const BoxWorld& world, const std::vector<Pose>& drive)
      : first(world, part(drive, 0, 60), 1), second(world, part(drive, 40, 100), 2)
  {
  }

  TestRun first;
  TestRun second;
};
}  // namespace dyslam::test
