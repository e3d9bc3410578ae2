// SPDX-License-Identifier: BSD-3-Clause
#include "CurvesCommand.h"

#include <dyslam/base/Files.h>
#include <dyslam/plot/LearningCurves.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "OutputFiles.h"

namespace dyslam
{
Subcommand curvesCommand(CLI::App& app)
{
  struct Arguments
  {
    std::vector<std::string> logs;
  };
  const auto a = std::make_shared<Arguments>();
  Subcommand command;
  command.parser =
      app.add_subcommand("curves", "plots the CSV logs of dyslam-train, one PNG per log");
  command.parser->add_option("logs", a->logs, "log.csv, validation.csv, ...")->required();
  command.run = [a]
  {
    for (const auto& file : a->logs)
    {
      const auto picture = renderLearningCurves(parseLearningLog(
          readWhole(file, "give a log.csv or validation.csv of dyslam-train"), file));
      const auto to = std::filesystem::path(file).replace_extension(".png").string();
      writePng(to, picture);
      std::printf("%s\n", to.c_str());
    }
  };
  return command;
}
}  // namespace dyslam
