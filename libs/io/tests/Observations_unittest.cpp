// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/io/GzOutput.h>
#include <dyslam/io/RawlogSource.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/maps/CColouredPointsMap.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CObservationVelodyneScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
using namespace mrpt::obs;

/** A rawlog written object by object, as other programs would. */
class ObjectWriter
{
 public:
  explicit ObjectWriter(const std::string& path) : file_(path) {}
  void operator()(const mrpt::serialization::CSerializable& object)
  {
    auto archive = mrpt::serialization::archiveFrom(file_);
    archive << object;
  }

 private:
  mrpt::io::CFileGZOutputStream file_;
};

CObservationPointCloud::Ptr cloud(double stamp, float x)
{
  auto observation = CObservationPointCloud::Create();
  observation->timestamp = mrpt::Clock::fromDouble(stamp);
  observation->sensorLabel = "lidar";
  auto map = mrpt::maps::CSimplePointsMap::Create();
  map->insertPoint(x, 2, 3);
  observation->pointcloud = map;
  return observation;
}

CObservationRobotPose truth(double stamp, double x, const std::string& label = "ground_truth")
{
  CObservationRobotPose observation;
  observation.timestamp = mrpt::Clock::fromDouble(stamp);
  observation.sensorLabel = label;
  observation.pose.mean.x(x);
  return observation;
}
}  // namespace

TEST(RawlogSource, ReadsActionsAndSensoryFrames)
{
  const TestFolder folder;
  {
    ObjectWriter write(folder.file("a.rawlog"));
    for (int i = 0; i < 3; ++i)
    {
      write(CActionCollection());
      CSensoryFrame frame;
      frame.insert(std::make_shared<CObservationRobotPose>(truth(10.0 + i, i)));
      frame.insert(cloud(10.0 + i, static_cast<float>(i)));
      write(frame);
    }
  }
  RawlogSource source(folder.file("a.rawlog"));
  for (int i = 0; i < 3; ++i)
  {
    const auto frame = source.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(static_cast<float>(i), frame->scan.points.at(0).x());
    ASSERT_TRUE(frame->T_world_vehicle_truth);
    EXPECT_EQ(i, frame->T_world_vehicle_truth->translation().x());
  }
  EXPECT_FALSE(source.next());
}

TEST(RawlogSource, InterpolatesTruthOfOtherTimes)
{
  const TestFolder folder;
  {
    ObjectWriter write(folder.file("a.rawlog"));
    write(truth(10.0, 0));
    write(*cloud(10.05, 0));
    write(truth(10.1, 1));
    write(truth(10.12, 77, "wheels"));
    write(*cloud(10.16, 1));
    write(truth(10.2, 2));
    write(*cloud(10.5, 2));  // too far from both neighbours
    write(truth(11.0, 10));
    write(*cloud(11.0, 3));
    write(*cloud(12.0, 4));  // after the last
  }
  RawlogSource source(folder.file("a.rawlog"));
  const auto x = [](const std::optional<Frame>& frame)
  { return frame->T_world_vehicle_truth.value().translation().x(); };
  EXPECT_NEAR(0.5, x(source.next()), 1e-5);
  EXPECT_NEAR(1.6, x(source.next()), 1e-5);
  EXPECT_FALSE(source.next()->T_world_vehicle_truth);
  EXPECT_NEAR(10.0, x(source.next()), 1e-9);
  EXPECT_FALSE(source.next()->T_world_vehicle_truth);

  RawlogSourceOptions options;
  options.ground_truth_label = "";
  EXPECT_FALSE(RawlogSource(folder.file("a.rawlog"), options).next()->T_world_vehicle_truth);
}

TEST(RawlogSource, ReadsColouredClouds)
{
  const TestFolder folder;
  {
    auto observation = cloud(1.0, 0);
    auto map = mrpt::maps::CColouredPointsMap::Create();
    map->insertPointRGB(1, 2, 3, 0.3F, 0.6F, 0.9F);
    observation->pointcloud = map;
    ObjectWriter(folder.file("a.rawlog"))(*observation);
  }
  const auto frame = RawlogSource(folder.file("a.rawlog")).next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(Eigen::Vector3f(1, 2, 3), frame->scan.points.at(0));
  EXPECT_NEAR(0.6F, frame->scan.intensity.at(0), 1e-3F);
}

