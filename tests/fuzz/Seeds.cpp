// SPDX-License-Identifier: BSD-3-Clause
// fuzz_seeds <folder>: writes small valid files for every parser to <folder>/<parser>/.
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/Frame.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/io/RawlogWriter.h>
#include <mrpt/maps/CColouredPointsMap.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CObservationRotatingScan.h>
#include <mrpt/obs/CObservationVelodyneScan.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>

#include "BagWriters.h"
#include "MrptBytes.h"
#include "RosMessageWriters.h"
#include "StateFile.h"
#include "SyntheticCapture.h"
#include "SyntheticHesai.h"
#include "SyntheticOuster.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
using test::bytesOf;

void write(const fs::path& path, const std::string& content)
{
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << content;
}

Scan someScan()
{
  Scan scan;
  scan.stamp = 1000;
  scan.sensor_label = "lidar";
  for (int i = 0; i < 6; ++i)
  {
    const auto f = static_cast<float>(i);
    scan.points.emplace_back(1 + f, 2 - f, 0.5F);
    scan.intensity.push_back(0.1F * f);
    scan.time.push_back(0.01F * f);
    scan.ring.push_back(static_cast<std::uint16_t>(i % 2));
  }
  return scan;
}

template <typename Observation>
std::string stamped(Observation observation)
{
  observation.sensorLabel = "lidar";
  observation.timestamp = mrpt::Clock::fromDouble(1000);
  return bytesOf(observation);
}

void writeRawlogs(const fs::path& folder)
{
  using namespace mrpt::obs;
  CObservationPointCloud cloud;
  auto coloured = mrpt::maps::CColouredPointsMap::Create();
  coloured->insertPoint(1, 2, 3);
  cloud.pointcloud = coloured;
  write(folder / "coloured", stamped(cloud));
  auto xyzi = mrpt::maps::CPointsMapXYZI::Create();
  xyzi->insertPoint(1, 2, 3);
  cloud.pointcloud = xyzi;
  auto later = cloud;
  later.timestamp = mrpt::Clock::fromDouble(1001);
  later.sensorLabel = "lidar";
  write(folder / "clouds", stamped(CObservationRobotPose()) + stamped(cloud) + bytesOf(later));
  CSensoryFrame frame;
  frame.insert(CObservationIMU::Create());
  frame.insert(std::make_shared<CObservationPointCloud>(later));
  write(folder / "frame", bytesOf(frame) + bytesOf(CObservationIMU()));
  CObservationIMU imu;
  imu.set(IMU_WX, 0.1);
  imu.set(IMU_WY, 0.2);
  imu.set(IMU_WZ, 0.3);
  CObservationOdometry wheels;
  wheels.hasEncodersInfo = wheels.hasVelocities = true;
  write(folder / "motion", stamped(imu) + stamped(wheels) + stamped(cloud) +
                               stamped(CObservationOdometry()) + bytesOf(later));
  CObservationRotatingScan rotating;
  rotating.rowCount = 16;
  rotating.columnCount = 2;
  rotating.rangeResolution = 0.002;
  rotating.rangeImage.resize(16, 2);
  rotating.rangeImage.fill(5000);
  write(folder / "rotating", stamped(rotating));
  CObservationVelodyneScan velodyne;
  velodyne.point_cloud.x = velodyne.point_cloud.y = velodyne.point_cloud.z = {1, 2};
  velodyne.point_cloud.intensity = {1, 2};
  write(folder / "velodyne", stamped(velodyne));
  velodyne.scan_packets.resize(1);
  velodyne.calibration = VelodyneCalibration::LoadDefaultCalibration("VLP16");
  write(folder / "packet", stamped(velodyne));
  CObservation3DRangeScan range;
  range.hasRangeImage = true;
  range.rangeImage_setSize(2, 3);
  range.rangeImage.fill(3000);
  range.cameraParams.ncols = 3;
  range.cameraParams.nrows = 2;
  range.hasIntensityImage = true;
  range.intensityImage.resize(3, 2, mrpt::img::CH_GRAY);
  write(folder / "range", stamped(range));
}

