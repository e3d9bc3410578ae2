// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/FrameCopy.h>

namespace dyslam
{
Frame copyOf(const Frame& frame, FrameParts parts)
{
  Frame copy;
  if (parts == FrameParts::all)
  {
    copy = frame;
    copy.static_confidence = {};  // no longer needed
    copy.static_prior = {};
    return copy;
  }
  copy.index = frame.index;
  copy.scan.stamp = frame.scan.stamp;
  copy.scan.T_vehicle_lidar = frame.scan.T_vehicle_lidar;
  copy.dt = frame.dt;
  copy.clock_offset = frame.clock_offset;
  copy.motion = frame.motion;
  copy.T_odom_vehicle = frame.T_odom_vehicle;
  copy.moving_probability = frame.moving_probability;
  copy.moving = frame.moving;
  copy.detections = frame.detections;
  copy.objects = frame.objects;
  copy.is_keyframe = frame.is_keyframe;
  copy.T_map_odom = frame.T_map_odom;
  copy.T_world_vehicle_truth = frame.T_world_vehicle_truth;
  if (parts == FrameParts::cloud)
  {
    copy.cloud = frame.cloud;
    copy.scan.parts = frame.scan.parts;
    return copy;
  }
  copy.cloud.points = frame.cloud.points;
  if (parts == FrameParts::intensity)
  {
    copy.cloud.intensity = frame.cloud.intensity;
  }
  return copy;
}
}  // namespace dyslam
