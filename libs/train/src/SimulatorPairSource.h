// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/train/Augmentation.h>
#include <dyslam/train/PairSource.h>

#include <memory>

namespace dyslam
{
/** Pairs from generated worlds. \throws UserError where the simulator was not built. */
[[nodiscard]] std::unique_ptr<PairSource> makeSimulatorPairSource(
    const AugmentationOptions& augmentation, int most_gap, std::uint64_t seed);
}  // namespace dyslam
