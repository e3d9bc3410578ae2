// SPDX-License-Identifier: BSD-3-Clause
#include "ConversionFlags.h"

#include <map>

#include "Checks.h"
#include "RangeFlags.h"

namespace dyslam
{
void declareRawlog(CLI::App& app, ConversionOptions& options)
{
  declareRange(app, options, "convert");
  app.add_option("--every", options.every_n, "convert every n-th scan only")->check(positive());
  app.add_flag("--external-storage", options.external_storage, "clouds in separate files");
}

void declareFurtherTopics(CLI::App& app, RecordingOptions& options)
{
  app.add_option("--further-topic", options.further_topics,
                 "topic of another lidar of the vehicle in a bag, placed by /tf_static; TOPIC=FILE "
                 "with a calibration of its packets; repeatable (dyslam merges its scans: "
                 "input.further_lidars)")
      ->take_all()
      ->allow_extra_args(false);
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

void declareImu(CLI::App& app, RecordingOptions& options)
{
  app.add_flag("--imu", options.imu,
               "also the IMU in the Ouster of a .pcap, whose samples are written beside the scans");
}

void declareClouds(CLI::App& app, RecordingOptions& options)
{
  app.add_option("--bin-layout", options.bin_layout,
                 "columns of .bin files (float32), a letter each: x y z, i intensity, r ring, t "
                 "time, _ any other; KITTI's are xyzi (default: by their content)");
  app.add_option(
         "--scale", options.scale,
         "metres per unit of the coordinates in a bag or a folder of scans: 0.001 for millimetres "
         "(default: 1)")
      ->check(positive());
}

void declareDeskewed(CLI::App& app, ScansDeskewed& deskewed)
{
  const std::map<std::string, ScansDeskewed> words{
      {"auto", ScansDeskewed::automatic}, {"yes", ScansDeskewed::yes}, {"no", ScansDeskewed::no}};
  app.add_option("--deskewed", deskewed,
                 "whether KITTI's scans are deskewed already: auto (odometry's are, those of "
                 "rawlog2kitti if "
                 "they have no point_times), yes or no")
      ->transform(wordFor(words));
}

void declareVerticalAngles(CLI::App& app, bool& correct)
{
  app.add_flag("--kitti-vertical-angle-correction", correct,
               "correct the elevation of the points by +0.205 deg, as KITTI odometry's scans need");
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

void declareConversion(CLI::App& app, RecordingOptions& options)
{
  const std::string before = app.option_defaults()->get_group();
  app.option_defaults()->group("Input that is no rawlog (the converters have more options)");
  app.add_option("--topic", options.topic,
                 "a bag's topic of scans (default: the most likely lidar; scans2rawlog --list "
                 "prints the topics)");
  declareFurtherTopics(app, options);
  app.add_option("--imu-topic", options.imu_topic,
                 "a bag's sensor_msgs/Imu, or packets of the IMU in an Ouster");
  declareImu(app, options);
  app.add_option("--odometry-topic", options.odometry_topic, "a bag's speed by the wheels");
  app.add_option("--gnss-topic", options.gnss_topic, "a bag's sensor_msgs/NavSatFix");
  declareLidar(app, options);
  declareMounting(app, options);
  app.add_option(
         "--dt", options.dt,
         "seconds between the scans of a folder; default: their own times, else 0.1 (KITTI: "
         "0.1034)")
      ->check(positive());
  declareClouds(app, options);
  declareDeskewed(app, options.deskewed);
  declareVerticalAngles(app, options.vertical_angle_correction);
  app.option_defaults()->group(before);
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
