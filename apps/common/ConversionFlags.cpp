// SPDX-License-Identifier: BSD-3-Clause
#include "ConversionFlags.h"

#include <map>

#include "Checks.h"

namespace dyslam
{
void declareRange(CLI::App& app, ScanRange& range)
{
  app.add_option("--skip-first-n", range.skip_first_n, "scans to skip");
  app.add_option("--only-first-n", range.only_first_n, "scans to convert after those");
  app.add_option("--start", range.start, "convert scans from this time on [s since the first scan]")
      ->check(notNegative());
  app.add_option("--end", range.end, "convert scans before this time [s since the first scan]")
      ->check(positive());
}

void declareRange(CLI::App& app, ScanRange& range, int& every_n)
{
  declareRange(app, range);
  app.add_option("--every", every_n, "convert every n-th scan only")->check(positive());
}

void declareLidar(CLI::App& app, RecordingOptions& options)
{
  app.add_option(
      "--sensor", options.sensor,
      "the Velodyne of packets: VLP16, VLP16HR, HDL32E, HDL64E, VLP32C or VLS128 (default: "
      "from the packets); "
      "otherwise the scans' sensor label");
  app.add_option(
      "--calibration", options.calibration,
      "of packets (.pcap, bag): Velodyne's XML or YAML, Hesai's angle correction (.csv), or an "
      "Ouster's metadata (.json; default: those beside the .pcap or in the bag)");
}

void declareSensorPose(CLI::App& app, std::string& pose)
{
  app.add_option("--sensor-pose", pose,
                 "pose of the lidar on the vehicle: 'x y z yaw pitch roll' [m, deg]");
}

void declareMounting(CLI::App& app, RecordingOptions& options)
{
  declareSensorPose(app, options.sensor_pose);
  app.add_option(
      "--base-frame", options.base_frame,
      "frame of the vehicle (base_link) in a bag's /tf_static, from which the pose of the "
      "lidar is taken, instead of --sensor-pose");
}

void declarePoseSource(CLI::App& app, PoseSource& source, const std::string& what)
{
  const std::map<std::string, PoseSource> words{{"simulated", PoseSource::simulated},
                                                {"gnss_ins", PoseSource::gnss_ins},
                                                {"given", PoseSource::given}};
  app.add_option("--pose-source", source,
                 what +
                     ": simulated (exact), gnss_ins, or given (of unknown accuracy); "
                     "default: by the files")
      ->transform(wordFor(words));
}
}  // namespace dyslam