void writeRawlogOfLidars(const std::string& path)
{
  RawlogWriter writer(path);
  for (int i = 0; i < 3; ++i)
  {
    Scan scan = someScan();
    scan.stamp += 0.1 * i;
    writer.write(scan);
    for (const char* label : {"rear", "left"})
    {
      scan.stamp += 0.02;
      scan.sensor_label = label;
      scan.T_vehicle_lidar.translation().x() += 1;
      writer.write(scan);
    }
  }
  writer.close();
}

void writeClouds(const fs::path& folder)
{
  const Scan scan = someScan();
  for (const char* kind : {"bin", "pcd", "ply"})
  {
    fs::create_directories(folder / kind);
    writeCloud((folder / kind / (std::string("a.") + kind)).string(), scan.points, scan.intensity);
  }
  write(
      folder / "pcd/ascii",
      "VERSION 0.7\nFIELDS x y z ring t _\nSIZE 4 4 4 2 8 1\nTYPE F F F U U U\nCOUNT 1 1 1 1 1 2\n"
      "WIDTH 1\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\nDATA ascii\n1 2 3 4 5 6 7\n");
  write(folder / "pcd/compressed",
        "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\n"
        "DATA binary_compressed\n" +
            std::string("\x06\0\0\0\x0c\0\0\0\x01\0\0\xE0\x01\0", 14));
  write(folder / "ply/ascii",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int near\nproperty float x\n"
        "property float y\nproperty float z\nproperty uchar ring\nproperty uint t\nelement face 1\n"
        "property list uchar int i\nend_header\n1 9 1 2 3 4 5\n1 0\n");
}

