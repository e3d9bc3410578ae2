// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

namespace dyslam
{
/** Swaps roll and yaw in rows and columns: MRPT's order in memory against that of its files. */
inline Matrix6 swappedRollYaw(const Matrix6& m)
{
  Eigen::PermutationMatrix<6> swap;
  swap.indices() << 0, 1, 2, 5, 4, 3;
  return swap * m * swap;
}
}  // namespace dyslam
