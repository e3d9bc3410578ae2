// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/io/ScanConverter.h>
#include <dyslam/packets/VelodyneModels.h>

#include <filesystem>
#include <string>
#include <vector>

#include "CaptureConverter.h"
#include "FolderConverter.h"
#include "ScanSink.h"
#include "bags/BagConverter.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** \throws UserError for a file that is known to be no network capture. */
void requireCapture(const std::string& file)
{
  const std::string ending = lowerExtension(file);
  if (isCloudFile(file))
  {
    throw UserError(file + ": is a single scan; give the folder of the scans");
  }
  if (const std::string command = unpackCommand(file); !command.empty())
  {
    throw UserError(file + ": is compressed; unpack it first: " + command + " " + shellWord(file));
  }
  if (ending == ".osf")
  {
    throw UserError(file + ": " + conversionAdvice(file));
  }
  if (ending == ".rawlog")
  {
    throw UserError(file + ": ends in .rawlog: dyslam reads rawlogs as they are");
  }
  if (fs::path(file).filename() == "metadata.yaml")
  {
    throw UserError(file + ": is only the description of a ROS 2 bag; give the bag's folder");
  }
}

}  // namespace

void ScanConverterOptions::describe(OptionsVisitor& visitor)
{
  const std::string sensors =
      "model of the Velodyne of packets, " + velodyneModelNames() + "; else the scans' label";
  visitor.text("sensor", sensor, sensors.c_str());
  visitor.text("calibration", calibration,
               "for packets: Velodyne XML or YAML calibration, or metadata of an Ouster (.json)");
  visitor.text("poses", poses, "file of TUM or KITTI poses of the lidar, a line for each scan");
  visitor.text("times", times, "file of times, a line for each scan of a folder");
  visitor.text("topic", topic, "topic of a bag's scans; empty: the most likely lidar");
  visitor.text("truth_topic", truth_topic,
               "topic of a bag's true poses of the vehicle; empty: none");
  visitor.text("truth_frame", truth_frame, "child frame of the poses in truth_topic");
  visitor.text("imu_topic", imu_topic, "topic of a bag's IMU; empty: none");
  visitor.flag("imu", imu, "convert the IMU in the Ouster of a capture, too");
  visitor.text("imu_pose", imu_pose,
               "pose of the IMU on the vehicle, x y z yaw pitch roll; empty: by the bag's "
               "/tf_static [m, deg]");
  visitor.text("odometry_topic", odometry_topic,
               "topic of the measured speed of a bag's vehicle; empty: none");
  visitor.text("gnss_topic", gnss_topic, "topic of a bag's satellite receiver; empty: none");
  visitor.text("sensor_pose", sensor_pose,
               "pose of the lidar on the vehicle, x y z yaw pitch roll; empty: identity [m, deg]");
  visitor.text("base_frame", base_frame,
               "frame of the vehicle in a bag's /tf_static, which places the lidar in it; empty: "
               "sensor_pose");
  visitor.real("dt", dt, 0, 3600, "time between scans; 0: the scans' own times, else 0.1 [s]");
  visitor.real("scale", scale, 1e-6, 1e6,
               "length of the unit of the coordinates in a bag or a folder of scans; 0.001: "
               "millimetres [m]");
  visitor.text("bin_layout", bin_layout,
               "columns of a folder's .bin files, a letter each; empty: by their content");
  visitor.flag("by_number", by_number,
               "times of a folder's scans by the numbers in their names, dt apart");
  visitor.flag("keep_partial", keep_partial, "convert also incomplete first and last revolutions");
  describePoseSource(
      visitor, "pose_source", pose_source,
      "source of the poses of poses or truth_topic; unknown: given, of unknown accuracy");
  describeConversion(visitor);
}

