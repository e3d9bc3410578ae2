// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>

#include <cstddef>
#include <vector>

namespace dyslam
{
/** Associated poses of a reference and an estimate, in order of time. */
struct PosePairs
{
  std::vector<double> stamps;      //!< of the reference [s]; indices for files without stamps
  std::vector<Pose> reference;     //!< T_world_body in the reference's world [m]
  std::vector<Pose> estimate;      //!< T_world_body in the estimate's world [m]
  std::size_t reference_size = 0;  //!< poses in the reference
  std::size_t estimate_size = 0;   //!< poses in the estimate
  std::size_t not_finite = 0;      //!< non-finite estimated poses, not associated
  /** The reference has positions alone; the rotations of its poses mean nothing. */
  bool positions_only = false;
  bool reference_has_quaternions = true;  //!< its file states rotations as such, not as matrices
  bool estimate_has_quaternions = true;   //!< as `reference_has_quaternions`

  [[nodiscard]] std::size_t size() const { return reference.size(); }
};

/** Associates each estimated pose with the reference pose nearest in time, one to one.
 *
 * If several estimates have the same nearest reference, only the nearest in time is kept.
 * \param tolerance largest difference of stamps [s].
 */
[[nodiscard]] PosePairs associateByTime(const Trajectory& reference,
                                        const Trajectory& estimate,
                                        double tolerance);

/** Associates each estimated pose with that of the reference at its time, interpolated between two
 * poses of which neither is more than `max_gap` away [s]. The pairs have the stamps of the
 * estimate.
 */
[[nodiscard]] PosePairs associateInterpolated(const Trajectory& reference,
                                              const Trajectory& estimate,
                                              double max_gap);

/** Associates poses of equal index, for files without stamps (KITTI); the longer file is cut. */
[[nodiscard]] PosePairs associateByIndex(const Trajectory& reference, const Trajectory& estimate);

/** Path length up to each pose [m]; as many values as poses. */
[[nodiscard]] std::vector<double> distanceTravelled(const std::vector<Pose>& poses);
}  // namespace dyslam