void writeTexts(const fs::path& folder)
{
  const std::string box = " Car 0 0 -1.5 1 2 3 4 1.5 1.6 4.2 10 1 20 0.1";
  const std::map<std::string, std::string> texts{
      {"ini/a", "[input]\nsensor_label = a ; text\n[refine]\nmethod = none\nvoxel = 0.5\n"},
      {"labels/a", std::string("\x09\0\0\0\xfb\0\x02\0", 8)},
      {"point_times/a", std::string("\0\0\0\0\0\0\x80\x3f", 8)},
      {"trajectory/tum", "# t x\n1 0 0 0 0 0 0 1\n2 1 2 3 0 0 0.6 0.8\n"},
      {"trajectory/kitti", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 5 0 1 0 6 0 0 1 7\n"},
      {"positions/lines", "# prism\n1 2 3 4\n2 nan 3 4\n"},
      {"positions/rtklib",
       "% ref pos : 1 2 3\n%  UTC   latitude(d'\")  longitude(d'\")  height(m)   Q\n"
       "2024/05/18 00:00:01.5 52 10 0.5 -0 30 0.25 110 1\n2314 518402 52 10 1 0 30 1 110 2\n"},
      {"positions/table", "time [ns], \"lat\" (deg), lon, height, Q\n1, 49, 8, 110, 4\n2,,,,0\n"},
      {"times/seconds", "0\n0.1\n0.2\n"},
      {"times/kitti", "2011-09-26 13:02:25.964389445\n2011-09-26 13:02:26.068369100\n"},
      {"tracks/a", "0 1 Car 0 0 -10 0 0 0 0 1.5 1.6 4.2 1 2 3 0.5 0.9\n"},
      {"detections/kitti", "0 -1" + box + " 0.9\n1 -1" + box + " 0.8\n"},
      {"detections/csv", "0,2,1,2,3,4,9.1,1.5,1.6,4.2,10,1,20,0.1,-1.5\n"},
      {"kitti_boxes/a", "0 1" + box + "\n1 1" + box + "\n"},
      {"kitti_calib/a",
       "P0: 1 0 0 0 0 1 0 0 0 0 1 0\nP2: 1 0 0 0 0 1 0 0 0 0 1 0\nR0_rect: 1 0 0 0 1 0 0 0 1\n"
       "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n"},
      {"kitti360_poses/imu", "1 1 0 0 5 0 1 0 6 0 0 1 7\n4 1 0 0 8 0 1 0 9 0 0 1 7\n"},
      {"kitti360_poses/camera", "1 0 0 1 5 -1 0 0 6 0 -1 0 7 0 0 0 1\n"},
      {"oxts/a",
       "49.01 8.43 116.4 0.03 0.01 -0.93 -2.7 -6.8 7.4 0.1 -0.1 1.2 -0.2 9.7 1.1 -0.3 9.8 0.01 "
       "0.02 "
       "0.03 0.01 0.02 0.03 0.1 0.1 4 6 6 6 6\n"},
      {"report/a",
       R"({"input":"/a/b.rawlog","ground_truth":{"source":"gnss_ins","name":"oxts"},)"
       R"("finished":false,"frames":3,"gnss":{"positions":2,"vertical_rmse_m":0.5,"fused":true},)"
       R"("gravity":{"directions":7,"map_tilt_deg":1,"map_tilt_sigma_deg":0.5,)"
       R"("up_map":[0.6,0,0.8],"fused":false},"prior_map":{"localised":true,"rmse_m":0.1},)"
       R"("ms_per_scan":null,"stage_ms":{"dyseg":3.5},"warnings":["w"],"files":["map.png"]})"},
      {"sustech/a", R"([{"obj_id":"1","obj_type":"Car","psr":{"position":{"x":1,"y":2,"z":3},)"
                    R"("rotation":{"x":0,"y":0,"z":0.5},"scale":{"x":4,"y":2,"z":1.5}}}])"},
      {"graph/a",
       "VERTEX3 0 0 0 0 0 0 0\nVERTEX3 1 1 0 0 0 0 0\n"
       "EDGE3 0 1 1 0 0 0 0 0 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n"},
      {"g2o/a",
       "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 0 0 0 0 0 1\nFIX 0\n"
       "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n"},
      {"calibration_xml/a",
       "<?xml version=\"1.0\"?><!DOCTYPE boost_serialization>"
       "<boost_serialization><DB><item_version>0</item_version></DB>"
       "</boost_serialization>"}};
  for (const auto& [name, text] : texts)
  {
    write(folder / name, text);
  }
  std::string yaml = "lasers:\n";
  for (int i = 0; i < 16; ++i)
  {
    yaml += "- {laser_id: " + std::to_string(i) + ", vert_correction: -0.1}\n";
  }
  write(folder / "calibration_yaml/a", yaml);
  std::string motions = "stamp,keyframe";
  std::string row = "1.5,1";
  for (const char kind : {'c', 'n'})
  {
    for (int i = 0; i < 6; ++i)
    {
      for (int j = i; j < 6; ++j)
      {
        motions += std::string(",") + kind + std::to_string(i) + std::to_string(j);
        row += i == j ? ",0.1" : ",0";
      }
    }
  }
  write(folder / "motions/a", motions + "\n" + row + "\n");
}

void writeBags(const fs::path& folder)
{
  for (const char* name : {"ros1_bag/a.bag", "sqlite_bag/a.db3", "mcap_bag/a.mcap"})
  {
    const std::string path = (folder / name).string();
    fs::create_directories(fs::path(path).parent_path());
    const bool cdr = test::holdsCdr(path);
    const Scan scan = someScan();
    const std::vector<test::TestMessage> messages{
        {"/points", "sensor_msgs/PointCloud2", 1000,
         test::pointCloud2(cdr, 1000, test::velodyneFields(scan))},
        {"/livox", "livox_ros_driver2/CustomMsg", 1000, test::livoxMessage(cdr, scan)},
        {"/odom", "nav_msgs/Odometry", 1000, test::odometry(cdr, 1000, Pose::Identity())},
        {"/tf", "tf2_msgs/TFMessage", 1000,
         test::transforms(cdr, 1000, {{"a", Pose::Identity()}})}};
    test::writeBag(path, messages);
  }
}

void writeStates(const fs::path& folder)
{
  std::vector<Frame> frames(2);
  frames[1].scan = someScan();
  frames[1].cloud.points = frames[1].scan.points;
  frames[1].moving = {true, false, true};
  frames[1].objects.resize(1);
  std::map<int, std::vector<std::string>> names{{1, {"a", "b"}}, {2, {}}};
  StateArchive archive;
  archive(frames, names);
  write(folder / "state_archive/a", archive.bytes());
  fs::create_directories(folder / "state");
  StateFileWriter file((folder / "state/a").string());
  file.add(archive.bytes());
  file.add("second");
  file.commit();
}
}  // namespace
}  // namespace dyslam

