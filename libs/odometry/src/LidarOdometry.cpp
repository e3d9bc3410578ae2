// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/odometry/LidarOdometry.h>

#include "SimpleOdometry.h"

namespace dyslam
{
std::vector<std::string> odometryMethods()
{
  return {"constant_velocity", "zero_motion"};
}

std::unique_ptr<LidarOdometry> makeOdometry(const std::string& method,
                                            ConfigLoader& /*loader*/,
                                            ThreadPool& /*pool*/)
{
  if (method == "constant_velocity")
  {
    return std::make_unique<SimpleOdometry>(SimpleOdometry::Kind::constant_velocity);
  }
  if (method == "zero_motion")
  {
    return std::make_unique<SimpleOdometry>(SimpleOdometry::Kind::zero_motion);
  }
  const std::string nearest = nearestWord(method, odometryMethods());
  throw UserError("odometry.method: unknown method '" + method + "'" +
                  (nearest.empty() ? std::string() : "; did you mean '" + nearest + "'?"));
}
}  // namespace dyslam
