// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/Association.h>

#include <vector>

namespace dyslam
{
/** Error of each pose of an estimate after the first poses were made to coincide; the arrays are of
 * one length. */
struct PoseDrift
{
  std::vector<double> distance;  //!< distance travelled along the reference [m]
  std::vector<double> position;  //!< horizontal distance from the reference [m]
  std::vector<double> height;    //!< height, estimate minus reference [m]
  std::vector<double> heading;   //!< heading, estimate minus reference, in (-pi, pi] [rad]
};

[[nodiscard]] PoseDrift poseDrift(const PosePairs& pairs);
}  // namespace dyslam
