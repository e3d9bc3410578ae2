// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>

#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Time of the first point after the stamp [s], if the stamp is late in the scan: more than a
 * quarter of the scan's duration after its middle, as that of the last point or of the message's
 * arrival. 0 if it is not; nothing if the points do not have two different times.
 *
 * Scans with late stamps cannot be registered well. They are deskewed by the motion up to the
 * stamp, so their points lie, on average, halfway between the last pose and the new one or before:
 * an error of a pose returns in the next one with the opposite sign and does not decay. */
[[nodiscard]] std::optional<double> firstOfLateStamp(const std::vector<float>& times);

/** Adds to the stamp of a scan [s] and takes it off the times of its points. */
void moveStamp(double shift, Scan& scan);

/** Moves late stamps to the first points, for one recording of one lidar: by the time that the
 * first two scans show, so that the intervals between later ones stay. The first scan of a
 * recording may be a part of a revolution. */
class LateStamps
{
 public:
  /** Examines the times of the points of the next scan, after its stamp [s]. */
  void examine(const std::vector<float>& times);
  /** Whether the shift is final. */
  [[nodiscard]] bool isKnown() const { return shown_ >= enough || examined_ >= most; }
  /** Of the stamps, by the scans so far: 0 or less [s]. */
  [[nodiscard]] double shift() const { return shift_; }

  /** Examines a scan, if the shift is not final, and moves its stamp. */
  void operator()(Scan& scan);
  /** What was done, one line; none if nothing was. */
  [[nodiscard]] std::vector<std::string> notes() const;

 private:
  static constexpr int enough = 2;  //!< scans with different times
  static constexpr int most = 20;   //!< examined at most, of times that are missing or all equal

  double shift_ = 0;
  int shown_ = 0;     //!< number of examined scans with different times
  int examined_ = 0;  //!< number of examined scans with two points or more
};
}  // namespace dyslam
