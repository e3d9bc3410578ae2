// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/packets/SensorClock.h>

#include <cmath>

namespace dyslam
{
namespace
{
constexpr double clock_jump = 1.0;  //!< longest step between packets of a running clock [s]
}  // namespace

double SensorClock::advance(double step, double captured)
{
  if (!last_captured_)
  {
    // A clock that agrees with the capture's is synchronised, and more exact than that.
    begin_ = step != 0 && std::abs(captured - step) < clock_jump ? step : captured;
  }
  else
  {
    const double captured_step = captured - *last_captured_;
    const bool is_set =
        (step < 0 || step > clock_jump) && std::abs(captured_step - step) > clock_jump;
    elapsed_ += is_set ? captured_step : step;
  }
  last_captured_ = captured;
  return begin_ + elapsed_;
}
}  // namespace dyslam
