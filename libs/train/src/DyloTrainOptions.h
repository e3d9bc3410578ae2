// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/train/DataSplits.h>
#include <dyslam/train/LearningRate.h>
#include <dyslam/train/PairSource.h>
#include <dyslam/train/Recordings.h>

#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
/** Ini section `[train]` of DyLO's training. */
struct TrainOptions : Options
{
  int seed = 1;      //!< seed of the initial weights and of all data
  int steps = 8000;  //!< number of optimiser steps
  int batch = 2;     //!< number of pairs per step
  LearningRateOptions rate;
  double ema_decay = 0.998;  //!< decay of the exponential moving average of the weights
  double clip = 5;           //!< largest norm of the gradient
  /** Share of pairs with an initial guess near the truth; 0.8 at least of pairs that moved by more
   * than 1.5 m, unless it is 0. */
  double perturbed_starts = 0.5;
  int threads = 1;                //!< pairs computed at a time
  double checkpoint_minutes = 3;  //!< time between checkpoints [min]
  int validate_every = 500;       //!< steps between validations
  int report_every = 20;          //!< steps between rows of the log

  void describe(OptionsVisitor& visitor) override;
};

/** Ini section `[data]` of DyLO's training. */
struct DataOptions : Options
{
  std::string base = "$DYSLAM_DATA";
  std::string splits = "splits";  //!< file of the training, validation and test frames
  // Lists, separated by '|'; see describe() for their fields.
  std::string recordings;
  std::string singles;
  std::string bodies;
  std::string validation;
  std::string simulated_validation;
  int max_gap = 5;  //!< largest gap between the scans of a pair [scans]; simulated: 3 at most
  // Weights of the sources of pairs, relative to each other.
  double recordings_weight = 1;
  double singles_weight = 0.1;
  double simulator_weight = 0;
  std::string simulator_worlds =
      "0.08;urban;HDL64E;1024;0;1 | 0.1;urban;HDL64E;0;0;1 | 0.2;highway;HDL64E;1024;0;0.3 | "
      "0.1;highway;HDL64E;0;0;0.3 | 0.15;highway;HDL64E;1024;0.3;1 | 0.15;highway;HDL64E;1024;1;1 "
      "| 0.12;campus;VLP16;0;0;1 | 0.1;urban;VLP16;0;0;1";

  void describe(OptionsVisitor& visitor) override;
};

/** Reads recordings whose descriptions are separated by '|'; see parseRecording(). \param split
 * split of all frames: training scans are deskewed by their own motion, others by that of the step
 * before \throws UserError, also for frames of another split. */
[[nodiscard]] std::vector<Recording> loadRecordings(const std::string& list,
                                                    const std::string& base,
                                                    const DataSplits& splits,
                                                    Split split);
}  // namespace dyslam
