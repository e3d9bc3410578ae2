// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace dyslam
{
/** What decided which points move. */
enum class MovingLabels
{
  causal,    //!< the scan and those before it; points near the ground are often wrong
  hindsight  //!< earlier and later scans
};
}  // namespace dyslam
