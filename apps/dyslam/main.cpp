// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Heap.h>
#include <dyslam/pipeline/SlamRun.h>

#include "../common/SlamProgram.h"

namespace
{
void declare(CLI::App& app, dyslam::SlamArguments& a)
{
  app.description("Replays a rawlog of 3D LiDAR scans: trajectory, moving objects, static map");
  app.add_option("-i,--input", a.settings.rawlog, "rawlog to replay");
  app.add_option("-o,--output", a.settings.output_folder, "folder for the results")->required();
  app.add_flag("--resume", a.resume,
               "resume the killed run in --output from its last checkpoint "
               "(output.checkpoint_seconds); --input only if the rawlog has been moved");
  dyslam::declareSlamArguments(app, a);
}
}  // namespace

int main(int argc, char** argv)
{
  dyslam::tuneHeap();
  dyslam::SlamArguments a;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, a); },
      [&]
      { dyslam::runSlamProgram("dyslam", a, a.resume ? dyslam::resumeSlam : dyslam::runSlam); });
}
