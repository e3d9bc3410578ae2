// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorType.h>
#include <dyslam/backend/factors/LocalisationFactor.h>

namespace dyslam
{
const FactorType LocalisationFactor::factor_type = {
    "localisation",
    "LOCALISATION",
    nullptr,
    6,
    [](FactorData& data, FactorFields& fields)
    {
      data.keys.resize(2);
      fields.index(data.keys[1].index);
      fields.pose(data.measurement);
    },
    [](const FactorData& data) -> std::unique_ptr<const Factor>
    {
      return std::make_unique<LocalisationFactor>(static_cast<std::size_t>(data.keys.at(1).index),
                                                  data.measurement, data.information);
    }};

FactorLoss LocalisationFactor::loss(const FactorGraphOptions& options) const
{
  return {options.loop_loss, options.loop_loss_width, true};
}
}  // namespace dyslam
