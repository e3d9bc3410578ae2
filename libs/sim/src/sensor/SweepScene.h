// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "RayScene.h"

namespace dyslam::sim
{
/** Motion of a body's part during a sweep and the next one, shape to map. Between start and end of
 * a sweep the matrix is interpolated linearly, as Embree does for the rays. */
struct PartMotion
{
  Eigen::Affine3d start, end, next_end;
  /** Shape to map at a fraction of the sweep, and of the next one. */
  [[nodiscard]] Eigen::Affine3d at(double fraction) const;
  [[nodiscard]] Eigen::Affine3d nextAt(double fraction) const;
};

/** Motion of a vehicle or a person. */
struct BodyMotion
{
  std::vector<PartMotion> parts;
  bool moving = false;
  std::uint16_t semantic = 0;  //!< SemanticKITTI class, including the moving state
  std::uint16_t instance = 0;
};

/** Scene of one sweep. */
struct SweepScene
{
  const RayScene* static_scene = nullptr;
  const RayScene* moving_scene = nullptr;
  const std::vector<BodyMotion>* bodies = nullptr;
  std::vector<Pose> T_map_lidar_column;      //!< lidar pose at the start of each column
  Pose T_map_lidar = Pose::Identity();       //!< lidar pose at the stamp
  Pose T_map_lidar_next = Pose::Identity();  //!< lidar pose at the next stamp
  double start = 0;        //!< start of the sweep since the sensor was switched on [s]
  std::uint64_t seed = 0;  //!< seed of the noise of this sweep
  bool noise = true;
  bool motion_distortion = true;
  bool on_car = false;  //!< the car's roof occludes some of the lowest rays
  Eigen::Matrix3f R_vehicle_lidar = Eigen::Matrix3f::Identity();  //!< mounting on the car
};
}  // namespace dyslam::sim
