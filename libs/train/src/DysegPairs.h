// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/train/DataSplits.h>
#include <dyslam/train/DysegData.h>
#include <dyslam/train/LabelledRun.h>

#include <deque>
#include <future>
#include <string>
#include <vector>

#include "DysegTrainerOptions.h"

namespace dyslam
{
/** Scene of a simulated training clip, by its number: world, sensor, firings per revolution,
 * traffic, carrier and cruising speed, drawn in the shares of the options. */
[[nodiscard]] DysegClipScene trainingScene(std::uint64_t number,
                                           const DysegTrainerOptions& options);

/** The training pairs of DySeg's network: simulated clips from a pool that is replaced one by one,
 * runs with ground truth, and pairs made from single scans. */
class DysegPairs
{
 public:
  /** Reads the real data. \throws UserError. */
  explicit DysegPairs(const DysegTrainerOptions& options);

  /** Takes the simulated clips that belong to a step into the pool; call for every step in turn.
   * The following clips are simulated meanwhile, in threads of their own. */
  void prepare(int step);
  /** Draws a pair. \throws UserError if there is no data at all. */
  [[nodiscard]] DysegSample draw(RandomDraws& draws) const;
  /** The kinds of data, for the user: "simulated clips, 1 real run, 89 single scans". */
  [[nodiscard]] std::string summary() const;

 private:
  void readRuns(const DataSplits& splits);
  void readSingles(const DataSplits& splits);
  [[nodiscard]] DysegClip simulate(int number) const;
  void simulateAhead();
  /** Draws a pair of a run: by the number of scans if there are runs with labels per point, which
   * may be of any length, else of every run equally often. */
  [[nodiscard]] DysegSample drawOfRuns(RandomDraws& draws) const;

  DysegTrainerOptions options_;
  NumberRange seeds_;            //!< seeds of simulated worlds
  std::vector<DysegClip> runs_;  //!< runs with boxes
  std::vector<LabelledRun> labelled_runs_;
  std::vector<std::vector<Eigen::Vector3f>> singles_;
  std::deque<DysegClip> pool_;
  int next_clip_ = 0;                          //!< number of the next clip for the pool
  std::deque<std::future<DysegClip>> coming_;  //!< clip `next_clip_` and those after it
};
}  // namespace dyslam
