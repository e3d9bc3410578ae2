// SPDX-License-Identifier: BSD-3-Clause
#include <vector>

#include "../common/AppMain.h"
#include "CurvesCommand.h"
#include "KittiMotCommand.h"
#include "KittiSlamCommand.h"
#include "MapCommand.h"
#include "MaskCommand.h"
#include "PredictionCommand.h"
#include "RunCommand.h"
#include "SegmentationCommand.h"
#include "SpeedsCommand.h"
#include "TablesCommand.h"
#include "TracksCommand.h"
#include "TrajectoryCommand.h"

int main(int argc, char** argv)
{
  std::vector<dyslam::Subcommand> commands;
  return dyslam::runApp(
      argc, argv,
      [&](CLI::App& app)
      {
        app.description("Evaluates trajectories, labels, maps and tracks against ground truth");
        app.require_subcommand(1);
        commands = {dyslam::trajectoryCommand(app), dyslam::segmentationCommand(app),
                    dyslam::mapCommand(app),        dyslam::tracksCommand(app),
                    dyslam::predictionCommand(app), dyslam::kittiMotCommand(app),
                    dyslam::kittiSlamCommand(app),  dyslam::speedsCommand(app),
                    dyslam::runCommand(app),        dyslam::curvesCommand(app),
                    dyslam::maskCommand(app),       dyslam::tablesCommand(app)};
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
