// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** First line of a run's `tracks.csv`, with its line feed. */
[[nodiscard]] std::string trackTableHeader();
/** A row of `tracks.csv` with its line feed: an object at a scan, in the odometry frame.
 * \param frame Frame::index of the scan \param stamp of the scan [s] */
[[nodiscard]] std::string trackTableRow(const TrackedObject& object,
                                        std::size_t frame,
                                        double stamp);

/** Values of `tracks.csv` that programs read. */
enum class TrackValue
{
  frame,
  id,
  velocity,
  speed,
  dynamic
};

/** The values read from a row of `tracks.csv`; others have their defaults. */
struct TrackTableRow
{
  int frame = 0;  //!< Frame::index
  int id = -1;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  //!< odometry frame [m/s]
  std::optional<double> speed;                         //!< [m/s]; nothing where the field is empty
  bool dynamic = false;                                //!< TrackedObject::dynamic
};

struct TrackTable
{
  /** Name of the first wanted column that the table lacks, as one of another program does; empty if
   * there are all. */
  std::string missing;
  std::vector<TrackTableRow> rows;  //!< in the order of the file; none if a column is missing
};

/** Reads wanted values of `tracks.csv`; the other columns are neither needed nor checked.
 * \throws UserError if the file cannot be read, "file:line: what" for damaged lines. */
[[nodiscard]] TrackTable readTrackTable(const std::string& path,
                                        const std::vector<TrackValue>& wanted);
}  // namespace dyslam
