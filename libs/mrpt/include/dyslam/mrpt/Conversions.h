// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <mrpt/core/Clock.h>
#include <mrpt/poses/CPose3D.h>

namespace dyslam
{
// Poses are converted bit for bit: the rotation is passed as a matrix, never as angles.

[[nodiscard]] Pose toPose(const mrpt::poses::CPose3D& from);
[[nodiscard]] mrpt::poses::CPose3D toMrpt(const Pose& from);

// MRPT counts ticks of 100 ns since 1601. Both directions round to the nearest tick, so that stamps
// that were read from text are preserved.

/** \return UNIX time [s]; an unspecified number for an invalid time, as in a damaged file. */
[[nodiscard]] double toStamp(mrpt::Clock::time_point time);
/** \param stamp UNIX time [s]; limited to 25 thousand years from 1970, and 1970 if not finite. */
[[nodiscard]] mrpt::Clock::time_point toMrptTime(double stamp);
}  // namespace dyslam
