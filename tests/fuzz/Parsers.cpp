// SPDX-License-Identifier: BSD-3-Clause
#include "Parsers.h"

#include <dyslam/base/Config.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/Frame.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/Kitti360Files.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/KittiTracks.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/MotionFiles.h>
#include <dyslam/formats/PointTimeFiles.h>
#include <dyslam/formats/PositionFile.h>
#include <dyslam/formats/RosMessages.h>
#include <dyslam/formats/RunReport.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/SustechFiles.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/GraphFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/packets/HesaiPackets.h>
#include <dyslam/packets/OusterMetadata.h>
#include <dyslam/packets/PcapSource.h>
#include <dyslam/packets/VelodynePackets.h>

#include <fstream>
#include <map>
#include <stdexcept>

#include "StateFile.h"
#include "SyntheticOuster.h"

namespace dyslam::fuzz
{
namespace
{
void readCloudFile(const std::string& path)
{
  (void)readCloud(path);
}

void readRawlog(const std::string& path)
{
  RawlogSource source(path);
  while (source.next())
  {
  }
  (void)source.warnings();
}

/** Reads all lidars of a rawlog: the lidar of the seeds, and every other one as a further lidar. */
void readRawlogOfLidars(const std::string& path)
{
  RawlogSourceOptions options;
  options.sensor_label = "lidar";
  options.further_lidars = ".*";
  RawlogSource source(path, options);
  while (source.next())
  {
  }
  (void)source.warnings();
}

void readCapture(const std::string& path)
{
  PcapSource source(path);
  while (source.next())
  {
  }
}

/** Reads Ouster packets, with the metadata of the lidar of the seeds. */
void readOusterCapture(const std::string& path)
{
  PcapSourceOptions options;
  options.calibration_file = path + ".json";
  options.imu = true;
  writeWhole(options.calibration_file, SyntheticOuster().metadata(), Durable::no);
  PcapSource source(path, options);
  while (source.next())
  {
    (void)source.takeImu();
  }
}

void readCalibration(const std::string& path)
{
  constexpr std::size_t lasers = 16;
  (void)readVelodyneCalibration(path, lasers);
}

/** Reads an archive with frames and containers, as the state of a run. */
void load(StateArchive archive)
{
  std::vector<Frame> frames;
  std::map<int, std::vector<std::string>> names;
  archive(frames, names);
  archive.requireEnd();
}

void readArchive(const std::string& path)
{
  const std::string bytes = readWhole(path);
  load(StateArchive(bytes));
}

void readState(const std::string& path)
{
  StateFileReader file(path, 2);
  load(file.part(0));
}

/** Reads the topics of a bag through all decoders. */
void readBag(const std::string& path)
{
  constexpr std::size_t most_messages = 2000;
  const auto bag = openBag(path);
  for (std::size_t i = 0; i < bag->topics().size() && i < 5; ++i)
  {
    const BagTopic topic = bag->topics()[i];
    bag->select({i});
    RosScanDecoder decoder;
    BagMessage message;
    for (std::size_t n = 0; n < most_messages && bag->next(message); ++n)
    {
      if (RosScanDecoder::reads(topic))
      {
        (void)decoder.decode(topic, message);
      }
      else if (isRosPose(topic))
      {
        (void)decodeRosPoses(topic, message);
      }
    }
  }
}
}  // namespace

const std::vector<Parser>& parsers()
{
  static const std::vector<Parser> all{
      {"ini", "a.ini", [](const std::string& path) { (void)Config::fromFile(path); }},
      {"bin", "a.bin", readCloudFile},
      {"pcd", "a.pcd", readCloudFile},
      {"ply", "a.ply", readCloudFile},
      {"labels", "a.label", [](const std::string& path) { (void)readLabels(path); }},
      {"point_times", "a.time", [](const std::string& path) { (void)readPointTimes(path, 2); }},
      {"trajectory", "a.txt", [](const std::string& path) { (void)readTrajectory(path); }},
      {"positions", "a.txt",
       [](const std::string& path)
       {
         if (isPositionFile(path))
         {
           (void)readPositions(path);
         }
       }},
      {"times", "a.txt", [](const std::string& path) { (void)readTimesOrTimestamps(path); }},
      {"tracks", "a.txt", [](const std::string& path) { (void)readTracks(path); }},
      {"detections", "a.txt",
       [](const std::string& path) { (void)readDetections(path, Pose::Identity()); }},
      {"kitti_calib", "calib.txt", [](const std::string& path) { (void)readKittiCalib(path); }},
      {"kitti_boxes", "a.txt",
       [](const std::string& path) { (void)readKittiTracking(path, Pose::Identity()); }},
      {"kitti360_poses", "a.txt", [](const std::string& path) { (void)readKitti360Poses(path); }},
      {"oxts", "a.txt", [](const std::string& path) { (void)readOxts(path); }},
      {"motions", "a.csv", [](const std::string& path) { (void)readMotionFile(path); }},
      {"report", "report.json",
       [](const std::string& path) { (void)runReportText(parseRunReport(readWhole(path), path)); }},
      {"sustech", "a.json", [](const std::string& path) { (void)readSustechJson(path, 0); }},
      {"graph", "a.graph", [](const std::string& path) { (void)readPoseGraph(path); }},
      {"g2o", "a.g2o", [](const std::string& path) { (void)readPoseGraph(path); }},
      {"rawlog", "a.rawlog", readRawlog},
      {"rawlog_lidars", "a.rawlog", readRawlogOfLidars},
      {"pcap", "a.pcap", readCapture},
      {"pcapng", "a.pcapng", readCapture},
      {"calibration_yaml", "a.yaml", readCalibration},
      {"calibration_xml", "a.xml", readCalibration},
      {"hesai_angles", "a.csv", [](const std::string& path) { (void)readHesaiAngles(path, 3); }},
      {"ouster_metadata", "a.json",
       [](const std::string& path) { (void)parseOusterMetadata(readWhole(path), path); }},
      {"ouster_pcap", "a.pcap", readOusterCapture},
      {"ros1_bag", "a.bag", readBag},
      {"sqlite_bag", "a.db3", readBag},
      {"mcap_bag", "a.mcap", readBag},
      {"state", "resume.state", readState},
      {"state_archive", "a.state", readArchive},
  };
  return all;
}

const Parser& parserNamed(const std::string& name)
{
  for (const Parser& parser : parsers())
  {
    if (name == parser.name)
    {
      return parser;
    }
  }
  throw std::out_of_range(name + ": no such parser");
}
}  // namespace dyslam::fuzz
