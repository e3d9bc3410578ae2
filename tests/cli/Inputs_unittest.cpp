// SPDX-License-Identifier: BSD-3-Clause
// The table of inputs in doc/formats.md, row by row: the programs read each format, and the same
// drive gives the same scans from every format. ROS bags: BagInputs_unittest.cpp.
#include <dyslam/base/Files.h>
#include <dyslam/core/NeighbourSearch.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogWriter.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "ConvertedDrive.h"
#include "RunProgram.h"
#include "SyntheticCapture.h"
#include "SyntheticOuster.h"

namespace dyslam
{
namespace
{
class Inputs : public test::ConvertedDrive
{
};

std::string oxts(std::size_t i)
{
  return "49.0" + std::to_string(i) +
         " 8.4 110 0 0 1.5707963 0 0 10 1 2 0 0 0 0 0 0 0 0 0 0 0 0 0.05 0 4 10 4 4 0\n";
}

/** A map along poses of the lidar equals the map along the poses of the vehicle. */
TEST_F(Inputs, PosesOfTheLidar)
{
  bins("mounted", counted);
  ASSERT_EQ(0, run("scans2rawlog", "-q -i " + at("mounted") + " --sensor-pose '1 0 2 90 0 0' -o " +
                                       at("mounted.rawlog"))
                   .code);
  std::string vehicle;
  std::string lidar;
  for (std::size_t i = 0; i < test::drive_scans; ++i)
  {
    vehicle += "1 0 0 " + std::to_string(i) + " 0 1 0 0 0 0 1 0\n";
    lidar += "0 -1 0 " + std::to_string(i + 1) + " 1 0 0 0 0 0 1 2\n";
  }
  write("vehicle.txt", vehicle);
  write("lidar.txt", lidar);
  // Without visibility checks: rounding could decide them where a sensor lies on the edge of a
  // cell.
  const std::string unchecked = " --set map.visibility=false --set labels.hindsight=false -o ";
  const auto map = [&](const std::string& poses, const std::string& flags)
  {
    const Outcome outcome =
        run("dyslam-map", "-q -i " + at("mounted.rawlog") + " --trajectory " + at(poses) + flags +
                              unchecked + at("poses_of.pcd"));
    EXPECT_EQ(0, outcome.code) << outcome.err;
    return readCloud(at("poses_of.pcd")).points;
  };
  const auto expected = map("vehicle.txt", "");
  const auto of_lidar = map("lidar.txt", " --poses-of lidar");
  const auto mistaken = map("lidar.txt", "");
  ASSERT_GT(expected.size(), 1000U);
  // The poses differ by rounding: a point at the border of two voxels may fall into either.
  const auto different = [&](const std::vector<Eigen::Vector3f>& points)
  {
    const KdTree tree(points);
    Neighbour found;
    return std::count_if(expected.begin(), expected.end(),
                         [&](const Eigen::Vector3f& p) { return !tree.nearest(p, found, 1e-5F); });
  };
  const auto few = static_cast<std::ptrdiff_t>(expected.size() / 200);
  EXPECT_NEAR(static_cast<double>(expected.size()), static_cast<double>(of_lidar.size()), 3);
  EXPECT_LE(different(of_lidar), few);
  EXPECT_GT(different(mistaken), static_cast<std::ptrdiff_t>(expected.size() / 2));

  const auto entropies = [&](const std::string& bodies)
  {
    const Outcome outcome =
        run("dyslam-eval", "map --self " + at("mounted.rawlog") + " --estimate " +
                               at("vehicle.txt") + " " + at("lidar.txt") + " --poses-of " + bodies +
                               " --csv " + at("self.csv"));
    EXPECT_EQ(0, outcome.code) << outcome.err;
    std::vector<double> result;
    std::istringstream rows(readWhole(at("self.csv")));
    std::string row;
    std::getline(rows, row);
    while (std::getline(rows, row))
    {
      for (int comma = 0; comma < 3; ++comma)
      {
        row.erase(0, row.find(',') + 1);
      }
      result.push_back(std::stod(row));
    }
    EXPECT_EQ(2U, result.size());
    result.resize(2);
    return result;
  };
  const auto sharp = entropies("vehicle lidar");
  EXPECT_NEAR(sharp[0], sharp[1], 0.001);
  const auto one_is_wrong = entropies("vehicle");
  EXPECT_GT(std::abs(one_is_wrong[0] - one_is_wrong[1]), 0.003);
}

TEST_F(Inputs, FoldersOfScans)
{
  bins("counted", counted);
  expectOriginal(converted(
      "scans2rawlog", "-i " + at("counted"),
      {"not taken as time stamps", "0.1 s between scans is assumed", "points have no times"}));
  bins("named", [](std::size_t i) { return "160000000" + std::to_string(i) + "250000000"; });
  const auto named =
      converted("scans2rawlog", "-i " + at("named"), {"time stamps: the file names"});
  expectOriginal(named);
  EXPECT_NEAR(1600000003.25, named.at(3).scan.stamp, 1e-6);
  for (const std::string ending : {".pcd", ".ply"})
  {
    bins("clouds" + ending, counted, ending);
    write("given/times.txt", "1\n1.5\n2\n2.5\n3\n3.5\n");
    const auto frames =
        converted("scans2rawlog", "-i " + at("clouds" + ending) + " --times " +
                                      at("given/times.txt") + " --sensor-pose '0 0 1.7 0 0 0'");
    expectOriginal(frames);
    EXPECT_NEAR(2.5, frames.at(3).scan.stamp, 1e-6);
    EXPECT_NEAR(1.7, frames[3].scan.T_vehicle_lidar.translation().z(), 1e-9);
  }
}

TEST_F(Inputs, RingsTimesAndPosesOfFolders)
{
  bins("ringed", counted);
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < test::drive_scans; ++i)
  {
    std::string rings;
    for (const std::uint16_t ring : scans_[i].ring)
    {
      rings += static_cast<char>(ring);
    }
    write("ringed/" + counted(i) + ".ring", rings);
  }
  Trajectory truth;
  for (std::size_t i = 0; i < test::drive_scans; ++i)
  {
    truth.push_back(static_cast<double>(i), poses_[i]);
  }
  writeKittiPoses(at("truth.txt"), truth);
  const auto frames =
      converted("scans2rawlog", "-i " + at("ringed") + " --poses " + at("truth.txt"));
  expectOriginal(frames);
  EXPECT_EQ(scans_[2].ring, frames.at(2).scan.ring);
  EXPECT_TRUE(frames[5].T_world_vehicle_truth->isApprox(poses_[5], 1e-6));

