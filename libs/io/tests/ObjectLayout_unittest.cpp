// SPDX-License-Identifier: BSD-3-Clause
// Objects of MRPT with every part filled in, and with every count damaged.
#include <dyslam/base/Error.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogStream.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/maps/CColouredPointsMap.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/maps/CWeightedPointsMap.h>
#include <mrpt/math/CMatrixF.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CObservationRotatingScan.h>
#include <mrpt/obs/CObservationVelodyneScan.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <cstring>

#include "MrptBytes.h"
#include "PeakMemory.h"
#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
using namespace mrpt::obs;
using test::bytesOf;

CObservation::Ptr named(CObservation::Ptr observation)
{
  observation->sensorLabel = "lidar";
  observation->timestamp = mrpt::Clock::fromDouble(1e9);
  return observation;
}

template <typename Map>
CObservation::Ptr cloud()
{
  auto observation = CObservationPointCloud::Create();
  auto map = Map::Create();
  for (int i = 0; i < 5; ++i)
  {
    map->insertPoint(1.0F + static_cast<float>(i), 2, 3);
  }
  observation->pointcloud = map;
  return named(observation);
}

CObservation::Ptr velodyne()
{
  auto scan = CObservationVelodyneScan::Create();
  scan->calibration = VelodyneCalibration::LoadDefaultCalibration("VLP16");
  scan->point_cloud.x = scan->point_cloud.y = scan->point_cloud.z = {1, 2, 3};
  scan->point_cloud.intensity = {4, 5, 6};
  scan->point_cloud.timestamp.assign(3, mrpt::Clock::fromDouble(1e9));
  scan->point_cloud.azimuth = {7, 8, 9};
  scan->point_cloud.laser_id = {0, 1, 2};
  scan->point_cloud.pointsForLaserID = {{0}, {1}, {2}};
  return named(scan);
}

CObservation::Ptr rotating()
{
  auto scan = CObservationRotatingScan::Create();
  scan->rowCount = 16;
  scan->columnCount = 4;
  scan->rangeResolution = 0.002;
  scan->rangeImage.resize(16, 4);
  scan->rangeImage.fill(5000);
  scan->intensityImage.resize(16, 4);
  scan->rangeOtherLayers["LAST"] = scan->rangeImage;
  return named(scan);
}

CObservation::Ptr rangeImage()
{
  auto scan = CObservation3DRangeScan::Create();
  scan->hasRangeImage = true;
  scan->rangeImage_setSize(6, 8);
  scan->rangeImage.fill(3000);
  scan->rangeImageOtherLayers["LAST"] = scan->rangeImage;
  scan->cameraParams.ncols = 8;
  scan->cameraParams.nrows = 6;
  scan->cameraParams.cameraName = "depth";
  scan->hasIntensityImage = true;
  scan->intensityImage.resize(8, 6, mrpt::img::CH_GRAY);
  scan->hasConfidenceImage = true;
  scan->confidenceImage.resize(8, 6, mrpt::img::CH_RGB);
  return named(scan);
}

CObservation::Ptr points3d()
{
  auto scan = CObservation3DRangeScan::Create();
  scan->hasPoints3D = true;
  scan->resizePoints3DVectors(4);
  return named(scan);
}

CObservation::Ptr picture()
{
  auto image = CObservationImage::Create();
  image->image.resize(64, 48, mrpt::img::CH_RGB);
  for (int row = 0; row < 48; ++row)
  {
    for (int column = 0; column < 64; ++column)
    {
      image->image.setPixel(column, row, 0x8888A1);
    }
  }
  return named(image);
}

std::vector<CObservation::Ptr> scanObjects()
{
  return {cloud<mrpt::maps::CSimplePointsMap>(),
          cloud<mrpt::maps::CPointsMapXYZI>(),
          cloud<mrpt::maps::CColouredPointsMap>(),
          cloud<mrpt::maps::CWeightedPointsMap>(),
          named(CObservationPointCloud::Create()),  // without points
          velodyne(),
          rotating(),
          rangeImage(),
          points3d()};
}

std::vector<CObservation::Ptr> readStream(const std::string& path)
{
  RawlogStream stream(path);
  std::vector<CObservation::Ptr> read;
  while (auto observation = stream.next())
  {
    read.push_back(observation);
  }
  return read;
}

/** With another name of the same length for a class. */
std::string renamed(std::string bytes, const std::string& from, const std::string& to)
{
  for (auto at = bytes.find(from); at != std::string::npos; at = bytes.find(from, at))
  {
    bytes.replace(at, from.size(), to);
  }
  return bytes;
}
}  // namespace

