// SPDX-License-Identifier: BSD-3-Clause
#include "GnssReceiver.h"

#include <dyslam/mrpt/Geodesy.h>

#include <cmath>

namespace dyslam::sim
{
namespace
{
const GeodeticPosition map_origin{49, 8.4, 115};
constexpr double period = 1;             // [s]
constexpr double white_sigma = 0.5;      // of east and north [m]
constexpr double slow_sigma = 1;         // of east and north [m]
constexpr double correlation_time = 60;  // of the slow errors [s]
constexpr double up_factor = 2;          // of the vertical errors
}  // namespace

std::optional<GnssFix> GnssReceiver::fixAt(double stamp, const Pose& T_map_vehicle)
{
  constexpr double tolerance = 1e-3;  // [s]
  if (last_ && stamp - *last_ < period - tolerance)
  {
    return std::nullopt;
  }
  const double kept = last_ ? std::exp(-(stamp - *last_) / correlation_time) : 0;
  last_ = stamp;
  Eigen::Vector3d white;
  for (int i = 0; i < 3; ++i)
  {
    slow_[i] = kept * slow_[i] + std::sqrt(1 - kept * kept) * normal_(random_);
    white[i] = normal_(random_);
  }
  GnssFix fix;
  fix.stamp = stamp;
  fix.antenna = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d error = white_sigma * white + slow_sigma * slow_;
  error.z() *= up_factor;
  fix.position = fromEnu(T_map_vehicle * fix.antenna + error, map_origin);
  fix.horizontal_sigma = std::hypot(white_sigma, slow_sigma);
  fix.vertical_sigma = up_factor * fix.horizontal_sigma;
  return fix;
}
}  // namespace dyslam::sim
