// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/benchmarks/NoteSink.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/eval/Table.h>
#include <dyslam/eval/TrajectoryMetrics.h>

#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** How the poses of two files are read and paired. */
struct PoseReading
{
  static constexpr double default_tolerance = 0.01;  //!< [s]

  std::optional<double> tolerance;  //!< tolerance of time stamps [s]; empty: default_tolerance
  /** The reference is interpolated at the time stamps of the estimate, between poses that are at
   * most this far from them [s]; empty: the nearest pose within the tolerance. */
  std::optional<double> interpolate;
  std::optional<double> time_offset;  //!< added to the time stamps of the estimate [s]
  /** Which file has the poses of a camera (z ahead), which are converted to poses of the lidar:
   * "estimate", "reference" or "none"; empty: the one whose body moves as a camera while the other
   * moves as a lidar, if there is one and `reference_body` is empty. */
  std::string camera;
  /** KITTI's calib.txt with the camera's mounting; empty: the calib.txt of the sequence that
   * the poses are of, if there is one, else only its axes. */
  std::string calib;
  /** Pose of the reference's body (IMU, antenna) in the body frame of the estimate, as
   * poseFromOption() reads it, without rotation for a reference of positions alone; empty: both are
   * poses of the same body. After `camera`. */
  std::string reference_body;
  std::string reference_times;  //!< a time [s] for each line of a KITTI reference; empty: none
};

/** Pairs the poses of two files (TUM or KITTI): by time if both have time stamps, else by line. The
 * reference may be a PositionFile; the estimated poses are then those of its body, and geodetic or
 * geocentric positions become east, north, up from the first one.
 * \param note called if the pairs are few or of a part of the reference's path, the files differ in
 * length, times were converted to UTC, or poses of a camera to those of the lidar \throws UserError
 * for files that cannot be read, without poses or with fewer than two pairs, for a tolerance, an
 * offset or times given with a file without time stamps, and for what needs orientations if the
 * reference has none. */
[[nodiscard]] PosePairs pairFiles(const std::string& reference,
                                  const std::string& estimate,
                                  const PoseReading& reading,
                                  const NoteSink& note);

/** Why errors may not be those of the estimate, for the console: other axes of the bodies,
 * orientations that do not fit although the positions do, another unit; empty if nothing is wrong.
 * \param reference, estimate their files \param reading as the pairs were read \param report of
 * these pairs */
[[nodiscard]] std::string pairWarning(const std::string& reference,
                                      const std::string& estimate,
                                      const PoseReading& reading,
                                      const PosePairs& pairs,
                                      const TrajectoryReport& report);

/** Which figures of a table are not comparable, or not those of other programs, for the console: of
 * estimates with differing numbers of pairs, and of nearly straight paths, which SE(3) alignment by
 * the positions alone may turn about their line. Empty if there is nothing to say.
 * \param same_reference all estimates have the same reference */
[[nodiscard]] std::vector<std::string> comparisonNotes(const std::vector<TrajectoryReport>& reports,
                                                       bool same_reference);

/** Adds a row of means over the estimates of several references, one for each method (see
 * methodGroups()); the mean drift is over the estimates that are long enough to have one.
 * \param files, references files of each estimate and of its reference \return why there is no
 * mean; empty if there is one */
std::string addMeanRows(Table& table,
                        const std::vector<TrajectoryReport>& reports,
                        const std::vector<std::string>& files,
                        const std::vector<std::string>& references);

/** A trajectory that is not compared with another. */
struct PathSummary
{
  std::string name;
  Trajectory trajectory;
  std::optional<double> duration;  //!< duration [s]; nothing without time stamps
  double length = 0;               //!< length of the path [m]
  double start_to_end = 0;         //!< distance of the last position from the first [m]
};

/** Reads a trajectory; `name` stays empty. \param reading its camera and calib apply \param
 * note called if poses of a camera were converted \throws UserError for a file that cannot be read
 * or has no poses. */
[[nodiscard]] PathSummary readPath(const std::string& path,
                                   const PoseReading& reading,
                                   const NoteSink& note);
/** One row per trajectory. */
[[nodiscard]] Table pathTable(const std::vector<PathSummary>& paths);
[[nodiscard]] std::string pathJson(const std::vector<PathSummary>& paths);
}  // namespace dyslam
