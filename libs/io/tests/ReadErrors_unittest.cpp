// SPDX-License-Identifier: BSD-3-Clause
// Whatever cannot be read is an error, never the end of the file.
#include <dyslam/base/Config.h>
#include <dyslam/base/Error.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/GraphFiles.h>
#include <dyslam/packets/PcapSource.h>
#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>

#include "../src/rawlog/GzInput.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** The first page of a process's memory is not mapped: reading it fails with EIO. */
std::string unreadable(const TestFolder& folder, const std::string& name)
{
  std::filesystem::create_symlink("/proc/self/mem", folder.file(name));
  return folder.file(name);
}

TEST(ReadErrors, EveryReaderTellsThemFromTheEnd)
{
  const std::vector<std::pair<std::string, std::function<void(const std::string&)>>> readers{
      {"x.ini", [](const std::string& path) { (void)Config::fromFile(path); }},
      {"x.bin", [](const std::string& path) { (void)readCloud(path); }},
      {"x.pcd", [](const std::string& path) { (void)readCloud(path); }},
      {"x.ply", [](const std::string& path) { (void)readCloud(path); }},
      {"x.label", [](const std::string& path) { (void)readLabels(path, 10); }},
      {"tum.txt", [](const std::string& path) { (void)readTum(path); }},
      {"kitti.txt", [](const std::string& path) { (void)readKittiPoses(path); }},
      {"tracks.txt", [](const std::string& path) { (void)readTracks(path); }},
      {"x.g2o", [](const std::string& path) { (void)readPoseGraph(path); }},
      {"x.pcap", [](const std::string& path) { (void)PcapSource(path); }},
  };
  for (const auto& [name, read] : readers)
  {
    const TestFolder folder;
    const std::string path = unreadable(folder, name);
    try
    {
      read(path);
      ADD_FAILURE() << name << " is read as if it were whole";
    }
    catch (const UserError& error)
    {
      const std::string what = error.what();
      EXPECT_NE(what.find(path), std::string::npos) << what;
      EXPECT_NE(what.find("Input/output error"), std::string::npos) << what;
    }
  }
}

TEST(ReadErrors, AGzipStreamIsNeitherCutNorBroken)
{
  const TestFolder folder;
  GzInput reading(unreadable(folder, "x.rawlog"));
  char byte = 0;
  EXPECT_THROW(reading.Read(&byte, 1), std::runtime_error);
  EXPECT_NE(reading.readError().find("Input/output error"), std::string::npos);
  EXPECT_FALSE(reading.cut() || reading.broken());

  GzInput ending(folder.file("x.rawlog"));
  EXPECT_TRUE(ending.atEnd());
  EXPECT_NE(ending.readError().find("Input/output error"), std::string::npos);
  EXPECT_FALSE(ending.cut() || ending.broken());
}
}  // namespace
}  // namespace dyslam
