// SPDX-License-Identifier: BSD-3-Clause
#include "DyloTrainOptions.h"

#include <dyslam/formats/ScanFiles.h>
#include <dyslam/train/DataText.h>

namespace dyslam
{
void TrainOptions::describe(OptionsVisitor& visitor)
{
  visitor.integer("seed", seed, 0, 1 << 30, "random seed of weights and data");
  visitor.integer("steps", steps, 1, 100000000, "number of optimiser steps");
  visitor.integer("batch", batch, 1, 1024, "number of pairs per step");
  rate.describe(visitor);
  visitor.real("ema_decay", ema_decay, 0, 1,
               "decay per step of the exponential moving average of the weights, which is saved");
  visitor.real("clip", clip, 1e-6, 1e6, "norm to which the gradient is clipped");
  visitor.real("perturbed_starts", perturbed_starts, 0, 1,
               "share of pairs with an initial guess near the truth, not at zero motion");
  visitor.integer(
      "threads", threads, 1, 256,
      "pairs computed at a time, each in a thread; in validation, threads of the network");
  visitor.real("checkpoint_minutes", checkpoint_minutes, 0.01, 1e6,
               "time between checkpoints [min]");
  visitor.integer("validate_every", validate_every, 1, 100000000, "steps between validations");
  visitor.integer("report_every", report_every, 1, 1000000,
                  "steps between rows of the training log");
}

void DataOptions::describe(OptionsVisitor& visitor)
{
  visitor.text("base", base, "folder of the data; a leading $NAME is an environment variable");
  visitor.text(
      "splits", splits,
      "splits of the frames (training, validation, test): a file, or the name of a shipped one");
  visitor.text(
      "recordings", recordings,
      "training recordings, folder;poses;first;last[;deskew][;labels=folder][;calib=calib.txt] "
      "each, separated by |");
  visitor.text("singles", singles, "folders of single scans, separated by |");
  visitor.text("bodies", bodies,
               "folders of labelled scans from which bodies are cut, separated by |");
  visitor.text("validation", validation, "validation recordings, in the format of recordings");
  visitor.text("simulated_validation", simulated_validation,
               "simulated validation drives, world;sensor;traffic;seed;scans each, separated by |");
  visitor.integer("max_gap", max_gap, 1, 100,
                  "largest gap between the scans of a pair [scans]; of simulated pairs 3 at most");
  visitor.real("recordings_weight", recordings_weight, 0, 1e6,
               "weight of recordings among the sources of pairs");
  visitor.real("singles_weight", singles_weight, 0, 1e6,
               "weight of single scans among the sources of pairs");
  visitor.real("simulator_weight", simulator_weight, 0, 1e6,
               "weight of the simulator among the sources of pairs");
  visitor.text("simulator_worlds", simulator_worlds,
               "simulated worlds, share;world;sensor;columns (0: the sensor's);least;most traffic "
               "each, separated by |");
}

std::vector<Recording> loadRecordings(const std::string& list,
                                      const std::string& base,
                                      const DataSplits& splits,
                                      Split split)
{
  const bool training = split == Split::training;
  const std::string field = training ? "[data] recordings" : "[data] validation";
  std::vector<Recording> recordings;
  for (const std::string& item : listItems(list, '|'))
  {
    const RecordingDescription description = parseRecording(item, base, field);
    const std::vector<std::string> files = listBinFiles(description.folder);
    for (std::size_t k = description.first; k <= description.last && k < files.size(); ++k)
    {
      splits.requireScan(files[k], split, field);
    }
    recordings.push_back(loadRecording(description, training));
  }
  return recordings;
}
}  // namespace dyslam