void ScanConverterOptions::requireAllFitting(RecordingKind kind) const
{
  struct Use
  {
    const char* flag;
    bool given;
    RecordingKind kind;
    const char* with;
  };
  for (const Use& use : {Use{"--poses", !poses.empty(), RecordingKind::scans, "a folder of scans"},
                         Use{"--times", !times.empty(), RecordingKind::scans, "a folder of scans"},
                         Use{"--by-number", by_number, RecordingKind::scans, "a folder of scans"},
                         Use{"--truth-topic", !truth_topic.empty(), RecordingKind::bag, "a bag"},
                         Use{"--truth-frame", !truth_frame.empty(), RecordingKind::bag, "a bag"},
                         Use{"--imu-pose", !imu_pose.empty(),
                             kind == RecordingKind::topics ? kind : RecordingKind::bag, "a bag"}})
  {
    if (use.given && use.kind != kind)
    {
      throw UserError(std::string(use.flag) + " works with " + use.with + " only");
    }
  }
  if ((kind == RecordingKind::network || kind == RecordingKind::topics) && external_storage)
  {
    throw UserError(
        std::string("--external-storage does not work with ") +
        (kind == RecordingKind::network ? "a lidar on the network" : "live topics of ROS 2"));
  }
  if (kind == RecordingKind::scans && keep_partial)
  {
    throw UserError("--keep-partial works with the packets of a .pcap or a bag only");
  }
  requireFitting(kind);
  if (!times.empty() && dt > 0)
  {
    throw UserError("--times and --dt exclude each other");
  }
  if (imu && dt > 0)
  {
    throw UserError(
        "--imu and --dt exclude each other: the samples of the IMU have the lidar's times");
  }
  if (!times.empty() && by_number)
  {
    throw UserError("--times and --by-number exclude each other");
  }
  if (pose_source != PoseSource::unknown && poses.empty() && truth_topic.empty())
  {
    throw UserError("--pose-source states where --poses or --truth-topic are from; give one, too");
  }
  if (!base_frame.empty() && !sensor_pose.empty())
  {
    throw UserError(
        "--base-frame takes the pose of the lidar from the bag, --sensor-pose states it; "
        "give one of them");
  }
  if (!truth_frame.empty() && truth_topic.empty())
  {
    throw UserError("--truth-frame chooses one of the bodies of --truth-topic; give that, too");
  }
  if (!imu_pose.empty() && imu_topic.empty())
  {
    throw UserError("--imu-pose states where the IMU of --imu-topic is mounted; give that, too");
  }
}

ConversionResult convertScans(const std::string& input,
                              const std::string& output,
                              const ScanConverterOptions& options,
                              const ConversionProgress& progress,
                              const BagUnpackingProgress& unpacking)
{
  validate(options, "scans2rawlog");
  if (isLiveInput(input))
  {
    throw UserError(input + ": is live, not a recording; record it with scans2rawlog");
  }
  if (!fs::exists(input))
  {
    throw UserError(input + ": no such file or folder");
  }
  std::vector<std::string> inputs = options.files();
  inputs.insert(inputs.end(), {input, options.poses, options.times});
  requireNoInput(output, inputs);
  const RecordingKind kind = isBag(input)              ? RecordingKind::bag
                             : fs::is_directory(input) ? RecordingKind::scans
                                                       : RecordingKind::capture;
  options.requireAllFitting(kind);
  const ScanFolder folder =
      kind == RecordingKind::scans ? findScanFolder(input, options) : ScanFolder();
  if (kind == RecordingKind::capture)
  {
    requireCapture(input);
  }
  // Made last: bad input must not touch an earlier output.
  ScanSink sink(output, options, progress);
  return sink.fill(
      [&]
      {
        if (kind == RecordingKind::bag)
        {
          convertBag(input, sink, options, unpacking);
        }
        else if (kind == RecordingKind::scans)
        {
          convertFolder(input, folder, sink, options);
        }
        else
        {
          convertCapture(input, sink, options);
        }
        return sink.close();
      });
}
}  // namespace dyslam
