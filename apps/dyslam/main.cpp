// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Heap.h>
#include <dyslam/run/RunSlam.h>

#include "../common/AppMain.h"
#include "../common/ConversionFlags.h"
#include "../common/OutputOptions.h"
#include "../common/SlamProgram.h"
#include "InputConversion.h"

namespace
{
void declare(CLI::App& app, dyslam::SlamArguments& a, dyslam::RecordingOptions& conversion)
{
  app.description("Replays a recording of 3D LiDAR scans: trajectory, moving objects, static map");
  app.add_option(
      "-i,--input", a.settings.rawlog,
      "rawlog to replay; or ROS bag, .pcap of a Velodyne, Hesai or Ouster, KITTI folder or folder "
      "of .bin, .pcd or .ply scans, converted to recording.rawlog in --output first");
  dyslam::addOutputFolder(app, "-o,--output", a.settings.output_folder, "folder for the results")
      ->required();
  app.add_flag("--resume", a.resume,
               "resume the stopped or killed run in --output from its last checkpoint "
               "(output.checkpoint_seconds); --input only if the rawlog has been moved");
  dyslam::declareSlamArguments(app, a);
  dyslam::declareConversion(app, conversion);
}
}  // namespace

int main(int argc, char** argv)
{
  dyslam::tuneHeap();
  dyslam::SlamArguments a;
  dyslam::RecordingOptions conversion;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, a, conversion); },
      [&]
      {
        dyslam::convertInput(a, conversion);
        dyslam::runSlamProgram("dyslam", a, a.resume ? dyslam::resumeSlam : dyslam::runSlam);
      });
}