TEST(ObjectLayout, EveryClassWithAllItsPartsIsRead)
{
  const TestFolder folder;
  auto all = scanObjects();
  all.push_back(named(CObservationRobotPose::Create()));
  for (const auto& scan : all)
  {
    const std::string bytes = bytesOf(*scan);
    const std::string path = folder.write("a.rawlog", bytes + bytes);
    const auto read = readStream(path);
    const auto* range = dynamic_cast<const CObservation3DRangeScan*>(scan.get());
    ASSERT_EQ(2U, read.size()) << scan->GetRuntimeClass()->className;
    if (range == nullptr || !range->hasIntensityImage)
    {
      EXPECT_EQ(bytes, bytesOf(*read[1])) << scan->GetRuntimeClass()->className;
    }
  }
}

TEST(ObjectLayout, ImagesOfRangeScansAreLeftOut)
{
  const TestFolder folder;
  const auto original = rangeImage();
  const auto read = readStream(folder.write("a.rawlog", bytesOf(*original)));
  ASSERT_EQ(1U, read.size());
  const auto& scan = dynamic_cast<const CObservation3DRangeScan&>(*read[0]);
  EXPECT_FALSE(scan.hasIntensityImage);
  EXPECT_FALSE(scan.hasConfidenceImage);
  EXPECT_EQ(6, scan.rangeImage.rows());
  EXPECT_EQ(3000, scan.rangeImage(5, 7));
  EXPECT_EQ("depth", scan.cameraParams.cameraName);
  EXPECT_EQ("lidar", scan.sensorLabel);
}

/** Version 8 has the ranges as a matrix of float32 [m], whose class was CMatrix before MRPT 2. */
TEST(ObjectLayout, RangesOfOlderMrptAreRead)
{
  CObservation3DRangeScan scan;
  scan.hasRangeImage = true;
  scan.rangeImage_setSize(6, 8);
  scan.sensorLabel = "lidar";
  scan.timestamp = mrpt::Clock::fromDouble(1e9);
  mrpt::math::CMatrixF ranges(6, 8);
  ranges.fill(3);
  const TestFolder folder;
  for (const std::string name : {"CMatrixF", "CMatrix"})
  {
    const auto nameSize = [](const std::string& object)
    { return static_cast<std::size_t>(static_cast<unsigned char>(object[0]) & 0x7FU); };
    const std::string now = bytesOf(ranges);
    const std::string matrix =
        static_cast<char>(0x80U | name.size()) + name + now.substr(1 + nameSize(now));
    std::string bytes = bytesOf(scan);
    bytes[1 + nameSize(bytes)] = 8;
    const std::size_t rows = bytes.find(std::string("\6\0\0\0\10\0\0\0", 8));
    ASSERT_NE(std::string::npos, rows);
    constexpr std::size_t unit = sizeof(float);
    bytes.replace(rows - unit, unit + 8 + 6 * 8 * sizeof(std::uint16_t), matrix);
    bytes.erase(bytes.size() - 2, 1);  // number of other layers
    const auto read = readStream(folder.write("a.rawlog", bytes));
    ASSERT_EQ(1U, read.size()) << name;
    const auto& older = dynamic_cast<const CObservation3DRangeScan&>(*read[0]);
    ASSERT_EQ(6, older.rangeImage.rows()) << name;
    EXPECT_NEAR(3000, older.rangeImage(5, 7), 1) << name;
    EXPECT_EQ("lidar", older.sensorLabel) << name;
  }
}

TEST(ObjectLayout, OtherClassesArePassedOver)
{
  const TestFolder folder;
  const auto scan = cloud<mrpt::maps::CPointsMapXYZI>();
  const std::string image = bytesOf(*picture());
  CSensoryFrame frame;
  frame.insert(named(CObservationComment::Create()));
  frame.insert(scan);
  frame.insert(picture());
  CActionCollection actions;
  const std::string path = folder.write(
      "a.rawlog", image + bytesOf(actions) + bytesOf(frame) + image + bytesOf(*scan) + image);
  const auto read = readStream(path);
  std::vector<std::string> classes;
  for (const auto& observation : read)
  {
    const std::string name = observation->GetRuntimeClass()->className;
    classes.push_back(name.substr(name.rfind(':') + 1));
    EXPECT_EQ(classes.back() != "CObservationPointCloud",
              observation->timestamp == INVALID_TIMESTAMP);
  }
  EXPECT_EQ(
      (std::vector<std::string>{"CObservationImage", "CObservationComment",
                                "CObservationPointCloud", "CObservationImage", "CObservationImage",
                                "CObservationPointCloud", "CObservationImage"}),
      classes);
  // One that is cut short is told from the end by its last byte.
  const std::size_t size = image.find('\xA1', 5000) + 1;
  const std::string cut = folder.write("b.rawlog", bytesOf(*scan) + image.substr(0, size));
  EXPECT_THROW((void)readStream(cut), UserError);
}

