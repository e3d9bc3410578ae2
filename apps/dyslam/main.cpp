// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Heap.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/io/LiveTopics.h>
#include <dyslam/run/RunSlam.h>

#include <functional>
#include <optional>
#include <string>

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
/** How the run is shown while it goes on. */
struct Shown
{
  bool window = false;
  bool publish = false;
  bool no_tf = false;
};

void declare(CLI::App& app,
             dyslam::SlamArguments& a,
             dyslam::RecordingOptions& conversion,
             Shown& shown)
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
      "--window", shown.window,
      "show scans, moving objects and map in a window while the run goes on; after a run with "
      "usable results it stays open until you close it");
  CLI::Option* publish = app.add_flag(
      "--publish", shown.publish,
      "publish poses, static points and moving objects by ROS 2 while the run goes on: "
      "/tf, /dyslam/odometry, /dyslam/points_static, /dyslam/objects");
  app.add_flag("--no-tf", shown.no_tf,
               "with --publish: no /tf, where another node has a transform of the vehicle")
      ->needs(publish);
  dyslam::declareSlamArguments(app, a);
  dyslam::declareConversion(app, conversion);
}

/** Shows the frames also to `show`. */
void addShow(dyslam::SlamArguments& a, const std::function<void(const dyslam::Frame&)>& show)
{
  a.settings.show = [earlier = a.settings.show, show](const dyslam::Frame& frame)
  {
    if (earlier)
    {
      earlier(frame);
    }
    show(frame);
  };
}

/** Converts or records the input, and runs it. \throws UserError, UnusableResult. */
void run(dyslam::SlamArguments& a, const dyslam::RecordingOptions& conversion, const Shown& shown)
{
  std::optional<dyslam::LiveWindow> window;
  std::optional<dyslam::LiveTopics> topics;
  if (shown.window)
  {
    window.emplace();  // first, so that a missing display is told before the conversion
    addShow(a, [&window](const dyslam::Frame& frame) { window->show(frame); });
  }
  if (shown.publish)
  {
    dyslam::LiveTopicsOptions options;
    options.transforms = !shown.no_tf;
    if (!conversion.base_frame.empty())
    {
      options.vehicle_frame = conversion.base_frame;
    }
    topics.emplace(options);
    a.settings.levelled = [&topics](const dyslam::Levelling& l) { topics->setLevelling(l); };
    addShow(a, [&topics](const dyslam::Frame& frame) { topics->publish(frame); });
  }
  if (dyslam::isLiveInput(a.settings.rawlog))
  {
    dyslam::runLive(a, conversion,
                    [&topics](const std::string& name)
                    {
                      if (topics)
                      {
                        topics->setVehicleFrame(name);
                      }
                    });
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
  Shown shown;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, a, conversion, shown); },
      [&] { run(a, conversion, shown); });
}
