// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

namespace dyslam
{
/** Frame::index of the scans in a run's `scans.csv` that could not be registered, so that their
 * poses are predicted. \throws UserError "file:line: what" for a table without the columns `frame`
 * and `registered`, and for damaged lines. */
[[nodiscard]] std::set<std::size_t> unregisteredScans(const std::string& path);

/** A row of a run's `scan_parts.csv`: a scan of a further lidar. */
struct ScanPartRow
{
  std::size_t frame = 0;  //!< Frame::index of the scan that it was merged into
  std::string sensor_label;
  double stamp = 0;  //!< of the further lidar's scan [s]
  std::size_t points = 0;
};

/** Reads `scan_parts.csv`. \throws UserError "file:line: what" for a table without the columns of
 * ScanPartRow, and for damaged lines. */
[[nodiscard]] std::vector<ScanPartRow> readScanParts(const std::string& path);
}  // namespace dyslam
