// SPDX-License-Identifier: BSD-3-Clause
// What the pattern of a sensor's scans shows, and texts about it.
#pragma once

#include <dyslam/core/ScanPattern.h>

#include <string>

namespace dyslam
{
/** A number with a fixed number of decimals, never "-0". */
[[nodiscard]] std::string fixed(double value, int decimals);
/** An angle in degrees. */
[[nodiscard]] std::string degrees(double radians, int decimals);

/** Whether a scan is a whole turn. */
[[nodiscard]] bool turnsFully(const ScanPattern& pattern);
/** Whether the lidar spins and has many rings that are not separable: rings of an HDL-64E overlap
 * when corrected for the position of each laser. */
[[nodiscard]] bool isDenseRevolution(const ScanPattern& pattern);

/** Text such as "16 rings, 2.0 deg apart" or "no rings, 24000 points a scan". */
[[nodiscard]] std::string ringsOf(const ScanPattern& pattern);
}  // namespace dyslam