int main(int argc, char** argv)
{
  if (argc != 2 || argv[1][0] == '-')
  {
    std::fprintf(stderr, "fuzz_seeds <folder>\n");
    return 1;
  }
  const fs::path folder = argv[1];
  dyslam::writeRawlogs(folder / "rawlog");
  fs::create_directories(folder / "rawlog_lidars");
  dyslam::writeRawlogOfLidars((folder / "rawlog_lidars/three.rawlog").string());
  dyslam::writeClouds(folder);
  dyslam::writeTexts(folder);
  dyslam::writeBags(folder);
  dyslam::writeStates(folder);
  const std::string capture = dyslam::captured(110);
  dyslam::write(folder / "pcap/a", capture);
  std::string over_ipv6 = dyslam::captureHeader();
  for (int n = 0; n < 110; ++n)
  {
    constexpr char udp = 17;
    const double time = n * 12 * 2 * 55.296e-6;
    const std::string datagram = dyslam::udpDatagram(dyslam::velodynePacket(time), 2368);
    dyslam::appendFrame(over_ipv6, 1000 + time, dyslam::ip6Frame(datagram, udp));
  }
  dyslam::write(folder / "pcap/ipv6", over_ipv6);
  // A pcapng of one section and one interface, with a block for the first packet.
  std::string ng("\x0A\x0D\x0D\x0A\x1C\0\0\0\x4D\x3C\x2B\x1A\x01\0\0\0", 16);
  ng += std::string(8, '\xFF') + std::string("\x1C\0\0\0", 4);
  ng += std::string("\x01\0\0\0\x14\0\0\0\x01\0\0\0\0\0\x04\0\x14\0\0\0", 20);
  const std::string packet = capture.substr(24 + 16, 42 + 1206);
  for (std::size_t at = 24; at + 16 + packet.size() <= capture.size(); at += 16 + packet.size())
  {
    ng += std::string("\x06\0\0\0\0\x05\0\0\0\0\0\0\0\0\0\0\0\0\0\0", 20);
    ng += std::string("\xE0\x04\0\0\xE0\x04\0\0", 8) + capture.substr(at + 16, packet.size());
    ng += std::string("\0\x05\0\0", 4);
  }
  dyslam::write(folder / "pcapng/a", ng);
  dyslam::write(folder / "hesai_angles/a", "Channel,Elevation,Azimuth\n1,15,0.1\n2,13,0\n3,-1,0\n");
  dyslam::SyntheticHesai hesai;
  dyslam::write(folder / "pcap/hesai_xt", dyslam::capturedHesai(hesai, 0.01));
  hesai.kind = dyslam::HesaiKind::pandar40;
  hesai.dual = true;
  dyslam::write(folder / "pcap/hesai_40", dyslam::capturedHesai(hesai, 0.01));
  const dyslam::SyntheticOuster ouster;
  dyslam::write(folder / "ouster_metadata/a", ouster.metadata());
  dyslam::write(folder / "ouster_metadata/b", ouster.metadata(true));
  dyslam::write(folder / "ouster_pcap/a", ouster.capture(ouster.packetsOf(3), 512));
  auto with_imu = ouster.packetsOf(1);
  with_imu.push_back(dyslam::SyntheticOuster::imuPacket(ouster.first_time));
  with_imu.push_back(ouster.newImuPacket(ouster.first_time));
  dyslam::write(folder / "ouster_pcap/imu", ouster.capture(with_imu));
  return 0;
}
