// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/packets/SensorClock.h>

#include <cmath>

namespace dyslam
{
namespace
{
constexpr double clock_jump = 1.0;  //!< longest step between packets of a running clock [s]
}

double SensorClock::advance(double step, double captured)
{
  sensor_time_ += step;
  if (!last_captured_)
  {
    // A clock that agrees with the capture's is synchronised, and more exact than that.
    offset_ = step != 0 && std::abs(captured - step) < clock_jump ? 0 : captured - step;
  }
  else
  {
    const double captured_step = captured - *last_captured_;
    if ((step < 0 || step > clock_jump) && std::abs(captured_step - step) > clock_jump)
    {
      offset_ += captured_step - step;
    }
  }
  last_captured_ = captured;
  return sensor_time_ + offset_;
}
}  // namespace dyslam
