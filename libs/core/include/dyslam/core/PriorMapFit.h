// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

namespace dyslam
{
/** How a run fits the prior map in which it was to be localised. */
struct PriorMapFit
{
  /** Why the run is not localised: what most of the last search failed on; empty before. */
  std::string reason;
  bool localised = false;       //!< if not, the run is in a map frame of its own
  std::size_t keyframe = 0;     //!< keyframe at which the run was localised
  double path_length = 0;       //!< path travelled until then [m]
  std::size_t tried = 0;        //!< number of keyframes that were to be registered since then
  std::size_t registered = 0;   //!< number of them whose registration is in the graph
  double rmse = 0;              //!< RMS of the point-to-plane residuals of these [m]
  std::size_t found_again = 0;  //!< number of times that the run was lost and then found again
};
}  // namespace dyslam
