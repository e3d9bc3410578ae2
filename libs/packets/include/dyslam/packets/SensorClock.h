// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

namespace dyslam
{
/** UNIX times by a lidar's own clock, which is accurate but may have any origin.
 *
 * The time begins at the reception of the first packet (or at the sensor's own UNIX time, if that
 * agrees to 1 s) and continues by the sensor's clock, independent of later times of the capture. If
 * the sensor's clock goes back or jumps by more than 1 s, it was set or packets are missing: then
 * the elapsed time is that of the capture. */
class SensorClock
{
 public:
  /** \param step of the sensor's clock since the last call; of the first call its time since 1970
   * if the sensor knows that, else 0 [s]
   * \param captured when the packet was received, UNIX time [s]
   * \return UNIX time [s] */
  double advance(double step, double captured);

 private:
  double begin_ = 0;  //!< UNIX time of the first packet [s]
  /** Time since then [s]. Not added to begin_ at each step: a UNIX time in double precision has a
   * resolution of 0.24 us, so that sums of many small steps drift. */
  double elapsed_ = 0;
  std::optional<double> last_captured_;
};
}  // namespace dyslam
