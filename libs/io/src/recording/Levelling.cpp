// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/io/Levelling.h>

namespace dyslam
{
Levelling::Levelling(double roll, double pitch)
{
  if (roll != 0 || pitch != 0)
  {
    rotation_ = poseFromYpr(0, 0, 0, 0, pitch, roll);
  }
}

void Levelling::apply(Frame& frame) const
{
  if (!rotation_)
  {
    return;
  }
  frame.scan.T_vehicle_lidar = *rotation_ * frame.scan.T_vehicle_lidar;
  for (ImuSample& sample : frame.imu)
  {
    sample.T_vehicle_imu = *rotation_ * sample.T_vehicle_imu;
  }
  for (GnssFix& fix : frame.gnss)
  {
    fix.antenna = *rotation_ * fix.antenna;
  }
  if (frame.T_world_vehicle_truth)
  {
    frame.T_world_vehicle_truth = levelled(*frame.T_world_vehicle_truth);
  }
}

void Levelling::undo(Scan& scan) const
{
  if (rotation_)
  {
    scan.T_vehicle_lidar = rotation_->inverse() * scan.T_vehicle_lidar;
  }
}

Pose Levelling::recorded(const Pose& T_any_level) const
{
  return rotation_ ? T_any_level * *rotation_ : T_any_level;
}

Pose Levelling::levelled(const Pose& T_any_recorded) const
{
  return rotation_ ? T_any_recorded * rotation_->inverse() : T_any_recorded;
}

Trajectory Levelling::recorded(Trajectory poses) const
{
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    poses[i].pose = recorded(poses[i].pose);
  }
  return poses;
}

Trajectory Levelling::levelled(Trajectory poses) const
{
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    poses[i].pose = levelled(poses[i].pose);
  }
  return poses;
}
}  // namespace dyslam
