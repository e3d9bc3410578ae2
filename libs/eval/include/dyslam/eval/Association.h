// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>

#include <cstddef>
#include <vector>

namespace dyslam
{
/** Poses of a reference and of an estimate that belong together, in order of time. */
struct PosePairs
{
  std::vector<double> stamps;  //!< of the reference [s]; index where the files have no times
  std::vector<Pose> reference;
  std::vector<Pose> estimate;
  std::size_t reference_size = 0;  //!< poses the reference had
  std::size_t estimate_size = 0;   //!< poses the estimate had
  std::size_t not_finite = 0;      //!< estimated poses left out because of NaN or infinity

  [[nodiscard]] std::size_t size() const { return reference.size(); }
};

/** Each estimated pose with the reference nearest in time, one to one.
 *
 * Where several estimates claim one reference, the nearest in time keeps it.
 * \param tolerance largest difference of stamps [s].
 */
[[nodiscard]] PosePairs associateByTime(const Trajectory& reference,
                                        const Trajectory& estimate,
                                        double tolerance);

/** The i-th pose with the i-th, up to the shorter one's end: KITTI files, which have no times. */
[[nodiscard]] PosePairs associateByIndex(const Trajectory& reference, const Trajectory& estimate);
}  // namespace dyslam
