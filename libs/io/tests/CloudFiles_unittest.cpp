// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/io/CloudFiles.h>

#include <cstring>
#include <limits>

#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
class CloudFormats : public ::testing::TestWithParam<const char*>
{
};

TEST_P(CloudFormats, RoundTrip)
{
  const TestFolder folder;
  const std::string path = folder.file(std::string("a.") + GetParam());
  Scan scan = someScan(1, 30);
  scan.points[3] = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  scan.points[4].setZero();
  for (const std::size_t size : {std::size_t{30}, std::size_t{1}})
  {
    scan.points.resize(size);
    scan.intensity.resize(size);
    writeCloud(path, scan.points, scan.intensity);
    const Scan read = readCloud(path);
    EXPECT_TRUE(samePoints(scan, read));
    EXPECT_EQ(scan.intensity, read.intensity);
    EXPECT_TRUE(read.time.empty());
    EXPECT_TRUE(read.ring.empty());
  }
  writeCloud(path, scan.points);
  const Scan read = readCloud(path);
  EXPECT_TRUE(samePoints(scan, read));
  EXPECT_EQ(std::string(GetParam()) == "bin", !read.intensity.empty());
  EXPECT_FALSE(std::filesystem::exists(path + ".tmp"));
}

TEST_P(CloudFormats, BadFiles)
{
  const TestFolder folder;
  const std::string name = std::string("a.") + GetParam();
  EXPECT_THROW((void)readCloud(folder.file(name)), UserError);
  EXPECT_THROW((void)readCloud(folder.write(name, "some text that is no cloud")), UserError);
  const Scan scan = someScan(1, 100);
  writeCloud(folder.file(name), scan.points, scan.intensity);
  const std::string whole = folder.read(name);
  EXPECT_THROW((void)readCloud(folder.write(name, whole.substr(0, whole.size() - 103))), UserError);
  EXPECT_THROW(writeCloud(folder.file("no/such/folder/" + name), scan.points), UserError);
  EXPECT_THROW(writeCloud(folder.file(name), scan.points, {1.0F}), std::logic_error);
}
INSTANTIATE_TEST_SUITE_P(Kinds, CloudFormats, ::testing::Values("bin", "pcd", "ply"));

TEST(CloudFiles, EmptyCloudsOfEachKind)
{
  const TestFolder folder;
  for (const std::string name : {"a.bin", "a.pcd", "a.ply"})
  {
    writeCloud(folder.file(name), {});
    EXPECT_TRUE(std::filesystem::exists(folder.file(name)));
  }
  EXPECT_EQ(0U, readCloud(folder.file("a.bin")).size());
}

TEST(CloudFiles, OtherFieldsOfPcdAndPly)
{
  const TestFolder folder;
  folder.write("a.pcd",
               "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
               "FIELDS x y z intensity ring time\nSIZE 4 4 4 4 2 8\nTYPE F F F F U F\n"
               "COUNT 1 1 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\n"
               "DATA ascii\n1 2 3 40 7 1500000000.5\n4 5 6 80 9 1500000000.25\n");
  const Scan pcd = readCloud(folder.file("a.pcd"));
  ASSERT_EQ(2U, pcd.size());
  EXPECT_EQ((std::vector<std::uint16_t>{7, 9}), pcd.ring);
  EXPECT_EQ(1500000000.25, pcd.stamp);
  EXPECT_EQ((std::vector<float>{0.25F, 0.0F}), pcd.time);
  EXPECT_EQ((std::vector<float>{40, 80}), pcd.intensity);

  folder.write("b.ply",
               "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
               "property double z\nproperty uint t\nend_header\n1 2 3 0\n4 5 6 50000000\n");
  const Scan ply = readCloud(folder.file("b.ply"));
  ASSERT_EQ(2U, ply.size());
  EXPECT_EQ(Eigen::Vector3f(4, 5, 6), ply.points[1]);
  EXPECT_EQ((std::vector<float>{0.0F, 0.05F}), ply.time);
}

TEST(CloudFiles, TimesOf64Bits)
{
  const TestFolder folder;
  const std::string header =
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z t\nSIZE 4 4 4 8\n"
      "TYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\n"
      "DATA binary\n";
  std::string bytes(40, '\0');
  for (std::size_t i = 0; i < 2; ++i)
  {
    const float x = 1.0F + static_cast<float>(i);
    const std::uint64_t nanoseconds = 1500000000000000000U + i * 50000000U;
    std::memcpy(&bytes[20 * i], &x, sizeof x);
    std::memcpy(&bytes[20 * i + 12], &nanoseconds, sizeof nanoseconds);
  }
  const Scan scan = readCloud(folder.write("a.pcd", header + bytes));
  ASSERT_EQ(2U, scan.time.size());
  EXPECT_DOUBLE_EQ(1500000000.0, scan.stamp);
  EXPECT_EQ(0.0F, scan.time[0]);
  EXPECT_NEAR(0.05F, scan.time[1], 1e-6F);
}

TEST(CloudFiles, RealPly)
{
  DYSLAM_REQUIRE_DATA();
  const Scan scan = readCloud(*realDataFolder() + "/registration_pairs/small_gicp_source.ply");
  EXPECT_EQ(69792U, scan.size());
  EXPECT_EQ(69792U, scan.intensity.size());
}
}  // namespace dyslam