TEST(RawlogSource, ReadsRangeImages)
{
  const TestFolder folder;
  {
    CObservation3DRangeScan observation;
    observation.timestamp = mrpt::Clock::fromDouble(5.0);
    observation.sensorLabel = "camera";
    observation.sensorPose.z(1.5);
    observation.hasRangeImage = true;
    observation.rangeUnits = 0.001F;
    observation.rangeImage_setSize(4, 6);
    observation.rangeImage.fill(2000);
    observation.rangeImage(0, 0) = 0;  // no return
    observation.range_is_depth = true;
    observation.cameraParams.ncols = 6;
    observation.cameraParams.nrows = 4;
    observation.cameraParams.setIntrinsicParamsFromValues(5, 5, 3, 2);
    ObjectWriter(folder.file("a.rawlog"))(observation);
  }
  const auto frame = RawlogSource(folder.file("a.rawlog")).next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(1.5, frame->scan.T_vehicle_lidar.translation().z());
  const auto& points = frame->scan.points;
  EXPECT_EQ(23, std::count_if(points.begin(), points.end(), isReturn));
  for (const auto& point : points)
  {
    // A flat wall 2 m ahead, in the sensor's own frame (x ahead).
    EXPECT_TRUE(!isReturn(point) || std::abs(point.x() - 2.0F) < 1e-4F) << point.transpose();
  }
}

