// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

namespace dyslam
{
class StateArchive;

/** How far the vehicle may have driven without being measured: in gaps of the recording, and while
 * no scan could be registered until the local map was restarted. The motion is predicted there,
 * from no more than two seconds of the velocity before. */
class UnseenPath
{
 public:
  /** The next frame, and the length of its motion as the odometry has it [m].
   * \return what it adds to the length [m] */
  double add(const Frame& frame, double step);
  /** Upper limit, at the highest speed seen before [m]. */
  [[nodiscard]] double length() const { return length_; }
  void exchangeState(StateArchive& archive);

 private:
  double length_ = 0;         //!< [m]
  double highest_speed_ = 0;  //!< of the motions that were registered [m/s]
  double unregistered_ = 0;   //!< time since the last scan that was registered or counted [s]
};
}  // namespace dyslam
