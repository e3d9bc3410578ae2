// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <cmath>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
std::vector<std::string> namesOf(const std::vector<std::string>& files)
{
  std::vector<std::string> names;
  for (const std::string& file : files)
  {
    names.push_back(std::filesystem::path(file).filename().string());
  }
  return names;
}
}  // namespace

TEST(ScanFiles, RingsBesideBin)
{
  const TestFolder folder;
  writeBin(folder.file("a.bin"), {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}});
  folder.write("a.ring", std::string("\x05\x00\xff", 3));
  EXPECT_EQ((std::vector<std::uint16_t>{5, 0, 255}), readBin(folder.file("a.bin")).ring);
  folder.write("a.ring", "xx");
  EXPECT_THROW((void)readBin(folder.file("a.bin")), UserError);
}

std::string bytesOf(const std::vector<float>& values)
{
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

/** Points on rings with `columns` numbers each; the count of 32 makes whole points of 4, too. */
std::vector<float> ringScan(std::size_t columns, std::size_t points = 320)
{
  std::vector<float> values;
  for (std::size_t i = 0; i < points; ++i)
  {
    const auto k = static_cast<float>(i);
    const std::vector<float> row{3.3F + 0.1F * k, -2.7F, 0.01F * k, k, static_cast<float>(i % 32)};
    values.insert(values.end(), row.begin(), row.begin() + static_cast<std::ptrdiff_t>(columns));
  }
  return values;
}

TEST(ScanFiles, FiveColumnsAreRecognisedAndRead)
{
  const TestFolder folder;
  const std::string path = folder.write("a.bin", bytesOf(ringScan(5)));
  ASSERT_EQ(0U, std::filesystem::file_size(path) % 16) << "the size alone does not tell";
  EXPECT_EQ(nuscenes_layout, binLayoutOf(path));
  folder.write("a.ring", "of another file");
  const Scan scan = readBin(path, nuscenes_layout);
  ASSERT_EQ(320U, scan.size());
  EXPECT_TRUE(scan.points[33].isApprox(Eigen::Vector3f(6.6F, -2.7F, 0.33F), 1e-5F));
  EXPECT_EQ(33.0F, scan.intensity[33]);
  EXPECT_EQ(1, scan.ring[33]);
  std::vector<float> bad = ringScan(5);
  for (const float number : {-1.0F, 0.5F, 65536.0F, std::nanf("")})
  {
    bad[9] = number;
    folder.write("a.bin", bytesOf(bad));
    EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)readBin(path, nuscenes_layout); }),
                         "number 5 of point 1"))
        << number;
  }
  folder.write("a.bin", bytesOf(ringScan(5)).substr(0, 100 * 20 - 4));
  const std::string message =
      messageOfError<UserError>([&] { (void)readBin(path, nuscenes_layout); });
  EXPECT_TRUE(contains(message, "not whole points of 5 floats")) << message;
  EXPECT_TRUE(contains(message, "--bin-layout of dyslam and scans2rawlog")) << message;
}

TEST(ScanFiles, LayoutsNameTheColumns)
{
  const TestFolder folder;
  std::vector<float> values;
  for (int i = 0; i < 20; ++i)
  {
    const auto k = static_cast<float>(i);
    values.insert(values.end(), {0.5F * k, 7, 0.005F * k, 3 + k, 1, 2});
  }
  const std::string path = folder.write("a.bin", bytesOf(values));
  const Scan scan = readBin(path, "i_tzxy");
  ASSERT_EQ(20U, scan.size());
  EXPECT_EQ(scan.points[2], Eigen::Vector3f(1, 2, 5));
  EXPECT_EQ(scan.intensity[2], 1);
  EXPECT_FLOAT_EQ(scan.time[2], 0.01F);
  EXPECT_TRUE(scan.ring.empty());
  const Scan plain = readBin(path, "xyz");
  ASSERT_EQ(40U, plain.size());
  EXPECT_EQ(plain.points[5], Eigen::Vector3f(5, 1, 2));
  EXPECT_TRUE(plain.intensity.empty());
  EXPECT_TRUE(plain.time.empty());
  EXPECT_NO_THROW(requireBinLayout("xyz__i"));
  for (const char* wrong : {"", "xyi", "xyzz", "xyzii", "xyza", "XYZI"})
  {
    EXPECT_TRUE(contains(messageOfError<UserError>([&] { requireBinLayout(wrong); }),
                         "give a letter for each column"))
        << wrong;
  }
}

