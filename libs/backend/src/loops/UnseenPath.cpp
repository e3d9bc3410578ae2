// SPDX-License-Identifier: BSD-3-Clause
#include "UnseenPath.h"

#include <dyslam/base/StateArchive.h>

#include <algorithm>

namespace dyslam
{
namespace
{
constexpr double longest_prediction = 2;  // longest gap with a predicted motion [s]
constexpr double least_length = 10;       // least length of an unmeasured stretch [m]
}  // namespace

double UnseenPath::add(const Frame& frame, double step)
{
  if (frame.motion.registered())
  {
    const double dt = std::max(frame.dt, frame.sweep_duration);
    highest_speed_ = dt > 0 ? std::max(highest_speed_, step / dt) : highest_speed_;
    unregistered_ = 0;
    return 0;
  }
  unregistered_ += frame.dt;
  if (!frame.motion.map_restarted && frame.dt <= longest_prediction)
  {
    return 0;
  }
  const double added = std::max(least_length, highest_speed_ * unregistered_);
  length_ += added;
  unregistered_ = 0;
  return added;
}

void UnseenPath::exchangeState(StateArchive& archive)
{
  archive(length_, highest_speed_, unregistered_);
}
}  // namespace dyslam