  const std::string header =
      "VERSION 0.7\nFIELDS x y z intensity time ring\nSIZE 4 4 4 4 4 2\nTYPE F F F F F U\n"
      "COUNT 1 1 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n";
  write("timed/0.pcd", header + "5 0 0 0.5 0.01 3\n0 5 0 0.25 0.05 7\n");
  write("timed/1.pcd", header + "5 0 1 0.5 0.02 4\n0 5 0 0.25 0.06 7\n");
  const auto timed = converted("scans2rawlog", "-i " + at("timed"));
  ASSERT_EQ(2U, timed.size());
  EXPECT_EQ((std::vector<float>{0.02F, 0.06F}), timed[1].scan.time);
  EXPECT_EQ((std::vector<std::uint16_t>{4, 7}), timed[1].scan.ring);
}

/** The packets of a capture in the format pcapng. */
std::string asPcapng(const std::string& pcap)
{
  std::string file;
  const auto block = [&file](std::uint32_t kind, std::string body)
  {
    body.resize((body.size() + 3) / 4 * 4);
    const auto length = static_cast<std::uint32_t>(body.size() + 12);
    appendBytes(file, kind);
    appendBytes(file, length);
    file += body;
    appendBytes(file, length);
  };
  std::string section;
  appendBytes<std::uint32_t>(section, 0x1A2B3C4D);
  appendBytes<std::uint32_t>(section, 1);  // version 1.0
  section += std::string(8, '\xFF');
  block(0x0A0D0D0A, section);
  std::string interface;
  appendBytes<std::uint32_t>(interface, 1);  // Ethernet
  appendBytes<std::uint32_t>(interface, 65535);
  block(1, interface);
  constexpr std::size_t header = 24;
  std::array<std::uint32_t, 4> record{};
  for (std::size_t at = header; at < pcap.size(); at += sizeof record + record[2])
  {
    std::memcpy(record.data(), &pcap[at], sizeof record);
    const std::uint64_t microseconds = record[0] * std::uint64_t{1000000} + record[1];
    std::string packet(4, '\0');
    appendBytes(packet, static_cast<std::uint32_t>(microseconds >> 32U));
    appendBytes(packet, static_cast<std::uint32_t>(microseconds));
    appendBytes(packet, record[2]);
    appendBytes(packet, record[3]);
    block(6, packet + pcap.substr(at + sizeof record, record[2]));
  }
  return file;
}

TEST_F(Inputs, VelodyneCaptures)
{
  write("drive.pcap", captured(400));
  write("drive.pcapng", asPcapng(captured(400)));
  const auto frames = converted("scans2rawlog", "-i " + at("drive.pcap"));
  ASSERT_GE(frames.size(), 3U);
  EXPECT_NEAR(0.1, frames[1].scan.stamp - frames[0].scan.stamp, 0.002);
  EXPECT_EQ(frames[0].scan.size(), frames[0].scan.time.size());
  EXPECT_EQ(frames[0].scan.size(), frames[0].scan.ring.size());
  const std::string bytes = contentOf(at("out.rawlog"));
  (void)converted("scans2rawlog", "-i " + at("drive.pcapng"));
  EXPECT_EQ(bytes, contentOf(at("out.rawlog")));
}

TEST_F(Inputs, OusterCaptures)
{
  const SyntheticOuster lidar;
  write("drive.pcap", lidar.capture(lidar.packetsOf(4), 512));
  const Outcome without =
      run("scans2rawlog", "-i " + at("drive.pcap") + " -o " + at("none.rawlog"));
  EXPECT_EQ(1, without.code);
  EXPECT_NE(without.err.find("--calibration"), std::string::npos) << without.err;
  write("drive.json", lidar.metadata(true));
  const auto frames = converted("scans2rawlog", "-i " + at("drive.pcap"), {"drive.json"});
  ASSERT_EQ(4U, frames.size());
  EXPECT_NEAR(0.1, frames[1].scan.stamp - frames[0].scan.stamp, 1e-6);
  EXPECT_EQ(frames[0].scan.size(), frames[0].scan.time.size());
  EXPECT_EQ(frames[0].scan.size(), frames[0].scan.ring.size());
}

TEST_F(Inputs, KittiRaw)
{
  const std::string drive = "2011_09_26/2011_09_26_drive_0001_sync";
  bins(drive + "/velodyne_points/data", counted);
  std::string stamps;
  for (std::size_t i = 0; i < test::drive_scans; ++i)
  {
    stamps += "2011-09-26 13:02:2" + std::to_string(i) + ".5\n";
    write(drive + "/oxts/data/" + counted(i) + ".txt", oxts(i));
  }
  write(drive + "/velodyne_points/timestamps.txt", stamps);
  const auto without = converted("kitti2rawlog", "--kind raw -i " + at(drive),
                                 {"converted without true poses", "calib_imu_to_velo.txt"});
  expectOriginal(without);
  EXPECT_FALSE(without.at(0).T_world_vehicle_truth);
  write("2011_09_26/calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n");
  EXPECT_TRUE(converted("kitti2rawlog", "--kind raw -i " + at(drive)).at(0).T_world_vehicle_truth);
  const Outcome wrong =
      run("kitti2rawlog", "--kind odometry --force -i " + at(drive) + " -o " + at("out.rawlog"));
  EXPECT_EQ(1, wrong.code);
  EXPECT_NE(wrong.err.find("use --kind raw"), std::string::npos) << wrong.err;
}

TEST_F(Inputs, KittiTracking)
{
  bins("tracking/training/velodyne/0003", counted);
  write("tracking/training/label_02/0003.txt", "0 5 Car 0 0 0 1 2 3 4 1.5 1.8 4 0 1 20 -1.57\n");
  write("tracking/training/calib/0003.txt",
        "R_rect 1 0 0 0 1 0 0 0 1\nTr_velo_cam 0 -1 0 0 0 0 -1 0 1 0 0 0\n"
        "Tr_imu_velo 1 0 0 0 0 1 0 0 0 0 1 0\n");
  expectOriginal(converted("kitti2rawlog", "--kind tracking -i " + at("tracking/training"),
                           {"0.1034 s between scans is assumed"}));
  EXPECT_FALSE(contentOf(at("out.gt/tracks.txt")).empty());
  (void)converted("kitti2rawlog", "--no-truth --kind tracking -i " + at("tracking/training"));
  EXPECT_TRUE(contentOf(at("out.gt/tracks.txt")).empty());
}

TEST_F(Inputs, ARawlogAsKittiAndBack)
{
  {
    RawlogWriter writer(at("truth.rawlog"));
    for (std::size_t i = 0; i < test::drive_scans; ++i)
    {
      writer.write(scans_[i], poses_[i]);
    }
    writer.close();
  }
  const Outcome there = run("rawlog2kitti", "-i " + at("truth.rawlog") + " -o " + at("kitti"));
  EXPECT_EQ(0, there.code) << there.err;
  EXPECT_NE(there.out.find("sequences/00: 6 scans"), std::string::npos) << there.out;
  EXPECT_NE(there.out.find("; truth: 6 poses (from the rawlog)"), std::string::npos) << there.out;
  const std::string estimate = at("kitti/poses/00.txt");
  const Outcome estimated =
      run("rawlog2kitti", "--no-scans --sequence 01 --trajectory " + estimate + " -i " +
                              at("truth.rawlog") + " -o " + at("kitti"));
  EXPECT_NE(estimated.out.find("; 6 poses (from " + estimate + ")"), std::string::npos)
      << estimated.out << estimated.err;
  const auto frames = converted("kitti2rawlog", "--kind odometry -i " + at("kitti/sequences/00"),
                                {"dyslam deskews them"});
  expectOriginal(frames);
  EXPECT_TRUE(frames.at(5).T_world_vehicle_truth->isApprox(poses_[0].inverse() * poses_[5], 1e-6));

  const Outcome merged = run("rawlog2kitti", "--further-lidars none --sequence 02 -i " +
                                                 at("truth.rawlog") + " -o " + at("kitti"));
  EXPECT_EQ(0, merged.code) << merged.err;
  EXPECT_NE(merged.err.find("no further lidar has a label like 'none'"), std::string::npos)
      << merged.err;

  const std::vector<Label> labels(scans_[1].size(), 252);
  makeFolder("kitti/sequences/00/labels");
  writeLabels(at("kitti/sequences/00/labels/000001.label"), labels);
  (void)converted("kitti2rawlog", "--kind odometry -i " + at("kitti/sequences/00"));
  EXPECT_EQ(labels.size(), readLabels(at("out.gt/labels/000001.label")).size());

  // KITTI's poses are those of a camera: next to poses of a lidar they are converted, unless a flag
  // says otherwise.
  Trajectory lidar;
  for (int i = 0; i < 40; ++i)
  {
    lidar.push_back(i, poseFromYpr(2.0 * i, 0, 0, 0, 0, 0));
  }
  writeKittiPoses(at("lidar.txt"), lidar);
  std::vector<Pose> camera;
  for (const StampedPose& pose : lidar)
  {
    camera.push_back(pose.pose);
  }
  writeKittiPoses(at("camera.txt"), posesOfMountedSensor(camera, cameraAxes().inverse()));
  const std::string files =
      "trajectory --lengths 10 --reference " + at("camera.txt") + " --estimate " + at("lidar.txt");
  const Outcome converted_poses = run("dyslam-eval", files + " --csv " + at("e.csv"));
  EXPECT_NE(converted_poses.err.find("camera.txt: has the poses of a camera"), std::string::npos)
      << converted_poses.err;
  EXPECT_NE(contentOf(at("e.csv")).find("\nlidar,40,78,0,0,"), std::string::npos)
      << contentOf(at("e.csv"));
  const Outcome noticed = run("dyslam-eval", files + " --camera none");
  EXPECT_NE(noticed.err.find("axes of a camera"), std::string::npos) << noticed.err;
  EXPECT_NE(noticed.err.find("--camera reference"), std::string::npos) << noticed.err;
  const Outcome compared = run("dyslam-eval", files + " --camera reference --json " + at("e.json"));
  EXPECT_EQ(0, compared.code);
  EXPECT_EQ(converted_poses.err, compared.err) << "the same note";
}

/** The folder of a run that has converted a sequence of KITTI: its poses for the server. */
TEST_F(Inputs, ARunAsKitti)
{
  bins("dataset/sequences/07/velodyne", counted);
  std::string times;
  Trajectory poses;
  for (std::size_t i = 0; i < test::drive_scans; ++i)
  {
    times += std::to_string(i) + "\n";
    poses.push_back(static_cast<double>(i), poses_[i]);
  }
  write("dataset/sequences/07/times.txt", times);
  write("dataset/sequences/07/calib.txt", "Tr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n");
  makeFolder("out/07");
  ASSERT_EQ(0, run("kitti2rawlog", "-q --kind odometry -i " + at("dataset/sequences/07") + " -o " +
                                       at("out/07/recording.rawlog"))
                   .code);
  write("out/07/recording.ini", "[recording]\ninput = " + at("dataset/sequences/07") + "\n");
  write("out/07/report.json",
        "{\"finished\": true, \"input\": \"" + at("out/07/recording.rawlog") + "\"}");
  writeTum(at("out/07/trajectory_tum.txt"), poses);
  const std::string flags = "-q --run " + at("out/07") + " --sequence 07 -o " + at("submission");
  const Outcome first = run("rawlog2kitti", flags + " --poses-only");
  EXPECT_EQ(0, first.code) << first.err;
  EXPECT_EQ("", first.err);
  EXPECT_NE(first.out.find("poses/07.txt: 6 scans"), std::string::npos) << first.out;
  EXPECT_FALSE(std::filesystem::exists(at("submission/sequences")));
  const std::string alone = contentOf(at("submission/poses/07.txt"));
  const Outcome again = run("rawlog2kitti", flags);
  EXPECT_EQ(1, again.code);
  EXPECT_NE(again.err.find("poses/07.txt: is there already; replace it with --force"),
            std::string::npos)
      << again.err;
  EXPECT_EQ(0, run("rawlog2kitti", flags + " --force").code);
  EXPECT_EQ(alone, contentOf(at("submission/poses/07.txt")));
  EXPECT_EQ(contentOf(at("dataset/sequences/07/calib.txt")),
            contentOf(at("submission/sequences/07/calib.txt")));
  const Outcome neither = run("rawlog2kitti", "-o " + at("submission"));
  EXPECT_NE(neither.err.find("--input or --run is required"), std::string::npos) << neither.err;
}

TEST_F(Inputs, OutputsAreCheckedBeforeTheWork)
{
  bins("counted", counted);
  makeFolder("taken.rawlog");
  const Outcome outcome = run("scans2rawlog", "-i " + at("counted") + " -o " + at("taken.rawlog"));
  EXPECT_EQ(1, outcome.code);
  EXPECT_NE(outcome.err.find("taken.rawlog: is a folder"), std::string::npos) << outcome.err;
}
}  // namespace
}  // namespace dyslam
