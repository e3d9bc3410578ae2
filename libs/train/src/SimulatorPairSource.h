// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/train/Augmentation.h>
#include <dyslam/train/DataSplits.h>
#include <dyslam/train/PairSource.h>
#include <dyslam/train/Recordings.h>

#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
/** Pairs from generated worlds.
 *
 * \param worlds each "share;world;sensor;columns;least traffic;most traffic", such as
 * "0.2;highway;HDL64E;1024;0;0.3"; 0 columns: default of the sensor \param seeds range of the
 * worlds' seeds \throws UserError for a text of another form, and if the simulator was not built.
 */
[[nodiscard]] std::unique_ptr<PairSource> makeSimulatorPairSource(
    const std::vector<std::string>& worlds,
    const AugmentationOptions& augmentation,
    int max_gap,
    const NumberRange& seeds,
    std::uint64_t seed);

/** A fixed simulated drive, e.g. to validate on.
 *
 * \param text "world;sensor;traffic;seed;scans", e.g. "urban;HDL64E;0.4;9001;20"
 * \throws UserError, also if the seed is not for validation. */
[[nodiscard]] Recording simulateRecording(const std::string& text, const DataSplits& splits);
}  // namespace dyslam
