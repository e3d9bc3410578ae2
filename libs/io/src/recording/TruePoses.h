// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <deque>
#include <optional>

namespace dyslam
{
/** Ground truth poses of a recording, for its scans one after the other.
 *
 * Stamps are those of the recording. Each pose belongs to the scans with its clock_shift: that from
 * the recording's stamps to those of the frames, which changes where the clock was set back. */
class TruePoses
{
 public:
  /** \param max_gap longest time between a scan and a pose to interpolate from [s] */
  explicit TruePoses(double max_gap) : max_gap_(max_gap) {}

  /** A pose, in the order of the recording. \param stamp as recorded [s] \param clock_shift [s] */
  void add(double stamp, const Pose& T_world_vehicle, double clock_shift);
  /** The clock was set back: the poses read since then, which begin where the times go back
   * farthest, belong to the scans from now on. \param clock_shift before [s] \param shift that is
   * added to it [s] */
  void shiftClock(double clock_shift, double shift);
  /** T_world_vehicle at a scan: a pose of the same time, or interpolated. Forgets the poses long
   * before; scans must come in order. \param stamp as recorded [s] \param clock_shift of the scan
   * [s] */
  [[nodiscard]] std::optional<Pose> at(double stamp, double clock_shift);

 private:
  struct Entry
  {
    double stamp = 0;  //!< recorded stamp [s]
    Pose pose = Pose::Identity();
    double clock_shift = 0;  //!< clock_shift of the scans with the same clock [s]
  };

  double max_gap_;
  std::deque<Entry> entries_;
};
}  // namespace dyslam
