// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/GnssFix.h>

#include <cmath>

namespace dyslam
{
bool isOnEarth(const GeodeticPosition& position)
{
  constexpr double highest = 1e5;  // largest height that is possible [m]
  return std::abs(position.height) < highest && std::abs(position.latitude) <= 90 &&
         std::abs(position.longitude) <= 360 &&
         !(position.latitude == 0 && position.longitude == 0);
}

void GnssFix::exchangeState(StateArchive& archive)
{
  archive(stamp, position.latitude, position.longitude, position.height, horizontal_sigma,
          vertical_sigma, antenna);
}
}  // namespace dyslam
