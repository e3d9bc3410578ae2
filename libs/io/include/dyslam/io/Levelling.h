// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Pose.h>
#include <dyslam/core/Trajectory.h>

#include <optional>

namespace dyslam
{
/** Rotation from the vehicle frame of a recording, in which the ground may be inclined, to the
 * levelled vehicle frame, in which its scans are processed. Files have poses of the recording's
 * frame.
 */
class Levelling
{
 public:
  /** No rotation: both frames are the same. */
  Levelling() = default;
  /** \param roll about x, \param pitch about y, both fixed: roll first [rad] */
  Levelling(double roll, double pitch);

  [[nodiscard]] bool isNone() const { return !rotation_.has_value(); }
  [[nodiscard]] Pose T_level_recorded() const { return rotation_.value_or(Pose::Identity()); }

  /** Transforms the mountings and the ground truth of a recorded frame to the levelled vehicle. */
  void apply(Frame& frame) const;
  /** Inverse of apply(), for the mounting of a scan. */
  void undo(Scan& scan) const;

  /** Pose of the recorded vehicle from that of the levelled one in any frame, and the inverse. */
  [[nodiscard]] Pose recorded(const Pose& T_any_level) const;
  [[nodiscard]] Pose levelled(const Pose& T_any_recorded) const;
  [[nodiscard]] Trajectory recorded(Trajectory poses) const;
  [[nodiscard]] Trajectory levelled(Trajectory poses) const;

 private:
  std::optional<Pose> rotation_;  //!< T_level_recorded
};
}  // namespace dyslam