TEST(ObjectLayout, ClassesThatMrptDoesNotHaveAreLeftOut)
{
  const TestFolder folder;
  const std::string scan = bytesOf(*cloud<mrpt::maps::CPointsMapXYZI>());
  const std::string own = renamed(bytesOf(*picture()), "CObservationImage", "CObservationOther");
  CSensoryFrame frame;
  frame.insert(named(CObservationIMU::Create()));
  frame.insert(cloud<mrpt::maps::CPointsMapXYZI>());
  frame.insert(named(CObservationIMU::Create()));
  const std::string in_frame = renamed(bytesOf(frame), "CObservationIMU", "CObservationOwn");
  const std::string path = folder.write("a.rawlog", own + scan + own + own + in_frame + own);
  EXPECT_EQ(2U, readStream(path).size());
  RawlogSourceOptions options;
  RawlogSource source(path, options);
  while (source.next())
  {
  }
  std::string told;
  for (const std::string& line : source.warnings())
  {
    told += line + '\n';
  }
  EXPECT_TRUE(contains(told, "4 observations of class 'CObservationOther'")) << told;
  EXPECT_TRUE(contains(told, "2 observations of class 'CObservationOwn'")) << told;

  const std::string only = folder.write("b.rawlog", own + own);
  const std::string said = messageOfError<UserError>([&] { RawlogSource nothing(only, options); });
  EXPECT_TRUE(contains(said, "has no 3D scans, only 2 CObservationOther")) << said;
  const std::string cut = folder.write("c.rawlog", scan + own.substr(0, own.size() - 1));
  EXPECT_THROW((void)readStream(cut), UserError);
}

TEST(ObjectLayout, ObjectsOfANewerMrptAreCalledSo)
{
  const TestFolder folder;
  const std::string xyzi = bytesOf(*cloud<mrpt::maps::CPointsMapXYZI>());
  const auto said = [&](const std::string& bytes)
  {
    return messageOfError<UserError>([&]
                                     { (void)readStream(folder.write("a.rawlog", bytes + xyzi)); });
  };
  const auto ofVersion = [](std::string bytes, const std::string& class_name, int version)
  {
    bytes.at(bytes.find(class_name) + class_name.size()) = static_cast<char>(version);
    return bytes;
  };
  const std::string generic = renamed(xyzi, "CPointsMapXYZI", "CPointsMapIRTX");
  EXPECT_TRUE(contains(said(generic),
                       "has points of class 'CPointsMapIRTX', written by a newer "
                       "MRPT than 2.5.8; "))
      << said(generic);
  for (const char* class_name : {"CObservationPointCloud", "CPointsMapXYZI"})
  {
    const std::string text = said(xyzi + ofVersion(xyzi, class_name, 12));
    EXPECT_TRUE(contains(text, "has a " + std::string(class_name) +
                                   " of version 12, written by a newer MRPT than 2.5.8; "))
        << text;
    const std::string damaged = said(xyzi + ofVersion(xyzi, class_name, 116));
    EXPECT_TRUE(contains(damaged, "is damaged after 1 object: a " + std::string(class_name) +
                                      " of version 116, which is not known; copy or record"))
        << damaged;
  }
  CSensoryFrame frame;
  frame.insert(cloud<mrpt::maps::CPointsMapXYZI>());
  EXPECT_TRUE(contains(said(ofVersion(bytesOf(frame), "CSensoryFrame", 12)), "a newer MRPT"));
  // Neither is a name that was damaged.
  EXPECT_FALSE(contains(said(renamed(xyzi, "CPointsMapXYZI", "CPoints\x01\x02pXYZI")), "newer"));
}

TEST(ObjectLayout, TheReasonIsGivenForTheFirstObjectToo)
{
  const TestFolder folder;
  const std::string other = renamed(bytesOf(*picture()), "CObservationImage", "CSomethingUnknown");
  const std::string said =
      messageOfError<UserError>([&] { (void)readStream(folder.write("a.rawlog", other)); });
  EXPECT_TRUE(contains(said, "is not a rawlog")) << said;
  EXPECT_TRUE(contains(said, "an object of class 'CSomethingUnknown', which is not known")) << said;
}

TEST(ObjectLayout, NoCountTakesMemoryThatTheFileHasNot)
{
  const TestFolder folder;
  [[maybe_unused]] const long before = peakMegabytes();
  std::size_t refused = 0;
  for (const auto& scan : scanObjects())
  {
    const std::string whole = bytesOf(*scan);
    for (std::size_t at = 0; at + sizeof(std::uint32_t) <= whole.size(); ++at)
    {
      const std::uint32_t count = at % 2 == 0 ? 0xFFFFFFFFU : 0x10000000U;
      std::string damaged = whole;
      std::memcpy(&damaged[at], &count, sizeof count);
      try
      {
        RawlogSource source(folder.write("a.rawlog", damaged));
        while (source.next())
        {
        }
      }
      catch (const UserError&)
      {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 500U);
#ifndef __SANITIZE_ADDRESS__  // it keeps freed memory
  EXPECT_LT(peakMegabytes() - before, 100);
#endif
}
}  // namespace dyslam
