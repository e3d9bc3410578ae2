// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Config.h>
#include <dyslam/core/Error.h>
#include <dyslam/core/FreedMemory.h>
#include <dyslam/core/SharedFiles.h>
#include <dyslam/train/DyloTrainer.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "DysegCommand.h"
#include "Share.h"

namespace
{
constexpr const char* usage = R"(Usage: dyslam-train dylo -c train.ini -o DIR [options]
       dyslam-train dyseg --help

Trains the LiDAR odometry network. Writes DIR/dylo.pt (the weights), checkpoint.pt, log.csv,
validation.csv and effective.ini.

  -c, --config FILE   sections [train], [network], [loss], [augmentation], [data]
  -o, --output DIR    made if it is not there
  --resume            go on from DIR/checkpoint.pt, exactly where it stopped
  --start FILE        begin with the weights of another training's checkpoint.pt, or with the layers
                      of a dylo.pt that the network of the config has too
  --blend FILE SHARE  no training: writes the mean of --start and of this dylo.pt, SHARE of it
                      from this
  --validate          only print the validation table of DIR/checkpoint.pt
  --mask-csv DIR      a validation scan's points and their static confidence, per recording
  --device cpu|cuda
  --set SECTION.KEY=VALUE   instead of what the file says; may be repeated
  --help, --version
)";

struct Arguments
{
  std::string network;
  std::string config;
  std::vector<std::string> assignments;
  dyslam::DyloTrainRequest request;
  bool done = false;
};

Arguments parse(int argc, char** argv)
{
  Arguments arguments;
  const std::vector<std::string> words(argv + 1, argv + argc);
  for (std::size_t i = 0; i < words.size(); ++i)
  {
    const std::string& word = words[i];
    const auto value = [&]() -> std::string
    {
      if (i + 1 >= words.size())
      {
        throw dyslam::UserError(word + ": a value is missing");
      }
      return words[++i];
    };
    if (word == "--help" || word == "-h")
    {
      std::fputs(usage, stdout);
      arguments.done = true;
      return arguments;
    }
    if (word == "--version")
    {
      std::puts("dyslam-train " DYSLAM_VERSION);
      arguments.done = true;
      return arguments;
    }
    if (word == "-c" || word == "--config")
    {
      arguments.config = value();
    }
    else if (word == "-o" || word == "--output")
    {
      arguments.request.output = value();
    }
    else if (word == "--device")
    {
      arguments.request.device = value();
    }
    else if (word == "--set")
    {
      arguments.assignments.push_back(value());
    }
    else if (word == "--mask-csv")
    {
      arguments.request.mask_folder = value();
    }
    else if (word == "--start")
    {
      arguments.request.start = value();
    }
    else if (word == "--blend")
    {
      arguments.request.blend = value();
      arguments.request.blend_share = dyslam::shareOf(value());
    }
    else if (word == "--resume")
    {
      arguments.request.resume = true;
    }
    else if (word == "--validate")
    {
      arguments.request.validate_only = true;
    }
    else if (word.rfind('-', 0) != 0 && arguments.network.empty())
    {
      arguments.network = word;
    }
    else
    {
      throw dyslam::UserError(word + ": unknown option; see --help");
    }
  }
  if (arguments.network != "dylo")
  {
    throw dyslam::UserError(arguments.network.empty()
                                ? "which network? Write dyslam-train dylo; see --help"
                                : arguments.network +
                                      ": unknown network; there are dylo and dyseg");
  }
  if (arguments.config.empty() || arguments.request.output.empty())
  {
    throw dyslam::UserError("--config and --output are needed; see --help");
  }
  const dyslam::DyloTrainRequest& request = arguments.request;
  dyslam::checkStart(request.start, request.resume, request.blend);
  return arguments;
}
}  // namespace

int main(int argc, char** argv)
{
  dyslam::keepFreedMemory();
  try
  {
    if (argc > 1 && std::string(argv[1]) == "dyseg")
    {
      return dyslam::trainDysegCommand({argv + 2, argv + argc});
    }
    Arguments arguments = parse(argc, argv);
    if (arguments.done)
    {
      return 0;
    }
    dyslam::Config config = dyslam::Config::fromFile(
        dyslam::findGivenOrShared(arguments.config, "config_files", ".ini"));
    for (const std::string& assignment : arguments.assignments)
    {
      config.set(assignment);
    }
    arguments.request.report = [](const std::string& line) { std::cout << line << std::endl; };
    dyslam::trainDylo(config, arguments.request);
    return 0;
  }
  catch (const std::exception& error)
  {
    const std::string text = error.what();  // torch's own goes on for a page
    std::cerr << "dyslam-train: " << text.substr(0, text.find('\n')) << std::endl;
    return 1;
  }
}
