// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>

#include <string>

namespace dyslam
{
/** What the three numbers of a position are. */
enum class PositionAxes
{
  local,       //!< x, y, z, or east, north, up [m]
  geodetic,    //!< latitude, longitude [deg], height [m]
  geocentric,  //!< x, y, z from the centre of the earth, z to the north pole (ECEF) [m]
};

/** Positions of one body without orientations, as of a satellite receiver or a total station. */
struct PositionFile
{
  Trajectory positions;  //!< in order of time; their rotations are the identity
  PositionAxes axes = PositionAxes::local;
  std::string clock;  //!< of the file, if the stamps were converted to UTC; else empty
};

/** Whether a file is one of positions alone: with lines of `t x y z`, or a header that names the
 * columns of time and position, but none of a quaternion, or RTKLIB's. \throws UserError if it
 * cannot be read */
[[nodiscard]] bool isPositionFile(const std::string& path);

/** Reads lines of `t x y z`, or the columns that a header names: time, and x y z, east north up or
 * latitude longitude height, each by several names, in any order and among others. Fields are
 * separated by spaces, tabs, commas or semicolons. Times since 1970 may be in ms, us or ns; lines
 * without a position (empty or nan) are left out, and of several with the same time the first
 * counts. Also reads RTKLIB's solutions (.pos), by their header: dates or GPS weeks, in GPS time,
 * UTC or Japan's time, are converted to UTC; latitude and longitude may be in degrees, minutes and
 * seconds.
 * \throws UserError "file:line: what" for lines that do not fit; for a file of another kind or
 * without a position */
[[nodiscard]] PositionFile readPositions(const std::string& path);
}  // namespace dyslam
