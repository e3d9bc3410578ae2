// SPDX-License-Identifier: BSD-3-Clause
#include "DysegCommand.h"

#include <dyslam/core/Config.h>
#include <dyslam/core/Error.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/core/SharedFiles.h>
#include <dyslam/train/DysegTrainer.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "Share.h"

namespace dyslam
{
namespace
{
constexpr const char* usage = R"(Usage: dyslam-train dyseg -c train_dyseg.ini -o DIR [options]

Trains the moving-object segmentation network. Writes DIR/dyseg.pt (the weights), state.pt
(everything to go on from), train.csv, validation.csv and effective.ini.

  -c, --config FILE   sections [train], [network], [grid], [augmentation], [loss]
  -o, --output DIR    made if it is not there
  --resume            go on from DIR/state.pt
  --start FILE        begin with the weights of another dyseg.pt
  --blend FILE SHARE  no training: writes the mean of --start and of this, SHARE of it from this
  --validate          only print the validation table of DIR/dyseg.pt
  --set SECTION.KEY=VALUE   instead of what the file says; may be repeated
)";

constexpr const char* data_variable = "$DYSLAM_DATA";

struct Arguments
{
  std::string config;
  std::string output;
  std::string start;
  std::string blend;
  double blend_share = 0;
  std::vector<std::string> assignments;
  bool resume = false;
  bool validate_only = false;
  bool help = false;
};

Arguments parse(const std::vector<std::string>& words)
{
  Arguments a;
  for (std::size_t i = 0; i < words.size(); ++i)
  {
    const std::string& word = words[i];
    const auto value = [&]() -> std::string
    {
      if (i + 1 >= words.size())
      {
        throw UserError(word + ": a value is missing");
      }
      return words[++i];
    };
    if (word == "-h" || word == "--help")
    {
      a.help = true;
      return a;
    }
    if (word == "-c" || word == "--config")
    {
      a.config = value();
    }
    else if (word == "-o" || word == "--output")
    {
      a.output = value();
    }
    else if (word == "--start")
    {
      a.start = value();
    }
    else if (word == "--blend")
    {
      a.blend = value();
      a.blend_share = shareOf(value());
    }
    else if (word == "--set")
    {
      a.assignments.push_back(value());
    }
    else if (word == "--resume")
    {
      a.resume = true;
    }
    else if (word == "--validate")
    {
      a.validate_only = true;
    }
    else
    {
      throw UserError(word + ": unknown option; see dyslam-train dyseg --help");
    }
  }
  if (a.config.empty() || a.output.empty())
  {
    throw UserError("--config and --output are needed; see dyslam-train dyseg --help");
  }
  checkStart(a.start, a.resume, a.blend);
  return a;
}

/** Replaces $DYSLAM_DATA at the start of the folder by the variable's value. */
std::string expanded(const std::string& folder)
{
  const std::string name = data_variable;
  if (folder.rfind(name, 0) != 0)
  {
    return folder;
  }
  const char* value = std::getenv(name.c_str() + 1);
  if (value == nullptr)
  {
    throw UserError("train.data: " + name + " is not set; export it or write the folder");
  }
  return value + folder.substr(name.size());
}
}  // namespace

int trainDysegCommand(const std::vector<std::string>& words)
{
  const Arguments a = parse(words);
  if (a.help)
  {
    std::fputs(usage, stdout);
    return 0;
  }
  Config config = Config::fromFile(findGivenOrShared(a.config, "config_files", ".ini"));
  for (const std::string& assignment : a.assignments)
  {
    config.set(assignment);
  }
  ConfigLoader loader(config);
  DysegTrainerSetup setup;
  setup.train = loader.get<DysegTrainerOptions>("train");
  setup.network = loader.get<DysegNetworkOptions>("network");
  setup.grid = loader.get<BevOptions>("grid");
  setup.augmentation = loader.get<DysegAugmentOptions>("augmentation");
  setup.loss = loader.get<DysegLossOptions>("loss");
  loader.requireAllUsed();
  setup.train.data = expanded(setup.train.data);

  std::filesystem::create_directories(a.output);
  writeWhole(a.output + "/effective.ini", loader.effective().toIni());
  DysegTrainer trainer(setup, a.output);
  if (a.resume)
  {
    trainer.resume();
  }
  else if (!a.start.empty())
  {
    trainer.startFrom(a.start);
  }
  if (!a.blend.empty())
  {
    trainer.blend(a.blend, a.blend_share);
    trainer.save();
    return 0;
  }
  const auto say = [](const std::string& line) { std::cout << line << std::endl; };
  if (a.validate_only)
  {
    trainer.startFrom(a.output + "/dyseg.pt");
    trainer.validateOnly(say);
    return 0;
  }
  trainer.run(say);
  return 0;
}
}  // namespace dyslam
