// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/train/DataSplits.h>
#include <dyslam/train/DysegData.h>
#include <dyslam/train/DysegTrainer.h>

#include <deque>
#include <string>
#include <vector>

namespace dyslam
{
/** The training pairs of DySeg's network: simulated clips from a pool that is replaced one by one,
 * runs with ground truth, and pairs made from single scans. */
class DysegPairs
{
 public:
  /** Reads the real data. \throws UserError. */
  explicit DysegPairs(const DysegTrainerOptions& options);

  /** Makes the simulated clips that belong to a step; call for every step in turn. */
  void prepare(int step);
  /** \throws UserError if there is no data at all. */
  [[nodiscard]] DysegSample draw(RandomDraws& draws) const;
  [[nodiscard]] std::string summary() const;

 private:
  DysegTrainerOptions options_;
  NumberRange seeds_;  //!< of simulated worlds
  std::vector<DysegClip> runs_;
  std::vector<std::vector<Eigen::Vector3f>> singles_;
  std::deque<DysegClip> pool_;
};
}  // namespace dyslam
