// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>

#include <string>

namespace dyslam
{
/** What the coordinates of a scan show of their unit. */
struct LengthFindings
{
  float median_range = 0;    //!< [m]
  double whole_numbers = 0;  //!< share of the points with such coordinates; 0 of few

  /** Whether no lidar measures such ranges, whatever the unit. */
  [[nodiscard]] bool areTooFar() const;
  /** A warning of coordinates that are not in metres, to follow the name of the scan; empty if
   * there is none. \param scale RecordingOptions::scale, with which they were read */
  [[nodiscard]] std::string warning(double scale) const;
};

/** Points at the origin and those that are no numbers are left out. */
[[nodiscard]] LengthFindings lengthsOf(const Scan& scan);
}  // namespace dyslam
