// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Heap.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/run/RunSlam.h>

#include <optional>

#include "../common/AppMain.h"
#include "../common/ConversionFlags.h"
#include "../common/OutputOptions.h"
#include "../common/SlamProgram.h"
#include "../common/StopSignals.h"
#include "InputConversion.h"
#include "LiveRun.h"
#include "LiveWindow.h"

namespace
{
void declare(CLI::App& app,
             dyslam::SlamArguments& a,
             dyslam::RecordingOptions& conversion,
             bool& with_window)
{
  app.description(
      "Replays a recording of 3D LiDAR scans, or follows a lidar on the network or live topics of "
      "ROS 2: trajectory, moving objects, static map");
  app.add_option(
      "-i,--input", a.settings.rawlog,
      "rawlog to replay; or ROS bag, .pcap of a Velodyne, Hesai or Ouster, KITTI folder or folder "
      "of .bin, .pcd or .ply scans, converted to recording.rawlog in --output first; or "
      "udp:[ADDRESS:]PORT[,PORT], a lidar on the network, or ros2:[TOPIC], live topics of ROS 2, "
      "recorded there until Ctrl-C");
  dyslam::addOutputFolder(app, "-o,--output", a.settings.output_folder, "folder for the results")
      ->required();
  app.add_flag("--resume", a.resume,
               "resume the stopped or killed run in --output from its last checkpoint "
               "(output.checkpoint_seconds); --input only if the rawlog has been moved");
  app.add_flag(
      "--window", with_window,
      "show scans, moving objects and map in a window while the run goes on; after a run with "
      "usable results it stays open until you close it");
  dyslam::declareSlamArguments(app, a);
  dyslam::declareConversion(app, conversion);
}

/** Converts or records the input, and runs it. \throws UserError, UnusableResult. */
void run(dyslam::SlamArguments& a, const dyslam::RecordingOptions& conversion, bool with_window)
{
  std::optional<dyslam::LiveWindow> window;
  if (with_window)
  {
    window.emplace();  // first, so that a missing display is told before the conversion
    a.settings.show = [&window](const dyslam::Frame& frame) { window->show(frame); };
  }
  if (dyslam::isLiveInput(a.settings.rawlog))
  {
    dyslam::runLive(a, conversion);
  }
  else
  {
    dyslam::convertInput(a, conversion);
    dyslam::runSlamProgram("dyslam", a, a.resume ? dyslam::resumeSlam : dyslam::runSlam);
  }
  if (window)
  {
    window->waitUntilClosed([] { return dyslam::stop_asked.load(); });
  }
}
}  // namespace

int main(int argc, char** argv)
{
  dyslam::tuneHeap();
  dyslam::SlamArguments a;
  dyslam::RecordingOptions conversion;
  bool with_window = false;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, a, conversion, with_window); },
      [&] { run(a, conversion, with_window); });
}
