// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorType.h>
#include <dyslam/backend/factors/OdometryFactor.h>

namespace dyslam
{
const FactorType OdometryFactor::factor_type = {
    "odometry",
    "ODOMETRY",
    nullptr,
    6,
    [](FactorData& data, FactorFields& fields)
    {
      data.keys.resize(2);
      fields.index(data.keys[0].index);
      fields.index(data.keys[1].index);
      fields.pose(data.measurement);
    },
    [](const FactorData& data) -> std::unique_ptr<const Factor>
    {
      return std::make_unique<OdometryFactor>(static_cast<std::size_t>(data.keys.at(0).index),
                                              static_cast<std::size_t>(data.keys.at(1).index),
                                              data.measurement, data.information);
    }};
}  // namespace dyslam
