// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/io/LiveRecorder.h>
#include <dyslam/io/ScanConverter.h>

#include <cstddef>
#include <iostream>
#include <string>

#include "../common/AppMain.h"
#include "../common/Checks.h"
#include "../common/ConversionFlags.h"
#include "../common/ConversionReport.h"
#include "../common/OutputOptions.h"
#include "../common/Progress.h"
#include "../common/StopSignals.h"

namespace
{
using namespace dyslam;

struct Arguments
{
  std::string input;
  std::string output;
  ScanConverterOptions options;
  bool list = false;
  bool force = false;
  bool quiet = false;
};

void declare(CLI::App& app, Arguments& arguments)
{
  ScanConverterOptions& o = arguments.options;
  app.description(
      "Converts a folder of .bin, .pcd or .ply scans, a .pcap of a Velodyne, Hesai or Ouster, or a "
      "ROS bag (.bag, .db3, .mcap) to an MRPT rawlog, or records a lidar on the network or topics "
      "of ROS 2 in one");
  app.add_option("-i,--input", arguments.input,
                 "folder of scans or of a bag's parts, or file; or udp:[ADDRESS:]PORT[,PORT], a "
                 "lidar on the network, or ros2:[TOPIC], live topics of ROS 2, recorded until "
                 "Ctrl-C")
      ->required();
  CLI::Option* output = addOutputFile(app, "-o,--output", arguments.output, "rawlog to write");
  CLI::Option* list =
      app.add_flag("--list", arguments.list, "print the topics of a bag, or of ros2:, and stop");
  list->excludes(output);
  app.add_option(
      "--topic", o.topic,
      "a bag's topic of clouds (PointCloud2, Livox) or packets (Velodyne, Hesai, Ouster) (default: "
      "clouds, those with times or rings of the points, then with the most bytes)");
  declareFurtherTopics(app, o);
  app.add_option("--truth-topic", o.truth_topic,
                 "a bag's true poses of the vehicle: PoseStamped, Odometry, TransformStamped, /tf");
  app.add_option("--truth-frame", o.truth_frame,
                 "child frame of --truth-topic, where that has several");
  app.add_option("--imu-topic", o.imu_topic,
                 "a bag's sensor_msgs/Imu, or packets of the IMU in an Ouster, whose samples are "
                 "written beside the scans");
  declareImu(app, o);
  app.add_option("--imu-pose", o.imu_pose,
                 "pose of the IMU on the vehicle: 'x y z yaw pitch roll' [m, deg] (default: by "
                 "/tf_static and --sensor-pose, else no rotation)");
  app.add_option("--odometry-topic", o.odometry_topic,
                 "a bag's speed by the wheels, written beside the scans: Odometry, TwistStamped, "
                 "TwistWithCovarianceStamped");
  app.add_option("--gnss-topic", o.gnss_topic,
                 "a bag's sensor_msgs/NavSatFix, whose positions are written beside the scans");
  declareLidar(app, o);
  app.add_option("--poses", o.poses, "true poses of the lidar, TUM or KITTI, a line for each scan");
  declarePoseSource(app, o.pose_source, "where --poses or --truth-topic are from");
  app.add_option("--times", o.times,
                 "times of a folder's scans, a line each: seconds, or KITTI's timestamps.txt");
  declareMounting(app, o);
  app.add_option("--dt", o.dt, "seconds between scans; default: their own times, else 0.1")
      ->check(positive());
  declareClouds(app, o);
  app.add_flag("--by-number", o.by_number,
               "times of a folder's scans: the number in the file name times --dt (default 0.1), "
               "where numbers have gaps");
  app.add_flag("--keep-partial", o.keep_partial,
               "also the incomplete first and last revolutions of packets");
  declareRawlog(app, o);
  app.add_flag("--force", arguments.force, "replace an earlier recording and its ground truth");
  app.add_flag("-q,--quiet", arguments.quiet, "no progress");
}

/** Records a lidar on the network, or topics of ROS 2, until Ctrl-C. */
void record(const Arguments& arguments)
{
  requireNewRecording(arguments.output, arguments.force);
  stopOnSignals();
  constexpr double unknown = -1;
  std::size_t recorded = 0;
  Progress progress("scans2rawlog", "scans", arguments.quiet);
  const auto print = [&arguments](const std::string& line)
  {
    if (!arguments.quiet)
    {
      printAbove("scans2rawlog: " + line);
    }
  };
  LiveRecorderHooks hooks;
  hooks.stop = [] { return stop_asked.load(); };
  hooks.listening = [&print](const std::string& name)
  { print("waits for " + name + "; Ctrl-C ends the recording"); };
  hooks.warn = [&print](const std::string& warning) { print("warning: " + warning); };
  hooks.recorded = [&](std::size_t scans)
  {
    recorded = scans;
    progress.update(unknown, scans);
  };
  const ConversionResult result =
      recordLive(arguments.input, arguments.output, arguments.options, hooks);
  progress.finish(recorded);
  report(result, arguments.output);
}

void run(const Arguments& arguments)
{
  const auto unpacking = unpackWithProgress("scans2rawlog", arguments.input, arguments.quiet);
  if (arguments.list && isRos2Input(arguments.input))
  {
    stopOnSignals();
    std::cout << listLiveTopics([] { return stop_asked.load(); });
    return;
  }
  if (arguments.list)
  {
    if (!isBag(arguments.input))
    {
      throw UserError(arguments.input +
                      ": is no bag; --list prints the topics of one, or of ros2:");
    }
    const auto bag = openBag(arguments.input, unpacking);
    for (const std::string& warning : bag->warnings())
    {
      std::cerr << "warning: " << printable(warning) << '\n';
    }
    std::cout << listingOf(*bag);
    return;
  }
  if (arguments.output.empty())
  {
    throw UserError("--output: name the rawlog to write (-o x.rawlog)");
  }
  if (isLiveInput(arguments.input))
  {
    record(arguments);
    return;
  }
  runConversion("scans2rawlog", arguments.input, arguments.output, arguments.force, arguments.quiet,
                [&](const ConversionProgress& progress)
                {
                  return convertScans(arguments.input, arguments.output, arguments.options,
                                      progress, unpacking);
                });
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, arguments); }, [&] { run(arguments); });
}
