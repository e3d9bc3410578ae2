// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Statistics.h>
#include <dyslam/core/MotionAccumulator.h>
#include <dyslam/eval/Association.h>
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
  Statistics translation;  //!< errors of the translation, with its covariance
  Statistics rotation;     //!< errors of the rotation, with its covariance
};

struct OdometryConsistency
{
  std::string name;
  NormalisedErrors steps;      //!< motions from scan to scan
  NormalisedErrors keyframes;  //!< motions from keyframe to keyframe, see MotionAccumulator
};

/** Evaluates the covariances of an odometry. Motions with an end that has no pose in `odometry`, or
 * whose covariance is not positive definite, are left out.
 * \param odometry estimated and true poses of the scans \param motions one per scan, in order of
 * time; the first one is not used \param tolerance largest difference of stamps [s] */
[[nodiscard]] OdometryConsistency odometryConsistency(const PosePairs& odometry,
                                                      const std::vector<MotionCovariance>& motions,
                                                      double tolerance);

/** Table with two rows per run (steps and keyframes) and a title that explains the figures. */
[[nodiscard]] Table consistencyTable(const std::vector<OdometryConsistency>& runs);
}  // namespace dyslam
