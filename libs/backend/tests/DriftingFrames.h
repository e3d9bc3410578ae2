// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

#include <cstddef>
#include <utility>
#include <vector>

#include "BoxWorld.h"

namespace dyslam::test
{
/** Frames along a drive whose odometry is wrong in the same way at every step.
 * \param stretch excess of the length of a step, as a fraction \param turn excess of the heading
 * [rad] \param information of every motion, for each of its six numbers */
inline std::vector<Frame> driftingFrames(const BoxWorld& world,
                                         const std::vector<Pose>& truth,
                                         double stretch,
                                         double turn,
                                         double information)
{
  std::vector<Frame> frames;
  Pose T_odom_vehicle = Pose::Identity();
  for (std::size_t i = 0; i < truth.size(); ++i)
  {
    Frame frame;
    frame.index = i;
    frame.scan.stamp = 100 + 0.1 * static_cast<double>(i);
    frame.cloud.points = world.scan(truth[i], static_cast<unsigned>(i));
    if (i > 0)
    {
      Pose step = truth[i - 1].inverse() * truth[i];
      step.translation() *= 1 + stretch;
      step = step * poseFromYpr(0, 0, 0, turn, 0, 0);
      T_odom_vehicle = T_odom_vehicle * step;
      frame.motion.T_previous_current = step;
    }
    frame.motion.status = MotionStatus::converged;
    frame.motion.information = information * Matrix6::Identity();
    frame.T_odom_vehicle = T_odom_vehicle;
    frames.push_back(std::move(frame));
  }
  return frames;
}
}  // namespace dyslam::test
