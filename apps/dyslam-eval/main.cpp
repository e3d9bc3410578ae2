// SPDX-License-Identifier: BSD-3-Clause
#include <vector>

#include "../common/AppMain.h"
#include "RunCommand.h"
#include "SegmentationCommand.h"
#include "TrajectoryCommand.h"

int main(int argc, char** argv)
{
  std::vector<dyslam::Subcommand> commands;
  return dyslam::runApp(
      argc, argv,
      [&](CLI::App& app)
      {
        app.description("Errors of trajectories, moving-point labels and maps against the truth");
        app.require_subcommand(1);
        commands = {dyslam::trajectoryCommand(app), dyslam::segmentationCommand(app),
                    dyslam::runCommand(app)};
      },
      [&]
      {
        for (const auto& command : commands)
        {
          if (command.parser->parsed())
          {
            command.run();
          }
        }
      });
}
