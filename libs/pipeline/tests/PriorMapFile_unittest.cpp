// SPDX-License-Identifier: BSD-3-Clause
#include "../src/PriorMapFile.h"

#include <dyslam/base/Error.h>
#include <dyslam/formats/ScanFiles.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
std::vector<Eigen::Vector3f> readFrom(const std::string& file)
{
  PriorMapOptions options;
  options.file = file;
  return readPriorMap(options);
}

std::string errorOf(const std::string& file)
{
  return messageOfError<UserError>([&] { (void)readFrom(file); });
}

std::vector<Eigen::Vector3f> cloudAt(float x)
{
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 2000; ++i)
  {
    points.emplace_back(x + 0.1F * static_cast<float>(i % 50), 0.1F * static_cast<float>(i / 50),
                        0);
  }
  return points;
}

TEST(PriorMapFile, IsACloudOrTheFolderOfARun)
{
  const TestFolder folder;
  EXPECT_TRUE(readFrom("").empty());
  writePcd(folder.file("a.pcd"), cloudAt(3));
  writePly(folder.file("b.ply"), cloudAt(3));
  EXPECT_EQ(readFrom(folder.file("a.pcd")).size(), 2000U);
  EXPECT_EQ(readFrom(folder.file("b.ply")).size(), 2000U);
  const std::string run = folder.file("run");
  std::filesystem::create_directory(run);
  EXPECT_NE(errorOf(run).find("has no map_static.pcd or map_static.ply"), std::string::npos);
  writePcd(run + "/map_static.pcd", cloudAt(3));
  EXPECT_EQ(readFrom(run), readFrom(folder.file("a.pcd")));
}

TEST(PriorMapFile, BadFilesAreNamed)
{
  const TestFolder folder;
  const std::string missing = folder.file("none.pcd");
  EXPECT_EQ(errorOf(missing), "prior_map.file: " + missing + ": no such file or folder");
  const std::string other = folder.write("map.las", "LASF");
  EXPECT_EQ(errorOf(other), "prior_map.file: " + other + ": is no .pcd or .ply");
  writePcd(folder.file("few.pcd"), {{1, 2, 3}});
  EXPECT_NE(errorOf(folder.file("few.pcd")).find("has 1 point,"), std::string::npos);
  writePcd(folder.file("utm.pcd"), cloudAt(450000));
  EXPECT_NE(errorOf(folder.file("utm.pcd")).find("not in UTM"), std::string::npos);
  const std::string damaged = folder.write("damaged.pcd", "VERSION 0.7\n");
  EXPECT_EQ(errorOf(damaged).rfind("prior_map.file: " + damaged, 0), 0U) << errorOf(damaged);
}
}  // namespace
}  // namespace dyslam
