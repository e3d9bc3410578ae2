// SPDX-License-Identifier: BSD-3-Clause
// Without CLI11 and MRPT: the training-only build has neither.
#include <dyslam/core/Error.h>
#include <dyslam/core/FreedMemory.h>
#include <dyslam/core/Version.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "TrainArguments.h"

namespace
{
constexpr const char* overview = R"(Usage: dyslam-train dylo -c train_dylo.ini -o DIR [options]
       dyslam-train dyseg -c train_dyseg.ini -o DIR [options]

Trains the networks: dylo the LiDAR odometry, dyseg the moving-object segmentation.
dyslam-train dylo --help and dyslam-train dyseg --help tell the options.

  --help, --version
)";

constexpr const char* dylo_usage = R"(Usage: dyslam-train dylo -c train_dylo.ini -o DIR [options]

Trains the LiDAR odometry network. Writes DIR/dylo.pt (the weights), checkpoint.pt (everything to go
on from), log.csv, validation.csv and effective.ini. Ctrl-C ends a training after a last checkpoint.

  -c, --config FILE   sections [train], [network], [loss], [augmentation], [data]
  -o, --output DIR    made if it is not there; one that holds a training is not overwritten
  --resume            go on from DIR/checkpoint.pt, exactly where it stopped
  --start FILE        begin with the weights of another training's checkpoint.pt, or with the layers
                      of a dylo.pt that the network of the config has too
  --blend FILE SHARE  no training: writes the mean of --start and of this dylo.pt, SHARE of it
                      from this
  --validate          only print the validation table, of --start FILE or else of
                      DIR/checkpoint.pt
  --mask-csv DIR      a validation scan's points and their static confidence, per recording
  --device cpu|cuda
  --set SECTION.KEY=VALUE   instead of what the file says; may be repeated
)";

constexpr const char* dyseg_usage = R"(Usage: dyslam-train dyseg -c train_dyseg.ini -o DIR [options]

Trains the moving-object segmentation network. Writes DIR/dyseg.pt (the weights), state.pt
(everything to go on from), train.csv, validation.csv and effective.ini. Ctrl-C ends a training
after a last checkpoint.

  -c, --config FILE   sections [train], [network], [grid], [augmentation], [loss]
  -o, --output DIR    made if it is not there; one that holds a training is not overwritten
  --resume            go on from DIR/state.pt, exactly where it stopped
  --start FILE        begin with the weights of another dyseg.pt
  --blend FILE SHARE  no training: writes the mean of --start and of this dyseg.pt, SHARE of it
                      from this
  --validate          only print the validation table, of --start FILE or else of DIR/dyseg.pt
  --set SECTION.KEY=VALUE   instead of what the file says; may be repeated
)";

bool asksFor(const std::vector<std::string>& words, const char* brief, const char* option)
{
  return std::any_of(words.begin(), words.end(),
                     [&](const std::string& word) { return word == brief || word == option; });
}

void run(const std::vector<std::string>& words)
{
  const std::string network = words.empty() ? "" : words.front();
  const bool known = network == "dylo" || network == "dyseg";
  if (asksFor(words, "--version", "--version"))
  {
    std::puts("dyslam-train " DYSLAM_VERSION);
    return;
  }
  if (asksFor(words, "-h", "--help"))
  {
    std::fputs(network == "dylo" ? dylo_usage : known ? dyseg_usage : overview, stdout);
    return;
  }
  if (!known)
  {
    throw dyslam::UserError(
        network.empty() ? "which network? Write dyslam-train dylo or dyslam-train dyseg; see --help"
        : network.front() == '-' ? network + ": the network comes first, dylo or dyseg; see --help"
                                 : network + ": unknown network; there are dylo and dyseg");
  }
  const auto arguments = dyslam::parseTrainArguments(
      network, std::vector<std::string>(words.begin() + 1, words.end()));
  network == "dylo" ? dyslam::trainDyloCommand(arguments) : dyslam::trainDysegCommand(arguments);
}
}  // namespace

int main(int argc, char** argv)
{
  dyslam::keepFreedMemory();
  try
  {
    run({argv + 1, argv + argc});
    return 0;
  }
  catch (const std::exception& error)
  {
    const std::string text = error.what();  // torch's own goes on for a page
    std::cerr << "dyslam-train: " << text.substr(0, text.find('\n')) << std::endl;
    return 1;
  }
}