TEST(RawlogSource, NamesAMissingExternalFile)
{
  const TestFolder folder;
  {
    auto observation = cloud(1.0, 0);
    observation->setAsExternalStorage("gone.bin",
                                      CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
    ObjectWriter(folder.file("a.rawlog"))(*observation);
  }
  RawlogSource source(folder.file("a.rawlog"));
  const auto message = messageOfError<UserError>([&] { (void)source.next(); });
  EXPECT_TRUE(contains(message, "gone.bin: no such file")) << message;
}

/** A recording of others must not have files of this machine read. */
TEST(RawlogSource, ExternalFilesOutsideOfTheFolderAreRefused)
{
  const TestFolder folder;
  const std::string outside = folder.write("outside.txt", "1 2 3\n");
  std::filesystem::create_directory(folder.file("recording"));
  const std::string rawlog = folder.file("recording/a.rawlog");
  for (const std::string& name : {outside, std::string("../../outside.txt")})
  {
    {
      auto observation = cloud(1.0, 0);
      observation->setAsExternalStorage(
          name, CObservationPointCloud::ExternalStorageFormat::PlainTextFile);
      ObjectWriter writer(rawlog);
      writer(*observation);
    }
    RawlogSource source(rawlog);
    const auto message = messageOfError<UserError>([&] { (void)source.next(); });
    EXPECT_TRUE(contains(message, "outside of its folder")) << message;
  }
  RawlogSourceOptions options;
  options.external_anywhere = true;
  {
    auto observation = cloud(1.0, 0);
    observation->setAsExternalStorage(outside,
                                      CObservationPointCloud::ExternalStorageFormat::PlainTextFile);
    ObjectWriter writer(rawlog);
    writer(*observation);
  }
  EXPECT_NO_THROW((void)RawlogSource(rawlog, options).next());
}

TEST(RawlogSource, ReadsExternalKittiAndTextFiles)
{
  const TestFolder folder;
  const std::array<float, 8> values{1, 2, 3, 0.5F, 4, 5, 6, 0.25F};
  folder.write("a_Images/0.bin",
               std::string(reinterpret_cast<const char*>(values.data()), sizeof values));
  folder.write("a_Images/1.txt", "1 2 3 0.5\n4 5 6 0.25\n");
  {
    ObjectWriter write(folder.file("a.rawlog"));
    auto bin = cloud(1.0, 0);
    bin->setAsExternalStorage("0.bin", CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
    write(*bin);
    auto text = cloud(2.0, 0);
    text->setAsExternalStorage("1.txt",
                               CObservationPointCloud::ExternalStorageFormat::PlainTextFile);
    write(*text);
  }
  RawlogSource source(folder.file("a.rawlog"));
  for (int i = 0; i < 2; ++i)
  {
    const auto frame = source.next();
    ASSERT_TRUE(frame);
    ASSERT_EQ(2U, frame->scan.size());
    EXPECT_EQ(Eigen::Vector3f(4, 5, 6), frame->scan.points[1]);
    EXPECT_EQ(0.25F, frame->scan.intensity.at(1));
  }
}

TEST(RawlogSource, DamagedExternalKittiFilesAreErrors)
{
  const TestFolder folder;
  const std::string rawlog = folder.file("a.rawlog");
  {
    auto bin = cloud(1.0, 0);
    bin->setAsExternalStorage("0.bin", CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
    ObjectWriter write(rawlog);
    write(*bin);
  }
  const std::string values(2 * GzOutput::member_size, '\1');
  std::filesystem::create_directory(folder.file("a_Images"));
  {
    GzOutput file(folder.file("a_Images/0.bin"), 1);
    file.Write(values.data(), values.size());
    file.close();
  }
  EXPECT_EQ(RawlogSource(rawlog).next()->scan.size(), values.size() / 16);
  std::string bytes = folder.read("a_Images/0.bin");
  const std::size_t second = bytes.find("\x1f\x8b\x08", 1);
  ASSERT_NE(second, std::string::npos);
  bytes[second] = 'x';
  (void)folder.write("a_Images/0.bin", bytes);
  RawlogSource source(rawlog);
  const auto message = messageOfError<UserError>([&] { (void)source.next(); });
  EXPECT_TRUE(contains(message, "0.bin: the compressed data are damaged after " +
                                    std::to_string(GzOutput::member_size / 16) + " points"))
      << message;
}

TEST(RawlogSource, VelodynePacketsAgreeWithMrptWhereMrptReadsThem)
{
  DYSLAM_REQUIRE_DATA();
  const std::string path =
      *realDataFolder() + "/misc_16beam_and_formats/test_velodyne_VLP16.rawlog";
  const auto frame = RawlogSource(path).next();
  ASSERT_TRUE(frame);
  const Scan& scan = frame->scan;
  // All 32 returns of each block: twice what MRPT's own conversion keeps.
  EXPECT_EQ(22591U, scan.size());
  EXPECT_EQ(scan.size(), scan.ring.size());
  EXPECT_EQ(15, *std::max_element(scan.ring.begin(), scan.ring.end()));
  EXPECT_NEAR(0.0995, *std::max_element(scan.time.begin(), scan.time.end()), 0.0005);
  EXPECT_NEAR(0.09, scan.T_vehicle_lidar.translation().z(), 1e-6);
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    const auto& p = scan.points[i];
    const double elevation = std::atan2(p.z(), p.head<2>().norm()) * 180 / M_PI;
    ASSERT_NEAR(-15.0 + 2.0 * scan.ring[i], elevation, 0.01);
  }
}

TEST(RawlogSource, RotatingScanIsTheSameSceneAsItsPackets)
{
  DYSLAM_REQUIRE_DATA();
  const std::string folder = *realDataFolder() + "/misc_16beam_and_formats/";
  const auto rotating = RawlogSource(folder + "rot_scan_velodyne.rawlog").next();
  const auto packets = RawlogSource(folder + "test_velodyne_VLP16.rawlog").next();
  ASSERT_TRUE(rotating && packets);
  EXPECT_EQ(11305U, rotating->scan.size());
  EXPECT_EQ(packets->scan.stamp, rotating->scan.stamp);
  std::vector<float> distances;
  for (std::size_t i = 0; i < rotating->scan.size(); i += 11)
  {
    float best = 1e9F;
    for (std::size_t k = 0; k < packets->scan.size(); ++k)
    {
      best = std::min(best, (rotating->scan.points[i] - packets->scan.points[k]).norm());
    }
    distances.push_back(best);
  }
  std::sort(distances.begin(), distances.end());
  EXPECT_LT(distances[distances.size() / 2], 0.02F);
  EXPECT_LT(distances[distances.size() * 99 / 100], 0.2F);
}

/** MRPT 2.5.8 cannot load its own HDL-64E calibration: one with every kind of offset stands in. */
VelodyneCalibration calibrationOf(const std::string& model)
{
  if (model != "HDL64")
  {
    return VelodyneCalibration::LoadDefaultCalibration(model);
  }
  VelodyneCalibration calibration;
  for (int i = 0; i < 64; ++i)
  {
    VelodyneCalibration::PerLaserCalib laser;
    laser.azimuthCorrection = 0;  // MRPT takes its degrees for hundredths of a degree
    laser.verticalCorrection = 2.0 - 0.42 * i;
    laser.distanceCorrection = 1.2 + 0.01 * i;
    laser.verticalOffsetCorrection = 0.02;
    laser.horizontalOffsetCorrection = i % 2 == 0 ? 0.026 : -0.026;
    laser.sinVertCorrection = std::sin(laser.verticalCorrection * M_PI / 180);
    laser.cosVertCorrection = std::cos(laser.verticalCorrection * M_PI / 180);
    laser.sinVertOffsetCorrection = laser.verticalOffsetCorrection * laser.sinVertCorrection;
    laser.cosVertOffsetCorrection = laser.verticalOffsetCorrection * laser.cosVertCorrection;
    calibration.laser_corrections.push_back(laser);
  }
  return calibration;
}

class VelodyneDecoding : public ::testing::TestWithParam<const char*>
{
};

TEST_P(VelodyneDecoding, AgreesWithMrptOnRandomPackets)
{
  const TestFolder folder;
  CObservationVelodyneScan observation;
  observation.timestamp = mrpt::Clock::fromDouble(100.0);
  observation.sensorLabel = "velodyne";
  observation.calibration = calibrationOf(GetParam());
  const bool two_banks = observation.calibration.laser_corrections.size() == 64;
  unsigned state = 1;
  const auto random = [&state](unsigned below)
  {
    state = state * 1664525U + 1013904223U;
    return (state >> 8U) % below;
  };
  for (std::size_t n = 0; n < 40; ++n)
  {
    std::array<std::uint8_t, 1206> bytes{};
    for (std::size_t block = 0; block < 12; ++block)
    {
      std::uint8_t* at = bytes.data() + 100 * block;
      const bool lower = two_banks && block % 2 == 1;
      const std::size_t firing = two_banks ? n * 6 + block / 2 : n * 12 + block;
      const auto azimuth = static_cast<std::uint16_t>(firing * (two_banks ? 4 : 40) % 36000);
      at[0] = 0xff;
      at[1] = lower ? 0xdd : 0xee;
      std::memcpy(at + 2, &azimuth, 2);
      for (std::size_t k = 0; k < 32; ++k)
      {
        const auto range = static_cast<std::uint16_t>(random(10) == 0 ? 0 : 1500 + random(15000));
        std::memcpy(at + 4 + 3 * k, &range, 2);
        at[6 + 3 * k] = static_cast<std::uint8_t>(random(256));
      }
    }
    const auto clock = static_cast<std::uint32_t>(n * 1327);
    std::memcpy(&bytes[1200], &clock, 4);
    bytes[1204] = 0x37;
    bytes[1205] = 0x22;
    static_assert(sizeof(CObservationVelodyneScan::TVelodyneRawPacket) == 1206);
    observation.scan_packets.emplace_back();
    std::memcpy(static_cast<void*>(&observation.scan_packets.back()), bytes.data(), 1206);
  }
  ObjectWriter(folder.file("a.rawlog"))(observation);
  const auto frame = RawlogSource(folder.file("a.rawlog")).next();
  ASSERT_TRUE(frame);
  observation.generatePointCloud();
  const auto& mrpt_cloud = observation.point_cloud;
  ASSERT_GT(mrpt_cloud.size(), 1000U);
  EXPECT_NEAR(2.0, static_cast<double>(frame->scan.size()) / static_cast<double>(mrpt_cloud.size()),
              0.05);
  for (std::size_t i = 0; i < mrpt_cloud.size(); i += 3)
  {
    const Eigen::Vector3f p(mrpt_cloud.x[i], mrpt_cloud.y[i], mrpt_cloud.z[i]);
    float best = 1e9F;
    for (const auto& q : frame->scan.points)
    {
      best = std::min(best, (p - q).norm());
    }
    // MRPT rounds azimuths to 0.01 degrees, moves an HDL-64E's not at all within a firing, and
    // takes the flat part of its vertical offset with the other sign (0.02 m here).
    const float tolerance = two_banks ? 0.02F + 0.0008F * p.norm() : 0.002F + 0.0002F * p.norm();
    ASSERT_LT(best, tolerance) << i << ": " << p.transpose();
  }
}
INSTANTIATE_TEST_SUITE_P(Models, VelodyneDecoding, ::testing::Values("VLP16", "HDL32", "HDL64"));
}  // namespace dyslam
