// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>
#include <dyslam/train/DataSplits.h>
#include <dyslam/train/LearningRate.h>
#include <dyslam/train/PairSource.h>
#include <dyslam/train/Recordings.h>

#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
struct TrainOptions : Options
{
  int seed = 1;      //!< of the initial weights and of all data
  int steps = 8000;  //!< of the optimiser
  int batch = 2;     //!< pairs in a step
  LearningRateOptions rate;
  double mean_decay = 0.998;      //!< decay of the exponential moving average of the weights
  double clip = 5;                //!< largest norm of the gradient
  double perturbed_starts = 0.5;  //!< share of pairs that start near the truth
  int threads = 1;                //!< pairs computed at a time
  double checkpoint_minutes = 3;  //!< between checkpoints
  int validate_every = 500;       //!< steps
  int report_every = 20;          //!< steps

  void describe(OptionsVisitor& visitor) override;
};

struct DataOptions : Options
{
  std::string base = "$DYSLAM_DATA";
  std::string splits = "splits";  //!< training, validation and test frames
  // Lists, separated by '|'; see describe() for their fields.
  std::string recordings;
  std::string singles;
  std::string bodies;
  std::string validation;
  std::string simulated_validation;
  int most_gap = 5;  //!< largest gap in a pair, in scans; simulated ones: 3 at most
  // Shares of pairs, relative to each other.
  double recordings_weight = 1;
  double singles_weight = 0.1;
  double simulator_weight = 0;
  std::string simulator_worlds =
      "0.08;urban;HDL64E;1024;0;1 | 0.1;urban;HDL64E;0;0;1 | 0.2;highway;HDL64E;1024;0;0.3 | "
      "0.1;highway;HDL64E;0;0;0.3 | 0.15;highway;HDL64E;1024;0.3;1 | 0.15;highway;HDL64E;1024;1;1 "
      "| 0.12;campus;VLP16;0;0;1 | 0.1;urban;VLP16;0;0;1";

  void describe(OptionsVisitor& visitor) override;
};

/** Recordings described one by one, separated by '|'; see parseRecording().
 * \param split of all their frames: those for training are corrected by their own motion, others by
 * that of the step before \throws UserError, also for frames of another split. */
[[nodiscard]] std::vector<Recording> loadRecordings(const std::string& list,
                                                    const std::string& base,
                                                    const DataSplits& splits,
                                                    Split split);
}  // namespace dyslam
