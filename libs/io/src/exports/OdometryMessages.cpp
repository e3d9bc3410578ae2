// SPDX-License-Identifier: BSD-3-Clause
#include "OdometryMessages.h"

#include <dyslam/formats/MotionFiles.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <algorithm>
#include <filesystem>

namespace dyslam
{
namespace fs = std::filesystem;

OdometryMessages::OdometryMessages(const Trajectory& poses, const std::string& motions)
    : poses_(poses)
{
  if (motions.empty())
  {
    return;
  }
  const fs::path odometry = fs::path(motions).parent_path() / run_files::odometry;
  covariances_.emplace(poses,
                       fs::is_regular_file(odometry) ? readTum(odometry.string()) : Trajectory(),
                       readMotionFile(motions));
}

std::string OdometryMessages::of(const RosPose& pose) const
{
  RosTwist twist;
  RosOdometryCovariances covariances;
  if (poses_.size() >= 2)
  {
    const std::size_t at =
        std::min(std::max<std::size_t>(poses_.firstNotBefore(pose.stamp - same_scan_time), 1),
                 poses_.size() - 1);
    const StampedPose& before = poses_[at - 1];
    const StampedPose& now = poses_[at];
    const double dt = now.stamp - before.stamp;
    const Vector6 velocity = logSE3(before.pose.inverse() * now.pose) / dt;
    twist.linear = velocity.head<3>();
    twist.angular = velocity.tail<3>();
    if (covariances_)
    {
      const auto of_motion = covariances_->ofMotion(before.stamp, now.stamp);
      covariances.twist = of_motion.value_or(Matrix6::Zero()) / (dt * dt);
    }
  }
  if (covariances_)
  {
    covariances.pose =
        inParentAxes(covariances_->ofPose(pose.stamp).value_or(Matrix6::Zero()), pose.pose);
  }
  return odometryMessage(pose, twist, covariances);
}
}  // namespace dyslam
