// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorType.h>
#include <dyslam/backend/factors/LoopFactor.h>

namespace dyslam
{
const FactorType LoopFactor::factor_type = {
    "loop", "LOOP", "LEFT_OUT_LOOP", 6, exchangeKeyframes, makeOfKeyframes<LoopFactor>};

FactorLoss LoopFactor::loss(const FactorGraphOptions& options) const
{
  return {options.loop_loss, options.loop_loss_width, true};
}
}  // namespace dyslam
