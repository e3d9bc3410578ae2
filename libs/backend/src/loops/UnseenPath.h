// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

namespace dyslam
{
class StateArchive;

/** Distance that the vehicle may have travelled unmeasured: in gaps of the recording, and while no
 * scan could be registered until the local map was restarted. The motion is then predicted, for at
 * most two seconds. */
class UnseenPath
{
 public:
  /** Adds the next frame. \param step length of its motion by the odometry [m]
   * \return increase of length() [m] */
  double add(const Frame& frame, double step);
  /** Upper limit of the unmeasured distance, at the highest speed seen before [m]. */
  [[nodiscard]] double length() const { return length_; }
  void exchangeState(StateArchive& archive);

 private:
  double length_ = 0;         //!< see length() [m]
  double highest_speed_ = 0;  //!< highest speed of registered motions [m/s]
  double unregistered_ = 0;   //!< time since the last scan that was registered or counted [s]
};
}  // namespace dyslam
