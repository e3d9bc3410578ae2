// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/train/ChangedSettings.h>
#include <dyslam/train/DataText.h>
#include <dyslam/train/DysegTrainer.h>

#include <iostream>

#include "TrainArguments.h"

namespace dyslam
{
void trainDysegCommand(const TrainArguments& arguments)
{
  arguments.requireConsistent();
  const Config config = arguments.loadConfig("dyseg");
  DysegTrainerSetup setup;
  const Config effective = setup.load(config);
  setup.device = arguments.device;
  setup.train.data = dataFolder(setup.train.data, "[train] data");

  const std::string& output = arguments.output;
  const std::string start = startWeights(arguments.start);
  const auto report = [](const std::string& line) { std::cout << line << std::endl; };
  DysegTrainer trainer(setup, output);
  if (arguments.validate_only)
  {
    GivenDysegShape given;
    if (!config.section("grid").empty())
    {
      given.grid = setup.grid;
    }
    if (!config.section("network").empty())
    {
      given.network = setup.network;
    }
    trainer.validateOnly(start, given, report);
    return;
  }
  if (arguments.resume)
  {
    trainer.resume();
  }
  else
  {
    trainer.requireFreshFolder();
    if (!start.empty())
    {
      trainer.startFrom(start);
    }
  }
  trainer.loadData();  // before anything is written: settings that fail leave the folder as it is
  makeFolder(output, "choose another --output");
  const std::string ini = output + "/effective.ini";
  const std::string changes = arguments.resume ? changedSettingsNote(ini, effective) : "";
  if (!changes.empty())
  {
    report(changes);
  }
  writeWhole(ini, effective.toIni());
  trainer.run(report, stopRequested);
}
}  // namespace dyslam