TEST(ScanFiles, FourColumnsAreNeverTakenForFive)
{
  const TestFolder folder;
  const auto layoutOf = [&folder](const std::vector<float>& values)
  { return binLayoutOf(folder.write("a.bin", bytesOf(values))); };
  EXPECT_EQ(kitti_layout, layoutOf({}));
  EXPECT_EQ(kitti_layout, layoutOf(ringScan(4)));
  EXPECT_EQ(kitti_layout, layoutOf(std::vector<float>(4000, 0)));
  // Coordinates in whole metres, with intensities of both kinds.
  for (const float intensity : {7.0F, 0.5F})
  {
    std::vector<float> grid;
    for (std::size_t i = 0; i < 1000; ++i)
    {
      const auto k = static_cast<float>(i % 100);
      grid.insert(grid.end(), {k, 2 * k, 1, intensity});
    }
    EXPECT_EQ(kitti_layout, layoutOf(grid)) << intensity;
  }
  // A scan that was cut short behind whole points of five.
  std::vector<float> cut = ringScan(4);
  cut.resize(1005);
  EXPECT_EQ(kitti_layout, layoutOf(cut));
  // Five columns, but the fifth is a time.
  std::vector<float> timed = ringScan(5);
  for (std::size_t i = 4; i < timed.size(); i += 5)
  {
    timed[i] = 0.001F * static_cast<float>(i);
  }
  EXPECT_EQ(kitti_layout, layoutOf(timed));
}

TEST(ScanFiles, FourColumnsOfRealScansAreNotTakenForFive)
{
  DYSLAM_REQUIRE_DATA();
  for (const char* name : {"/hdl32_nuscenes", "/hdl32_nclt", "/hdl64_singles_other", "/vlp16_run30",
                           "/sfnd_lidar_data_1/velodyne"})
  {
    for (const std::string& file : listBinFiles(*realDataFolder() + name))
    {
      EXPECT_EQ(kitti_layout, binLayoutOf(file)) << file;
    }
  }
}

TEST(ScanFiles, ListsInNumericalOrder)
{
  const TestFolder folder;
  for (const char* name : {"10.bin", "9.bin", "007.bin", "100.bin", "notes.txt"})
  {
    folder.write(name, "");
  }
  const std::vector<std::string> expected{"007.bin", "9.bin", "10.bin", "100.bin"};
  EXPECT_EQ(expected, namesOf(listCloudFiles(folder.path())));
  folder.write("a.pcd", "");
  EXPECT_THROW((void)listCloudFiles(folder.path()), UserError);
  EXPECT_EQ(expected, namesOf(listBinFiles(folder.path())));
  EXPECT_THROW((void)listCloudFiles(folder.file("none")), UserError);
  EXPECT_THROW((void)listBinFiles(folder.file("none")), UserError);
  std::filesystem::create_directories(folder.file("empty"));
  EXPECT_THROW((void)listCloudFiles(folder.file("empty")), UserError);
  EXPECT_THROW((void)listBinFiles(folder.file("empty")), UserError);
}

// Reading the first page of one's own memory fails with EIO: an end that is not the file's.
TEST(ReadErrors, AreNotTheEndOfTheFile)
{
  const std::string path = "/proc/self/mem";
  if (!std::filesystem::exists(path))
  {
    GTEST_SKIP() << "needs Linux's /proc";
  }
  const auto expectError = [](const auto& read)
  {
    const std::string message = messageOfError<UserError>(read);
    EXPECT_TRUE(contains(message, "cannot be read to its end: Input/output error")) << message;
  };
  expectError([&] { (void)readWhole(path); });
  expectError([&] { (void)readBin(path); });
  expectError([&] { (void)readLabels(path); });
  expectError([&] { (void)readTum(path); });
  expectError([&] { (void)readTimes(path); });
}
}  // namespace dyslam
