// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

namespace dyslam
{
struct Frame;

/** First line of a run's `scans.csv`, with its line feed. */
[[nodiscard]] std::string scanTableHeader();
/** A row of `scans.csv` with its line feed: the result of a scan. */
[[nodiscard]] std::string scanTableRow(const Frame& frame);
/** Frame::index of all scans in `scans.csv`, in its order. \throws UserError "file:line: what" for
 * a table without the column `frame`, and for damaged lines. */
[[nodiscard]] std::vector<std::size_t> scansOfTable(const std::string& path);
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

/** First line of `scan_parts.csv`, with its line feed. */
[[nodiscard]] std::string scanPartsHeader();
/** Rows of `scan_parts.csv` with their line feeds: scans that were merged into that of a frame. */
[[nodiscard]] std::string scanPartRows(const Frame& frame);
/** Reads `scan_parts.csv`. \throws UserError "file:line: what" for a table without the columns of
 * ScanPartRow, and for damaged lines. */
[[nodiscard]] std::vector<ScanPartRow> readScanParts(const std::string& path);
}  // namespace dyslam
