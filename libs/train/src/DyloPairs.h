// SPDX-License-Identifier: BSD-3-Clause
// Includes torch.
#pragma once

#include <dyslam/nets/ScanTensors.h>
#include <dyslam/train/Augmentation.h>
#include <dyslam/train/DataSplits.h>
#include <dyslam/train/PairSource.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "DyloTrainOptions.h"

namespace dyslam
{
/** Makes the sources of training pairs that have a weight in `[data]`: recordings, single scans,
 * simulator. \param base folder that the paths are relative to \param seed seed of all draws
 * \throws UserError if there are none, for data that cannot be read, and for data of another split.
 */
[[nodiscard]] std::unique_ptr<PairSource> makeDyloPairSource(
    const DataOptions& data,
    const AugmentationOptions& augmentation,
    const std::string& base,
    const DataSplits& splits,
    std::uint64_t seed);

/** A training pair as the network reads it, on its device. */
struct PreparedDyloPair
{
  ScanTensors scan1, scan2;  //!< the later and the earlier scan
  std::vector<torch::Tensor>
      labels;  //!< [level] PointLabel of each node of scan 1, from level 1 on
  Pose T_2_1 = Pose::Identity();
  Pose start = Pose::Identity();  //!< initial guess of T_2_1
};

/** \param perturbed_starts as TrainOptions
 * \param seed, index number of the pair: the initial guess depends on both alone */
[[nodiscard]] PreparedDyloPair prepareDyloPair(const TrainingPair& pair,
                                               double perturbed_starts,
                                               std::uint64_t seed,
                                               std::uint64_t index,
                                               torch::Device device);
}  // namespace dyslam
