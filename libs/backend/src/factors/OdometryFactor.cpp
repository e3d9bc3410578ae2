// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorType.h>
#include <dyslam/backend/factors/OdometryFactor.h>

namespace dyslam
{
const FactorType OdometryFactor::factor_type = {
    "odometry", "ODOMETRY", nullptr, 6, exchangeKeyframes, makeOfKeyframes<OdometryFactor>};
}  // namespace dyslam
