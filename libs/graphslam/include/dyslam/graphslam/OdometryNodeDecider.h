// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/graphslam/GraphSlamContext.h>
#include <mrpt/graphslam/interfaces/CNodeRegistrationDecider.h>

#include <memory>
#include <string>

namespace dyslam
{
/** Node registration for mrpt::graphslam::CGraphSlamEngine: makes keyframes from 3D scans by
 * DySLAM's odometry; the odometry between keyframes becomes the edges.
 *
 * The engine demands two nodes at the first registration: keyframe 0 appears with keyframe 1.
 */
class OdometryNodeDecider
    : public mrpt::graphslam::deciders::CNodeRegistrationDecider<GraphSlamContext::Graph>
{
 public:
  explicit OdometryNodeDecider(std::shared_ptr<GraphSlamContext> context);

  /** Takes an observation, or all observations of a sensory frame. \return whether a node was added
   * \throws UserError for damaged data, and for a sensory frame with two scans of the lidar. */
  bool updateState(mrpt::obs::CActionCollection::Ptr action,
                   mrpt::obs::CSensoryFrame::Ptr observations,
                   mrpt::obs::CObservation::Ptr observation) override;

  /** T_map_vehicle at the newest scan; identity before the first scan. */
  [[nodiscard]] global_pose_t getCurrentRobotPosEstimation() const override;
  void getDescriptiveReport(std::string* report) const override;

 private:
  void registerKeyframe();

  std::shared_ptr<GraphSlamContext> context_;
};
}  // namespace dyslam
