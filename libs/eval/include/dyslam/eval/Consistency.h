// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/MotionAccumulator.h>
#include <dyslam/eval/Association.h>
#include <dyslam/eval/Statistics.h>
#include <dyslam/eval/Table.h>

#include <string>
#include <vector>

namespace dyslam
{
/** Normalised squared errors of motions: e' C^-1 e with e = log(T_estimated^-1 T_true) and the
 * stated covariance C. Its mean is 6 if C is exact (3 for translation and for rotation alone),
 * larger if C is too small (overconfident), smaller if C is too large. */
struct NormalisedErrors
{
  Statistics all;
  Statistics translation;  //!< with the covariance of the translation alone
  Statistics rotation;     //!< with that of the rotation alone
};

struct OdometryConsistency
{
  std::string name;
  NormalisedErrors steps;      //!< of the motions from scan to scan
  NormalisedErrors keyframes;  //!< of the motions from keyframe to keyframe, see MotionAccumulator
};

/** Motions whose two ends have no pose in `odometry`, or whose covariance is not positive definite,
 * are left out.
 * \param odometry estimated and true poses of the scans \param motions one for each scan, in order
 * of time; that of the first scan is not read \param tolerance largest difference of stamps [s] */
[[nodiscard]] OdometryConsistency odometryConsistency(const PosePairs& odometry,
                                                      const std::vector<MotionCovariance>& motions,
                                                      double tolerance);

/** Two rows for each run, steps and keyframes, with a title that says what the figures mean. */
[[nodiscard]] Table consistencyTable(const std::vector<OdometryConsistency>& runs);
}  // namespace dyslam
