// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Backend.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "BoxWorld.h"
#include "DriftingFrames.h"

namespace dyslam::test
{
/** The frame of the prior map in which the world is seen: turned, and far from its origin. */
inline const Pose T_prior_world = poseFromYpr(300, -120, 12, 2, 0, 0);

/** Points along a drive, frame of the prior map. */
inline std::vector<Eigen::Vector3f> mapOf(const BoxWorld& world, const std::vector<Pose>& drive)
{
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < drive.size(); i += 2)
  {
    const Eigen::Isometry3f T = (T_prior_world * drive[i]).cast<float>();
    for (const Eigen::Vector3f& p : world.scan(drive[i], 7000 + static_cast<unsigned>(i)))
    {
      points.emplace_back(T * p);
    }
  }
  return points;
}

inline std::vector<Frame> framesOf(const BoxWorld& world,
                                   const std::vector<Pose>& truth,
                                   double stretch = 0.01,
                                   double turn = 0.0005)
{
  return driftingFrames(world, truth, stretch, turn, 1e4);
}

/** A run that is localised in a map. */
struct LocalisedRun
{
  LocalisedRun(const std::vector<Eigen::Vector3f>& map,
               std::vector<Frame> given,
               const BackendConfig& config = {})
      : frames(std::move(given)), backend(config, keyframes, map)
  {
    for (Frame& frame : frames)
    {
      backend.addFrame(frame);
    }
    backend.finish();
  }

  [[nodiscard]] PriorMapFit fit() const { return backend.priorMapFit().value(); }
  /** Largest error of the poses in the frame of the prior map [m]. */
  [[nodiscard]] double error(const std::vector<Pose>& truth) const
  {
    const Trajectory trajectory = backend.optimisedTrajectory();
    double worst = 0;
    for (std::size_t i = 0; i < truth.size(); ++i)
    {
      const Pose T_true = T_prior_world * truth[i];
      worst = std::max(worst, (trajectory[i].pose.translation() - T_true.translation()).norm());
    }
    return worst;
  }

  std::vector<Frame> frames;
  KeyframeStore keyframes;
  Backend backend;
};

inline BackendConfig withStart(const Pose& T_world_start)
{
  BackendConfig config;
  config.prior_map.start = poseText(T_prior_world * T_world_start);
  return config;
}
}  // namespace dyslam::test
