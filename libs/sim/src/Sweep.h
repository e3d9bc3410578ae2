// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Parallel.h>
#include <dyslam/sim/Simulator.h>

#include <vector>

#include "Body.h"
#include "RayScene.h"

namespace dyslam::sim
{
/** A part of a body during a sweep and the one after it, shape to map. Between start and end of a
 * sweep the matrix is interpolated linearly, as Embree does for the rays. */
struct PartMotion
{
  Eigen::Affine3d start, end, next_end;
  [[nodiscard]] Eigen::Affine3d at(double fraction) const;
  [[nodiscard]] Eigen::Affine3d nextAt(double fraction) const;
};

struct BodyMotion
{
  std::vector<PartMotion> parts;
  bool moving = false;
  std::uint16_t semantic = 0;  //!< class in the labels, moving or not
  std::uint16_t instance = 0;
};

/** All that one turn of the sensor sees. */
struct SweepScene
{
  const RayScene* still = nullptr;
  const RayScene* moving = nullptr;
  const std::vector<BodyMotion>* bodies = nullptr;
  std::vector<Pose> T_map_lidar_column;      //!< at the start of each column
  Pose T_map_lidar = Pose::Identity();       //!< at the stamp
  Pose T_map_lidar_next = Pose::Identity();  //!< at the next stamp
  std::uint64_t seed = 0;                    //!< of this sweep
  bool noise = true;
  bool motion_distortion = true;
  bool on_car = false;  //!< its roof hides some of the lowest rays
};

struct BodySighting
{
  std::size_t points = 0;
  double time = 0;  //!< sum over its points, relative to the stamp [s]
};

/** Casts every ray of a turn and turns the hits into returns with truth. Fills the per-point arrays
 * of `scan`; gives one sighting per body. Same bytes for any size of the pool. */
[[nodiscard]] std::vector<BodySighting> castSweep(const SensorModel& sensor,
                                                  const SweepScene& scene,
                                                  ThreadPool& pool,
                                                  SimulatedScan& scan);
}  // namespace dyslam::sim
