// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>

#include <string>
#include <vector>

namespace dyslam
{
enum class TrajectoryFormat
{
  tum,   //!< t x y z qx qy qz qw, or another file with time stamps
  kitti  //!< 12 numbers: the upper 3x4 of the pose, row by row; no time
};

// All readers skip empty lines and lines that begin with `#`, accept spaces, tabs and commas
// between numbers, and throw UserError "file:line: what" for anything else that is not as the
// format says. Rotations are made orthonormal; one that is no rotation at all is an error.

/** Reads a TUM file: lines of `t x y z qx qy qz qw` in order of time; of several with the same time
 * the first counts; more than five, as of times with too few digits, are an error. Times since 1970
 * may be in ms, us or ns. \return stamps in s */
[[nodiscard]] Trajectory readTum(const std::string& path);
/** A line of a TUM file: t with 9 decimals, the other numbers with 12 significant digits. */
[[nodiscard]] std::string tumLine(double stamp, const Pose& pose);
/** Writes a TUM file, first under a temporary name. */
void writeTum(const std::string& path, const Trajectory& trajectory);

/** Reads a KITTI file: 12 numbers per line. */
[[nodiscard]] std::vector<Pose> readKittiPoses(const std::string& path);
void writeKittiPoses(const std::string& path, const std::vector<Pose>& poses);
void writeKittiPoses(const std::string& path, const Trajectory& trajectory);

/** Reads times [s], one per line, as in KITTI's times.txt. */
[[nodiscard]] std::vector<double> readTimes(const std::string& path);

struct TrajectoryFile
{
  Trajectory trajectory;
  TrajectoryFormat format = TrajectoryFormat::tum;
};
/** Reads a TUM or KITTI file, told apart by the count of numbers in the first line (8: TUM, 12:
 * KITTI; 13: a time since 1970 and KITTI's twelve, as of MulRan), or EuRoC's csv, which its header
 * shows: times in ns, position, quaternion with w first, other columns. Stamps of a KITTI file are
 * the line numbers 0, 1, 2, ... */
[[nodiscard]] TrajectoryFile readTrajectory(const std::string& path);

/** T_cam_velo of a camera at the lidar's position that faces forward: its x is right, y down, z
 * ahead.
 */
[[nodiscard]] Pose cameraAxes();
}  // namespace dyslam
