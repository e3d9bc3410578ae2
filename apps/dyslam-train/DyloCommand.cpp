// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/train/DataText.h>
#include <dyslam/train/DyloTrainer.h>

#include <iostream>

#include "TrainArguments.h"

namespace dyslam
{
void trainDyloCommand(const TrainArguments& arguments)
{
  arguments.requireConsistent();
  DyloTrainRequest request;
  request.output = arguments.output;
  request.resume = arguments.resume;
  request.start = startWeights(arguments.start);
  request.device = arguments.device;
  request.mask_folder = arguments.mask_folder;
  request.validate_only = arguments.validate_only;
  request.report = [](const std::string& line) { std::cout << line << std::endl; };
  request.stopped = stopRequested;
  trainDylo(arguments.loadConfig("dylo"), request);
}
}  // namespace dyslam
